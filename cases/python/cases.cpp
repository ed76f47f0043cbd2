#include "cases/check/check.h"
#include "cases/output/run_folder.h"
#include "cases/python/bindings.h"
#include "cases/results/failure.h"
#include "cases/results/motion_columns.h"
#include "cases/results/schema.h"
#include "cases/run/finished_run.h"
#include "cases/run/motion_run.h"
#include "cases/scene/design/goal.h"
#include "geometry/plain_numbers.h"
#include "optim/mmc/problem/finished_part.h"

namespace flexmorph::python {
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Loads a case from a file or a shipped case (`name`), or from a text.
Case load(const std::string& name, const std::optional<std::string>& text,
          const std::vector<std::string>& changes, int threads) {
  if (threads < 1 || threads > 256) throw Error::input("threads lies between 1 and 256");
  std::shared_ptr<const cases::ReadyCase> ready;
  compute_in_thread(
      [&] {
        io::CaseFile file = text ? io::CaseFile::of_text(*text, name, changes)
                                 : io::CaseFile(cases::find_case(name), changes);
        ready =
            std::make_shared<const cases::ReadyCase>(cases::ready_case(std::move(file), changes));
      },
      threads, StopFlag());
  return {ready, threads};
}

cases::ComputeSettings settings_of(const Case& of, const py::object& progress,
                                   const py::object& callback, const StopFlag& flag) {
  cases::ComputeSettings out;
  out.threads = of.threads;
  out.keep_running = callback_of(flag);
  out.iteration = observer_of(callback, of.prepared().scene(), flag);
  if (const Callback say(progress); say)
    out.say = [say](const std::string& words) {
      const py::gil_scoped_acquire acquire;
      say.get()(words);
    };
  return out;
}

/// Throws the error of a run again unless a callback has ended the run.
void pass_on(const std::exception_ptr& error) {
  try {
    if (error) std::rethrow_exception(error);
  } catch (const cases::Interrupted&) {
  }
}

py::dict compute(const Case& of, const py::object& progress, const py::object& callback) {
  const StopFlag flag;
  const cases::ComputeSettings settings = settings_of(of, progress, callback, flag);
  cases::EndedRun ended;
  compute_in_thread([&] { ended = cases::compute_as_far_as_possible(of.prepared(), settings); },
                    of.threads, flag);
  pass_on(ended.error);
  return dict_of(of.prepared().scene(), ended.result);
}

int compute_into(const Case& of, const std::string& folder, bool resume, const py::object& progress,
                 const py::object& callback) {
  const StopFlag flag;
  const cases::ComputeSettings settings = settings_of(of, progress, callback, flag);
  int code = 0;
  compute_in_thread([&] { code = cases::compute_into(*of.ready, folder, settings, resume); },
                    of.threads, flag);
  return code;
}

py::dict motion(const Case& of, const std::map<std::string, Array>& designs,
                const std::optional<double>& step, int cells) {
  cases::MotionRequest request;
  const StopFlag flag;
  if (of.prepared().scene().domain || of.prepared().scene().statics)
    throw Error::input("this case has no motion");
  for (const mmc::BodyProblem& p : of.prepared().design_problems()) {
    const auto given = designs.find(p.body);
    request.factors.push_back(mmc::dynamic_factors(
        p, given == designs.end() ? p.design.components() : components_of(given->second)));
  }
  request.step = step;
  request.mesh.cells = cells;
  request.keep_running = callback_of(flag);
  cases::MotionOutcome outcome;
  compute_in_thread([&] { outcome = cases::run_motion(of.prepared(), request); }, of.threads, flag);
  return dict_of(outcome.record.table);
}

const mmc::BodyProblem& problem_of(const Case& of, const std::string& body) {
  for (const mmc::BodyProblem& p : of.prepared().design_problems())
    if (p.body == body) return p;
  throw Error::input("body '" + body + "' is not designed");
}

py::array_t<double> points_of(const std::vector<Vec2>& ring) {
  py::array_t<double> out({static_cast<py::ssize_t>(ring.size()), static_cast<py::ssize_t>(2)});
  double* at = out.mutable_data();
  for (const Vec2& p : ring) *at++ = p.x(), *at++ = p.y();
  return out;
}

/// Returns the geometry of a design: edges of the cells, density, and polygons of the outline.
py::dict geometry(const Case& of, const std::string& body, const Array& components) {
  const mmc::BodyProblem& p = problem_of(of, body);
  const std::vector<Component> all = components_of(components);
  VectorXd density;
  std::vector<Region> regions;
  compute_in_thread(
      [&] {
        density = mmc::part_fractions(p, all);
        regions = mmc::part_of(p, all, mmc::kOutlineTolerance * p.grid.dx());
      },
      of.threads, StopFlag());
  const Grid& g = p.grid;
  py::list outline;
  for (const Region& region : regions) {
    py::list holes;
    for (const std::vector<Vec2>& hole : region.holes) holes.append(points_of(hole));
    outline.append(py::make_tuple(points_of(region.outer), holes));
  }
  py::dict out;
  out["x"] = VectorXd(VectorXd::LinSpaced(g.nx + 1, g.x0, g.x0 + g.width));
  out["y"] = VectorXd(VectorXd::LinSpaced(g.ny + 1, g.y0, g.y0 + g.height));
  out["density"] = on_grid(g, density);
  out["outline"] = outline;
  return out;
}

/// Returns unit and meaning of every column of the tables of a case.
py::dict columns(const Case& of) {
  py::dict out;
  const auto add = [&](const std::string& name, const std::string& unit,
                       const std::string& meaning) {
    out[name.c_str()] = py::make_tuple(unit, meaning);
  };
  const cases::Scene& scene = of.prepared().scene();
  std::vector<cases::ColumnInfo> all;
  if (scene.statics)
    all = cases::path_columns(scene);
  else if (!scene.domain)
    all = cases::MotionColumns(scene, of.prepared().mechanism().moving_roots, true).columns();
  for (const cases::ColumnInfo& each : all) add(each.name, each.unit, each.meaning);
  for (const auto& each : cases::iteration_quantities()) add(each.name, each.unit, each.meaning);
  for (const mmc::ResponseRow* row : cases::further_rows(scene))
    add(mmc::key_of(*row), std::string(row->unit), std::string(row->words));
  return out;
}

py::dict start_designs(const Case& of) {
  py::dict out;
  for (const mmc::BodyProblem& p : of.prepared().design_problems())
    out[p.body.c_str()] = array_of(p.design.components());
  return out;
}

}  // namespace

void bind_cases(py::module_& m) {
  py::class_<Case>(m, "Case")
      .def_property_readonly("name", [](const Case& c) { return c.prepared().scene().name; })
      .def_property_readonly("title", [](const Case& c) { return c.prepared().scene().title; })
      .def_property_readonly("threads", [](const Case& c) { return c.threads; })
      .def_property_readonly("text", [](const Case& c) { return c.ready->file.text(); })
      .def("explained", [](const Case& c) { return c.ready->file.explained(); })
      .def("check",
           [](const Case& c) {
             const PlainNumbers plain;
             return cases::check_text(c.prepared());
           })
      .def("compute", &compute)
      .def("compute_into", &compute_into)
      .def("motion", &motion)
      .def("geometry", &geometry)
      .def("columns", &columns)
      .def("start_designs", &start_designs)
      .def("components_file", [](const Case& c, const std::string& body) {
        return cases::components_name(c.prepared().scene(), body);
      });
  m.def("load", &load);
}

}  // namespace flexmorph::python
