#include "cases/run/run_folder.h"

#include <cmath>

#include "cases/scene/design/goal.h"
#include "cases/scene/elements/row.h"
#include "geometry/cpu_time.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

const std::vector<std::string> kHistoryColumns = {"body",
                                                  "cycle",
                                                  "iteration",
                                                  "evaluations",
                                                  "scaled_objective",
                                                  "compliance",
                                                  "volume",
                                                  "violation",
                                                  "kkt",
                                                  "change",
                                                  "band",
                                                  "sharp_compliance",
                                                  "sharp_volume",
                                                  "connected",
                                                  "min_feature"};
/// Between these and what follows are the responses of further_rows().
const std::vector<std::string> kHistorySeconds = {"seconds_tdf",       "seconds_factor",
                                                  "seconds_solve",     "seconds_sensitivity",
                                                  "seconds_optimizer", "seconds_output"};

std::string numbered(const std::string& stem, int number, const std::string& ending) {
  std::string digits = io::to_text(number);
  return stem + std::string(digits.size() < 5 ? 5 - digits.size() : 0, '0') + digits + ending;
}

}  // namespace

const std::vector<double>* MotionRecord::column(const std::string& name) const {
  for (const auto* columns : {&observed, &measured, &mechanism, &written})
    for (const Column& column : *columns)
      if (column.name == name) return &column.values;
  return nullptr;
}

const std::vector<double>* PathRecord::column(const std::string& name) const {
  for (const auto* columns : {&observed, &measured})
    for (const Column& column : *columns)
      if (column.name == name) return &column.values;
  return nullptr;
}

double tip_deflection(const fem::Model& model, const fem::Growth& growth, const fem::State& x) {
  const fem::Body& body = model.body(growth.body);
  const fem::LineGrid& mesh = fem::grid_of(body);
  const fem::FrameMotion hub = growth.hub.at(model, x);
  const Vec2 tip = fem::point_motion(body, x, {mesh.line_m(mesh.n_m()).value, 0}).position;
  return Vec2(-std::sin(hub.angle), std::cos(hub.angle)).dot(tip - hub.origin);
}

RunFolder::RunFolder(std::string path, const Scene& scene, bool beside)
    : folder_(std::move(path)),
      scene_(scene),
      iterations_(*this, "design/iterations.pvd"),
      components_(*this, "design/components.pvd"),
      motion_(*this, "motion/motion.pvd"),
      writer_(beside) {
  if (scene.designs.empty()) return;
  std::vector<std::string> columns = kHistoryColumns;
  for (const mmc::ResponseRow* row : further_rows(scene)) columns.push_back(mmc::key_of(*row));
  columns.insert(columns.end(), kHistorySeconds.begin(), kHistorySeconds.end());
  history_ = std::make_unique<io::CsvWriter>(folder_.file("history.csv"), columns);
}

void RunFolder::FrameIndex::add(double time, const std::string& file, int part) {
  if (!series_) series_.emplace(folder_.file(name_));
  series_->add(time, file, part);
}

void RunFolder::write_frame(std::function<void()> task) {
  writer_.then([this, task = std::move(task)] {
    try {
      task();
    } catch (const Error& error) {
      if (lost_frames_++ == 0) why_lost_ = error.what();
    }
  });
}

std::string RunFolder::lost_frames() {
  writer_.wait();
  if (lost_frames_ == 0) return "";
  return io::to_text(lost_frames_) + (lost_frames_ == 1 ? " frame" : " frames") +
         " for ParaView could not be written: " + why_lost_;
}

double RunFolder::take_output_seconds() { return output_seconds_.exchange(0); }

