#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "fem/terms/cells/turned_cell.h"
#include "fem/terms/gram.h"
#include "geometry/base.h"

/// Cells of a design, eight side by side, of which some are nearly empty. The energy of a cell
/// changes gradually from that of St. Venant and Kirchhoff to a small-strain energy in a
/// corotational frame (turned_cell.h) as its stiffness factor decreases.
namespace flexmorph::fem {

/// Small-strain energies of eight cells and the fraction of St. Venant-Kirchhoff energy of each.
class VoidCells {
 public:
  /// Selection of one of the eight cells.
  struct Lane {
    using V = double;  ///< Number type of one cell.
    int lane;          ///< SIMD lane of the cell.
    /// Returns the value of the cell.
    double operator()(const Pack& x) const { return x[lane]; }
  };
  /// Selection of all eight cells.
  template <class Of>
  struct AllPacks {
    using V = Of;  ///< Pack of SIMD lanes.
    /// Returns the values of all cells.
    const V& operator()(const Pack& x) const { return *packs_as<V>(&x); }
  };

  /// Returns true if any of the cells is nearly empty.
  bool any() const { return !stiffness_.empty(); }

  /// Returns the fraction of a cell's energy that is St. Venant-Kirchhoff: it changes from 0 to 1
  /// around a stiffness factor of 0.01, with two continuous derivatives.
  static double solid_part(double factor) {
    if (!(factor > 0)) return 0;
    const double x = std::clamp(std::log(factor / kVoid) / std::log(kMaterial / kVoid), 0.0, 1.0);
    return x * x * x * (10 + x * (6 * x - 15));
  }

  /// Returns the derivative of solid_part() with respect to the factor.
  static double solid_derivative(double factor) {
    if (!(factor > 0)) return 0;
    const double decades = std::log(kMaterial / kVoid), x = std::log(factor / kVoid) / decades;
    return x <= 0 || x >= 1 ? 0 : 30 * x * x * (1 - x) * (1 - x) / (factor * decades);
  }

  /// Sets the size and the stiffness factor of the cell in a SIMD lane.
  /// @param size  size of the undeformed cell [m]
  /// @param factor  its mean stiffness factor
  void set(int lane, const Vec2& size, double factor) {
    undeformed_.resize(turned_cell::kSize);
    undeformed_[0][lane] = 0.5 * size.x();
    undeformed_[3][lane] = 0.5 * size.y();
    factor_[lane] = factor;
    solid_[lane] = solid_part(factor);
  }
  /// Returns the stiffness factor of a cell.
  double factor(int lane) const { return factor_[lane]; }
  /// Returns the size of the undeformed cell [m].
  Vec2 size(int lane) const { return {2 * undeformed_[0][lane], 2 * undeformed_[3][lane]}; }
  /// Fills the SIMD lanes from `count` on with copies of the lane before.
  void fill(int count) {
    for (int lane = count; lane < kLanes; ++lane) {
      for (Pack& x : undeformed_) x[lane] = x[count - 1];
      solid_[lane] = solid_[count - 1];
    }
  }
  /// Computes K = Dᵀ W D at the undeformed cells, with W for all pairs: the tangent stiffness of
  /// the undeformed cells. Nothing is stored if all cells are solid.
  void set_stiffness(const std::vector<Pack>& w) {
    stiffness_.clear();
    bool all_solid = true;
    for (int lane = 0; lane < kLanes; ++lane) all_solid &= solid_[lane] >= 1;
    if (all_solid || undeformed_.empty()) return;
    constexpr int n = turned_cell::kVectors, size = turned_cell::kSize;
    Pack blocks[n * n * 4] = {};
    const Pack none[gram::Numbering<1>::n_pairs] = {};
    gram::stiffness_of<1, 2, gram::Coupling::all, true>(
        gram::Different<Pack>{w.data()}, none, undeformed_.data(), undeformed_.data(), blocks);
    stiffness_.resize(size * size);
    for (int i = 0; i < size; ++i)
      for (int j = 0; j < size; ++j) {
        const int k = std::min(i / 2, j / 2), l = std::max(i / 2, j / 2);
        const int x = i / 2 <= j / 2 ? i % 2 : j % 2, c = i / 2 <= j / 2 ? j % 2 : i % 2;
        stiffness_[static_cast<std::size_t>(i * size + j)] = blocks[(k * n + l) * 4 + x * 2 + c];
      }
  }

