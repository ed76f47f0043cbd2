#include <algorithm>
#include <cmath>
#include <memory>

#include "fem/terms.h"
#include "fem/terms/densities.h"
#include "fem/terms/density_term.h"
#include "fem/terms/gram.h"
#include "fem/terms/membrane_invariant.h"
#include "fem/terms/sampling.h"
#include "fem/terms/strain_flow.h"
#include "fem/terms/void_cells.h"

namespace flexmorph::fem {
namespace {

using gram::Coupling;

/// In-plane elastic force of a thin St. Venant-Kirchhoff plate in Gram form.
///
///   U = h/2 ∫ εᵀ C ε dA,   ε = (½(r_m·r_m - 1), ½(r_n·r_n - 1), r_m·r_n)      P (6)-(8)
///
/// N_k multiplies the identity, so ε depends on the unknowns only through the Gram matrix
/// G_kl = q_k · q_l, and linearly: ε = Λ(X) (g - g°), g = the distinct entries of G, g° those of
/// the undeformed element. Hence U is exactly quadratic,
///
///   U = ½ (g - g°)ᵀ W (g - g°),   W = h ∫ Λᵀ C Λ dA,
///
/// and W is built once per design (per time for an element whose lines move), at the same cost of
/// evaluation whatever the cells. Force and tangent: gram.h, with sums and differences of the q_k
/// instead of the q_k. Positions enter relative to the first one: the force is the same (rigid
/// translations strain nothing) and loses no digits far from the origin.
///
/// Elements of a mesh are evaluated eight at a time, see Batch.
///
/// Cells of a design (shape set q4) that are nearly empty have small strains in a frame that turns
/// with them instead, see void_cells.h.
///
/// Replaces P (11)-(15) and the tensors of the appendix; fem/README.md, Gram form.
class Membrane final : public ElasticTerm {
 public:
  Membrane(const PlaneSection& s, Strains strains)
      : ElasticTerm(strains == Strains::assumed ? "membrane_assumed" : "membrane",
                    parts_of(s, strains)),
        section_(s),
        elasticity_(s.thickness * s.elasticity()),
        strains_(strains) {}

  static std::vector<ElasticPart> parts_of(const PlaneSection& s, Strains strains) {
    return {{std::make_shared<MembraneDensity>(s), strains == Strains::assumed
                                                       ? sample_assumed()
                                                       : sample_points(12, Tabulate::gradient)}};
  }

  /// Made anew: what is prepared would only be prepared again.
  std::unique_ptr<Term> clone() const override {
    return strains_ == Strains::assumed ? make_assumed_membrane(section_) : make_membrane(section_);
  }
  void prepare(const Element& element, const Factors& factors, bool all) override {
    tabulated_ = -1;
    scaled_from_ = nullptr;
    prepare_parts(element, factors);
    if (all) {
      dim_ = element.dim();
      coupling_ = factors.uniform() ? Coupling::classes : Coupling::all;
      if (element.n_shapes() == 4)
        number<1>();
      else if (element.n_shapes() == 12)
        number<3>();
      else if (element.n_shapes() == 16)
        number<4>();
      else
        throw Error::input("term 'membrane' needs 1, 3 or 4 vectors at each of four nodes");
      batches_.assign(static_cast<size_t>((element.n_elements() + kLanes - 1) / kLanes), {});
    }
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
    // By columns or by rows: K is symmetric. Single elements are rare, and compiling kernels takes
    // minutes: they share those of add_mean_tangent(), which compute both halves.
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

  void add_forces(const Batch& x, Lanes* force) const override {
    evaluate(x, [&]<int kKinds, int kDim, Coupling>(Lanes* s, const Lanes* p, auto) {
      if constexpr (kKinds == 1) {
        if (const VoidCells& cells = of(x.first).cells; cells.any())
          cells.add_force(VoidCells::AllLanes{}, p, s, force);
      }
      gram::add_force<kKinds, kDim>(s, p, force);
    });
  }

  void add_tangents(const Batch& x, const Weights& w, Lanes* tangent) const override {
    if (w.q == 0) return;
    evaluate(x, [&]<int kKinds, int kDim, Coupling coupling>(const Lanes* s, const Lanes* p,
                                                             auto invariant) {
      if constexpr (kKinds == 1) {
        if (const VoidCells& cells = of(x.first).cells; cells.any())
          return cells.add_tangent<coupling>(VoidCells::AllLanes{}, invariant, s, p, w.q, tangent);
      }
      gram::add_tangent<kKinds, kDim, coupling>(invariant, s, p, p, w.q, tangent);
    });
  }

  /// F̄ = S(ḡ) q̄ with the mean of the Gram entries at both ends,
  ///
  ///   ḡ = ½ (g₀ + g₁) = g(q̄) + ¼ g(d),   q̄ = ½ (q₀ + q₁),   d = q₁ - q₀
  ///
  /// an exact discrete gradient, because U is quadratic in g and g in q:
  /// U₁ - U₀ = (g₁ - g₀)ᵀ W (ḡ - g°) = F̄ · d. S is symmetric, so F̄ has no moment about q̄.
  /// Simo, Tarnow (1992), Z. angew. Math. Phys. 43, 757-792, have the same mean of the stress.
  void add_mean_force(int e, const LocalStep& x, LocalRows& force) const override {
    evaluate_mean(e, x,
                  [&]<int kKinds, int kDim, Coupling>(const double* s, const double* p, auto) {
                    gram::add_force<kKinds, kDim>(s, p, force.data());
                  });
  }

  /// ∂F̄/∂q₁ = ½ (S(ḡ) ⊗ 1 + D(q̄)ᵀ W D(q₁)): as the tangent, from two states.
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
    return strains_ == Strains::assumed
               ? assumed_flow_power(element(), e, factors(), elasticity_, x.q)
               : ElasticTerm::flow_power(e, x);
  }

