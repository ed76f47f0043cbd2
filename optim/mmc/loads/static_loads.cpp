#include "optim/mmc/loads/static_loads.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "fem/shapes/singular_values.h"
#include "fem/solve/q4_cell.h"

namespace flexmorph::mmc {

namespace {

using Stencil = Eigen::Matrix3d;  // (1 + di, 1 + dj): weight of node (i + di, j + dj)

/// Returns the row of the mass matrix for node (i, j): the sum over the adjacent cells with their
/// mass factors.
Stencil mass_stencil(const Grid& g, const Eigen::Matrix4d& cell_mass, const VectorXd& mass, int i,
                     int j) {
  Stencil s = Stencil::Zero();
  for (int a = 0; a < 4; ++a) {
    const int ci = i - fem::kCornerI[static_cast<std::size_t>(a)];
    const int cj = j - fem::kCornerJ[static_cast<std::size_t>(a)];
    if (ci < 0 || ci >= g.nx || cj < 0 || cj >= g.ny) continue;
    const double factor = mass(g.cell(ci, cj));
    for (int b = 0; b < 4; ++b) {
      const int ni = ci + fem::kCornerI[static_cast<std::size_t>(b)];
      const int nj = cj + fem::kCornerJ[static_cast<std::size_t>(b)];
      s(1 + ni - i, 1 + nj - j) += factor * cell_mass(a, b);
    }
  }
  return s;
}

/// Computes f[k] = -Σ s_b a_b[k] over the nine nodes of a stencil.
void apply_stencil(const Stencil& s, const std::array<const double*, 9>& a, Eigen::Index n,
                   double* __restrict f) {
  const double* __restrict a0 = a[0], * __restrict a1 = a[1], * __restrict a2 = a[2], * __restrict a3 = a[3], * __restrict a4 = a[4], * __restrict a5 = a[5], * __restrict a6 = a[6], * __restrict a7 = a[7], * __restrict a8 = a[8];
  for (Eigen::Index k = 0; k < n; ++k) {
    f[k] = -(s(0) * a0[k] + s(1) * a1[k] + s(2) * a2[k] + s(3) * a3[k] + s(4) * a4[k] +
             s(5) * a5[k] + s(6) * a6[k] + s(7) * a7[k] + s(8) * a8[k]);
  }
}

}  // namespace

StaticLoads inertia_loads(const fem::EslSets& sets, std::span<const int> rows) {
  const auto n = static_cast<Eigen::Index>(sets.sets.size());
  const auto row = [&](const fem::NodalForce& f) {
    return rows[2 * static_cast<std::size_t>(f.node)];
  };
  StaticLoads loads;
  loads.acceleration.resize(n, 2 * sets.grid.n_nodes());
  for (Eigen::Index l = 0; l < n; ++l) {
    const fem::EslSet& set = sets.sets[static_cast<std::size_t>(l)];
    loads.acceleration.row(l) = set.acceleration.transpose();
    for (const fem::NodalForce& f : set.forces)
      if (row(f) >= 0)  // a force on a held node acts on the hub, not on the plate
        loads.slots.insert(loads.slots.end(), {row(f), row(f) + 1});
  }
  // A link has no held displacements: every column of F can carry a force.
  if (*std::min_element(rows.begin(), rows.end()) >= 0)
    loads.slots.assign(rows.begin(), rows.end());
  std::sort(loads.slots.begin(), loads.slots.end());
  loads.slots.erase(std::unique(loads.slots.begin(), loads.slots.end()), loads.slots.end());
  loads.slot_forces.setZero(n, static_cast<Eigen::Index>(loads.slots.size()));
  for (Eigen::Index l = 0; l < n; ++l) {
    for (const fem::NodalForce& f : sets.sets[static_cast<std::size_t>(l)].forces) {
      if (row(f) < 0) continue;
      const auto slot = std::lower_bound(loads.slots.begin(), loads.slots.end(), row(f));
      const auto k = static_cast<Eigen::Index>(slot - loads.slots.begin());
      loads.slot_forces.block<1, 2>(l, k) += f.force.transpose();
    }
  }
  return loads;
}

StaticLoads combine(const MatrixXd& combination, const StaticLoads& loads) {
  StaticLoads combined;
  combined.slots = loads.slots;
  if (loads.follows_design()) {
    combined.acceleration = combination * loads.acceleration;
    combined.slot_forces = combination * loads.slot_forces;
  } else {
    combined.fixed = combination * loads.fixed;
  }
  return combined;
}

InertiaOperator::InertiaOperator(const Grid& grid, const fem::PlaneSection& section,
                                 std::vector<int> rows)
    : grid_(grid),
      section_(section),
      cell_mass_(fem::q4_mass(section, grid.dx(), grid.dy())),
      rows_(std::move(rows)),
      n_rows_(*std::max_element(rows_.begin(), rows_.end()) + 1) {}

void InertiaOperator::forces(const StaticLoads& loads, const VectorXd& mass, MatrixXd& F) const {
  const Grid& g = grid_;
  const Eigen::Index n = loads.acceleration.rows();
  F.resize(n, n_rows_);
  for (int i = g.nx; i >= 0 && row(g.node(i, 0)) >= 0; --i) {
    for (int j = 0; j <= g.ny; ++j) {
      const Stencil s = mass_stencil(g, cell_mass_, mass, i, j);
      std::array<const double*, 9> a{};
      // Column-major order like that of the stencil, whose weights are zero beyond the edge.
      for (int b = 0; b < 9; ++b) {
        const int ni = std::clamp(i + b % 3 - 1, 0, g.nx), nj = std::clamp(j + b / 3 - 1, 0, g.ny);
        a[static_cast<std::size_t>(b)] = &loads.acceleration(0, 2 * g.node(ni, nj));
      }
      apply_stencil(s, a, 2 * n, &F(0, row(g.node(i, j))));
    }
  }
  for (std::size_t k = 0; k < loads.slots.size(); ++k) {
    F.col(loads.slots[k]) += loads.slot_forces.col(static_cast<Eigen::Index>(k));
  }
}

/// Calls use(cell, products) for every cell with unknown displacements; the products of all loads
/// in x are followed by those in y.
template <class Use>
void InertiaOperator::each_product(const MatrixXd& z, const MatrixXd& a, Use use) const {
  const Grid& g = grid_;
  const Eigen::Index n = 2 * z.rows();  // x and y of a node lie next to each other
  const fem::Q4MassProduct mass(section_, g.dx(), g.dy());
  held_.setZero(n);
  product_of_load_.resize(n);
  for (int i = g.nx - 1; i >= 0 && row(g.node(i + 1, 0)) >= 0; --i) {
    for (int j = 0; j < g.ny; ++j) {
      fem::Q4MassProduct::Corners z_corner{}, a_corner{};
      for (std::size_t c = 0; c < 4; ++c) {
        const int node = g.node(i + fem::kCornerI[c], j + fem::kCornerJ[c]);
        z_corner[c] = row(node) < 0 ? held_.data() : &z(0, row(node));
        a_corner[c] = &a(0, 2 * node);
      }
      mass.multiply(z_corner, a_corner, n, product_of_load_.data());
      use(g.cell(i, j), product_of_load_);
    }
  }
}

void InertiaOperator::products(const MatrixXd& z, const MatrixXd& a, VectorXd& product) const {
  product.setZero(grid_.n_cells());
  each_product(z, a, [&](int cell, const VectorXd& of_load) { product(cell) = of_load.sum(); });
}

void InertiaOperator::products(const MatrixXd& z, const MatrixXd& a, MatrixXd& product) const {
  product.setZero(z.rows(), grid_.n_cells());
  each_product(z, a, [&](int cell, const VectorXd& of_load) {
    product.col(cell) = of_load.head(z.rows()) + of_load.tail(z.rows());
  });
}

MatrixXd leading_combinations(const MatrixXd& y, double tolerance) {
  const Eigen::HouseholderQR<MatrixXd> qr(y.transpose());
  const Eigen::Index n = y.rows(), k = std::min(n, y.cols());
  MatrixXd R = MatrixXd::Zero(n, n);
  R.topRows(k) = qr.matrixQR().topRows(k).triangularView<Eigen::Upper>();
  const fem::SingularValues svd = fem::singular_values(R.transpose());
  const VectorXd energy = svd.values.cwiseAbs2();
  Eigen::Index r = energy.size();
  double left_out = 0;
  const double allowed = tolerance * energy.sum();
  while (r > 1 && left_out + energy(r - 1) <= allowed) left_out += energy(--r);
  return svd.left.leftCols(r);
}

}  // namespace flexmorph::mmc
