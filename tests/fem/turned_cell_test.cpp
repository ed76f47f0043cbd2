// Shows that a cell with small strains in a rotating frame has a force and a tangent equal to
// differences of the energy, no resultant and no moment, and the right linear limit.

#include "fem/terms/cells/turned_cell.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "geometry/base.h"

namespace flexmorph::fem {
namespace {

using turned_cell::kSize;
using turned_cell::kVectors;
using Six = Eigen::Matrix<double, kSize, 1>;
using Square = Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>;

constexpr double kA = 0.0025, kB = 0.004;  // [m]

Six undeformed() {
  Six p = Six::Zero();
  p[0] = 0.5 * kA;
  p[3] = 0.5 * kB;
  return p;
}
Six turned(const Six& p, double angle) {
  Six out;
  for (int k = 0; k < kSize; k += 2)
    out.segment<2>(k) = Eigen::Rotation2Dd(angle) * p.segment<2>(k);
  return out;
}

/// Returns a symmetric, positive semidefinite matrix for which an infinitesimal rotation has no
/// force.
Square stiffness(unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Square root;
  for (int i = 0; i < kSize; ++i)
    for (int j = 0; j < kSize; ++j) root(i, j) = uniform(engine);
  const Six p = undeformed();
  Six spin;
  for (int k = 0; k < kSize; k += 2) spin.segment<2>(k) = Vec2(-p[k + 1], p[k]);
  const Square keep = Square::Identity() - spin * spin.transpose() / spin.squaredNorm();
  return keep * root * root.transpose() * keep;
}

turned_cell::State<double> state(const Square& k, const Six& p) {
  return turned_cell::state_of<double>(k.data(), p.data(), undeformed().data());
}
Six force(const Square& k, const Six& p) {
  Six out = Six::Zero();
  turned_cell::add_force<double>(state(k, p), 1.0, out.data());
  return out;
}
Square tangent(const Square& k, const Six& p) {
  double blocks[kVectors * kVectors * 4] = {};
  turned_cell::add_stiffness<double>(k.data(), state(k, p), 1.0, blocks);
  Square out;
  for (int i = 0; i < kSize; ++i)
    for (int j = i / 2 * 2; j < kSize; ++j)
      out(j, i) = out(i, j) = blocks[(i / 2 * kVectors + j / 2) * 4 + i % 2 * 2 + j % 2];
  return out;
}
Six moved(unsigned seed, double size) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-size * kA, size * kA);
  Six p = undeformed();
  for (int k = 0; k < kSize; ++k) p[k] += uniform(engine);
  return turned(p, 20.0 * static_cast<double>(seed));
}

TEST(TurnedCell, ForceAndTangentAreDerivativesOfTheEnergy) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Square k = stiffness(seed);
    const Six p = moved(seed, 0.3), f = force(k, p);
    const Square t = tangent(k, p);
    const double h = 1e-5 * kA;
    for (int i = 0; i < kSize; ++i) {
      Six up = p, down = p;
      up[i] += h;
      down[i] -= h;
      const double slope = (state(k, up).energy - state(k, down).energy) / (2 * h);
      EXPECT_NEAR(f[i], slope, 1e-7 * f.norm()) << seed << " " << i;
      const Six column = (force(k, up) - force(k, down)) / (2 * h);
      EXPECT_LT((t.col(i) - column).norm(), 1e-7 * t.norm()) << seed << " " << i;
    }
  }
}

TEST(TurnedCell, TurnsHaveNoEnergyNorMoment) {
  const Square k = stiffness(3);
  for (const double angle : {0.0, 0.3, 1.6, 3.1, -2.4}) {
    const Six at_rest = turned(undeformed(), angle);
    EXPECT_NEAR(state(k, at_rest).energy, 0, 1e-28);
    const Six p = moved(5, 0.4), q = turned(p, angle);
    EXPECT_NEAR(state(k, q).energy, state(k, p).energy, 1e-12 * state(k, p).energy);
    const Six f = force(k, q);
    double moment = 0;
    for (int i = 0; i < kSize; i += 2) moment += q[i] * f[i + 1] - q[i + 1] * f[i];
    EXPECT_NEAR(moment, 0, 1e-12 * f.norm() * q.norm());
  }
}

TEST(TurnedCell, IsTheLinearCellAtRest) {
  const Square k = stiffness(4);
  const Six p = undeformed();
  EXPECT_LT((tangent(k, p) - k).norm(), 1e-12 * k.norm());
  EXPECT_LT(force(k, p).norm(), 1e-15 * k.norm());
}

}  // namespace
}  // namespace flexmorph::fem