  void add_factor_slopes(int e, const Local& x, const LocalRows& psi,
                         FactorSlopes& out) const override {
    if (kinds_ == 1)
      add_cell_slopes(e, x.q.data(), psi.data(), 1, out.stiffness);
    else
      ElasticTerm::add_factor_slopes(e, x, psi, out);
  }
  void add_energy_slopes(int e, const Local& x, double weight, FactorSlopes& out) const override {
    if (kinds_ == 1)
      add_cell_slopes(e, x.q.data(), nullptr, weight, out.stiffness);
    else
      ElasticTerm::add_energy_slopes(e, x, weight, out);
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
  static constexpr int kCellDegree = 4;  // of the strains' products, with one vector at a node
  using Packed = std::shared_ptr<const std::vector<double>>;

  struct BatchData {
    Packed shared;                 // squares; where all elements have the same W
    std::vector<Lanes> different;  // packed; where they do not
    std::vector<Lanes> reference;  // g°
    VoidCells cells;               // of the shape set q4
  };

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

  /// Work of a cell's force on ψ, or its energy, with all of it solid and with all of it void.
  struct Shares {
    double solid = 0, empty = 0;
  };

  /// @param w  W of lane w.lane   @param psi  by nodes; null: energies
  static Shares shares(const gram::OneOf& w, const VoidCells& cells, const BatchData& batch,
                       int lane, const double* q, const double* psi) {
    using N = gram::Numbering<1>;
    double p[2 * N::n], d[2 * N::n], g[N::n_pairs], s[N::n_pairs];
    gram::vectors<1, 2>(q, p);
    gram::products<1, 2>(p, g);
    for (size_t k = 0; k < N::n_pairs; ++k) g[k] -= batch.reference[k][lane];
    gram::multiply<1, Coupling::all>(w, g, s);
    Shares out;
    if (psi) gram::vectors<1, 2>(psi, d);
    for (size_t k = 0; k < N::n_pairs; ++k) {
      const int i = 2 * N::tables.i[k], j = 2 * N::tables.j[k];
      double change = g[k] / 2;
      if (psi) {
        change = p[i] * d[j] + p[i + 1] * d[j + 1];
        if (i != j) change += d[i] * p[j] + d[i + 1] * p[j + 1];
      }
      out.solid += s[k] * change;
    }
    if (cells.any()) out.empty = cells.small_strains(w.lane, p, psi ? d : nullptr);
    return out;
  }

  /// U = γ(κ̄) U_solid + (1 - γ(κ̄)) U_empty, both linear in the factors, κ̄ the mean one.
  void add_cell_slopes(int e, const double* q, const double* psi, double weight,
                       VectorXd& out) const {
    const BatchData& batch = of(e);
    const int lane = e % kLanes;
    const VoidCells& cells = batch.cells;
    const Grid& grid = factors().grid;
    const double factor = cells.factor(lane), solid = VoidCells::solid_part(factor),
                 slope = VoidCells::solid_slope(factor);
    const Shares all = shares({batch.different.data(), lane}, cells, batch, lane, q, psi);
    const Element::CellRange at = element().cells(e, grid);
    if (at.single() && factor > 0) {
      out[grid.cell(at.i0, at.j0)] += weight * ((solid / factor + slope) * all.solid +
                                                ((1 - solid) / factor - slope) * all.empty);
      return;
    }
    for (int i = at.i0; i < at.i1; ++i)
      for (int j = at.j0; j < at.j1; ++j) {
        CellPart part = part_in(e, grid.cell(i, j), cells.size(lane));
        const Shares own = shares({part.w.data(), 0}, part.cells, batch, lane, q, psi);
        out[grid.cell(i, j)] += weight * (solid * own.solid + (1 - solid) * own.empty +
                                          slope * part.share * (all.solid - all.empty));
      }
  }

  /// What full material of one cell is in an element: its W, and its part of the area.
  struct CellPart {
    std::vector<Lanes> w;
    VoidCells cells;
    double share = 0;
  };
  CellPart part_in(int e, int cell, const Vec2& size) const {
    static thread_local Factors only;
    only.grid = factors().grid;
    only.stiffness.setZero(factors().stiffness.size());
    only.stiffness[cell] = 1;
    ProductTable table;
    element().tabulate_products(e, kCellDegree, only, FactorKind::stiffness, table);
    CellPart out;
    out.share = table.weight.sum() / size.prod();
    for (const double x : membrane_invariant(even_and_odd(table, function_m_, function_n_), pairs_,
                                             elasticity_, strains_))
      out.w.push_back(Lanes{} + x);
    out.cells.set(0, size, 0);
    out.cells.fill(1);
    out.cells.set_stiffness(out.w);
    return out;
  }

  /// Tables of gram.h that integrate() needs, and the functions of one coordinate in every vector.
  template <int kKinds>
  void number() {
    using N = gram::Numbering<kKinds>;
    pairs_.i.assign(N::tables.i.begin(), N::tables.i.end());
    pairs_.j.assign(N::tables.j.begin(), N::tables.j.end());
    pairs_.starts.assign(N::tables.start.begin(), N::tables.start.end());
    if (coupling_ == Coupling::all) pairs_.starts = {0, N::n_pairs};
    kinds_ = kKinds;
    function_m_.resize(N::n);
    function_n_.resize(N::n);
    for (int c = 0; c < 4; ++c)
      for (int kind = c == 0 ? 1 : 0; kind < kKinds; ++kind) {
        const auto at = static_cast<size_t>(N::vector(kind, c));
        function_m_[at] = 2 * gram::slope_m(kind) + c % 2;
        function_n_[at] = 2 * gram::slope_n(kind) + c / 2;
      }
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
  template <class F>
  void evaluate(const Batch& x, const F& f) const {
    const BatchData& batch = batches_[static_cast<size_t>(x.first / kLanes)];
    dispatch([&]<int kKinds, int kDim>() {
      Lanes p[kMaxVectors * kDim], g[kMaxPairs], s[kMaxPairs];
      gram::vectors<kKinds, kDim>(x.q, p);
      gram::products<kKinds, kDim>(p, g);
      for (int k = 0; k < gram::Numbering<kKinds>::n_pairs; ++k)
        g[k] -= batch.reference[static_cast<size_t>(k)];
      const auto with = [&]<Coupling coupling>(auto w) {
        gram::multiply<kKinds, coupling>(w, g, s);
        f.template operator()<kKinds, kDim, coupling>(s, p, w);
      };
      const gram::Different different{batch.different.data()};
      if (coupling_ == Coupling::all)
        with.template operator()<Coupling::all>(different);
      else if (batch.shared)
        with.template operator()<Coupling::classes>(gram::Shared{batch.shared->data()});
      else
        with.template operator()<Coupling::classes>(different);
    });
  }

  void prepare_batch(const Element& element, int first, const Factors& factors,
                     const MatrixXd& reference, bool all, BatchData& out) {
    const int count = std::min(kLanes, element.n_elements() - first);
    int n_moving = 0, n_free = 0;  // elements with free lines are left to FreeElastic
    for (int lane = 0; lane < count; ++lane) {
      const bool free = is_free(first + lane);
      n_free += free;
      n_moving += !free && element.moving(first + lane);
    }
    if (n_free == count || (!all && n_moving == 0)) return;
    std::array<Packed, kLanes> w;
    out.reference.resize(pairs_.i.size());
    for (int lane = 0; lane < count; ++lane)
      if ((all || element.moving(first + lane)) && !is_free(first + lane)) {
        w[static_cast<size_t>(lane)] = integrate(element, first + lane, factors);
        set_reference(element, first + lane, reference, out);
        if (kinds_ == 1 && !factors.uniform()) set_cell(element, first + lane, reference, out);
      }
    // A W that some elements share today and not tomorrow is not shared.
    const bool alike =
        coupling_ == Coupling::classes && n_free == 0 && (n_moving == 0 || n_moving == count) &&
        std::all_of(w.begin(), w.begin() + count, [&](const Packed& x) { return x == w[0]; });
    out.shared = alike ? squares(*w[0]) : nullptr;
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
        for (Lanes& x : out.different) x[lane] = x[count - 1];
      for (Lanes& x : out.reference) x[lane] = x[count - 1];
    }
    if (coupling_ != Coupling::all || kinds_ != 1) return;
    out.cells.fill(count);
    out.cells.set_stiffness(out.different);
  }

  /// Of an element whose products are in table_: its mean factor says how solid it is.
  void set_cell(const Element& element, int e, const MatrixXd& reference, BatchData& out) {
    const auto numbers = element.vectors(e);
    const Vec2 size = (reference.row(numbers[2]) - reference.row(numbers[0])).head<2>();
    out.cells.set(e % kLanes, size, table_.weight.sum() / (size.x() * size.y()));
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

  /// W of an element, packed; that of its neighbour where size and material are the same.
  Packed integrate(const Element& element, int e, const Factors& factors) {
    std::swap(previous_, table_);
    const int degree = kinds_ == 1 ? kCellDegree : 12;
    if (!element.tabulate_products(e, degree, factors, FactorKind::stiffness, table_))
      throw Error::input("term 'membrane' needs shape functions that are products along m and n");
    const auto equal = [](const MatrixXd& x, const MatrixXd& y) {
      return x.rows() == y.rows() && x.cols() == y.cols() && x.isApprox(y, 1e-13);
    };
    const bool same = tabulated_ >= 0 && tabulated_ == e - 1 &&
                      equal(previous_.weight, table_.weight) && equal(previous_.f_m, table_.f_m) &&
                      equal(previous_.f_n, table_.f_n);
    tabulated_ = e;
    if (!same) last_ = scaled();
    return last_;
  }

  /// W of table_. Cells of one shape, each of one material, differ by a factor: it is made once.
  Packed scaled() {
    const auto equal = [](const MatrixXd& x, const MatrixXd& y) { return x.isApprox(y, 1e-13); };
    const bool cell = kinds_ == 1 && coupling_ == Coupling::all;
    if (cell && scaled_from_) {
      const ProductTable &a = scaled_from_table_, &b = table_;
      const double factor = b.weight.sum() / a.weight.sum();
      if (b.weight.rows() == a.weight.rows() && b.weight.cols() == a.weight.cols() &&
          std::isfinite(factor) && equal(factor * a.weight, b.weight) && equal(a.f_m, b.f_m) &&
          equal(a.f_n, b.f_n) && equal(a.d_m, b.d_m) && equal(a.d_n, b.d_n)) {
        auto out = std::make_shared<std::vector<double>>(*scaled_from_);
        for (double& x : *out) x *= factor;
        return out;
      }
    }
    const auto out = std::make_shared<std::vector<double>>(membrane_invariant(
        even_and_odd(table_, function_m_, function_n_), pairs_, elasticity_, strains_));
    if (cell) {
      scaled_from_ = out;
      scaled_from_table_ = table_;
    }
    return out;
  }

  /// Full squares of the blocks of W; those of the last W asked for are kept.
  Packed squares(const std::vector<double>& w) {
    if (squares_of_ == last_) return squares_;
    squares_of_ = last_;
    return squares_ = std::make_shared<std::vector<double>>(full_squares(pairs_, w));
  }

  PlaneSection section_;
  Eigen::Matrix3d elasticity_;  // h C [N/m]
  Strains strains_;
  int dim_ = 0, kinds_ = 0;
  Coupling coupling_ = Coupling::classes;
  PairNumbers pairs_;                         // of gram::Numbering
  std::vector<int> function_m_, function_n_;  // even or odd function of every vector
  std::vector<BatchData> batches_;
  ProductTable table_, previous_;
  int tabulated_ = -1;  // element of table_
  Packed scaled_from_;  // W of a cell that those of others are scaled from
  ProductTable scaled_from_table_;
  Packed last_, squares_, squares_of_;  // W of table_; the squares of which W
};

template <Strains kStrains>
TermRow row(const char* name, const char* sentence, std::vector<TermPlace> places) {
  return {.name = name,
          .sentence = sentence,
          .role = "membrane",
          .places = std::move(places),
          .required_in = {TermPlace::space},
          .designable = kStrains == Strains::displacement,
          .on_cells = kStrains == Strains::displacement,
          .free_lines = kStrains == Strains::displacement,
          .keys = {},
          .columns = {},
          .elastic = [](const TermData& d) { return Membrane::parts_of(d.section, kStrains); },
          .make = [](const TermData& d) -> std::unique_ptr<Term> {
            return std::make_unique<Membrane>(d.section, kStrains);
          }};
}

}  // namespace

const TermRow& membrane_row() {
  static const TermRow kRow = row<Strains::displacement>(
      "membrane", "Membrane forces, strains as the displacements have them.",
      {TermPlace::plane, TermPlace::space});
  return kRow;
}

const TermRow& membrane_assumed_row() {
  static const TermRow kRow =
      row<Strains::assumed>("membrane_assumed",
                            "Membrane forces with assumed strains: thin plates, and slender ones "
                            "in the plane, do not lock.",
                            {TermPlace::plane, TermPlace::space});
  return kRow;
}

}  // namespace flexmorph::fem