/// VTK files of a design on its way.
void RunFolder::write_design_frame(const mmc::IterationReport& r) {
  const double start = thread_seconds();
  const std::string stem = scene_.designs.size() > 1 ? r.problem.body + "_" : "";
  const mmc::CellFactors& factors = r.state.factors();
  // Σ w ½ uᵀ K_cell u: the derivative by the stiffness factor holds it. The energies of loads and
  // of held growth are added; what they do on each other sums to zero over the cells.
  VectorXd by_stiffness = -r.value.d_stiffness;
  if (by_stiffness.size() == 0) by_stiffness.setZero(factors.stiffness.size());  // not solved
  if (r.value.d_held.size() > 0) by_stiffness += 2 * r.value.d_held;
  VectorXd shown = r.loads.displacement(factors.stiffness, factors.mass, r.loads.n_loads() - 1);
  output_seconds_ += thread_seconds() - start;
  // Whatever is shown is copied: it is written while the next iteration goes on.
  write_frame([this, image = numbered("iteration_" + stem, rows_, ".vti"),
               lines = numbered("components_" + stem, rows_, ".vtp"), row = rows_,
               grid = r.problem.grid, mass = factors.mass, stiffness = factors.stiffness,
               energy = VectorXd(0.5 * by_stiffness.cwiseProduct(factors.stiffness)),
               phi = VectorXd(r.state.phi()), displacement = std::move(shown),
               components = r.state.components(),
               min_half_thickness = r.problem.stages.back().min_half_thickness] {
    const double clock = thread_seconds();
    const auto view = [](const VectorXd& v) {
      return std::span<const double>(v.data(), static_cast<size_t>(v.size()));
    };
    const io::Field cells[] = {{"density", view(mass)},
                               {"stiffness_factor", view(stiffness)},
                               {"strain_energy", view(energy)}};
    const io::Field points[] = {{"tdf", view(phi)}, {"displacement", view(displacement), 2}};
    io::write_image_data(folder_.file("design/" + image), grid, cells, points);
    iterations_.add(row, image);
    io::write_components(folder_.file("design/" + lines), components, min_half_thickness);
    components_.add(row, lines);
    output_seconds_ += thread_seconds() - clock;
  });
}

void RunFolder::add_iteration(const mmc::IterationReport& r) {
  ++rows_;
  const Output& wish = scene_.output;
  if (wish.vtk && wish.design_every > 0 &&
      (r.iteration == 1 || r.iteration % wish.design_every == 0))
    write_design_frame(r);
  History& h = history_of(r.problem.body);
  h.row.push_back(static_cast<double>(h.row.size() + 1));
  h.compliance.push_back(r.state.compliance());
  h.volume.push_back(r.state.volume());
  h.kkt.push_back(r.iterate.kkt);
  if (r.sharp) {
    h.sharp_row.push_back(h.row.back());
    h.sharp_compliance.push_back(r.sharp->compliance);
  }
  add_events(r);
  write_history_row(r);
}

void RunFolder::write_history_row(const mmc::IterationReport& r) {
  io::Cell sharp_c, sharp_v, connected, min_feature;
  if (r.sharp) {
    sharp_c = r.sharp->compliance;
    sharp_v = r.sharp->volume;
    connected = r.sharp->connectivity.connected;
    if (r.sharp->features && std::isfinite(r.sharp->features->solid))
      min_feature = r.sharp->features->solid;
  }
  const mmc::LoadResponse::Seconds s = r.state.seconds();
  const auto number = [](double v) { return std::isfinite(v) ? io::Cell(v) : io::Cell(); };
  std::vector<io::Cell> row = {r.problem.body,
                               r.cycle,
                               r.iteration,
                               r.evaluations,
                               r.iterate.response->f,
                               number(r.state.compliance()),
                               r.state.volume(),
                               r.iterate.violation,
                               r.iterate.kkt,
                               r.iterate.change,
                               r.state.band() / r.problem.grid.dx(),
                               sharp_c,
                               sharp_v,
                               connected,
                               min_feature};
  for (const mmc::ResponseRow* further : further_rows(scene_)) {
    const std::optional<VectorXd> values = r.state.values(*further);
    row.push_back(values ? io::Cell(values->maxCoeff()) : io::Cell());
  }
  row.insert(row.end(), {r.state.seconds_tdf(), s.factor, s.solve, s.sensitivity, r.iterate.seconds,
                         take_output_seconds()});
  history_->row(row);
}

RunFolder::History& RunFolder::history_of(const std::string& body) {
  for (History& h : histories_)
    if (h.body == body) return h;
  histories_.emplace_back().body = body;
  return histories_.back();
}

