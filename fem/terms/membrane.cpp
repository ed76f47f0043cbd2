#include "fem/terms/membrane.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "fem/terms/cells/cell_gradients.h"
#include "fem/terms/cells/void_cells.h"
#include "fem/terms/density_term.h"
#include "fem/terms/element_invariants.h"
#include "fem/terms/gram.h"
#include "fem/terms/strain_flow.h"

namespace flexmorph::fem {
namespace {

using gram::Coupling;

/// In-plane elastic force of a thin St. Venant-Kirchhoff plate in Gram form.
///
///   U = h/2 ∫ εᵀ C ε dA,   ε = (½(r_m·r_m - 1), ½(r_n·r_n - 1), r_m·r_n)      P (6)-(8)
///
/// N_k multiplies the identity, so ε depends on the unknowns only through the Gram matrix G_kl =
/// q_k · q_l, and linearly: ε = Λ(X) (g - g°), g the distinct entries of G, g° their values in the
/// undeformed element. Hence U is exactly quadratic,
///
///   U = ½ (g - g°)ᵀ W (g - g°),   W = h ∫ Λᵀ C Λ dA.
///
/// W is computed once per design (once per time for an element whose lines move), and the cost of
/// an evaluation does not depend on the cells. Force and tangent: gram.h, with sums and differences
/// of the q_k instead of the q_k. Positions are relative to the first one: this does not change the
/// force (rigid translations cause no strain) and loses no digits far from the origin.
///
/// Elements of a mesh are evaluated eight at a time, see Batch.
///
/// Cells of a design (shape set q4) that are nearly empty have small strains in a corotational
/// frame instead, see void_cells.h.
///
/// Replaces P (11)-(15) and the tensors of the appendix; fem/README.md, Gram form.
class Membrane final : public ElasticTerm, public BatchTerm {
 public:
  Membrane(const PlaneSection& s, Strains strains)
      : ElasticTerm(strains == Strains::assumed ? "membrane_assumed" : "membrane",
                    membrane_parts(s, strains)),
        section_(s),
        elasticity_(s.thickness * s.elasticity()),
        strains_(strains),
        invariants_(elasticity_, strains) {}

  /// Creates an unprepared term, because prepared data would be recomputed anyway.
  std::unique_ptr<Term> clone() const override { return make_membrane(section_, strains_); }
  void prepare(const Element& element, const ScaleFactors& factors, bool all) override {
    prepare_parts(element, factors);
    if (all) {
      dim_ = element.dim();
      coupling_ = factors.uniform() ? Coupling::classes : Coupling::all;
      kinds_ = element.n_shapes() % 4 == 0 ? element.n_shapes() / 4 : 0;
      invariants_.number(kinds_, coupling_ == Coupling::all);
      batches_.assign(static_cast<size_t>((element.n_elements() + kLanes - 1) / kLanes), {});
    }
    invariants_.begin(element, factors, all);
    const MatrixXd reference = element.reference();
    for (size_t b = 0; b < batches_.size(); ++b)
      prepare_batch(element, static_cast<int>(b) * kLanes, factors, reference, all, batches_[b]);
  }

  void add_force(int e, const Local& x, LocalRows& force) const override {
    evaluate(e, x, [&]<int kKinds, int kDim, Coupling>(double* s, const double* p, auto) {
      if constexpr (kKinds == 1) {
        if (const VoidCells& cells = of(e).cells; cells.any())
          cells.add_force(VoidCells::Lane{e % kLanes}, p, s, force.data());
      }
      gram::add_force<kKinds, kDim>(s, p, force.data());
    });
  }

  void add_tangent(int e, const Local& x, const Weights& w, LocalTangent& tangent) const override {
    if (w.q == 0) return;
    // K is symmetric, so that the order by columns or by rows does not matter. Single elements are
    // rare, and compiling kernels takes minutes. Therefore they share the kernels of
    // add_mean_tangent(), which compute both halves.
    evaluate(
        e, x,
        [&]<int kKinds, int kDim, Coupling coupling>(const double* s, const double* p, auto w_e) {
          if constexpr (kKinds == 1) {
            if (const VoidCells& cells = of(e).cells; cells.any())
              return cells.add_tangent<coupling>(VoidCells::Lane{e % kLanes}, w_e, s, p, w.q,
                                                 tangent.data());
          }
          gram::add_tangent<kKinds, kDim, coupling, false>(w_e, s, p, p, w.q, tangent.data());
        });
  }

  void add_forces(const Batch& x, Pack* force) const override {
    run_batch_kernel([&]<class V>() {
      evaluate<V>(x, [&]<int kKinds, int kDim, Coupling>(V* s, const V* p, auto) {
        if constexpr (kKinds == 1) {
          if (const VoidCells& cells = of(x.first).cells; cells.any())
            cells.add_force(VoidCells::AllPacks<V>{}, p, s, packs_as<V>(force));
        }
        gram::add_force<kKinds, kDim>(s, p, packs_as<V>(force));
      });
    });
  }

