#include "fem/dynamics/start.h"

#include <cmath>

#include "fem/solve/statics.h"

namespace flexmorph::fem {
namespace {

const Eigen::Matrix2d kQuarter = (Eigen::Matrix2d() << 0, -1, 1, 0).finished();

Body& body_named(Model& model, const std::string& name) {
  for (Body& b : model.bodies())
    if (b.name == name) return b;
  throw Error::input("there is no body '" + name + "'");
}

/// Undeformed body in its hub, and the velocity of the rigid, extending body.
void rigid_body(const Body& body, const FrameMotion& hub, State& x) {
  const LineGrid& plate = grid_of(body);
  const Motion root = plate.line_m(0);
  const Eigen::Matrix2d turn = rotation(hub.angle);
  const MatrixXd reference = plate.reference();
  for (int k = 0; k < plate.n_vectors(); ++k) {
    const int at = body.first_dof + 2 * k;
    Vec2 local = reference.row(k).transpose();
    Vec2 rate = Vec2::Zero();
    if (plate.is_position(k)) {
      local.x() -= root.value;
      // A node on a moving line goes along with the line, not with the material.
      rate.x() = plate.line_m(k / plate.per_node() / (plate.n_n() + 1)).rate - root.rate;
    }
    const Vec2 r = turn * local;
    x.q.segment<2>(at) = r;
    x.v.segment<2>(at) = hub.angle_rate * kQuarter * r + turn * rate;
    if (plate.is_position(k)) {
      x.q.segment<2>(at) += hub.origin;
      x.v.segment<2>(at) += hub.origin_rate;
    }
  }
}

/// The same model with the lines of all plates frozen where they are at `lines`, for statics.
void freeze(Model& model, std::span<const Growth> growths, double lines) {
  for (const Growth& g : growths) {
    Body& body = body_named(model, g.body);
    const std::unique_ptr<LineGrid> mesh = grid_of(body).copy();
    mesh->move_to(lines);
    model.set_element(body, mesh->frozen());
  }
}

}  // namespace

State start_state(Model& model, std::span<const Growth> growths, double t, Start start) {
  for (Body& b : model.bodies()) b.element->move_to(t);
  State x = model.reference();
  x.t = t;
  for (const Growth& g : growths) rigid_body(model.body(g.body), g.hub(t), x);
  if (start == Start::rigid) return x;

  // Static equilibrium under centrifugal forces: q̈ = -ω² (q - origin), lines frozen. Its rate as
  // the body grows comes from equilibria a little earlier and later.
  std::vector<std::unique_ptr<LineGrid>> moving;
  for (const Growth& g : growths) moving.push_back(grid_of(model.body(g.body)).copy());
  const auto restore = [&] {
    for (size_t i = 0; i < growths.size(); ++i)
      model.set_element(body_named(model, growths[i].body), moving[i]->copy());
  };
  const auto equilibrium = [&](double lines) {
    restore();
    freeze(model, growths, lines);
    State s = model.reference();
    s.t = t;
    VectorXd spin(model.n_dofs()), center = VectorXd::Zero(model.n_dofs());
    spin.setZero();
    for (const Growth& g : growths) {
      const Body& body = model.body(g.body);
      const FrameMotion hub = g.hub(t);
      rigid_body(body, hub, s);
      spin.segment(body.first_dof, body.n_dofs()).setConstant(hub.angle_rate * hub.angle_rate);
      for (int k = 0; k < body.element->n_vectors(); ++k)
        if (body.element->is_position(k)) center.segment<2>(body.first_dof + 2 * k) = hub.origin;
    }
    s.v.setZero();
    solve_rotating_equilibrium(model, spin, center, s);
    return s.q;
  };
  const double delta = 1e-4;
  const VectorXd q = equilibrium(t), later = equilibrium(t + delta),
                 earlier = equilibrium(t - delta);
  restore();
  for (Body& b : model.bodies()) b.element->move_to(t);
  x.q = q;
  for (const Growth& g : growths) {
    const Body& body = model.body(g.body);
    const FrameMotion hub = g.hub(t);
    for (int k = 0; k < body.element->n_vectors(); ++k) {
      const int at = body.first_dof + 2 * k;
      const bool position = body.element->is_position(k);
      const Vec2 r = q.segment<2>(at) - (position ? hub.origin : Vec2::Zero());
      x.v.segment<2>(at) =
          hub.angle_rate * kQuarter * r + (later - earlier).segment<2>(at) / (2 * delta);
      if (position) x.v.segment<2>(at) += hub.origin_rate;
    }
  }
  return x;
}

}  // namespace flexmorph::fem
