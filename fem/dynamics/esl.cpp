#include "fem/dynamics/esl.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

namespace flexmorph::fem {
namespace {

/// Returns the acceleration, in the axes of the hub, of a point `at` of the rigid body that moves
/// out of the hub along x.
Vec2 rigid_acceleration(const FrameMotion& hub, const Eigen::Matrix2d& to_hub, const Vec2& at,
                        const Motion& root) {
  const double w = hub.angle_rate, x_dot = -root.rate, x_ddot = -root.acceleration;
  return to_hub * hub.origin_acceleration - w * w * at +
         hub.angle_acceleration * Vec2(-at.y(), at.x()) + Vec2(x_ddot, 2 * w * x_dot);
}

/// Thermal growth of a hot body along and across its axis, as factors of lengths.
struct HotBody {
  Motion along, across;
  double stretch = 0, held = 0;  ///< Free growth a, and its part g that the root line prevents.
};

/// Relative difference of growth that is treated as zero. It is caused by round-off and by the
/// tolerance of Newton's method, and its energy is 1e-12 of that of an edge whose growth is
/// prevented.
constexpr double kSameGrowth = 1e-6;

/// Returns the growth γ of a straight root line: least squares fit of u_y = γ (Y - Ȳ).
double moving_root_of(const Body& body, const State& x, const FrameMotion& hub,
                      const Eigen::Matrix2d& to_hub, const Grid& grid, double root) {
  const double middle = grid.y0 + 0.5 * grid.height;
  double moment = 0, second = 0;
  for (int j = 0; j <= grid.ny; ++j) {
    const Vec2 material(root, grid.node_position(0, j).y());
    const Vec2 at = to_hub * (point_motion(body, x, material).position - hub.origin);
    const double arm = material.y() - middle;
    moment += arm * (at.y() - material.y());
    second += arm * arm;
  }
  return moment / second;
}

/// Returns the growth |e| - 1 of an edge that may be rotated: least squares fit of
/// r = e (Y - Ȳ) + const.
double growth_of_edge(const Body& body, const State& x, const Grid& grid, int column) {
  const double middle = grid.y0 + 0.5 * grid.height;
  Vec2 moment(0, 0);
  double second = 0;
  for (int j = 0; j <= grid.ny; ++j) {
    const Vec2 material = grid.node_position(column, j);
    const double arm = material.y() - middle;
    moment += arm * Vec2(point_motion(body, x, material).position);
    second += arm * arm;
  }
  return moment.norm() / second - 1;
}

/// Returns the fraction of the free growth `stretch` that a line with the given growth has.
double part_of_growth(double growth, double stretch) {
  const double small = kSameGrowth * std::abs(stretch);
  if (stretch == 0 || std::abs(growth) <= small) return 0;
  if (std::abs(growth - stretch) <= small) return 1;
  return growth / stretch;
}

/// Returns the growth of a hot body from that of its root line.
/// @throws Error (numerical) if the thermal stretch is not positive.
HotBody hot_body(const Body& body, const State& x, double moving_root_of) {
  HotBody out;
  out.along = body.heat->stretch(x.t);
  out.stretch = out.along.value - 1;
  if (!std::isfinite(out.stretch) || !(out.along.value > 0))
    throw Error::numerical("esl: the thermal stretch of body '" + body.name + "' is " +
                           std::to_string(out.along.value) + "; it must be positive");
  const double part = part_of_growth(moving_root_of, out.stretch);
  out.held = (1 - part) * out.stretch;
  out.across = {1 + part * out.stretch, part * out.along.rate, part * out.along.acceleration};
  return out;
}

/// Returns rigid_acceleration() for a hot body, whose points are at p = (s (X - m₀), s_y Y) in the
/// axes of the hub.
Vec2 grown_acceleration(const FrameMotion& hub, const Eigen::Matrix2d& to_hub, const Vec2& at,
                        const Motion& root, const HotBody& hot) {
  const Motion &s = hot.along, &s_y = hot.across;
  const double w = hub.angle_rate;
  const Vec2 p(s.value * at.x(), s_y.value * at.y());
  const Vec2 p_t(s.rate * at.x() - s.value * root.rate, s_y.rate * at.y());
  const Vec2 p_tt(s.acceleration * at.x() - 2 * s.rate * root.rate - s.value * root.acceleration,
                  s_y.acceleration * at.y());
  return to_hub * hub.origin_acceleration - w * w * p +
         hub.angle_acceleration * Vec2(-p.y(), p.x()) + 2 * w * Vec2(-p_t.y(), p_t.x()) + p_tt;
}

/// Subtracts the free growth, w = u - e_Θ, outside the root line. On the root line it sets the
/// growth that is prevented there.
void take_off_growth(const Grid& grid, double root, const HotBody& hot, EslSet& set) {
  set.thermal_stretch = hot.stretch;
  set.held_stretch = hot.held;
  for (int i = set.root_column; i <= grid.nx; ++i)
    for (int j = 0; j <= grid.ny; ++j) {
      const Vec2 at = grid.node_position(i, j) - Vec2(root, 0);
      const int entry = 2 * grid.node(i, j);
      if (i == set.root_column)
        set.deformation.segment<2>(entry) = Vec2(0, -hot.held * at.y());
      else
        set.deformation.segment<2>(entry) -= hot.stretch * at;
    }
}

/// Distributes a force and a moment linearly over the nodes of a column of the grid.
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

/// Returns the whole number next to x; nothing if x differs from it by more than rounding errors.
std::optional<int> whole(double x) {
  if (std::abs(x - std::round(x)) > 1e-6) return {};
  return static_cast<int>(std::lround(x));
}

/// Returns the column of nodes at a coordinate along the plate. @throws Error (input) if there is
/// none.
int column_at(const Grid& grid, double x) {
  if (const auto column = whole((x - grid.x0) / grid.dx())) return *column;
  throw Error::input(
      "a force along an edge must be at a column of nodes of the design mesh; none is at " +
      std::to_string(x) + " m");
}

/// Adds the d'Alembert forces of point masses; out.acceleration must be set.
void add_masses(const Grid& grid, std::span<const AttachedMass> masses, EslSet& out) {
  for (const AttachedMass& m : masses) {
    const int node = node_at(grid, m.material);
    out.forces.push_back({node, -m.mass * out.acceleration.segment<2>(2 * node)});
  }
}

}  // namespace

int node_at(const Grid& grid, const Vec2& point) {
  const std::optional<int> i = whole((point.x() - grid.x0) / grid.dx()),
                           j = whole((point.y() - grid.y0) / grid.dy());
  if (!i || !j)
    throw Error::input(
        "masses, pins and forces must be at nodes of the design mesh; no node is at (" +
        std::to_string(point.x()) + ", " + std::to_string(point.y()) + ") m");
  return grid.node(*i, *j);
}

std::vector<AttachedForce> joint_forces(Workspace& model, const State& x, const Body& body,
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
    out.push_back({attached.material, attached.spread, w.force.head<2>(), w.moment.z(),
                   /*held=*/attached.spread});
  }
  return out;
}

