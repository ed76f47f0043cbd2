// Material lines of the plate: free lines, and copies of the mesh with other lines.
#include <algorithm>
#include <array>

#include "fem/elements/ancf_plate.h"
#include "fem/elements/plate_shapes.h"
#include "fem/eulerian_lines.h"

namespace flexmorph::fem {

using plate::function_m;
using plate::function_n;
using plate::kCorners;
using plate::powers;
using plate::Row4;

void AncfPlate::number_eulerian_lines() {
  const auto number = [&](const std::vector<MaterialLine>& lines) {
    std::vector<int> out;
    for (const MaterialLine& line : lines) {
      if (line.free && shapes_ == ShapeSet::q4)
        throw Error::input("ancf_plate: a mesh of cells (q4) has no free material lines");
      if (line.free && line.drive)
        throw Error::input("ancf_plate: a material line cannot be both driven and free");
      out.push_back(line.free ? static_cast<int>(free_.size()) : -1);
      if (line.free) free_.push_back({line.value, 0, 0});
    }
    return out;
  };
  const std::vector<int> m = number(m_), n = number(n_);
  if (free_.empty()) return;
  for (size_t i = 0; i + 1 < m.size(); ++i)
    for (size_t j = 0; j + 1 < n.size(); ++j)
      sides_.insert(sides_.end(), {m[i], m[i + 1], n[j], n[j + 1]});
}

std::span<const int> AncfPlate::free_sides(int e) const {
  if (sides_.empty()) return {};
  const std::span<const int> out(sides_.data() + kSides * e, kSides);
  return std::all_of(out.begin(), out.end(), [](int s) { return s < 0; }) ? std::span<const int>{}
                                                                          : out;
}

VectorXd AncfPlate::scalars() const {
  VectorXd out(static_cast<Eigen::Index>(free_.size()));
  for (size_t k = 0; k < free_.size(); ++k) out[static_cast<Eigen::Index>(k)] = free_[k].value;
  return out;
}

void AncfPlate::move_lines(const VectorXd& p, const VectorXd& rate, const VectorXd& acceleration) {
  for (size_t k = 0; k < free_.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    free_[k] = {p[i], rate[i], acceleration[i]};
  }
  move_to(t_);
}

namespace {

/// Derivatives of the Hermite functions of [x1, x2] by x1 and x2 at a fixed material point. They
/// are the rates of the functions when one end, or both ends, move with unit velocity.
struct EndDerivatives {
  std::array<Eigen::Matrix4d, 2> first;
  Eigen::Matrix4d second_11, second_22, second_12;

