#include "cases/assembly/operating_point.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "cases/assembly/domain_model.h"
#include "cases/assembly/static_path.h"
#include "fem/dynamics/starts/rigid_motion.h"
#include "fem/dynamics/starts/start_parts.h"
#include "fem/solve/relaxation.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr double kSpeedAtRest = 1e-9;  // [m/s]

/// Executes the changes of meshes of a motion up to a time, one after the other. Changes at free
/// lines depend on the motion and are not executed.
void change_meshes(Mechanism& mechanism, double time) {
  fem::Workspace& model = mechanism.model;
  for (double at = 0;;) {
    fem::NextChange next{std::numeric_limits<double>::infinity(), fem::MeshChange::insertion};
    const fem::MovingRoot* changing = nullptr;
    for (const fem::MovingRoot& root : mechanism.moving_roots) {
      const fem::NextChange each =
          fem::next_change(model.body(root.body), root, at, time, mechanism.motion.step);
      if (!(each.t < next.t)) continue;
      next = each;
      changing = &root;
    }
    if (changing == nullptr || next.t > time) return;
    at = next.t;
    model.move_lines(at);
    fem::State x = model.reference();
    x.t = at;
    for (fem::Body& body : model.bodies())
      if (body.name == changing->body)
        fem::change_mesh(model, body, next.change, x, changing->cell);
  }
}

/// Returns the mechanism of a case with the temperatures of all bodies held at their values of a
/// time.
Mechanism at_constant_temperature(const PreparedCase& prepared, double time) {
  const Mechanism& mechanism = prepared.mechanism();
  if (!prepared.scene().has_heat()) return mechanism;
  Scene scene = prepared.scene();
  for (Body& body : scene.bodies) {
    if (!body.heat) continue;
    Law held;
    held.value = mechanism.model.body(body.name).heat->temperature(time).value;
    body.heat->profile.clear();
    body.heat->rise = held;
  }
  return build_mechanism(scene, {}, prepared.rigid());
}

/// Stops the flow of material at a time: the lines of all meshes without free lines are fixed.
void stop_flow(fem::Workspace& model, double time) {
  model.move_lines(time);
  for (fem::Body& body : model.bodies())
    if (const auto* grid = dynamic_cast<const fem::LineGrid*>(body.element.get());
        grid != nullptr && grid->n_scalars() == 0)
      model.set_element(body, grid->frozen());
}

/// Returns the largest violation of a joint, relative to the size of the model.
double violation(fem::Workspace& model, const fem::State& x) {
  if (model.n_constraints() == 0) return 0;
  fem::ScaledConstraints rows;
  rows.evaluate(model, x);
  return rows.misses().lpNorm<Eigen::Infinity>() / fem::model_size(rows.scales(), x.q);
}

/// Throws an error where Newton's method found an equilibrium with unlimited joint forces, as a
/// crank with a constant torque has at its dead centre.
void require_regular(fem::Workspace& model, const fem::State& x) {
  constexpr double kMaxCondition = 1e6;
  if (model.n_constraints() > 0 && fem::constraint_condition(model, x) > kMaxCondition)
    throw Error::numerical(
        "there is no equilibrium at rest near the start: forces are in balance only at a singular "
        "position (dead centre) of the joints");
}

/// Returns true if small motions about an equilibrium at rest grow.
bool is_unstable(fem::Workspace& model, const fem::State& x) {
  const std::vector<fem::Turning> still(model.bodies().size());
  const fem::NaturalModes found = fem::natural_modes(model, x, still, 6);
  return std::any_of(found.modes.begin(), found.modes.end(),
                     [](const fem::NaturalMode& m) { return m.grows(); });
}

/// Finds an equilibrium at rest, a stable one if the search ends at one.
void find_at_rest(fem::Workspace& model, fem::State& x) {
  const fem::State start = x;
  std::optional<Error> failure;
  try {
    fem::start::start_in_equilibrium(model, x);
    if (!is_unstable(model, x)) return;
  } catch (const Error& error) {
    if (error.kind() != Error::Kind::numerical) throw;
    failure = error;
  }
  fem::State relaxed = start;
  if (fem::relax_to_equilibrium(model, relaxed)) {
    fem::start::start_in_equilibrium(model, relaxed);
    x = relaxed;
  } else if (failure) {
    throw *failure;
  }
}

/// Follows the equilibrium at rest from a time to a later time.
void follow_at_rest(fem::Workspace& model, double time, fem::State& x) {
  constexpr double kLargestViolation = 0.02;
  constexpr int kMaxHalvings = 20;
  double step = time - x.t;
  for (int halvings = 0; halvings < kMaxHalvings && x.t < time;) {
    fem::State next = x;
    next.t = std::min(time, x.t + step);
    if (violation(model, next) < kLargestViolation) {
      try {
        fem::start::start_in_equilibrium(model, next);
        x = next;
        step *= 1.5;
        continue;
      } catch (const Error& error) {
        if (error.kind() != Error::Kind::numerical) throw;
      }
    }
    step *= 0.5;
    ++halvings;
  }
  if (x.t < time)
    throw Error::numerical("no equilibrium at rest was found after t = " + io::to_text(x.t, 4) +
                           " s on the way from the start of the motion");
}

