#include "optim/mmc/loads/link_balance.h"

#include <Eigen/LU>
#include <cstddef>

#include "fem/solve/q4_cell.h"

namespace flexmorph::mmc {
namespace {

/// Returns two translations and a small rotation about the middle of the grid, scaled by the size
/// of the grid (2 n_nodes x 3).
MatrixXd rigid_motions(const Grid& g) {
  MatrixXd out = MatrixXd::Zero(2 * static_cast<Eigen::Index>(g.n_nodes()), 3);
  const Vec2 middle(g.x0 + 0.5 * g.width, g.y0 + 0.5 * g.height);
  for (int i = 0; i <= g.nx; ++i)
    for (int j = 0; j <= g.ny; ++j) {
      const Vec2 at = (g.node_position(i, j) - middle) / (g.width + g.height);
      out.block<2, 3>(2 * g.node(i, j), 0) << 1, 0, -at.y(), 0, 1, at.x();
    }
  return out;
}

Vec2 position_of(const Grid& g, int node) {
  return g.node_position(node / (g.ny + 1), node % (g.ny + 1));
}

}  // namespace

LinkBalance::LinkBalance(const Grid& grid, const fem::PlaneSection& section,
                         const std::array<int, 2>& pins, Support support)
    : grid_(grid),
      cell_mass_(fem::q4_mass(section, grid.dx(), grid.dy())),
      support_(support),
      rigid_(rigid_motions(grid)) {
  if (pins[0] == pins[1])
    throw Error::input("equivalent static loads: both pins of a link are at the same location");
  if (support_ == Support::floating) return;
  const Vec2 along = (position_of(grid, pins[1]) - position_of(grid, pins[0])).normalized();
  held_ = MatrixXd::Zero(rigid_.rows(), 3);
  held_(2 * pins[0], 0) = held_(2 * pins[0] + 1, 1) = 1;
  held_.block<2, 1>(2 * pins[1], 2) = Vec2(-along.y(), along.x());
  together_ = Eigen::Matrix3d(rigid_.transpose() * held_).inverse();
}

/// Computes the inertia forces -M a (n x 2 n_nodes).
void LinkBalance::inertia_forces(const VectorXd& mass, const MatrixXd& acceleration,
                                 MatrixXd& F) const {
  F.setZero(acceleration.rows(), acceleration.cols());
  for (int cell = 0; cell < grid_.n_cells(); ++cell) {
    std::array<int, 4> nodes{};
    for (std::size_t a = 0; a < 4; ++a)
      nodes[a] = grid_.node(cell / grid_.ny + fem::kCornerI[a], cell % grid_.ny + fem::kCornerJ[a]);
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b)
        F.middleCols<2>(2 * nodes[a]) -= mass(cell) *
                                         cell_mass_(static_cast<int>(a), static_cast<int>(b)) *
                                         acceleration.middleCols<2>(2 * nodes[b]);
  }
}

/// Computes H and (Rᵀ H)⁻¹ of a floating link, which depend on the mass of the design.
void LinkBalance::set_mass(const VectorXd& mass) {
  if (support_ != Support::floating) return;
  MatrixXd pushed;
  inertia_forces(mass, rigid_.transpose(), pushed);
  held_ = -pushed.transpose();
  together_ = Eigen::Matrix3d(rigid_.transpose() * held_).inverse();
}

void LinkBalance::forces(const StaticLoads& loads, const VectorXd& mass, MatrixXd& F,
                         MatrixXd& acceleration) {
  set_mass(mass);
  acceleration = loads.acceleration;
  inertia_forces(mass, acceleration, F);
  for (std::size_t k = 0; k < loads.slots.size(); ++k)
    F.col(loads.slots[k]) += loads.slot_forces.col(static_cast<Eigen::Index>(k));
  const MatrixXd c = F * rigid_ * together_.transpose();
  F.noalias() -= c * held_.transpose();
  if (support_ == Support::floating) acceleration.noalias() += c * rigid_.transpose();
}

void LinkBalance::choose(MatrixXd& u) const {
  const MatrixXd moved = u * held_ * together_;
  u.noalias() -= moved * rigid_.transpose();
}

}  // namespace flexmorph::mmc
