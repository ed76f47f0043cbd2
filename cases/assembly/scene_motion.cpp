#include "cases/assembly/scene_motion.h"

#include <algorithm>
#include <cmath>

#include "optim/mmc/problem/responses/rows.h"

namespace flexmorph::cases {
namespace {

/// Returns a grid whose cells consist of n x n cells of the given grid.
Grid merged(Grid grid, int n) {
  grid.nx /= n;
  grid.ny /= n;
  return grid;
}

/// Returns the means of cell values over n x n cells.
VectorXd means(const Grid& fine, int n, const VectorXd& all) {
  if (n == 1) return all;
  const Grid coarse = merged(fine, n);
  VectorXd out = VectorXd::Zero(coarse.n_cells());
  for (int i = 0; i < fine.nx; ++i)
    for (int j = 0; j < fine.ny; ++j)
      out[coarse.cell(i / n, j / n)] += all[fine.cell(i, j)] / (n * n);
  return out;
}

/// Returns the product of the transpose of means() with values of the coarse cells.
VectorXd spread(const Grid& fine, int n, const VectorXd& all) {
  if (n == 1) return all;
  const Grid coarse = merged(fine, n);
  VectorXd out(fine.n_cells());
  for (int i = 0; i < fine.nx; ++i)
    for (int j = 0; j < fine.ny; ++j)
      out[fine.cell(i, j)] = all[coarse.cell(i / n, j / n)] / (n * n);
  return out;
}

}  // namespace

SceneMotion::SceneMotion(const PreparedCase& prepared, const Settings& settings,
                         std::function<bool()> keep_running)
    : prepared_(prepared),
      scene_(prepared.scene()),
      settings_(settings),
      keep_running_(std::move(keep_running)) {}

int SceneMotion::coarse(size_t design) const {
  const double cell = settings_.cell;
  return cell > 0 ? static_cast<int>(std::lround(cell / scene_.designs[design].grid.dx())) : 1;
}

Mechanism SceneMotion::mechanism_with(std::span<const mmc::CellScaleFactors> factors) const {
  MeshChoice mesh;
  mesh.cells = 1;
  mesh.coarse = coarse(0);
  Mechanism out = prepared_.mechanism(mesh);
  if (settings_.step > 0) set_step(scene_, settings_.step, out.motion);
  for (size_t d = 0; d < factors.size(); ++d) {
    const BodyDesign& design = scene_.designs[d];
    for (fem::Body& body : out.model.bodies())
      if (body.name == design.body)
        out.model.set_factors(body, {merged(design.grid, coarse(d)),
                                     means(design.grid, coarse(d), factors[d].stiffness),
                                     means(design.grid, coarse(d), factors[d].mass)});
  }
  out.motion.stops = load_times(scene_);
  return out;
}

fem::MotionObjective SceneMotion::objective_of(const mmc::MotionRow& row,
                                               const Mechanism& mechanism) const {
  using Times = fem::MotionObjective::Times;
  const std::string_view name = row.row->name;
  if (name == "strain_energy") return {fem::measure_strain_energy(), Times::stops, 1};
  if (name == "peak_strain_energy")
    return {fem::measure_strain_energy(), Times::stops, mmc::kPeakExponent};
  if (name == "trajectory_error") {
    const TargetTrajectory& t = *scene_.trajectory;
    return {fem::measure_location_error(t.body, {scene_.motion_of(t.x), scene_.motion_of(t.y)}),
            Times::steps, mmc::kPeakExponent};
  }
  const Body& body = scene_.body(scene_.designs[row.body].body);
  if (name == "joint_force") {
    const auto carries = [&](const Joint& j) {  // a link is carried by the joint at its first pin
      return j.carries(body.name) || (scene_.designs[row.body].link && j.point_on(body.name));
    };
    const auto joint = std::find_if(scene_.joints.begin(), scene_.joints.end(), carries);
    return {fem::measure_joint_force(joint->name, body.name), Times::steps, mmc::kPeakExponent};
  }
  const auto rides = [&](const fem::MovingRoot& g) { return g.body == body.name; };
  const auto growth =
      std::find_if(mechanism.moving_roots.begin(), mechanism.moving_roots.end(), rides);
  const Vec2 tip(body.longest(scene_.time.end), body.low() + 0.5 * body.width);
  return {fem::measure_deflection(body.name, tip, growth->hub, growth->line), Times::steps,
          mmc::kPeakExponent};
}

std::vector<mmc::MotionResponse::Value> SceneMotion::evaluate(
    std::span<const mmc::MotionRow> rows, std::span<const mmc::CellScaleFactors> factors) {
  // The scale factors of void are a smooth offset, so that derivatives exist.
  std::vector<mmc::CellScaleFactors> of_motion(factors.begin(), factors.end());
  for (size_t d = 0; d < factors.size(); ++d) {
    const BodyDesign& design = scene_.designs[d];
    const auto offset = [](double at_void, VectorXd& x) {
      x = (at_void + (1 - at_void) * x.array()).matrix();
    };
    offset(design.stiffness_void, of_motion[d].stiffness);
    offset(design.mass_void, of_motion[d].mass);
  }
  stop_if_cancelled();
  const Mechanism mechanism = mechanism_with(of_motion);
  std::vector<fem::MotionObjective> objectives;
  for (const mmc::MotionRow& row : rows) objectives.push_back(objective_of(row, mechanism));
  ++motions_;
  last_ = fem::motion_gradients(
      mechanism.model, mechanism.moving_roots, mechanism.motion, objectives,
      {.checkpoints = settings_.checkpoints, .parameters = {}, .every_step = [this] {
         stop_if_cancelled();
       }});
  std::vector<Value> out;
  for (const fem::MotionGradient& of : last_.of) {
    Value& value = out.emplace_back();
    value.f = of.value;
    for (size_t d = 0; d < factors.size(); ++d) {
      const BodyDesign& design = scene_.designs[d];
      const auto& bodies = mechanism.model.bodies();
      const auto body = std::find_if(bodies.begin(), bodies.end(),
                                     [&](const fem::Body& b) { return b.name == design.body; });
      const fem::ScaleFactorGradient& slopes =
          of.d_factors[static_cast<size_t>(body - bodies.begin())];
      value.slopes.push_back(
          {(1 - design.stiffness_void) * spread(design.grid, coarse(d), slopes.stiffness),
           (1 - design.mass_void) * spread(design.grid, coarse(d), slopes.mass)});
    }
  }
  return out;
}

std::vector<double> SceneMotion::crisp(std::span<const mmc::MotionRow> rows,
                                       std::span<const VectorXd> fractions) {
  std::vector<mmc::CellScaleFactors> factors;
  for (size_t d = 0; d < fractions.size(); ++d)
    factors.push_back(mmc::Ersatz::dynamic(fractions[d], scene_.designs[d].stiffness_void,
                                           scene_.designs[d].mass_void));
  const Mechanism mechanism = mechanism_with(factors);
  std::vector<fem::MotionObjective> objectives;
  for (const mmc::MotionRow& row : rows) objectives.push_back(objective_of(row, mechanism));
  ++motions_;
  return fem::motion_values(mechanism.model, mechanism.moving_roots, mechanism.motion, objectives,
                            [this] { stop_if_cancelled(); });
}

void SceneMotion::stop_if_cancelled() const {
  if (keep_running_ && !keep_running_()) throw StoppedMotion();
}

}  // namespace flexmorph::cases
