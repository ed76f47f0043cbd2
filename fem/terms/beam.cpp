#include <array>
#include <cmath>

#include "fem/terms.h"
#include "fem/terms/density_term.h"
#include "fem/terms/sampling.h"

namespace flexmorph::fem {
namespace {

enum class Mechanics { general, enhanced };

constexpr int kVectors = 5, kDim = 2, kShapes = 6;
constexpr int kPairs = kVectors * (kVectors + 1) / 2;

/// Number of the pair i, j in the order 00, 10, 11, 20, ...
constexpr int pair(int i, int j) { return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i; }

/// Where W stands for the pairs x and (l, j) in its packed lower triangle: kPlace[x][l][j].
constexpr auto kPlace = [] {
  std::array<std::array<std::array<int, kVectors>, kVectors>, kPairs> out{};
  for (int x = 0; x < kPairs; ++x)
    for (int l = 0; l < kVectors; ++l)
      for (int j = 0; j < kVectors; ++j)
        out[static_cast<size_t>(x)][static_cast<size_t>(l)][static_cast<size_t>(j)] =
            pair(x, pair(l, j));
  return out;
}();

/// Vectors p of nodal ones (r¹ r_x¹ r_y¹ r² r_x² r_y²): r² - r¹, r_x¹, r_y¹, r_x², r_y². Rigid
/// translations strain nothing, and no digits are lost far from the origin.
template <class V>
void vectors(const V* q, V* p) {
  for (int c = 0; c < kDim; ++c) {
    p[c] = q[3 * kDim + c] - q[c];
    p[kDim + c] = q[kDim + c];
    p[2 * kDim + c] = q[2 * kDim + c];
    p[3 * kDim + c] = q[4 * kDim + c];
    p[4 * kDim + c] = q[5 * kDim + c];
  }
}
/// Shape functions that vector k goes to with +1; vector 0 also to shape function 0, with -1.
constexpr std::array<int, kVectors> kShapeOf = {3, 1, 2, 4, 5};

/// g_ij = p_i · p_j (i ≠ j), g_ii = ½ p_i · p_i.
template <class V>
void products(const V* p, V* g) {
  for (int i = 0; i < kVectors; ++i)
    for (int j = 0; j <= i; ++j) {
      const V sum = p[i * kDim] * p[j * kDim] + p[i * kDim + 1] * p[j * kDim + 1];
      g[pair(i, j)] = i == j ? 0.5 * sum : sum;
    }
}

/// s = W (g - g°); W packed as a lower triangle.
template <class V>
void stress(const V* w, const V* reference, const V* g, V* s) {
  V change[kPairs];
  for (int k = 0; k < kPairs; ++k) change[k] = g[k] - reference[k];
  for (int r = 0; r < kPairs; ++r) {
    const V* row = w + r * (r + 1) / 2;
    V sum{};
    for (int t = 0; t < r; ++t) {
      sum += row[t] * change[t];
      s[t] += row[t] * change[r];
    }
    s[r] = sum + row[r] * change[r];
  }
}

/// Adds F_k = Σ_l s_kl p_l.
template <class V>
void add_force_of(const V* s, const V* p, V* force) {
  for (int k = 0; k < kVectors; ++k)
    for (int c = 0; c < kDim; ++c) {
      V sum{};
      for (int l = 0; l < kVectors; ++l) sum += s[pair(k, l)] * p[l * kDim + c];
      force[kShapeOf[static_cast<size_t>(k)] * kDim + c] += sum;
      if (k == 0) force[c] -= sum;
    }
}

/// Entries of a tangent (kShapes kDim)², by rows.
struct ByRows {
  double* data;
  double& operator()(int row, int column) const { return data[row * kShapes * kDim + column]; }
};

/// Adds weight (s_kl δ_bc + Σ_ij left_ib W_(ki),(lj) right_jc) at entry(row, column).
template <class V, class Entry>
void add_tangent_of(const V* w, const V* s, const V* left, const V* right, double weight,
                    const Entry& entry) {
  V rows[kPairs][kVectors * kDim];  // Σ_j W_(pair),(lj) right_jc
  for (size_t x = 0; x < kPairs; ++x)
    for (size_t l = 0; l < kVectors; ++l) {
      V sum[kDim] = {};
#pragma GCC unroll 5
      for (size_t j = 0; j < kVectors; ++j) {
        const V value = w[kPlace[x][l][j]];
        for (size_t c = 0; c < kDim; ++c) sum[c] += value * right[j * kDim + c];
      }
      for (size_t c = 0; c < kDim; ++c) rows[x][l * kDim + c] = sum[c];
    }
  for (int k = 0; k < kVectors; ++k)
    for (int l = 0; l < kVectors; ++l) {
      V block[kDim][kDim] = {};
#pragma GCC unroll 5
      for (int i = 0; i < kVectors; ++i) {
        const V* row = rows[pair(k, i)] + l * kDim;
        for (int b = 0; b < kDim; ++b)
          for (int c = 0; c < kDim; ++c) block[b][c] += left[i * kDim + b] * row[c];
      }
      const int first = kShapeOf[static_cast<size_t>(k)] * kDim,
                other = kShapeOf[static_cast<size_t>(l)] * kDim;
      for (int b = 0; b < kDim; ++b)
        for (int c = 0; c < kDim; ++c) {
          const V value = weight * (b == c ? block[b][c] + s[pair(k, l)] : block[b][c]);
          entry(first + b, other + c) += value;
          if (k == 0) entry(b, other + c) -= value;
          if (l == 0) entry(first + b, c) -= value;
          if (k == 0 && l == 0) entry(b, c) += value;
        }
    }
}

/// Elastic force of a planar fully parameterized ANCF beam of St. Venant-Kirchhoff material, by
/// general (gcm) or enhanced (ecm) continuum mechanics.
///
///   ε = ½ (FᵀF - I),   F = J J_o⁻¹,   Voigt: ε₁₁, ε₂₂, 2ε₁₂                       T (27), (28)
///   gcm   U = b/2 ∫ εᵀ D ε dA,                       D = plane stress, P (8)
///   ecm   U = b/2 ∫ εᵀ D⁰ ε dA + b/2 ∫ h εᵀ D^ν ε dX on the axis y = 0
///         D⁰ = diag(E, E, G),   D^ν = E/(1 - ν²) [ν² ν; ν ν²],   D⁰ + D^ν = D
///
/// 1 and 2: Cartesian axes of the reference; in ecm, where D⁰ is not isotropic, 2 is along the
/// section and 1 at right angles to it. b is the width across the plane.
///
/// gcm bends 1/(1 - ν²) too stiffly on every mesh: r_y is constant over the height, so that ε₂₂
/// cannot follow -ν ε₁₁, which is linear in y. With ecm the coupling sees the mean strain only.
///
/// Gram form, as the membrane's (terms/membrane.cpp): the strain is linear in the products of the
/// element's unknowns, ε = Λ (g - g°), so U = ½ (g - g°)ᵀ W (g - g°) with W = b ∫ Λᵀ D Λ dA, built
/// once: for a straight reference exactly by 5 x 3 points.
///
/// Source: T 9; Gerstmayr, Matikainen & Mikkola (2008), Multibody Syst. Dyn. 20, 359-384, 3.2;
/// Nachbagauer et al. (2011), Multibody Syst. Dyn. 26, 245-263.
class Beam final : public ElasticTerm {
 public:
  Beam(const PlaneSection& section, Mechanics mechanics)
      : ElasticTerm(mechanics == Mechanics::general ? "gcm" : "ecm", parts_of(section, mechanics)),
        section_(section),
        width_(section.thickness),
        elasticity_(section.elasticity()),
        mechanics_(mechanics) {
    volume_ = mechanics == Mechanics::general ? elasticity_ : uncoupled(section);
    coupling_ = elasticity_ - volume_;
  }

