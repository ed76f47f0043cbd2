#include "fem/triangles/recovered_stress.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cstddef>

#include "fem/triangles/t6.h"

namespace flexmorph::fem {
namespace {

// Smallest number of triangles in a patch: nine points for six coefficients.
constexpr std::size_t kMinTriangles = 3;

/// Returns the monomials of a quadratic polynomial about a corner.
Eigen::Matrix<double, 6, 1> monomials(const Vec2& p) {
  Eigen::Matrix<double, 6, 1> out;
  out << 1, p.x(), p.y(), p.x() * p.x(), p.x() * p.y(), p.y() * p.y();
  return out;
}

void sort_unique(std::vector<int>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

}  // namespace

RecoveredStress::RecoveredStress(const TrianglePlate& plate) : plate_(plate) {
  const PartMesh& mesh = plate.mesh();
  const auto n = static_cast<std::size_t>(mesh.n_corners);
  around_.resize(n);
  middles_.resize(n);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!plate.takes_part(t)) continue;
    const auto& nodes = mesh.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      around_[static_cast<std::size_t>(nodes[k])].push_back(static_cast<int>(t));
      middles_[static_cast<std::size_t>(nodes[k])].push_back(nodes[3 + k]);
      middles_[static_cast<std::size_t>(nodes[k])].push_back(nodes[3 + (k + 2) % 3]);
    }
  }
  for (auto& each : middles_) sort_unique(each);
}

std::vector<int> RecoveredStress::patch(int corner, int clamp) const {
  const PartMesh& mesh = plate_.mesh();
  std::vector<int> out;
  const auto add_around = [&](int node) {
    for (const int t : around_[static_cast<std::size_t>(node)])
      if (plate_.first_clamp(static_cast<std::size_t>(t)) <= clamp) out.push_back(t);
  };
  add_around(corner);
  // Adds neighbours. The patch never reaches another connected region, because only corners of its
  // triangles are visited.
  for (int ring = 0; ring < 2 && !out.empty() && out.size() < kMinTriangles; ++ring) {
    const std::vector<int> inner = out;
    for (const int t : inner)
      for (std::size_t k = 0; k < 3; ++k)
        add_around(mesh.triangles[static_cast<std::size_t>(t)][k]);
    sort_unique(out);
  }
  return out;
}

/// Returns σ at the three points of each triangle (3 n_loads x 3 n_triangles).
MatrixXd RecoveredStress::stresses(const MatrixXd& u, const MatrixXd& prescribed) const {
  const PartMesh& mesh = plate_.mesh();
  const Eigen::Index n = u.rows();
  MatrixXd out = MatrixXd::Zero(3 * n, 3 * static_cast<Eigen::Index>(mesh.triangles.size()));
  const Eigen::Matrix3d d = plate_.section().elasticity();
  MatrixXd local(n, 12), stress(n, 3);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!plate_.takes_part(t) || plate_.first_clamp(t) >= plate_.n_clamps()) continue;
    for (int a = 0; a < 12; ++a) {
      const int node = mesh.triangles[t][static_cast<std::size_t>(a / 2)];
      const int row = plate_.row(node, a % 2);
      if (row >= 0)
        local.col(a) = u.col(row);
      else
        local.col(a).setZero();
      if (prescribed.size() > 0) local.col(a) += prescribed.col(2 * node + a % 2);
    }
    const T6 element(mesh.corners(t));
    for (std::size_t p = 0; p < 3; ++p) {
      stress.noalias() = local * (d * element.strains(kThreePoints[p])).transpose();
      auto column = out.col(3 * static_cast<Eigen::Index>(t) + static_cast<Eigen::Index>(p));
      for (Eigen::Index l = 0; l < n; ++l) column.segment<3>(3 * l) = stress.row(l);
    }
  }
  return out;
}

/// Adds the values of the polynomial around a corner to its nodes, for loads [first, first +
/// count).
void RecoveredStress::recover_at(int corner, std::span<const int> triangles, Eigen::Index first,
                                 Eigen::Index count, const MatrixXd& stresses,
                                 MatrixXd& nodal) const {
  const PartMesh& mesh = plate_.mesh();
  const auto m = static_cast<Eigen::Index>(3 * triangles.size());
  if (m == 0 || count == 0) return;
  const Vec2 at = mesh.point(corner);
  double size = 0;
  for (const int t : triangles)
    for (const Vec2& p : mesh.corners(static_cast<std::size_t>(t)))
      size = std::max(size, (p - at).norm());
  MatrixXd basis(m, 6), samples(3 * count, m);
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const auto t = static_cast<std::size_t>(triangles[k]);
    const T6 element(mesh.corners(t));
    for (std::size_t p = 0; p < 3; ++p) {
      const auto row = static_cast<Eigen::Index>(3 * k + p);
      basis.row(row) = monomials((element.position(kThreePoints[p]) - at) / size).transpose();
      samples.col(row) = stresses.block(
          3 * first, 3 * static_cast<Eigen::Index>(t) + static_cast<Eigen::Index>(p), 3 * count, 1);
    }
  }
  // Where the points do not determine a quadratic polynomial, the smallest one that fits is used.
  const Eigen::CompleteOrthogonalDecomposition<MatrixXd> fit(basis);
  const MatrixXd inverse = fit.pseudoInverse();  // (6 x m)
  const auto add = [&](int node, double share) {
    const VectorXd weights =
        share * (inverse.transpose() * monomials((mesh.point(node) - at) / size));
    nodal.block(3 * first, node, 3 * count, 1).noalias() += samples * weights;
  };
  add(corner, 1);
  for (const int middle : middles_[static_cast<std::size_t>(corner)]) add(middle, 0.5);
}

