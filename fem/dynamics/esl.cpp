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
    throw Error::input("masses and forces must sit on nodes of the design mesh");
  return grid.node(static_cast<int>(std::lround(i)), static_cast<int>(std::lround(j)));
}

/// A force and its moment, linear across the column of the grid at that X.
void spread(const Grid& grid, int column, const Vec2& force, double moment,
            std::vector<NodalForce>& out) {
  const double middle = grid.y0 + 0.5 * grid.height;
  double second = 0;  // Σ w y² with the trapezoidal weights w of the nodes
  const auto weight = [&](int j) { return j == 0 || j == grid.ny ? 0.5 : 1.0; };
  for (int j = 0; j <= grid.ny; ++j)
    second += weight(j) * std::pow(grid.node_position(column, j).y() - middle, 2);
  for (int j = 0; j <= grid.ny; ++j) {
    const double y = grid.node_position(column, j).y() - middle;
    const Vec2 part = weight(j) / grid.ny * force - Vec2(weight(j) * y / second * moment, 0);
    out.push_back({grid.node(column, j), part});
  }
}

}  // namespace

std::vector<AttachedForce> joint_forces(const Model& model, const State& x, const Body& body,
                                        std::span<const AttachedJoint> joints) {
  std::vector<AttachedForce> out;
  for (const AttachedJoint& attached : joints) {
    const auto& all = model.joints();
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const auto& j) { return j->name() == attached.name; });
    if (found == all.end()) throw Error::input("esl: there is no joint '" + attached.name + "'");
    const Vec3 about = point_position(body, x, attached.material);
    const Wrench w =
        model.joint_wrench(static_cast<size_t>(found - all.begin()), body.name, about, x);
    out.push_back({attached.material, attached.spread, w.force.head<2>(), w.moment.z()});
  }
  return out;
}

EslSet equivalent_static_load(const Model& model, const State& x, const Growth& growth,
                              const Grid& grid, std::span<const AttachedMass> masses,
                              std::span<const AttachedForce> forces, const VectorXd& gravity) {
  const Body& body = model.body(growth.body);
  const Motion root = grid_of(body).line_m(0);
  const FrameMotion hub = growth.hub.at(model, x);
  const Eigen::Matrix2d to_hub = rotation(hub.angle).transpose();
  const Vec2 g = gravity.size() > 0 ? Vec2(to_hub * gravity.head<2>()) : Vec2(0, 0);

  EslSet out;
  out.time = x.t;
  out.root_column = static_cast<int>(std::lround((root.value - grid.x0) / grid.dx()));
  out.deformation = VectorXd::Zero(2 * grid.n_nodes());
  out.acceleration.resize(2 * grid.n_nodes());
  for (int i = 0; i <= grid.nx; ++i)
    for (int j = 0; j <= grid.ny; ++j) {
      const Vec2 material = grid.node_position(i, j);
      const Vec2 at(material.x() - root.value, material.y());
      const int entry = 2 * grid.node(i, j);
      // Less than a millionth of a cell inside is rounding.
      const bool inside = material.x() < root.value - 1e-6 * grid.dx();
      if (i < out.root_column || inside) {
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
  for (const AttachedForce& f : forces) {
    const Vec2 force = to_hub * f.force;
    const int node = nearest_node(grid, f.material);
    if (f.spread)
      spread(grid, node / (grid.ny + 1), force, f.moment, out.forces);
    else
      out.forces.push_back({node, force});
  }
  out.strain_energy = model.energies(x).strain;
  return out;
}

}  // namespace flexmorph::fem