  static std::vector<ElasticPart> parts_of(const PlaneSection& s, Mechanics mechanics) {
    const auto density = [&](const Eigen::Matrix3d& D) {
      return std::make_shared<LinearDensity>(green_lagrange(), s.thickness * D);
    };
    if (mechanics == Mechanics::general)  // isotropic: any axes do
      return {{density(s.elasticity()), sample_points(8, Tabulate::gradient)}};
    return {{density(uncoupled(s)), sample_sections(false)},
            {density(s.elasticity() - uncoupled(s)), sample_sections(true)}};
  }

  /// Made anew: what is prepared would only be prepared again.
  std::unique_ptr<Term> clone() const override {
    return mechanics_ == Mechanics::general ? make_beam_gcm(section_) : make_beam_ecm(section_);
  }
  void prepare(const Element& element, const Factors& factors, bool all) override {
    if (element.dim() != kDim || element.n_shapes() != kShapes)
      throw Error::input("term '" + name() +
                         "' is that of a beam in the plane (r, r_x, r_y at each of two nodes)");
    prepare_parts(element, factors);
    if (!all) return;  // lines of a beam do not move
    const int n = element.n_elements();
    batches_.assign(static_cast<size_t>((n + kLanes - 1) / kLanes), {});
    const MatrixXd reference = element.reference();
    Data data;
    for (int e = 0; e < kLanes * static_cast<int>(batches_.size()); ++e) {
      // Lanes behind the last element repeat it.
      if (e < n) data = integrate(element, e, factors, reference);
      Batched& batch = batches_[static_cast<size_t>(e / kLanes)];
      for (size_t k = 0; k < data.w.size(); ++k) batch.w[k][e % kLanes] = data.w[k];
      for (size_t k = 0; k < data.reference.size(); ++k)
        batch.reference[k][e % kLanes] = data.reference[k];
    }
    elements_.clear();
    for (int e = 0; e < n; ++e) elements_.push_back(one(e));
  }