void RecoveredStress::recover(const MatrixXd& stresses, std::span<const int> clamps,
                              MatrixXd& nodal) const {
  // Index of the first load with this clamp or a later one.
  const auto first_load = [&](int clamp) {
    return std::lower_bound(clamps.begin(), clamps.end(), clamp) - clamps.begin();
  };
  const auto n_loads = static_cast<Eigen::Index>(clamps.size());
  for (int c = 0; c < plate_.mesh().n_corners; ++c) {
    const std::vector<int> all = patch(c, plate_.n_clamps() - 1);
    int most = 0;  // first clamp with which the whole patch is included
    for (const int t : all) most = std::max(most, plate_.first_clamp(static_cast<std::size_t>(t)));
    const Eigen::Index whole = all.empty() ? n_loads : first_load(most);
    recover_at(c, all, whole, n_loads - whole, stresses, nodal);
    // Loads whose clamp crosses the patch; all loads with one clamp share one patch.
    for (Eigen::Index l = 0, end = 0; l < whole; l = end) {
      const int clamp = clamps[static_cast<std::size_t>(l)];
      end = std::min<Eigen::Index>(whole, first_load(clamp + 1));
      recover_at(c, patch(c, clamp), l, end - l, stresses, nodal);
    }
  }
}

RecoveredStress::Outcome RecoveredStress::evaluate(const MatrixXd& displacements,
                                                   std::span<const int> clamps,
                                                   const MatrixXd& prescribed) const {
  const PartMesh& mesh = plate_.mesh();
  const Eigen::Index n = displacements.rows();
  const auto n_triangles = static_cast<Eigen::Index>(mesh.triangles.size());
  const MatrixXd computed = stresses(displacements, prescribed);
  Outcome out;
  out.energies = out.errors = VectorXd::Zero(n);
  out.by_triangle = MatrixXd::Zero(n, n_triangles);
  out.stress = MatrixXd::Zero(3 * n, static_cast<Eigen::Index>(mesh.points.size()));
  recover(computed, clamps, out.stress);

  const Eigen::Matrix3d inverse = plate_.section().elasticity().inverse();
  const double thickness = plate_.section().thickness;
  // Weights that extrapolate linearly from the three points to any point.
  const auto from_points = [](const AreaPoint& at) {
    Vec3 weights;
    for (int k = 0; k < 3; ++k) weights[k] = 2 * at[static_cast<std::size_t>(k)] - 1. / 3;
    return weights;
  };
  constexpr std::array<AreaPoint, 6> kNodes = {
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5, 0.5, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}}};
  out.averaged = MatrixXd::Zero(out.stress.rows(), out.stress.cols());
  VectorXd count = VectorXd::Zero(out.stress.cols());
  MatrixXd nodes(3 * n, 6);
  VectorXd off(3 * n);
  for (Eigen::Index t = 0; t < n_triangles; ++t) {
    const auto at = static_cast<std::size_t>(t);
    if (!plate_.takes_part(at) || plate_.first_clamp(at) >= plate_.n_clamps()) continue;
    const Eigen::Index first =
        std::lower_bound(clamps.begin(), clamps.end(), plate_.first_clamp(at)) - clamps.begin();
    const double volume = thickness * T6(mesh.corners(at)).area();
    for (int k = 0; k < 6; ++k)
      nodes.col(k) = out.stress.col(mesh.triangles[at][static_cast<std::size_t>(k)]);
    const auto points = computed.middleCols(3 * t, 3);
    for (std::size_t k = 0; k < 6; ++k) {
      const int node = mesh.triangles[at][k];
      out.averaged.col(node).noalias() += points * from_points(kNodes[k]);
      ++count[node];
    }
    for (const WeightedPoint& w : six_points()) {
      off.noalias() = nodes * t6_shapes(w.at) - points * from_points(w.at);
      for (Eigen::Index l = first; l < n; ++l) {
        const Vec3 s = off.segment<3>(3 * l);
        out.by_triangle(l, t) += w.weight * volume * s.dot(inverse * s);
      }
    }
    for (Eigen::Index l = first; l < n; ++l) {
      for (int p = 0; p < 3; ++p) {
        const Vec3 s = points.col(p).segment<3>(3 * l);
        out.energies[l] += volume / 3 * s.dot(inverse * s);
      }
      out.errors[l] += out.by_triangle(l, t);
    }
  }
  for (Eigen::Index k = 0; k < count.size(); ++k)
    if (count[k] > 0) out.averaged.col(k) /= count[k];
  return out;
}

}  // namespace flexmorph::fem
