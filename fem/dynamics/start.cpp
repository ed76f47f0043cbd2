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

/// Undeformed body in its hub, and the velocity of the rigid, extending body. In space all of it
/// lies in the plane z = 0.
void rigid_body(const Body& body, const Growth& growth, double t, State& x) {
  const FrameMotion hub = growth.hub(t);
  const LineGrid& plate = grid_of(body);
  const auto line_rate = [&](int i) {
    const bool slides = i == growth.line && plate.lines_m()[static_cast<size_t>(i)].free;
    return slides ? growth.slide : plate.line_m(i).rate;
  };
  const double root = plate.line_m(growth.line).value, root_rate = line_rate(growth.line);
  const Eigen::Matrix2d turn = rotation(hub.angle);
  const MatrixXd reference = plate.reference();
  for (int k = 0; k < plate.n_vectors(); ++k) {
    const int at = body.first_dof + plate.dim() * k;
    Vec2 local = reference.row(k).head<2>().transpose();
    Vec2 rate = Vec2::Zero();
    if (plate.is_position(k)) {
      local.x() -= root;
      // A node on a moving line goes along with the line, not with the material.
      rate.x() = line_rate(k / plate.per_node() / (plate.n_n() + 1)) - root_rate;
    }
    const Vec2 r = turn * local;
    x.q.segment<2>(at) = r;
    x.v.segment<2>(at) = hub.angle_rate * kQuarter * r + turn * rate;
    if (plate.is_position(k)) {
      x.q.segment<2>(at) += hub.origin;
      x.v.segment<2>(at) += hub.origin_rate;
    }
  }
  int scalar = body.first_scalar();
  for (int i = 0; i < growth.line; ++i) scalar += plate.lines_m()[static_cast<size_t>(i)].free;
  if (plate.lines_m()[static_cast<size_t>(growth.line)].free) x.v[scalar] = growth.slide;
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
  for (const Growth& g : growths) rigid_body(model.body(g.body), g, t, x);
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
      const int dim = body.element->dim();
      rigid_body(body, g, t, s);
      for (int k = 0; k < body.element->n_vectors(); ++k) {
        const int at = body.first_dof + dim * k;
        spin.segment<2>(at).setConstant(hub.angle_rate * hub.angle_rate);
        if (body.element->is_position(k)) center.segment<2>(at) = hub.origin;
      }
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
      const int at = body.first_dof + body.element->dim() * k;
      const bool position = body.element->is_position(k);
      const Vec2 r = q.segment<2>(at) - (position ? hub.origin : Vec2::Zero());
      x.v.segment<2>(at) =
          hub.angle_rate * kQuarter * r + (later - earlier).segment<2>(at) / (2 * delta);
      if (position) x.v.segment<2>(at) += hub.origin_rate;
      if (body.element->dim() == 3) x.v[at + 2] = (later - earlier)[at + 2] / (2 * delta);
    }
  }
  return x;
}

}  // namespace flexmorph::fem