void RunFolder::add_events(const mmc::IterationReport& r) {
  if (r.events.empty()) return;
  if (!events_) {
    const std::vector<std::string> columns = {"body",  "cycle",     "iteration",
                                              "event", "component", "components"};
    events_ = std::make_unique<io::CsvWriter>(folder_.file("events.csv"), columns);
  }
  for (const mmc::ComponentEvent& e : r.events)
    events_->row(
        {r.problem.body, r.cycle, r.iteration, to_string(e.kind), e.component + 1, e.n_components});
}

void RunFolder::write_path(const PathRecord& path) {
  std::vector<std::string> columns = {"step", "load_factor"};
  for (const auto* group : {&path.observed, &path.measured})
    for (const Column& column : *group) columns.push_back(column.name);
  columns.emplace_back("energy.strain");
  columns.emplace_back("iterations");
  io::CsvWriter csv(folder_.file("path.csv"), columns);
  for (size_t i = 0; i < path.factor.size(); ++i) {
    std::vector<io::Cell> row = {static_cast<int>(i), path.factor[i]};
    for (const auto* group : {&path.observed, &path.measured})
      for (const Column& column : *group) row.emplace_back(column.values[i]);
    row.emplace_back(path.strain[i]);
    row.emplace_back(path.iterations[i]);
    csv.row(row);
  }
}

namespace {

/// A field with values of its own.
struct OwnField {
  std::string name;
  std::vector<double> values;
  int components;
};

std::vector<OwnField> copies_of(std::span<const io::Field> fields) {
  std::vector<OwnField> out;
  for (const io::Field& f : fields)
    out.push_back({f.name, {f.values.begin(), f.values.end()}, f.components});
  return out;
}

std::vector<io::Field> views_of(const std::vector<OwnField>& fields) {
  std::vector<io::Field> out;
  for (const OwnField& f : fields) out.push_back({f.name, f.values, f.components});
  return out;
}

}  // namespace

void RunFolder::write_part(const std::string& body, const io::QuadMesh& mesh,
                           std::vector<io::Field> cells, std::span<const io::Field> points,
                           double time, int part) {
  const std::vector<double> number(mesh.quads.size(), part);
  cells.push_back({"body", number});
  write_frame([this, file = numbered("motion_" + body + "_", ++motion_frames_, ".vtu"), mesh,
               of_cells = copies_of(cells), of_points = copies_of(points), time, part] {
    io::write_quad_mesh(folder_.file("motion/" + file), mesh, views_of(of_cells),
                        views_of(of_points));
    motion_.add(time, file, part);
  });
}

void RunFolder::add_surface_frame(const fem::Body& body, const fem::State& x, const Pose& pose,
                                  double time, int part, double heating) {
  const Surface surface = deformed_surface(*scene_.body(body.name).row, body, x, pose, heating);
  const io::Field points[] = {{"displacement", surface.displacement, surface.mesh.dimension}};
  std::vector<io::Field> cells = {{"strain_energy", surface.energy}};
  if (!surface.strain.empty()) cells.push_back({"elastic_strain", surface.strain, 3});
  write_part(body.name, surface.mesh, std::move(cells), points, time, part);
  if (part == 0 && surface.mesh.dimension == 3)
    shapes_.push_back(
        {(scene_.statics ? "step " : "t = ") + io::to_text(time, 4) + (scene_.statics ? "" : " s"),
         surface.mesh, surface.energy});
}

void RunFolder::add_rigid_frame(const std::string& body, std::span<const Vec2> corners, double time,
                                int part) {
  io::QuadMesh mesh;
  for (const Vec2& corner : corners) mesh.points.insert(mesh.points.end(), {corner[0], corner[1]});
  mesh.quads.push_back({0, 1, 2, 3});
  write_part(body, mesh, {}, {}, time, part);
}

void RunFolder::add_motion_frame(const std::string& body, const DesignedSurface& surface,
                                 double time, int part) {
  write_part(body, surface.mesh, {{"density", surface.density}}, {}, time, part);
}

std::vector<io::SurfaceFrame> RunFolder::shapes(size_t most) const {
  if (shapes_.size() <= most) return shapes_;
  std::vector<io::SurfaceFrame> out;
  for (size_t k = 0; k < most; ++k) out.push_back(shapes_[k * (shapes_.size() - 1) / (most - 1)]);
  return out;
}

void RunFolder::write_text(const std::string& name, const std::string& text) {
  io::write_file(folder_.file(name), text);
}

}  // namespace flexmorph::cases