/// Returns true if the rigid motion of the drives, or material, moves at a time.
bool moves(Mechanism& mechanism, double time) {
  mechanism.model.move_lines(time);
  const fem::State x = fem::start::rigid_state(mechanism.model, mechanism.moving_roots,
                                               mechanism.motion.body_poses, time);
  const VectorXd scales = mechanism.model.scales();
  for (const VectorXd* rate : {&x.v, &x.a})
    if (scales.cwiseProduct(*rate).lpNorm<Eigen::Infinity>() > kSpeedAtRest) return true;
  return false;
}

/// Finds the equilibrium of a [static] analysis at a load factor.
void find_loaded(const Scene& scene, double factor, OperatingPoint& out) {
  begin_static_path(scene, out.model, out.x);
  out.words = "equilibrium at load factor " + io::to_text(factor, 4);
  if (factor == 0) return;
  fem::StaticSettings settings = static_settings(*scene.statics);
  settings.to = factor;
  fem::solve_static(out.model, out.x, settings);
}

void require_time(const Scene& scene, double time) {
  if (scene.domain) {
    if (time == 0) return;
    throw Error::input("--time " + io::to_text(time) +
                       ": a case with [domain] has no motion; omit the time");
  }
  const double end = scene.statics ? scene.statics->to : scene.time.end;
  if (time >= 0 && time <= end * (1 + 1e-12)) return;
  throw Error::input("--time " + io::to_text(time) + ": a " +
                     (scene.statics
                          ? "load factor of this case is between 0 and " + io::to_text(end)
                          : "time of this motion is between 0 and " + io::to_text(end) + " s"));
}

void find_moving(const PreparedCase& prepared, double time, bool stopped, OperatingPoint& out) {
  Mechanism mechanism = at_constant_temperature(prepared, time);
  mechanism.model.move_lines(0);
  change_meshes(mechanism, time);
  const Scene& scene = prepared.scene();
  const bool driven = drives_determine_motion(prepared, time),
             moving = driven && moves(mechanism, time);
  out.turning.assign(mechanism.model.bodies().size(), {});
  if (moving && !stopped) {
    fem::start::SteadyEquilibrium steady = fem::start::steady_equilibrium(
        mechanism.model, mechanism.moving_roots, mechanism.motion.body_poses, time);
    out.x = std::move(steady.strained);
    out.turning = std::move(steady.turning);
    out.words = "steady equilibrium under the inertia forces of the prescribed motion";
  } else {
    stop_flow(mechanism.model, time);
    const double from = driven ? time : 0;
    out.x = fem::start::rigid_state(mechanism.model, mechanism.moving_roots,
                                    mechanism.motion.body_poses, from);
    out.x.v.setZero();
    out.x.a.setZero();
    find_at_rest(mechanism.model, out.x);
    follow_at_rest(mechanism.model, time, out.x);
    require_regular(mechanism.model, out.x);
    out.words = "equilibrium at rest";
    if (moving) out.words += "; drives and material stand still at their positions";
    if (!driven && !stopped && !scene.drives.empty())
      out.words += "; drives do not determine the whole motion, and their velocities are left out";
  }
  out.model = std::move(mechanism.model);
}

}  // namespace

bool drives_determine_motion(const PreparedCase& prepared, double time) {
  const Scene& scene = prepared.scene();
  for (const fem::Body& body : prepared.mechanism().model.bodies()) {
    const auto drives = [&](const Joint& j) { return j.drives_line && j.body == body.name; };
    if (body.element->n_scalars() > std::count_if(scene.joints.begin(), scene.joints.end(), drives))
      return false;
  }
  if (!scene.is_mechanism())
    return std::all_of(scene.bodies.begin(), scene.bodies.end(), [&](const Body& body) {
      return std::any_of(scene.joints.begin(), scene.joints.end(), [&](const Joint& j) {
        return j.body == body.name && (j.holds_frame() || j.holds_edges());
      });
    });
  fem::RigidMotion rigid(*prepared.rigid());
  return rigid.degrees_of_freedom() == 0 && rigid.reaches(time);
}

OperatingPoint operating_point(const PreparedCase& prepared, double time, bool stopped) {
  const Scene& scene = prepared.scene();
  require_time(scene, time);
  OperatingPoint out;
  if (scene.domain) {
    out.model = domain_model(prepared);
    out.x = out.model.reference();
    out.turning.assign(1, {});
    out.words = "plate with full material, without loads";
    return out;
  }
  try {
    if (scene.statics) {
      Mechanism mechanism = prepared.mechanism();
      out.x = fem::start_state(mechanism.model, mechanism.moving_roots, 0, fem::Start::rigid,
                               mechanism.motion.body_poses);
      out.model = std::move(mechanism.model);
      out.turning.assign(out.model.bodies().size(), {});
      find_loaded(scene, time, out);
    } else {
      find_moving(prepared, time, stopped, out);
    }
  } catch (const Error& error) {
    if (error.kind() == Error::Kind::input) throw;
    throw Error::numerical("operating point at " +
                           std::string(scene.statics ? "load factor " : "t = ") +
                           io::to_text(time, 4) + (scene.statics ? "" : " s") +
                           ": no equilibrium was found: " + error.what());
  }
  return out;
}

}  // namespace flexmorph::cases
