#include "cases/run/path_run.h"

#include "cases/results/body_measures.h"
#include "cases/results/failure.h"
#include "cases/run/motion_run.h"
#include "cases/scene/elements/row.h"

namespace flexmorph::cases {
namespace {

fem::StaticSettings settings_of(const StaticAnalysis& analysis) {
  fem::StaticSettings out;
  out.path = analysis.path;
  out.to = analysis.to;
  out.first_step = 1.0 / analysis.steps;
  out.largest_step = out.first_step;
  out.max_steps = analysis.max_steps;
  out.max_iterations = analysis.max_iterations;
  return out;
}

/// Of loads and temperatures, what does not grow along the path is put on before, step by step.
void put_on(const Scene& scene, fem::Workspace& model, fem::State& x) {
  const StaticAnalysis& analysis = *scene.statics;
  model.scale_loads(0);
  const bool loads = !analysis.loads_grow && (!scene.loads.empty() || scene.gravity),
             temperatures = !analysis.temperatures_grow;
  if (loads || temperatures) {
    model.choose_scaled(loads, temperatures);
    fem::StaticSettings settings = settings_of(analysis);
    settings.path = fem::StaticSettings::Path::load;
    settings.to = 1;
    fem::solve_static(model, x, settings, {});
  }
  model.choose_scaled(analysis.loads_grow, analysis.temperatures_grow);
}

/// path.csv, a row per equilibrium, which grows with the path: what a run was killed after is on
/// the disk.
class PathTable {
 public:
  explicit PathTable(std::string path) : path_(std::move(path)) {}

  /// The last equilibrium of a record, whose columns of bodies may still be elsewhere.
  void add(const PathRecord& path, const std::vector<Column>& measured) {
    std::vector<std::string> names = {"step", "load_factor"};
    std::vector<io::Cell> row = {static_cast<int>(path.factor.size()) - 1, path.factor.back()};
    for (const auto* group : {&path.observed, &measured})
      for (const Column& column : *group) {
        names.push_back(column.name);
        row.emplace_back(column.values.back());
      }
    names.insert(names.end(), {"energy.strain", "iterations"});
    row.emplace_back(path.strain.back());
    row.emplace_back(path.iterations.back());
    if (!csv_) csv_.emplace(path_, names);
    csv_->row(row);
  }

 private:
  std::string path_;
  std::optional<io::CsvWriter> csv_;
};

}  // namespace

PathRecord run_path(const Scene& scene, RunFolder& folder, const PathWishes& wishes) {
  Mechanism mechanism = build_mechanism(scene);
  fem::Workspace& model = mechanism.model;
  fem::State x =
      fem::start_state(model, mechanism.growths, 0, fem::Start::rigid, mechanism.motion.placement);
  BodyMeasures measures(scene, model, x);
  PathRecord out;
  PathTable table(folder.file("path.csv"));
  static const char* const kAxes[] = {"_ux", "_uy", "_uz"};
  for (const Observe& o : scene.observed)
    for (int c = 0; c < scene.body(o.body).dim(); ++c)
      out.observed.push_back({o.body + "." + o.name + kAxes[c], {}});
  std::vector<Vec3> starts;  // of the observed points
  for (const Observe& o : scene.observed) {
    const Body& body = scene.body(o.body);
    // Of a body with lines it may still be in the hub; of one without, it may be on an arc.
    starts.push_back(body.row->lines ? start_pose(scene, body).place(o.point)
                                     : fem::point_position(model.body(o.body), x, o.point));
  }
  const VectorXd scales = model.scales();
  VectorXd before = x.q;
  const auto observe = [&](const fem::StaticStep& step) {
    const double way = (step.x.q - before).cwiseProduct(scales).norm();
    out.arc.push_back(out.arc.empty() ? 0 : out.arc.back() + way);
    before = step.x.q;
    const fem::Energies energies = model.energies(step.x);
    out.factor.push_back(step.factor);
    out.iterations.push_back(step.iterations);
    out.strain.push_back(energies.strain);
    size_t column = 0;
    for (size_t i = 0; i < scene.observed.size(); ++i) {
      const Observe& o = scene.observed[i];
      const Vec3 u = fem::point_position(model.body(o.body), step.x, o.point) - starts[i];
      for (int c = 0; c < scene.body(o.body).dim(); ++c)
        out.observed[column++].values.push_back(u[c]);
    }
    const double heating = scene.statics->temperatures_grow ? step.factor : 1;
    measures.add(model, step.x, heating);
    table.add(out, measures.columns());
    if (scene.output.vtk)
      for (size_t i = 0; i < scene.bodies.size(); ++i)
        folder.add_surface_frame(model.body(scene.bodies[i].name), step.x,
                                 start_pose(scene, scene.bodies[i]), step.number,
                                 static_cast<int>(i), heating);
    if (wishes.way) wishes.way(step.factor);
    if (wishes.go_on && !wishes.go_on()) throw Interrupted();
    return true;
  };
  try {
    if (scene.has_heat()) put_on(scene, model, x);
    fem::StaticSettings settings = settings_of(*scene.statics);
    settings.condition = wishes.condition;
    out.result = fem::solve_static(model, x, settings, observe);
  } catch (const Error& error) {
    out.measured = measures.take();
    Failure where;
    where.phase = "statics";
    where.load_factor = out.factor.empty() ? 0 : out.factor.back();
    where.step = std::max(0, static_cast<int>(out.factor.size()) - 1);  // the start is none
    throw FailedRun(error, where);
  }
  out.measured = measures.take();
  return out;
}

}  // namespace flexmorph::cases