  void add_force(int e, const Local& x, LocalRows& force) const override {
    const Data& d = elements_[static_cast<size_t>(e)];
    double p[kVectors * kDim], g[kPairs], s[kPairs];
    evaluate(d, x.q.data(), p, g, s);
    add_force_of(s, p, force.data());
  }

  void add_tangent(int e, const Local& x, const Weights& w, LocalTangent& tangent) const override {
    if (w.q == 0) return;
    const Data& d = elements_[static_cast<size_t>(e)];
    double p[kVectors * kDim], g[kPairs], s[kPairs];
    evaluate(d, x.q.data(), p, g, s);
    add_tangent_of(d.w.data(), s, p, p, w.q, ByRows{tangent.data()});
  }

  void add_forces(const Batch& x, Lanes* force) const override {
    Lanes p[kVectors * kDim], g[kPairs], s[kPairs];
    evaluate(batches_[static_cast<size_t>(x.first / kLanes)], x.q, p, g, s);
    add_force_of(s, p, force);
  }

  void add_tangents(const Batch& x, const Weights& w, Lanes* tangent) const override {
    if (w.q == 0) return;
    const Batched& d = batches_[static_cast<size_t>(x.first / kLanes)];
    Lanes p[kVectors * kDim], g[kPairs], s[kPairs];
    evaluate(d, x.q, p, g, s);
    add_tangent_of(d.w.data(), s, p, p, w.q, [&](int row, int column) -> Lanes& {
      return tangent[column * kShapes * kDim + row];
    });
  }

  /// F̄ = S(ḡ) q̄, ḡ = ½ (g₀ + g₁) = g(q̄) + ¼ g(q₁ - q₀): an exact discrete gradient, because U is
  /// quadratic in g and g in q. Simo & Tarnow (1992), Z. angew. Math. Phys. 43, 757-792.
  void add_mean_force(int e, const LocalStep& x, LocalRows& force) const override {
    double p[kVectors * kDim], s[kPairs];
    evaluate_mean(elements_[static_cast<size_t>(e)], x, p, s);
    add_force_of(s, p, force.data());
  }

  /// ∂F̄/∂q₁ = ½ (S(ḡ) ⊗ 1 + D(q̄)ᵀ W D(q₁)): as the tangent, from two states.
  void add_mean_tangent(int e, const LocalStep& x, const Weights& w,
                        LocalTangent& tangent) const override {
    if (w.q == 0) return;
    const Data& d = elements_[static_cast<size_t>(e)];
    double p[kVectors * kDim], s[kPairs], end[kVectors * kDim];
    evaluate_mean(d, x, p, s);
    vectors(x.end.data(), end);
    add_tangent_of(d.w.data(), s, p, end, w.q, ByRows{tangent.data()});
  }

 private:
  /// D⁰.
  static Eigen::Matrix3d uncoupled(const PlaneSection& s) {
    const double E = s.youngs_modulus, nu = s.poisson_ratio;
    return Vec3(E, E, E / (2 * (1 + nu))).asDiagonal();
  }

  double energy_at(int e, const Local& x) const override {
    const Data& d = elements_[static_cast<size_t>(e)];
    double p[kVectors * kDim], g[kPairs], s[kPairs], energy = 0;
    evaluate(d, x.q.data(), p, g, s);
    for (size_t k = 0; k < kPairs; ++k) energy += 0.5 * s[k] * (g[k] - d.reference[k]);
    return energy;
  }

  template <class V>
  struct DataOf {
    std::array<V, kPairs*(kPairs + 1) / 2> w{};  // lower triangle of W
    std::array<V, kPairs> reference{};           // g°
  };
  using Data = DataOf<double>;
  using Batched = DataOf<Lanes>;

  template <class V>
  static void evaluate(const DataOf<V>& d, const V* q, V* p, V* g, V* s) {
    vectors(q, p);
    products(p, g);
    stress(d.w.data(), d.reference.data(), g, s);
  }

  static void evaluate_mean(const Data& d, const LocalStep& x, double* p, double* s) {
    double g[kPairs], moved[kVectors * kDim], g_moved[kPairs];
    vectors(x.mean.q.data(), p);
    products(p, g);
    const LocalRows step = x.end - x.start;
    vectors(step.data(), moved);
    products(moved, g_moved);
    for (int k = 0; k < kPairs; ++k) g[k] += 0.25 * g_moved[k];
    stress(d.w.data(), d.reference.data(), g, s);
  }

