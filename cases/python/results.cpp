#include "cases/python/bindings.h"
#include "cases/results/run_json.h"
#include "cases/results/schema.h"
#include "cases/scene/design/goal.h"

namespace flexmorph::python {
namespace {

void add_motion(py::dict& tables, const char* name,
                const std::optional<cases::MotionRecord>& from) {
  if (from) tables[name] = dict_of(from->table);
}

}  // namespace

py::object object_of(const cases::Value& value) {
  return std::visit(
      [](const auto& v) -> py::object {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, std::monostate> || std::is_same_v<T, std::nullptr_t>)
          return py::none();
        else
          return py::cast(v);
      },
      value);
}

py::array_t<double> on_grid(const Grid& g, const VectorXd& field) {
  py::array_t<double> out({g.ny, g.nx});
  auto view = out.mutable_unchecked<2>();
  for (int i = 0; i < g.nx; ++i)
    for (int j = 0; j < g.ny; ++j) view(j, i) = field[g.cell(i, j)];
  return out;
}

VectorXd from_grid(const Grid& g, const py::object& array) {
  const auto given = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!given || given.ndim() != 2 || given.shape(0) != g.ny || given.shape(1) != g.nx) {
    PyErr_Clear();
    throw py::value_error("a field of the cells has the shape (" + std::to_string(g.ny) + ", " +
                          std::to_string(g.nx) + ")");
  }
  VectorXd out(g.n_cells());
  const auto view = given.unchecked<2>();
  for (int i = 0; i < g.nx; ++i)
    for (int j = 0; j < g.ny; ++j) out[g.cell(i, j)] = view(j, i);
  return out;
}

py::array_t<double> array_of(const std::vector<Component>& components) {
  py::array_t<double> out({static_cast<py::ssize_t>(components.size()),
                           static_cast<py::ssize_t>(Component::kParameters)});
  double* at = out.mutable_data();
  for (const Component& c : components)
    for (const double p : c.parameters()) *at++ = p;
  return out;
}

std::vector<Component> components_of(
    const py::array_t<double, py::array::c_style | py::array::forcecast>& array) {
  if (array.ndim() != 2 || array.shape(1) != Component::kParameters)
    throw py::value_error("components are an array of the shape (N, 7)");
  std::vector<Component> out;
  for (py::ssize_t k = 0; k < array.shape(0); ++k)
    out.push_back(Component::from_parameters(array.data(k, 0)));
  return out;
}

py::dict dict_of(const cases::Series& table) {
  const auto rows = static_cast<py::ssize_t>(table.n_rows());
  const auto n = static_cast<py::ssize_t>(table.columns.size());
  py::array_t<double> values({rows, n});
  auto view = values.mutable_unchecked<2>();
  py::list names, units, meanings;
  for (py::ssize_t c = 0; c < n; ++c) {
    const auto k = static_cast<size_t>(c);
    names.append(table.columns[k].name);
    units.append(table.columns[k].unit);
    meanings.append(table.columns[k].meaning);
    for (py::ssize_t r = 0; r < rows; ++r) view(r, c) = table.values[k][static_cast<size_t>(r)];
  }
  py::dict out;
  out["names"] = names;
  out["units"] = units;
  out["meanings"] = meanings;
  out["values"] = values;
  return out;
}

py::dict dict_of(const cases::Scene& scene, const mmc::IterationReport& report) {
  py::dict out;
  for (const auto& quantity : cases::iteration_quantities())
    out[quantity.name] = object_of(quantity.value(report));
  for (const mmc::ResponseRow* further : cases::further_rows(scene)) {
    const std::optional<VectorXd> values = report.state.values(*further);
    out[mmc::key_of(*further).c_str()] =
        values ? py::object(py::float_(values->maxCoeff())) : py::object(py::none());
  }
  out["x"] = VectorXd(*report.iterate.x);
  return out;
}

py::dict dict_of(const cases::Scene& scene, const cases::RunResult& result) {
  py::dict tables;
  add_motion(tables, "motion", result.motions.motion);
  add_motion(tables, "motion_uniform", result.motions.uniform);
  add_motion(tables, "motion_verified", result.motions.verified);
  add_motion(tables, "motion_verified_uniform", result.motions.verified_uniform);
  if (result.path) tables["path"] = dict_of(result.path->table);
  py::dict components;
  for (const mmc::BodyProblem& problem : result.design.problems)
    components[problem.body.c_str()] = array_of(problem.design.components());
  py::dict out;
  out["json"] = cases::run_json(scene, result);
  out["tables"] = tables;
  out["components"] = components;
  return out;
}

std::function<void(const mmc::IterationReport&)> observer_of(const py::object& function,
                                                             const cases::Scene& scene,
                                                             const StopFlag& flag) {
  const Callback callback(function);
  if (!callback) return {};
  return [callback, &scene, flag](const mmc::IterationReport& report) {
    const py::gil_scoped_acquire acquire;
    const py::object answer = callback.get()(dict_of(scene, report));
    if (answer.ptr() == Py_True) flag.stop();
  };
}

}  // namespace flexmorph::python