  void add_tangents(const Batch& x, const Weights& w, Pack* tangent) const override {
    if (w.q == 0) return;
    run_batch_kernel([&]<class V>() {
      evaluate<V>(x, [&]<int kKinds, int kDim, Coupling coupling>(const V* s, const V* p,
                                                                  auto invariant) {
        V* out = packs_as<V>(tangent);
        if constexpr (kKinds == 1) {
          if (const VoidCells& cells = of(x.first).cells; cells.any())
            return cells.add_tangent<coupling>(VoidCells::AllPacks<V>{}, invariant, s, p, w.q, out);
        }
        gram::add_tangent<kKinds, kDim, coupling>(invariant, s, p, p, w.q, out);
      });
    });
  }

  /// Adds F̄ = S(ḡ) q̄ with the mean of the Gram entries at both ends,
  ///
  ///   ḡ = ½ (g₀ + g₁) = g(q̄) + ¼ g(d),   q̄ = ½ (q₀ + q₁),   d = q₁ - q₀
  ///
  /// an exact discrete gradient, because U is quadratic in g and g in q: U₁ - U₀ = (g₁ - g₀)ᵀ W (ḡ
  /// - g°) = F̄ · d. S is symmetric, so that F̄ has no moment about q̄. Simo, Tarnow (1992), Z.
  /// angew. Math. Phys. 43, 757-792, use this mean of the stress.
  void add_mean_force(int e, const LocalStep& x, LocalRows& force) const override {
    evaluate_mean(e, x,
                  [&]<int kKinds, int kDim, Coupling>(const double* s, const double* p, auto) {
                    gram::add_force<kKinds, kDim>(s, p, force.data());
                  });
  }

  /// Adds ∂F̄/∂q₁ = ½ (S(ḡ) ⊗ 1 + D(q̄)ᵀ W D(q₁)), a tangent from two states.
  void add_mean_tangent(int e, const LocalStep& x, const Weights& w,
                        LocalTangent& tangent) const override {
    if (w.q == 0) return;
    LocalTangent by_columns = LocalTangent::Zero(tangent.rows(), tangent.cols());
    evaluate_mean(
        e, x,
        [&]<int kKinds, int kDim, Coupling coupling>(const double* s, const double* p, auto w_e) {
          double end[kMaxVectors * kMaxDim];
          gram::vectors<kKinds, kDim>(x.end.data(), end);
          gram::add_tangent<kKinds, kDim, coupling, false>(w_e, s, p, end, w.q, by_columns.data());
        });
    tangent += by_columns.transpose();
  }
  double flow_power(int e, const Local& x) const override {
    if (strains_ == Strains::assumed)
      return assumed_flow_power(element(), e, factors(), elasticity_, x.q);
    MatrixXd weights;
    if (!invariants_.weigh(e, weights)) return ElasticTerm::flow_power(e, x);
    ShapeTable t;
    element().tabulate(e, 2 * ElementInvariants::kDegree, Tabulate::gradient_rates, {},
                       ScaleFactorKind::none, t);
    for (Eigen::Index g = 0; g < weights.rows(); ++g)
      for (Eigen::Index h = 0; h < weights.cols(); ++h)
        t.weight[g * weights.cols() + h] = weights(g, h);
    return fem::flow_power(*parts().front().density, t, x.q);
  }

  void add_scale_factor_gradient(int e, const Local& x, const LocalRows& psi,
                                 ScaleFactorGradient& out) const override {
    if (kinds_ == 1)
      add_gradient_of_cell(e, x.q.data(), psi.data(), 1, out.stiffness);
    else
      ElasticTerm::add_scale_factor_gradient(e, x, psi, out);
  }
  void add_energy_gradient(int e, const Local& x, double weight,
                           ScaleFactorGradient& out) const override {
    if (kinds_ == 1)
      add_gradient_of_cell(e, x.q.data(), nullptr, weight, out.stiffness);
    else
      ElasticTerm::add_energy_gradient(e, x, weight, out);
  }

  void add_line_energy(std::span<const ShapeTable> line, const Local& x,
                       LineEnergy& out) const override {
    if (strains_ == Strains::assumed)
      add_assumed_line_energy(line, elasticity_, x.q, out.stiffness);
    else
      ElasticTerm::add_line_energy(line, x, out);
  }

 private:
  static constexpr int kMaxPairs = gram::Numbering<4>::n_pairs;
  static constexpr int kMaxVectors = gram::Numbering<4>::n;
  using Packed = ElementInvariants::Packed;