  Data one(int e) const {
    const Batched& batch = batches_[static_cast<size_t>(e / kLanes)];
    Data out;
    for (size_t k = 0; k < out.w.size(); ++k) out.w[k] = batch.w[k][e % kLanes];
    for (size_t k = 0; k < out.reference.size(); ++k)
      out.reference[k] = batch.reference[k][e % kLanes];
    return out;
  }

  using Strains = Eigen::Matrix<double, 3, kPairs>;

  /// Λ of one point: (r_1 r_2) = (F e₁, F e₂), r_1 = Σ a_i p_i, r_2 = Σ b_i p_i.
  static Strains strains(const ShapeTable& t, Eigen::Index at, const Vec2& e1, const Vec2& e2) {
    double a[kVectors], b[kVectors];
    for (size_t k = 0; k < kVectors; ++k) {
      const Vec2 d(t.N_m(at, kShapeOf[k]), t.N_n(at, kShapeOf[k]));
      a[k] = e1.dot(d);
      b[k] = e2.dot(d);
    }
    Strains out;
    for (int i = 0; i < kVectors; ++i)
      for (int j = 0; j <= i; ++j)
        out.col(pair(i, j)) << a[i] * a[j], b[i] * b[j], a[i] * b[j] + a[j] * b[i];
    return out;
  }

  Data integrate(const Element& element, int e, const Factors& factors, const MatrixXd& reference) {
    const auto numbers = element.vectors(e);
    Eigen::Matrix<double, kShapes, kDim, Eigen::RowMajor> X;
    for (int k = 0; k < kShapes; ++k) X.row(k) = reference.row(numbers[static_cast<size_t>(k)]);
    element.tabulate(e, 8, Tabulate::gradient, factors, FactorKind::stiffness, table_);
    Eigen::Matrix<double, kPairs, kPairs> W;
    W.setZero();
    const auto n = table_.weight.size();
    // Points with the same x follow each other; they are a section.
    for (Eigen::Index first = 0, last = 0; first < n; first = last) {
      const double x = table_.material[static_cast<size_t>(first)].x();
      while (last < n && table_.material[static_cast<size_t>(last)].x() == x) ++last;
      const Vec2 across = ((table_.N.row(last - 1) - table_.N.row(first)) * X).transpose();
      const Vec2 e2 = across.normalized(), e1(e2.y(), -e2.x());
      double area = 0;  // of the section: h dX
      for (Eigen::Index p = first; p < last; ++p) {
        const Strains lambda = strains(table_, p, e1, e2);
        W += width_ * table_.weight[p] * lambda.transpose() * volume_ * lambda;
        area += table_.weight[p];
      }
      if (mechanics_ == Mechanics::general) continue;
      element.locate({x, 0}, Tabulate::gradient, axis_);
      const Strains lambda = strains(axis_, 0, e1, e2);
      W += width_ * area * lambda.transpose() * coupling_ * lambda;
    }
    Data out;
    for (int r = 0; r < kPairs; ++r)
      for (int t = 0; t <= r; ++t) out.w[static_cast<size_t>(pair(r, t))] = W(r, t);
    double p[kVectors * kDim];
    vectors(X.data(), p);
    products(p, out.reference.data());
    return out;
  }

  PlaneSection section_;
  double width_;
  Eigen::Matrix3d elasticity_, volume_, coupling_;  // D; D or D⁰; 0 or D^ν [Pa]
  Mechanics mechanics_;
  std::vector<Data> elements_;
  std::vector<Batched> batches_;
  ShapeTable table_, axis_;
};

}  // namespace

std::unique_ptr<Term> make_beam_gcm(const PlaneSection& section) {
  return std::make_unique<Beam>(section, Mechanics::general);
}

std::unique_ptr<Term> make_beam_ecm(const PlaneSection& section) {
  return std::make_unique<Beam>(section, Mechanics::enhanced);
}

const TermRow& gcm_row() {
  static const TermRow kRow{
      .name = "gcm",
      .sentence = "Elastic forces of a beam by general continuum mechanics.",
      .role = "beam",
      .places = {TermPlace::beam},
      .required_in = {TermPlace::beam},
      .keys = {},
      .columns = {},
      .elastic =
          [](const TermData& data) { return Beam::parts_of(data.section, Mechanics::general); },
      .make = [](const TermData& data) { return make_beam_gcm(data.section); }};
  return kRow;
}

const TermRow& ecm_row() {
  static const TermRow kRow{
      .name = "ecm",
      .sentence = "Elastic forces of a beam by enhanced continuum mechanics, which does not lock.",
      .role = "beam",
      .places = {TermPlace::beam},
      .required_in = {TermPlace::beam},
      .keys = {},
      .columns = {},
      .elastic =
          [](const TermData& data) { return Beam::parts_of(data.section, Mechanics::enhanced); },
      .make = [](const TermData& data) { return make_beam_ecm(data.section); }};
  return kRow;
}

}  // namespace flexmorph::fem