  explicit EndDerivatives(const Hermite& h) {
    const double x1 = h.start, x2 = h.start + h.length;
    const Hermite one({x1, 1, 0}, {x2, 0, 0}), two({x1, 0, 0}, {x2, 1, 0}),
        both({x1, 1, 0}, {x2, 1, 0});
    first = {one.rate, two.rate};
    second_11 = one.acceleration;
    second_22 = two.acceleration;
    second_12 = 0.5 * (both.acceleration - second_11 - second_22);
  }
};

}  // namespace

void AncfPlate::tabulate_eulerian(int e, int degree, Tabulate what, EulerianTable& out) const {
  tabulate(e, degree, what, {}, ScaleFactorKind::none, out.at);
  const auto i = static_cast<size_t>(e / n_n()), j = static_cast<size_t>(e % n_n());
  out.side = {at_m_[i], at_m_[i + 1], at_n_[j], at_n_[j + 1]};
  const std::span<const int> sides = free_sides(e);
  std::copy(sides.begin(), sides.end(), out.unknown.begin());
  out.power_m.clear();
  out.power_n.clear();
  for (int corner = 0; corner < 4; ++corner)
    for (int k = 0; k < per_node_; ++k) {
      out.power_m.push_back(k == 1 || k == 3);
      out.power_n.push_back(k >= 2);
    }
  if (what != Tabulate::position) return;

  const Hermite &hm = hermite_m_[i], &hn = hermite_n_[j];
  const EndDerivatives dm(hm), dn(hn);
  const auto n_points = out.at.N.rows();
  for (int l = 0; l < kSides; ++l) {
    out.N_p[static_cast<size_t>(l)].resize(n_points, n_shapes());
    for (int k = 0; k <= l; ++k)
      out.N_pp[static_cast<size_t>(l)][static_cast<size_t>(k)].resize(n_points, n_shapes());
  }
  for (Eigen::Index g = 0; g < n_points; ++g) {
    const Vec2& x = out.at.material[static_cast<size_t>(g)];
    const Row4 s = powers((x.x() - hm.start) / hm.length),
               u = powers((x.y() - hn.start) / hn.length);
    const auto along = [](const Row4& p, const Eigen::Matrix4d& c) -> Row4 {
      return p * c.transpose();
    };
    const Row4 m = along(s, hm.value), m_1 = along(s, dm.first[0]), m_2 = along(s, dm.first[1]),
               m_11 = along(s, dm.second_11), m_12 = along(s, dm.second_12),
               m_22 = along(s, dm.second_22);
    const Row4 n = along(u, hn.value), n_1 = along(u, dn.first[0]), n_2 = along(u, dn.first[1]),
               n_11 = along(u, dn.second_11), n_12 = along(u, dn.second_12),
               n_22 = along(u, dn.second_22);
    int column = 0;
    for (const auto& [ca, cb] : kCorners)
      for (int k = 0; k < per_node_; ++k, ++column) {
        const int p = function_m(ca, k), q = function_n(cb, k);
        out.N_p[kM1](g, column) = m_1[p] * n[q];
        out.N_p[kM2](g, column) = m_2[p] * n[q];
        out.N_p[kN1](g, column) = m[p] * n_1[q];
        out.N_p[kN2](g, column) = m[p] * n_2[q];
        out.N_pp[kM1][kM1](g, column) = m_11[p] * n[q];
        out.N_pp[kM2][kM1](g, column) = m_12[p] * n[q];
        out.N_pp[kM2][kM2](g, column) = m_22[p] * n[q];
        out.N_pp[kN1][kM1](g, column) = m_1[p] * n_1[q];
        out.N_pp[kN1][kM2](g, column) = m_2[p] * n_1[q];
        out.N_pp[kN1][kN1](g, column) = m[p] * n_11[q];
        out.N_pp[kN2][kM1](g, column) = m_1[p] * n_2[q];
        out.N_pp[kN2][kM2](g, column) = m_2[p] * n_2[q];
        out.N_pp[kN2][kN1](g, column) = m[p] * n_12[q];
        out.N_pp[kN2][kN2](g, column) = m[p] * n_22[q];
      }
  }
}

std::unique_ptr<LineGrid> AncfPlate::copy() const { return std::make_unique<AncfPlate>(*this); }

namespace {

/// Returns the same lines, with the current coordinates of free lines as their initial ones.
std::vector<MaterialLine> where(std::vector<MaterialLine> lines, const std::vector<Motion>& at) {
  for (size_t i = 0; i < lines.size(); ++i)
    if (lines[i].free) lines[i].value = at[i].value;
  return lines;
}

}  // namespace

std::unique_ptr<LineGrid> AncfPlate::with_line(int i, double value) const {
  std::vector<MaterialLine> m = where(m_, at_m_);
  m.insert(m.begin() + i + 1, MaterialLine{value, {}, false});
  return std::make_unique<AncfPlate>(dim(), shapes_, std::move(m), where(n_, at_n_), t_);
}

std::unique_ptr<LineGrid> AncfPlate::without_line(int i) const {
  std::vector<MaterialLine> m = where(m_, at_m_);
  m.erase(m.begin() + i);
  return std::make_unique<AncfPlate>(dim(), shapes_, std::move(m), where(n_, at_n_), t_);
}

std::unique_ptr<LineGrid> AncfPlate::with_lines_m(std::vector<MaterialLine> m, double t) const {
  return std::make_unique<AncfPlate>(dim(), shapes_, std::move(m), where(n_, at_n_), t);
}

std::unique_ptr<LineGrid> AncfPlate::frozen() const {
  std::vector<MaterialLine> m, n;
  for (const Motion& line : at_m_) m.push_back({line.value, {}, false});
  for (const Motion& line : at_n_) n.push_back({line.value, {}, false});
  return std::make_unique<AncfPlate>(dim(), shapes_, std::move(m), std::move(n), t_);
}

}  // namespace flexmorph::fem