  struct BatchData {
    Packed shared;                // W as squares, if equal for all elements
    std::vector<Pack> different;  // W packed, if not equal
    std::vector<Pack> reference;  // g°
    VoidCells cells;              // only with the shape set q4
  };

  void add_gradient_of_cell(int e, const double* q, const double* psi, double weight,
                            VectorXd& out) const {
    const BatchData& b = of(e);
    add_cell_gradient(element(), factors(), invariants_, {b.different, b.reference, b.cells}, e, q,
                      psi, weight, out);
  }

  const BatchData& of(int e) const { return batches_[static_cast<size_t>(e / kLanes)]; }

  double energy_at(int e, const Local& x) const override {
    double energy = 0;
    const BatchData& batch = of(e);
    evaluate(e, x, [&]<int kKinds, int kDim, Coupling>(const double* s, const double* p, auto) {
      double g[kMaxPairs];
      gram::products<kKinds, kDim>(p, g);
      for (size_t k = 0; k < batch.reference.size(); ++k)
        energy += 0.5 * s[k] * (g[k] - batch.reference[k][e % kLanes]);
      if constexpr (kKinds == 1) {
        if (batch.cells.any()) energy = batch.cells.energy(e % kLanes, p, energy);
      }
    });
    return energy;
  }

  template <class F>
  void dispatch(const F& f) const {
    if (kinds_ == 1)
      f.template operator()<1, 2>();
    else if (kinds_ == 3)
      dim_ == 2 ? f.template operator()<3, 2>() : f.template operator()<3, 3>();
    else
      dim_ == 2 ? f.template operator()<4, 2>() : f.template operator()<4, 3>();
  }

  /// Calls f<kKinds, kDim, coupling>(s, p, W) of one element.
  template <class F>
  void evaluate(int e, const Local& x, const F& f) const {
    const BatchData& batch = batches_[static_cast<size_t>(e / kLanes)];
    dispatch([&]<int kKinds, int kDim>() {
      double p[kMaxVectors * kMaxDim], g[kMaxPairs], s[kMaxPairs];
      gram::vectors<kKinds, kDim>(x.q.data(), p);
      gram::products<kKinds, kDim>(p, g);
      for (size_t k = 0; k < batch.reference.size(); ++k) g[k] -= batch.reference[k][e % kLanes];
      with_invariant(e, batch, [&]<Coupling coupling>(auto w) {
        gram::multiply<kKinds, coupling>(w, g, s);
        f.template operator()<kKinds, kDim, coupling>(s, p, w);
      });
    });
  }

  /// Calls f<kKinds, kDim, coupling>(s, p, W) of one element, s at ḡ and p at q̄.
  template <class F>
  void evaluate_mean(int e, const LocalStep& x, const F& f) const {
    const BatchData& batch = batches_[static_cast<size_t>(e / kLanes)];
    const LocalRows change = x.end - x.start;
    dispatch([&]<int kKinds, int kDim>() {
      double p[kMaxVectors * kMaxDim], g[kMaxPairs], s[kMaxPairs], of_change[kMaxPairs];
      gram::vectors<kKinds, kDim>(change.data(), p);
      gram::products<kKinds, kDim>(p, of_change);
      gram::vectors<kKinds, kDim>(x.mean.q.data(), p);
      gram::products<kKinds, kDim>(p, g);
      for (size_t k = 0; k < batch.reference.size(); ++k)
        g[k] += 0.25 * of_change[k] - batch.reference[k][e % kLanes];
      with_invariant(e, batch, [&]<Coupling coupling>(auto w) {
        gram::multiply<kKinds, coupling>(w, g, s);
        f.template operator()<kKinds, kDim, coupling>(s, p, w);
      });
    });
  }

  /// Calls f<coupling>(W) with W of one element.
  template <class F>
  void with_invariant(int e, const BatchData& batch, const F& f) const {
    const gram::OneOf one{batch.different.data(), e % kLanes};
    if (coupling_ == Coupling::all)
      f.template operator()<Coupling::all>(one);
    else if (batch.shared)
      f.template operator()<Coupling::classes>(gram::Shared{batch.shared->data()});
    else
      f.template operator()<Coupling::classes>(one);
  }

