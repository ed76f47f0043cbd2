#include "fem/dynamics/esl.h"

#include <cmath>

namespace flexmorph::fem {
namespace {

/// Acceleration, in the hub's axes, of the rigid body that moves out of it along x.
Vec2 rigid_acceleration(const FrameMotion& hub, const Eigen::Matrix2d& to_hub, const Vec2& at,
                        const Motion& root) {
  const double w = hub.angle_rate, x_dot = -root.rate, x_ddot = -root.acceleration;
  return to_hub * hub.origin_acceleration - w * w * at +
         hub.angle_acceleration * Vec2(-at.y(), at.x()) + Vec2(x_ddot, 2 * w * x_dot);
}

int nearest_node(const Grid& grid, const Vec2& point) {
  const double i = (point.x() - grid.x0) / grid.dx(), j = (point.y() - grid.y0) / grid.dy();
  if (std::abs(i - std::round(i)) > 1e-6 || std::abs(j - std::round(j)) > 1e-6)
    throw Error::input("a point mass must sit on a node of the design mesh");
  return grid.node(static_cast<int>(std::lround(i)), static_cast<int>(std::lround(j)));
}

}  // namespace

EslSet equivalent_static_load(const Model& model, const State& x, const Growth& growth,
                              const Grid& grid, std::span<const AttachedMass> masses,
                              const VectorXd& gravity) {
  const Body& body = model.body(growth.body);
  const Motion root = grid_of(body).line_m(0);
  const double column = (root.value - grid.x0) / grid.dx();
  if (std::abs(column - std::round(column)) > 1e-6)
    throw Error::input("esl: at t = " + std::to_string(x.t) + " s the root lies between two " +
                       "columns of the design mesh; load times must move it by whole cells");
  const FrameMotion hub = growth.hub(x.t);
  const Eigen::Matrix2d to_hub = rotation(hub.angle).transpose();
  const Vec2 g = gravity.size() > 0 ? Vec2(to_hub * gravity.head<2>()) : Vec2(0, 0);

  EslSet out;
  out.time = x.t;
  out.root_column = static_cast<int>(std::lround(column));
  out.deformation = VectorXd::Zero(2 * grid.n_nodes());
  out.acceleration.resize(2 * grid.n_nodes());
  for (int i = 0; i <= grid.nx; ++i)
    for (int j = 0; j <= grid.ny; ++j) {
      const Vec2 material = grid.node_position(i, j);
      const Vec2 at(material.x() - root.value, material.y());
      const int entry = 2 * grid.node(i, j);
      if (i < out.root_column) {
        out.acceleration.segment<2>(entry) = rigid_acceleration(hub, to_hub, at, root) - g;
        continue;
      }
      const PointMotion p = point_motion(body, x, material);
      out.acceleration.segment<2>(entry) = to_hub * p.acceleration - g;
      if (i > out.root_column)
        out.deformation.segment<2>(entry) = to_hub * (p.position - hub.origin) - at;
    }
  for (const AttachedMass& m : masses) {
    const int node = nearest_node(grid, m.material);
    out.forces.push_back({node, -m.mass * out.acceleration.segment<2>(2 * node)});
  }
  out.strain_energy = model.energies(x).strain;
  return out;
}

}  // namespace flexmorph::fem
