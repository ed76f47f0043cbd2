#include <algorithm>
#include <cmath>

#include "fem/dynamics/starts/start_parts.h"
#include "fem/solve/statics.h"

namespace flexmorph::fem {
namespace {

const Eigen::Matrix2d kQuarter = (Eigen::Matrix2d() << 0, -1, 1, 0).finished();

Body& body_named(Workspace& model, const std::string& name) {
  for (Body& b : model.bodies())
    if (b.name == name) return b;
  throw Error::input("there is no body '" + name + "'");
}

/// A vector in the axes of a frame, with its time derivatives relative to the frame.
struct Local2 {
  Vec2 value{0, 0}, rate{0, 0}, acceleration{0, 0};
};

/// Sets the unknowns [at, at + 2) and their rates to a vector that the frame carries.
void carry(const FrameMotion& f, const Local2& local, bool position, int at, State& x) {
  const Eigen::Matrix2d turn = rotation(f.angle);
  const Vec2 r = turn * local.value, rate = turn * local.rate;
  x.q.segment<2>(at) = r;
  x.v.segment<2>(at) = f.angle_rate * kQuarter * r + rate;
  x.a.segment<2>(at) = f.angle_acceleration * kQuarter * r - f.angle_rate * f.angle_rate * r +
                       2 * f.angle_rate * kQuarter * rate + turn * local.acceleration;
  if (!position) return;
  x.q.segment<2>(at) += f.origin;
  x.v.segment<2>(at) += f.origin_rate;
  x.a.segment<2>(at) += f.origin_acceleration;
}

/// Sets an undeformed plate in a frame as a rigid, extending body. A plate in space lies in the
/// plane z = 0.
/// @param held    Motion of the material coordinate at the origin of the frame [m].
/// @param slides  Index of the m-line at the origin of the frame if it is free, else -1.
void carry_plate(const Body& body, const FrameMotion& frame, const Motion& held, int slides,
                 State& x) {
  const LineGrid& plate = grid_of(body);
  const MatrixXd reference = plate.reference();
  for (int k = 0; k < plate.n_vectors(); ++k) {
    Local2 local;
    local.value = reference.row(k).head<2>().transpose();
    if (plate.is_position(k)) {
      // A node on a moving line moves with the line and not with the material.
      const int line = k / plate.per_node() / (plate.n_n() + 1);
      const Motion m = line == slides ? held : plate.line_m(line);
      local.value.x() -= held.value;
      local.rate.x() = m.rate - held.rate;
      local.acceleration.x() = m.acceleration - held.acceleration;
    }
    carry(frame, local, plate.is_position(k), body.first_dof + plate.dim() * k, x);
  }
}

/// Sets an undeformed beam in a frame as a rigid body. The material coordinate `held` lies at the
/// origin of the frame.
void carry_beam(const Body& body, const FrameMotion& frame, double held, State& x) {
  const MatrixXd reference = body.element->reference();
  for (int k = 0; k < body.element->n_vectors(); ++k) {
    Local2 local;
    local.value = reference.row(k).transpose();
    const bool position = body.element->is_position(k);
    if (position) local.value.x() -= held;
    carry(frame, local, position, body.first_dof + 2 * k, x);
  }
}

/// Sets an undeformed body in its hub as a rigid, extending body.
void carry_in_hub(const Model& model, const MovingRoot& growth, State& x) {
  const Body& body = model.body(growth.body);
  const LineGrid& plate = grid_of(body);
  const auto line = static_cast<size_t>(growth.line);
  const bool slides = plate.lines_m()[line].free;
  Motion held = plate.line_m(growth.line);
  if (slides) held.rate = growth.slide;
  carry_plate(body, growth.hub.at(model, x), held, slides ? growth.line : -1, x);
  if (!slides) return;
  int scalar = body.first_scalar();
  for (size_t i = 0; i < line; ++i) scalar += plate.lines_m()[i].free;
  x.v[scalar] = growth.slide;
}

}  // namespace

namespace start {

State rigid_state(const Model& model, std::span<const MovingRoot> moving_roots,
                  const BodyPoses& body_poses, double t) {
  State x = model.reference();
  x.t = t;
  if (body_poses)
    for (const BodyPose& p : body_poses(t)) {
      const Body& body = model.body(p.body);
      if (dynamic_cast<const LineGrid*>(body.element.get())) {
        carry_plate(body, p.frame, {p.line, 0, 0}, -1, x);
        continue;
      }
      if (!body.element->is_rigid()) {
        carry_beam(body, p.frame, p.line, x);
        continue;
      }
      carry(p.frame, {}, true, body.first_dof, x);
      carry(p.frame, {.value = {1, 0}}, false, body.first_dof + 2, x);
    }
  for (const MovingRoot& g : moving_roots) carry_in_hub(model, g, x);
  return x;
}

bool rides_in_hubs(std::span<const MovingRoot> moving_roots, const BodyPoses& body_poses) {
  return !body_poses && std::all_of(moving_roots.begin(), moving_roots.end(),
                                    [](const MovingRoot& g) { return g.hub.body().empty(); });
}

InHubs::InHubs(Workspace& model, std::span<const MovingRoot> moving_roots, double t)
    : model_(model), moving_roots_(moving_roots), t_(t) {
  for (const MovingRoot& g : moving_roots_) moving_.push_back(grid_of(model_.body(g.body)).copy());
}

InHubs::~InHubs() {
  for (size_t i = 0; i < moving_roots_.size(); ++i)
    model_.set_element(body_named(model_, moving_roots_[i].body), moving_[i]->copy());
  model_.move_lines(t_);
}

State InHubs::at(double lines) {
  for (size_t i = 0; i < moving_roots_.size(); ++i) {
    const std::unique_ptr<LineGrid> mesh = moving_[i]->copy();
    mesh->move_to(lines);
    model_.set_element(body_named(model_, moving_roots_[i].body), mesh->frozen());
  }
  State s = rigid_state(model_, moving_roots_, {}, t_);
  spin_.setZero(model_.n_dofs());
  center_.setZero(model_.n_dofs());
  for (const MovingRoot& g : moving_roots_) {
    const Body& body = model_.body(g.body);
    const FrameMotion hub = g.hub.at(model_, s);
    for (int k = 0; k < body.element->n_vectors(); ++k) {
      const int at = body.first_dof + body.element->dim() * k;
      spin_.segment<2>(at).setConstant(hub.angle_rate * hub.angle_rate);
      if (body.element->is_position(k)) center_.segment<2>(at) = hub.origin;
    }
  }
  s.v.setZero();
  solve_rotating_equilibrium(model_, spin_, center_, s);
  return s;
}

void InHubs::add_turn(const VectorXd& change, VectorXd& rate, bool transposed) const {
  for (const MovingRoot& g : moving_roots_) {
    const Body& body = model_.body(g.body);
    State now;
    now.t = t_;
    const double w = g.hub.at(model_, now).angle_rate * (transposed ? -1 : 1);
    for (int k = 0; k < body.element->n_vectors(); ++k) {
      const int at = body.first_dof + body.element->dim() * k;
      rate.segment<2>(at) += w * kQuarter * change.segment<2>(at);
    }
  }
}

std::vector<double> spins(const Model& model, const State& rigid) {
  std::vector<double> out;
  for (const Body& body : model.bodies()) {
    const int dim = body.element->dim(), n = body.element->n_vectors();
    int axis = 0;  // index of a vector that rotates with the body
    while (axis + 1 < n && body.element->is_position(axis)) ++axis;
    if (body.element->is_position(axis)) {  // none: a line between nodes is used
      const int at = body.first_dof, to = at + dim * axis;
      const Vec2 u = (rigid.q.segment<2>(to) - rigid.q.segment<2>(at)),
                 rate = rigid.v.segment<2>(to) - rigid.v.segment<2>(at);
      out.push_back((kQuarter * u).dot(rate) / u.squaredNorm());
      continue;
    }
    const int turned = body.first_dof + dim * axis;
    const Vec2 u = rigid.q.segment<2>(turned), rate = rigid.v.segment<2>(turned);
    out.push_back((kQuarter * u).dot(rate) / u.squaredNorm());
  }
  return out;
}

void add_turns(const Model& model, const std::vector<double>& spins, const VectorXd& change,
               double sign, VectorXd& rate) {
  for (size_t b = 0; b < spins.size(); ++b) {
    const Body& body = model.bodies()[b];
    for (int k = 0; k < body.element->n_vectors(); ++k) {
      const int at = body.first_dof + body.element->dim() * k;
      rate.segment<2>(at) += sign * spins[b] * kQuarter * change.segment<2>(at);
    }
  }
}

State carried_equilibrium(Workspace& model, std::span<const MovingRoot> moving_roots,
                          const BodyPoses& body_poses, double t) {
  constexpr int kPasses = 50;
  model.move_lines(t);
  State s = rigid_state(model, moving_roots, body_poses, t);
  const State rigid = s;
  solve_carried_equilibrium(model, s);
  VectorXd last = rigid.q;
  for (int pass = 0; pass < kPasses && model.dissipation(s) > 0 &&
                     (s.q - last).norm() > 1e-10 * (s.q - rigid.q).norm();
       ++pass) {
    last = s.q;
    s.v = rigid.v;
    add_turns(model, spins(model, rigid), s.q - rigid.q, 1, s.v);
    solve_carried_equilibrium(model, s);
  }
  return s;
}

SteadyEquilibrium steady_equilibrium(Workspace& model, std::span<const MovingRoot> moving_roots,
                                     const BodyPoses& body_poses, double t) {
  model.move_lines(t);
  SteadyEquilibrium out;
  out.rigid = rigid_state(model, moving_roots, body_poses, t);
  out.turning.resize(model.bodies().size());
  out.angle.resize(model.bodies().size());
  const auto take = [&](const std::string& name, const FrameMotion& frame) {
    const auto b = static_cast<size_t>(&model.body(name) - model.bodies().data());
    out.turning[b] = {frame.angle_rate, frame.angle_acceleration};
    out.angle[b] = frame.angle;
  };
  if (body_poses)
    for (const BodyPose& p : body_poses(t)) take(p.body, p.frame);
  for (const MovingRoot& g : moving_roots) take(g.body, g.hub.at(model, out.rigid));
  out.strained = out.rigid;
  solve_steady_equilibrium(model, out.turning, out.strained);
  return out;
}

bool start_in_equilibrium(Workspace& model, State& x) {
  constexpr double kNearby = 0.02;  // in sizes of the model; the error of the hold is smaller
  solve_static_equilibrium(model, x);
  State exact = x;
  try {
    solve_carried_equilibrium(model, exact);
  } catch (const Error& error) {
    if (error.kind() != Error::Kind::numerical) throw;
    return false;
  }
  const VectorXd moved = model.scales().cwiseProduct(exact.q - x.q);
  if (!(moved.lpNorm<Eigen::Infinity>() <= kNearby * x.q.lpNorm<Eigen::Infinity>())) return false;
  x = exact;
  return true;
}

void turn_by(const Model& model, const std::vector<double>& angles, VectorXd& vectors) {
  for (size_t b = 0; b < angles.size(); ++b) {
    const Body& body = model.bodies()[b];
    const Eigen::Matrix2d turn = rotation(angles[b]);
    for (int k = 0; k < body.element->n_vectors(); ++k) {
      const int at = body.first_dof + body.element->dim() * k;
      vectors.segment<2>(at) = (turn * vectors.segment<2>(at)).eval();
    }
  }
}

namespace {

/// Returns the state of Start::steady. The rate of the shape, in the axes of the bodies, is a
/// forward difference of equilibria because drives need not be defined before the start of the
/// motion.
State steady_state(Workspace& model, std::span<const MovingRoot> moving_roots,
                   const BodyPoses& body_poses, double t, double delta) {
  VectorXd rate = VectorXd::Zero(model.n_dofs());
  std::vector<SteadyEquilibrium> at;
  for (const int k : {0, 1, 2})
    at.push_back(steady_equilibrium(model, moving_roots, body_poses, t + k * delta));
  for (const int k : {1, 0, 2}) {
    const SteadyEquilibrium& then = at[static_cast<size_t>(k)];
    VectorXd u = then.strained.q - then.rigid.q;
    std::vector<double> back = at[0].angle;
    for (size_t b = 0; b < back.size(); ++b) back[b] -= then.angle[b];
    turn_by(model, back, u);
    rate += kForward[k] / (2 * delta) * u;
  }
  model.move_lines(t);
  State x = at[0].strained;  // its velocities contain the rotation of the bodies
  x.v += rate;
  x.a.setZero();
  return x;
}

/// Computes Start::prestretched for bodies in hubs. The rate of the strained shape due to the
/// growth of the body is a central difference of equilibria.
void stretch_in_hubs(Workspace& model, std::span<const MovingRoot> moving_roots, double delta,
                     State& x) {
  const double t = x.t;
  VectorXd q, later, earlier;
  {
    InHubs stretched(model, moving_roots, t);
    q = stretched.at(t).q;
    later = stretched.at(t + delta).q;
    earlier = stretched.at(t - delta).q;
  }
  x.q = q;
  for (const MovingRoot& g : moving_roots) {
    const Body& body = model.body(g.body);
    const FrameMotion hub = g.hub.at(model, x);
    for (int k = 0; k < body.element->n_vectors(); ++k) {
      const int at = body.first_dof + body.element->dim() * k;
      const bool position = body.element->is_position(k);
      const Vec2 r = q.segment<2>(at) - (position ? hub.origin : Vec2::Zero());
      x.v.segment<2>(at) =
          hub.angle_rate * kQuarter * r + (later - earlier).segment<2>(at) / (2 * delta);
      if (position) x.v.segment<2>(at) += hub.origin_rate;
      if (body.element->dim() == 3) x.v[at + 2] = (later - earlier)[at + 2] / (2 * delta);
    }
  }
}

/// Computes Start::prestretched for a mechanism. The rate of the strained shape is a forward
/// difference of equilibria because drives need not be defined before the start of the motion.
void stretch_mechanism(Workspace& model, std::span<const MovingRoot> moving_roots,
                       const BodyPoses& body_poses, double delta, State& x) {
  const double t = x.t;
  const auto strain = [&](double at) {
    const VectorXd q = carried_equilibrium(model, moving_roots, body_poses, at).q;
    return VectorXd(q - rigid_state(model, moving_roots, body_poses, at).q);
  };
  const VectorXd later = strain(t + delta), last = strain(t + 2 * delta), now = strain(t);
  x.q += now;
  x.v += (kForward[1] * later + kForward[0] * now + kForward[2] * last) / (2 * delta);
}

}  // namespace
}  // namespace start

State start_state(Workspace& model, std::span<const MovingRoot> moving_roots, double t, Start kind,
                  const BodyPoses& body_poses, double delta) {
  model.move_lines(t);
  State x = start::rigid_state(model, moving_roots, body_poses, t);
  if (kind == Start::rigid) return x;
  if (kind == Start::settled) {
    solve_static_equilibrium(model, x);
    return x;
  }
  if (kind == Start::at_rest) {
    start::start_in_equilibrium(model, x);
    return x;
  }
  if (kind == Start::steady) return start::steady_state(model, moving_roots, body_poses, t, delta);
  if (start::rides_in_hubs(moving_roots, body_poses))
    start::stretch_in_hubs(model, moving_roots, delta, x);
  else
    start::stretch_mechanism(model, moving_roots, body_poses, delta, x);
  return x;
}

}  // namespace flexmorph::fem
