#include "optim/mmc/link_balance.h"

#include <Eigen/LU>
#include <cstddef>

#include "fem/solve/q4_cell.h"

namespace flexmorph::mmc {
namespace {

/// Shifts and a small turn about the middle of the grid, in sizes of the grid (2 n_nodes x 3).
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

template <class Use>
void LinkBalance::each_cell(Use use) const {
  for (int i = 0; i < grid_.nx; ++i)
    for (int j = 0; j < grid_.ny; ++j) {
      std::array<int, 4> nodes{};
      for (std::size_t a = 0; a < 4; ++a)
        nodes[a] = grid_.node(i + fem::kCornerI[a], j + fem::kCornerJ[a]);
      use(grid_.cell(i, j), nodes);
    }
}

LinkBalance::LinkBalance(const Grid& grid, const fem::PlaneSection& section,
                         const std::array<int, 2>& pins, Support support)
    : grid_(grid),
      section_(section),
      cell_mass_(fem::q4_mass(section, grid.dx(), grid.dy())),
      support_(support),
      rigid_(rigid_motions(grid)) {
  if (pins[0] == pins[1])
    throw Error::input("equivalent static loads: both pins of a link are at one place");
  if (support_ == Support::floating) return;
  const Vec2 along = (position_of(grid, pins[1]) - position_of(grid, pins[0])).normalized();
  held_ = MatrixXd::Zero(rigid_.rows(), 3);
  held_(2 * pins[0], 0) = held_(2 * pins[0] + 1, 1) = 1;
  held_.block<2, 1>(2 * pins[1], 2) = Vec2(-along.y(), along.x());
  together_ = Eigen::Matrix3d(rigid_.transpose() * held_).inverse();
}

void LinkBalance::set_mass(const VectorXd& mass) {
  mass_ = mass;
  if (support_ != Support::floating) return;
  MatrixXd pushed;
  inertia_forces(rigid_.transpose(), pushed);
  held_ = -pushed.transpose();
  together_ = Eigen::Matrix3d(rigid_.transpose() * held_).inverse();
}

void LinkBalance::inertia_forces(const MatrixXd& acceleration, MatrixXd& F) const {
  F.setZero(acceleration.rows(), acceleration.cols());
  each_cell([&](int cell, const std::array<int, 4>& nodes) {
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b)
        F.middleCols<2>(2 * nodes[a]) -= mass_(cell) *
                                         cell_mass_(static_cast<int>(a), static_cast<int>(b)) *
                                         acceleration.middleCols<2>(2 * nodes[b]);
  });
}

void LinkBalance::balance(MatrixXd& F, MatrixXd& acceleration) const {
  const MatrixXd c = F * rigid_ * together_.transpose();
  F.noalias() -= c * held_.transpose();
  if (support_ == Support::floating) acceleration.noalias() += c * rigid_.transpose();
}

void LinkBalance::choose(MatrixXd& u) const {
  const MatrixXd moved = u * held_ * together_;
  u.noalias() -= moved * rigid_.transpose();
}

void LinkBalance::products(const MatrixXd& z, const MatrixXd& a, const VectorXd& weights,
                           VectorXd& product) const {
  MatrixXd each;
  products(z, a, each);
  product = each.transpose() * weights;
}

void LinkBalance::products(const MatrixXd& z, const MatrixXd& a, MatrixXd& product) const {
  const fem::Q4MassProduct mass(section_, grid_.dx(), grid_.dy());
  const Eigen::Index n = z.rows();
  product.setZero(n, grid_.n_cells());
  VectorXd of_y(n);
  each_cell([&](int cell, const std::array<int, 4>& nodes) {
    for (int c = 0; c < 2; ++c) {
      fem::Q4MassProduct::Corners z_corner{}, a_corner{};
      for (std::size_t k = 0; k < 4; ++k) {
        z_corner[k] = &z(0, 2 * nodes[k] + c);
        a_corner[k] = &a(0, 2 * nodes[k] + c);
      }
      if (c == 0) {
        mass.multiply(z_corner, a_corner, n, product.col(cell).data());
      } else {
        mass.multiply(z_corner, a_corner, n, of_y.data());
        product.col(cell) += of_y;
      }
    }
  });
}

}  // namespace flexmorph::mmc
