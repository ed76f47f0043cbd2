// The right-hand sides of LoadedMesh.
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "fem/triangles/t6.h"
#include "optim/verification/force_spread.h"
#include "optim/verification/loaded_mesh.h"

namespace flexmorph::verification {

/// Returns nodes and their forces [N]; empty if the material at the location cannot carry the
/// force.
std::vector<std::pair<int, Vec2>> LoadedMesh::forces_at_nodes(const Force& force) const {
  const auto& at = at_locations_[static_cast<std::size_t>(force.location)].shares;
  std::vector<Vec2> points;
  std::vector<double> shares;
  for (const auto& [node, share] : at) {
    points.push_back(mesh_.point(node));
    shares.push_back(share);
  }
  const std::vector<Vec2> forces =
      spread({force.force, force.moment, force.bearing, force.center}, points, shares);
  std::vector<std::pair<int, Vec2>> out;
  for (std::size_t k = 0; k < forces.size(); ++k) out.emplace_back(at[k].first, forces[k]);
  return out;
}

/// Finds the nodes of the held edge and sets springs between neighbours, where k Δy is a constant.
/// The edge shall stay straight but may rotate. Therefore the springs in x have the elongation
/// Δu - s Δy, where Δu is the difference of displacements of two neighbours and s the rotation from
/// the first node to the last one. The term with s acts like a spring of negative stiffness between
/// these two nodes.
void LoadedMesh::find_edge() {
  if (!loads_.held_edge) return;
  std::vector<char> carries(mesh_.points.size(), 0);
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
    for (const int node : mesh_.triangles[t])
      if (omitted_[t] == 0) carries[static_cast<std::size_t>(node)] = 1;
  for (std::size_t k = 0; k < mesh_.points.size(); ++k)
    if (carries[k] && std::abs(mesh_.points[k].x() - loads_.held_edge->x) <= small_)
      edge_.push_back(static_cast<int>(k));
  std::sort(edge_.begin(), edge_.end(),
            [&](int a, int b) { return mesh_.point(a).y() < mesh_.point(b).y(); });
  if (edge_.size() < 2) return edge_.clear();
  const double stiffness = loads_.held_edge->stiffness;
  const auto height = [&](int a, int b) { return mesh_.point(b).y() - mesh_.point(a).y(); };
  for (std::size_t k = 1; k < edge_.size(); ++k)
    for (const int c : {0, 1})
      springs_.push_back({edge_[k - 1], edge_[k], c, stiffness / height(edge_[k - 1], edge_[k])});
  springs_.push_back(
      {edge_.front(), edge_.back(), 0, -stiffness / height(edge_.front(), edge_.back())});
}

double LoadedMesh::held_end_stretch(std::size_t row) const {
  return edge_.empty() ? 0 : loads_.loads[static_cast<std::size_t>(order_[row])].held_end_stretch;
}

/// The springs in y have the elongation Δw + g_e Δy, with Δw the difference of displacements and
/// g_e the suppressed stretch of the edge.
VectorXd LoadedMesh::edge_energies(const MatrixXd& u) const {
  VectorXd out = VectorXd::Zero(u.rows());
  const auto difference = [&](int a, int b, int c) -> VectorXd {
    const int at_a = plate_->row(a, c), at_b = plate_->row(b, c);
    VectorXd d = VectorXd::Zero(u.rows());
    if (at_b >= 0) d += u.col(at_b);
    if (at_a >= 0) d -= u.col(at_a);
    return d;
  };
  for (const fem::NodeSpring& s : springs_)
    out += s.stiffness * difference(s.a, s.b, s.component).cwiseAbs2();
  if (edge_.empty()) return out;
  const VectorXd across = difference(edge_.front(), edge_.back(), 1);
  const double height = mesh_.point(edge_.back()).y() - mesh_.point(edge_.front()).y();
  for (Eigen::Index l = 0; l < u.rows(); ++l) {
    const double g = held_end_stretch(static_cast<std::size_t>(l));
    out[l] += loads_.held_edge->stiffness * g * (2 * across[l] + g * height);
  }
  return out;
}

/// Adds the forces -ρ a of all material that takes part, for the given rows (n x 2 n_nodes).
void LoadedMesh::add_inertia(std::span<const int> rows, MatrixXd& at_nodes) const {
  const Grid& g = loads_.grid;
  const auto n = static_cast<Eigen::Index>(rows.size());
  MatrixXd acceleration = MatrixXd::Zero(n, 2 * g.n_nodes());
  bool any = false;
  for (Eigen::Index l = 0; l < n; ++l) {
    const int load = order_[static_cast<std::size_t>(rows[static_cast<std::size_t>(l)])];
    const VectorXd* a = loads_.loads[static_cast<std::size_t>(load)].acceleration;
    if (a == nullptr) continue;
    acceleration.row(l) = a->transpose();
    any = true;
  }
  if (!any) return;
  MatrixXd here(n, 2);
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    if (omitted_[t] != 0) continue;
    const fem::T6 element(mesh_.corners(t));
    const double mass = section_.density * section_.thickness * element.area();
    for (const fem::WeightedPoint& w : fem::six_points()) {
      const Vec2 p = element.position(w.at);
      const double x = std::clamp((p.x() - g.x0) / g.dx(), 0.0, double(g.nx)),
                   y = std::clamp((p.y() - g.y0) / g.dy(), 0.0, double(g.ny));
      const int i = std::min(static_cast<int>(x), g.nx - 1),
                j = std::min(static_cast<int>(y), g.ny - 1);
      const double u = x - i, v = y - j;
      here.setZero();
      for (int k = 0; k < 4; ++k) {
        const double share = (k % 2 ? u : 1 - u) * (k / 2 ? v : 1 - v);
        here += share * acceleration.middleCols(2 * g.node(i + k % 2, j + k / 2), 2);
      }
      const Eigen::Matrix<double, 6, 1> shapes = fem::t6_shapes(w.at);
      for (int k = 0; k < 6; ++k)
        at_nodes.middleCols(2 * mesh_.triangles[t][static_cast<std::size_t>(k)], 2) -=
            w.weight * mass * shapes[k] * here;
    }
  }
}