EslSet equivalent_static_load(Workspace& model, const State& x, const MovingRoot& growth,
                              const Grid& grid, std::span<const AttachedMass> masses,
                              std::span<const AttachedForce> forces, const VectorXd& gravity) {
  const Body& body = model.body(growth.body);
  const Motion root = grid_of(body).line_m(0);
  const FrameMotion hub = growth.hub.at(model, x);
  const Eigen::Matrix2d to_hub = rotation(hub.angle).transpose();
  const Vec2 g = gravity.size() > 0 ? Vec2(to_hub * gravity.head<2>()) : Vec2(0, 0);

  std::optional<HotBody> hot;
  if (body.heat) hot = hot_body(body, x, moving_root_of(body, x, hub, to_hub, grid, root.value));
  const auto continued = [&](const Vec2& at) {
    return hot ? grown_acceleration(hub, to_hub, at, root, *hot)
               : rigid_acceleration(hub, to_hub, at, root);
  };

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
      // A distance below a millionth of a cell is round-off.
      const bool inside = material.x() < root.value - 1e-6 * grid.dx();
      if (i < out.root_column || inside) {
        out.acceleration.segment<2>(entry) = continued(at) - g;
        continue;
      }
      const PointMotion p = point_motion(body, x, material);
      out.acceleration.segment<2>(entry) = to_hub * p.acceleration - g;
      if (i > out.root_column)
        out.deformation.segment<2>(entry) = to_hub * (p.position - hub.origin) - at;
    }
  if (hot) take_off_growth(grid, root.value, *hot, out);
  add_masses(grid, masses, out);
  for (const AttachedForce& f : forces) {
    const Vec2 force = to_hub * f.force;
    if (!f.spread) {
      out.forces.push_back({node_at(grid, f.material), force});
      continue;
    }
    const int column = column_at(grid, f.material.x());
    spread(grid, column, force, f.moment, out.forces);
    if (hot && f.held && column == grid.nx) {
      const double growth = growth_of_edge(body, x, grid, column);
      out.held_end_stretch = (1 - part_of_growth(growth, hot->stretch)) * hot->stretch;
    }
  }
  out.strain_energy = model.energies(x, model.body(growth.body)).strain;
  return out;
}

EslSet equivalent_static_load(Workspace& model, const State& x, const Body& body,
                              const std::array<Vec2, 2>& pins, const Grid& grid,
                              std::span<const AttachedMass> masses,
                              std::span<const AttachedForce> forces, const VectorXd& gravity) {
  for (const Vec2& pin : pins) node_at(grid, pin);
  const Vec2 origin = point_motion(body, x, pins[0]).position;
  const Vec2 line = point_motion(body, x, pins[1]).position - origin, flat = pins[1] - pins[0];
  const double angle = std::atan2(line.y(), line.x()) - std::atan2(flat.y(), flat.x());
  const Eigen::Matrix2d to_frame = rotation(angle).transpose();
  const Vec2 g = gravity.size() > 0 ? Vec2(gravity.head<2>()) : Vec2(0, 0);
  EslSet out;
  out.time = x.t;
  out.deformation.resize(2 * grid.n_nodes());
  out.acceleration.resize(2 * grid.n_nodes());
  for (int i = 0; i <= grid.nx; ++i)
    for (int j = 0; j <= grid.ny; ++j) {
      const Vec2 material = grid.node_position(i, j);
      const PointMotion p = point_motion(body, x, material);
      const int entry = 2 * grid.node(i, j);
      out.deformation.segment<2>(entry) = to_frame * (p.position - origin) - (material - pins[0]);
      out.acceleration.segment<2>(entry) = to_frame * (p.acceleration - g);
    }
  add_masses(grid, masses, out);
  for (const AttachedForce& f : forces)
    out.forces.push_back({node_at(grid, f.material), to_frame * f.force});
  out.strain_energy = model.energies(x, body).strain;
  return out;
}

}  // namespace flexmorph::fem