  /// Calls f<kKinds, kDim, coupling>(s, p, W) of eight elements.
  template <class V, class F>
  void evaluate(const Batch& x, const F& f) const {
    const BatchData& batch = batches_[static_cast<size_t>(x.first / kLanes)];
    const V* reference = packs_as<V>(batch.reference.data());
    dispatch([&]<int kKinds, int kDim>() {
      V p[kMaxVectors * kDim], g[kMaxPairs], s[kMaxPairs];
      gram::vectors<kKinds, kDim>(packs_as<V>(x.q), p);
      gram::products<kKinds, kDim>(p, g);
      for (int k = 0; k < gram::Numbering<kKinds>::n_pairs; ++k) g[k] -= reference[k];
      const auto with = [&]<Coupling coupling>(auto w) {
        gram::multiply<kKinds, coupling>(w, g, s);
        f.template operator()<kKinds, kDim, coupling>(s, p, w);
      };
      const gram::Different<V> different{packs_as<V>(batch.different.data())};
      if (coupling_ == Coupling::all)
        with.template operator()<Coupling::all>(different);
      else if (batch.shared)
        with.template operator()<Coupling::classes>(gram::Shared{batch.shared->data()});
      else
        with.template operator()<Coupling::classes>(different);
    });
  }

  void prepare_batch(const Element& element, int first, const ScaleFactors& factors,
                     const MatrixXd& reference, bool all, BatchData& out) {
    const int count = std::min(kLanes, element.n_elements() - first);
    int n_moving = 0, n_free = 0;  // elements with free lines are evaluated by EulerianElastic
    for (int lane = 0; lane < count; ++lane) {
      const bool free = is_free(first + lane);
      n_free += free;
      n_moving += !free && element.moving(first + lane);
    }
    if (n_free == count || (!all && n_moving == 0)) return;
    std::array<Packed, kLanes> w;
    out.reference.resize(static_cast<size_t>(invariants_.n_pairs()));
    for (int lane = 0; lane < count; ++lane)
      if ((all || element.moving(first + lane)) && !is_free(first + lane)) {
        w[static_cast<size_t>(lane)] = invariants_.of(element, first + lane, factors);
        set_reference(element, first + lane, reference, out);
        if (kinds_ == 1 && !factors.uniform()) set_cell(element, first + lane, reference, out);
      }
    // W is not shared if the lines of only some of the elements move.
    const bool alike =
        coupling_ == Coupling::classes && n_free == 0 && (n_moving == 0 || n_moving == count) &&
        std::all_of(w.begin(), w.begin() + count, [&](const Packed& x) { return x == w[0]; });
    out.shared = alike ? invariants_.squares() : nullptr;
    if (!alike) {
      const auto any =
          std::find_if(w.begin(), w.end(), [](const Packed& x) { return x != nullptr; });
      if (any != w.end()) out.different.resize((*any)->size());
      for (int lane = 0; lane < count; ++lane)
        if (const Packed& of_lane = w[static_cast<size_t>(lane)])
          for (size_t k = 0; k < of_lane->size(); ++k) out.different[k][lane] = (*of_lane)[k];
    }
    for (int lane = count; lane < kLanes; ++lane) {
      if (!alike)
        for (Pack& x : out.different) x[lane] = x[count - 1];
      for (Pack& x : out.reference) x[lane] = x[count - 1];
    }
    if (coupling_ != Coupling::all || kinds_ != 1) return;
    out.cells.fill(count);
    out.cells.set_stiffness(out.different);
  }

  /// Sets the cell of the element whose W was computed last, with its mean scale factor.
  void set_cell(const Element& element, int e, const MatrixXd& reference, BatchData& out) {
    const auto numbers = element.vectors(e);
    const Vec2 size = (reference.row(numbers[2]) - reference.row(numbers[0])).head<2>();
    out.cells.set(e % kLanes, size, invariants_.table().weight.sum() / (size.x() * size.y()));
  }

  void set_reference(const Element& element, int e, const MatrixXd& reference, BatchData& out) {
    const auto numbers = element.vectors(e);
    double q[kMaxShapes * 2], p[kMaxVectors * 2], g[kMaxPairs];
    for (size_t k = 0; k < numbers.size(); ++k)
      for (size_t c = 0; c < 2; ++c)
        q[2 * k + c] = reference(numbers[k], static_cast<Eigen::Index>(c));
    if (kinds_ == 1) {
      gram::vectors<1, 2>(q, p);
      gram::products<1, 2>(p, g);
    } else if (kinds_ == 3) {
      gram::vectors<3, 2>(q, p);
      gram::products<3, 2>(p, g);
    } else {
      gram::vectors<4, 2>(q, p);
      gram::products<4, 2>(p, g);
    }
    for (size_t k = 0; k < out.reference.size(); ++k) out.reference[k][e % kLanes] = g[k];
  }

  PlaneSection section_;
  Eigen::Matrix3d elasticity_;  // h C [N/m]
  Strains strains_;
  int dim_ = 0, kinds_ = 0;
  Coupling coupling_ = Coupling::classes;
  std::vector<BatchData> batches_;
  ElementInvariants invariants_;
};

}  // namespace

std::unique_ptr<Term> make_membrane(const PlaneSection& section, Strains strains) {
  return std::make_unique<Membrane>(section, strains);
}

}  // namespace flexmorph::fem