  /// Adds the force of the void fraction to the nodes, and multiplies the stress s by the solid
  /// fraction.
  template <class Pick, class V = typename Pick::V>
  void add_force(const Pick& pick, const V* p, V* s, V* force) const {
    V stiffness[turned_cell::kSize * turned_cell::kSize], f[turned_cell::kSize] = {};
    const V solid = pick(solid_);
    turned_cell::add_force<V>(state(pick, p, stiffness), 0.25 * (1.0 - solid), f);
    gram::add_to_nodes<1, 2>(f, force);
    for (int k = 0; k < gram::Numbering<1>::n_pairs; ++k) s[k] *= solid;
  }

  /// Adds the tangent of the solid and of the void fraction to the nodes.
  template <gram::Coupling coupling, class Pick, class W, class V = typename Pick::V>
  void add_tangent(const Pick& pick, W w, const V* s, const V* p, double weight, V* tangent) const {
    V stiffness[turned_cell::kSize * turned_cell::kSize], sum[turned_cell::kVectors * 12] = {};
    const V solid = pick(solid_);
    gram::stiffness_of<1, 2, coupling, true>(w, s, p, p, sum);
    for (V& each : sum) each *= solid;
    const auto at = state(pick, p, stiffness);
    turned_cell::add_stiffness<V>(stiffness, at, 1.0 - solid, sum);
    gram::add_to_nodes<1, 2, true>(sum, weight, tangent);
  }

  /// Returns the contribution of the small-strain energy alone, for the whole cell: the work of its
  /// force on ψ (vectors (kSize) like p), or its energy if ψ is null.
  double small_strains(int lane, const double* p, const double* psi) const {
    double stiffness[turned_cell::kSize * turned_cell::kSize];
    const auto at = state(Lane{lane}, p, stiffness);
    if (!psi) return at.energy;
    double force[turned_cell::kSize] = {}, work = 0;
    turned_cell::add_force<double>(at, 1.0, force);
    for (int k = 0; k < turned_cell::kSize; ++k) work += force[k] * psi[k];
    return work;
  }

  /// Returns the energy of a cell.
  /// @param energy  energy of St. Venant and Kirchhoff
  double energy(int lane, const double* p, double energy) const {
    double stiffness[turned_cell::kSize * turned_cell::kSize];
    const Lane pick{lane};
    const double solid = pick(solid_);
    return solid * energy + (1 - solid) * state(pick, p, stiffness).energy;
  }

 private:
  template <class Pick, class V = typename Pick::V>
  turned_cell::State<V> state(const Pick& pick, const V* p, V* stiffness) const {
    V undeformed[turned_cell::kSize];
    for (std::size_t k = 0; k < stiffness_.size(); ++k) stiffness[k] = pick(stiffness_[k]);
    for (std::size_t k = 0; k < undeformed_.size(); ++k) undeformed[k] = pick(undeformed_[k]);
    return turned_cell::state_of<V>(stiffness, p, undeformed);
  }

  // Stiffness factors below and above which a cell is void and solid.
  static constexpr double kVoid = 1e-3, kMaterial = 1e-1;

  // K of turned_cell.h; empty where all cells are solid
  std::vector<Pack> stiffness_;
  std::vector<Pack> undeformed_;  // P
  Pack solid_{}, factor_{};       // solid_part() of each factor, and the factors
};

}  // namespace flexmorph::fem