VectorXd LoadedMesh::nodal_forces(int row) const {
  MatrixXd out = MatrixXd::Zero(1, 2 * static_cast<Eigen::Index>(mesh_.points.size()));
  add_inertia(std::span<const int>(&row, 1), out);
  const Load& load = loads_.loads[static_cast<std::size_t>(order_[static_cast<std::size_t>(row)])];
  for (const Force& f : load.forces)
    for (const auto& [node, at_node] : forces_at_nodes(f))
      out.middleCols(2 * node, 2) += at_node.transpose();
  VectorXd forces = out.row(0).transpose();
  if (balance_) balance_->apply(forces);
  return forces;
}

MatrixXd LoadedMesh::prescribed() const {
  if (std::all_of(loads_.loads.begin(), loads_.loads.end(),
                  [](const Load& l) { return l.held_stretch == 0; }))
    return {};
  MatrixXd out = MatrixXd::Zero(static_cast<Eigen::Index>(order_.size()),
                                2 * static_cast<Eigen::Index>(mesh_.points.size()));
  for (std::size_t l = 0; l < order_.size(); ++l) {
    const Load& load = loads_.loads[static_cast<std::size_t>(order_[l])];
    for (std::size_t k = 0; load.clamp && k < mesh_.points.size(); ++k)
      if (std::abs(mesh_.points[k].x() - *load.clamp) <= small_)
        out(static_cast<Eigen::Index>(l), 2 * static_cast<Eigen::Index>(k) + 1) =
            -load.held_stretch * mesh_.points[k].y();
  }
  return out;
}

MatrixXd LoadedMesh::forces() const {
  constexpr std::size_t kBlock = 16;  // number of loads whose nodal forces are stored at a time
  const auto n = order_.size();
  MatrixXd out = MatrixXd::Zero(static_cast<Eigen::Index>(n), plate_->n_unknowns());
  if (balance_) {
    for (std::size_t l = 0; l < n; ++l) {
      const VectorXd at_nodes = nodal_forces(static_cast<int>(l));
      for (Eigen::Index k = 0; k < at_nodes.size(); ++k)
        if (const int row = plate_->row(static_cast<int>(k / 2), static_cast<int>(k % 2)); row >= 0)
          out(static_cast<Eigen::Index>(l), row) = at_nodes[k];
    }
    return out;
  }
  const MatrixXd given = prescribed();
  for (std::size_t first = 0; first < n; first += kBlock) {
    std::vector<int> rows;
    for (std::size_t l = first; l < std::min(n, first + kBlock); ++l)
      rows.push_back(static_cast<int>(l));
    const auto m = static_cast<Eigen::Index>(rows.size()), from = static_cast<Eigen::Index>(first);
    MatrixXd at_nodes = MatrixXd::Zero(m, 2 * static_cast<Eigen::Index>(mesh_.points.size()));
    add_inertia(rows, at_nodes);
    for (Eigen::Index k = 0; k < at_nodes.cols(); ++k) {
      const int row = plate_->row(static_cast<int>(k / 2), static_cast<int>(k % 2));
      if (row >= 0) out.block(from, row, m, 1) = at_nodes.col(k);
    }
  }
  for (std::size_t l = 0; l < n; ++l)
    for (const Force& f : loads_.loads[static_cast<std::size_t>(order_[l])].forces)
      for (const auto& [node, at_node] : forces_at_nodes(f))
        for (int c = 0; c < 2; ++c)
          if (const int row = plate_->row(node, c); row >= 0)
            out(static_cast<Eigen::Index>(l), row) += at_node[c];
  for (std::size_t l = 0; l < n; ++l) {
    const double g = held_end_stretch(l);
    if (g == 0) continue;
    const double force = loads_.held_edge->stiffness * g;
    out(static_cast<Eigen::Index>(l), plate_->row(edge_.front(), 1)) += force;
    out(static_cast<Eigen::Index>(l), plate_->row(edge_.back(), 1)) -= force;
  }
  if (given.size() == 0) return out;
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    if (omitted_[t] != 0) continue;
    MatrixXd local(given.rows(), 12);
    for (int a = 0; a < 12; ++a)
      local.col(a) = given.col(2 * mesh_.triangles[t][static_cast<std::size_t>(a / 2)] + a % 2);
    if (local.isZero(0)) continue;
    // A load has no unknowns behind its clamp; contributions there are ignored.
    const MatrixXd back = local * fem::T6(mesh_.corners(t)).stiffness(section_);
    for (int a = 0; a < 12; ++a)
      if (const int row = plate_->row(mesh_.triangles[t][static_cast<std::size_t>(a / 2)], a % 2);
          row >= 0)
        out.col(row) -= back.col(a);
  }
  return out;
}

std::vector<fem::HeldUnknown> LoadedMesh::held(int row) const {
  std::vector<fem::HeldUnknown> out = held_;
  if (clamp_lines_.empty()) return out;
  const int clamp = clamps_[static_cast<std::size_t>(row)];
  for (int node = 0; node < static_cast<int>(mesh_.points.size()); ++node)
    if (plate_->first_clamp(node) > clamp)
      for (int c = 0; c < 2; ++c) out.push_back({node, c});
  return out;
}

}  // namespace flexmorph::verification
