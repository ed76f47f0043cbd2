#include "fem/terms.h"
#include "fem/terms/beam_gram.h"
#include "fem/terms/beam_strains.h"
#include "fem/terms/density_term.h"
#include "fem/terms/sampling.h"

namespace flexmorph::fem {
namespace {

using namespace beam_gram;

enum class Mechanics { general, enhanced };

/// Name, mechanics and strains of one kind of beam.
struct Kind {
  const char* name;
  Mechanics mechanics;
  BeamStrains strains;
};

/// Elastic force of a planar fully parameterized ANCF beam of St. Venant-Kirchhoff material, by
/// general (gcm) or enhanced (ecm) continuum mechanics.
///
///   ε = ½ (FᵀF - I),   F = J J_o⁻¹,   Voigt: ε₁₁, ε₂₂, 2ε₁₂                       T (27), (28)
///   gcm   U = b/2 ∫ εᵀ D ε dA,                       D = plane stress, P (8)
///   ecm   U = b/2 ∫ εᵀ D⁰ ε dA + b/2 ∫ h εᵀ D^ν ε dX on the axis y = 0
///         D⁰ = diag(E, E, G),   D^ν = E/(1 - ν²) [ν² ν; ν ν²],   D⁰ + D^ν = D
///
/// Directions 1 and 2 are Cartesian axes of the reference; in ecm, where D⁰ is not isotropic, 2 is
/// along the section and 1 perpendicular to it. b is the width across the plane.
///
/// Strains are those of the displacement field, or assumed on the axis (terms/beam_strains.h).
/// Without assumed strains slender beams lock in large bending. For small displacements of a
/// straight beam both are equal to first order, so that the linear stiffness and the frequencies do
/// not depend on this choice.
///
/// gcm is too stiff in bending by 1/(1 - ν²) on every mesh: r_y is constant over the height, so
/// that ε₂₂ cannot follow -ν ε₁₁, which is linear in y. In ecm only the mean strain enters the
/// coupling.
///
/// Gram form, as in the membrane (terms/membrane.cpp): the strain is linear in the products of the
/// element's unknowns, ε = Λ (g - g°). Therefore U = ½ (g - g°)ᵀ W (g - g°) with W = b ∫ Λᵀ D Λ dA.
/// W is computed once; for a straight reference 5 x 3 points are exact.
///
/// Source: T 9; Gerstmayr, Matikainen & Mikkola (2008), Multibody Syst. Dyn. 20, 359-384, 3.2;
/// Nachbagauer et al. (2011), Multibody Syst. Dyn. 26, 245-263.
class Beam final : public ElasticTerm, public BatchTerm {
 public:
  Beam(const PlaneSection& section, const Kind& kind)
      : ElasticTerm(kind.name, parts_of(section, kind)),
        section_(section),
        width_(section.thickness),
        elasticity_(section.elasticity()),
        kind_(kind) {
    volume_ = kind.mechanics == Mechanics::general ? elasticity_ : uncoupled(section);
    coupling_ = elasticity_ - volume_;
  }

  static std::vector<ElasticPart> parts_of(const PlaneSection& s, const Kind& kind) {
    const auto density = [&](const Eigen::Matrix3d& D) {
      return std::make_shared<LinearDensity>(green_lagrange(), s.thickness * D);
    };
    const auto sections = [&](bool on_axis) { return sample_sections(kind.strains, on_axis); };
    if (kind.mechanics == Mechanics::general) return {{density(s.elasticity()), sections(false)}};
    return {{density(uncoupled(s)), sections(false)},
            {density(s.elasticity() - uncoupled(s)), sections(true)}};
  }

  /// Creates an unprepared term, because prepared data would be recomputed anyway.
  std::unique_ptr<Term> clone() const override { return std::make_unique<Beam>(section_, kind_); }
  void prepare(const Element& element, const ScaleFactors& factors, bool all) override {
    if (element.dim() != kDim || element.n_shapes() != kShapes)
      throw Error::input(
          "term '" + name() +
          "' is only available for a beam in the plane (r, r_x, r_y at each of two nodes)");
    prepare_parts(element, factors);
    if (!all) return;  // lines of a beam do not move
    const int n = element.n_elements();
    batches_.assign(static_cast<size_t>((n + kLanes - 1) / kLanes), {});
    const MatrixXd reference = element.reference();
    Data data;
    for (int e = 0; e < kLanes * static_cast<int>(batches_.size()); ++e) {
      // SIMD lanes behind the last element repeat it.
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
    evaluate(view(d), x.q.data(), p, g, s);
    add_force_of(s, p, force.data());
  }

  void add_tangent(int e, const Local& x, const Weights& w, LocalTangent& tangent) const override {
    if (w.q == 0) return;
    const Data& d = elements_[static_cast<size_t>(e)];
    double p[kVectors * kDim], g[kPairs], s[kPairs];
    evaluate(view(d), x.q.data(), p, g, s);
    add_tangent_of(d.w.data(), s, p, p, w.q, ByRows{tangent.data()});
  }

  void add_forces(const Batch& x, Pack* force) const override {
    run_batch_kernel([&]<class V>() {
      V p[kVectors * kDim], g[kPairs], s[kPairs];
      evaluate(of<V>(x), packs_as<V>(x.q), p, g, s);
      add_force_of(s, p, packs_as<V>(force));
    });
  }

  void add_tangents(const Batch& x, const Weights& w, Pack* tangent) const override {
    if (w.q == 0) return;
    run_batch_kernel([&]<class V>() {
      V p[kVectors * kDim], g[kPairs], s[kPairs], *out = packs_as<V>(tangent);
      evaluate(of<V>(x), packs_as<V>(x.q), p, g, s);
      add_tangent_of(of<V>(x).w, s, p, p, w.q,
                     [&](int row, int column) -> V& { return out[column * kShapes * kDim + row]; });
    });
  }

  /// Adds F̄ = S(ḡ) q̄, ḡ = ½ (g₀ + g₁) = g(q̄) + ¼ g(q₁ - q₀). It is an exact discrete gradient,
  /// because U is quadratic in g and g in q. Simo & Tarnow (1992), Z. angew. Math. Phys. 43,
  /// 757-792.
  void add_mean_force(int e, const LocalStep& x, LocalRows& force) const override {
    double p[kVectors * kDim], s[kPairs];
    evaluate_mean(elements_[static_cast<size_t>(e)], x, p, s);
    add_force_of(s, p, force.data());
  }

  /// Adds ∂F̄/∂q₁ = ½ (S(ḡ) ⊗ 1 + D(q̄)ᵀ W D(q₁)), a tangent from two states.
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
  /// Returns D⁰.
  static Eigen::Matrix3d uncoupled(const PlaneSection& s) {
    const double E = s.youngs_modulus, nu = s.poisson_ratio;
    return Vec3(E, E, E / (2 * (1 + nu))).asDiagonal();
  }

  double energy_at(int e, const Local& x) const override {
    const Data& d = elements_[static_cast<size_t>(e)];
    double p[kVectors * kDim], g[kPairs], s[kPairs], energy = 0;
    evaluate(view(d), x.q.data(), p, g, s);
    for (size_t k = 0; k < kPairs; ++k) energy += 0.5 * s[k] * (g[k] - d.reference[k]);
    return energy;
  }

  template <class V>
  struct DataOf {
    std::array<V, kPairs*(kPairs + 1) / 2> w{};  // lower triangle of W
    std::array<V, kPairs> reference{};           // g°
  };
  using Data = DataOf<double>;
  using Batched = DataOf<Pack>;
  /// View of DataOf as the kernels read it.
  template <class V>
  struct DataView {
    const V *w, *reference;
  };
  static DataView<double> view(const Data& d) { return {d.w.data(), d.reference.data()}; }
  template <class V>
  DataView<V> of(const Batch& x) const {
    const Batched& d = batches_[static_cast<size_t>(x.first / kLanes)];
    return {packs_as<V>(d.w.data()), packs_as<V>(d.reference.data())};
  }

  template <class V>
  static void evaluate(const DataView<V>& d, const V* q, V* p, V* g, V* s) {
    vectors(q, p);
    products(p, g);
    stress(d.w, d.reference, g, s);
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

  /// Returns Λ of one row: r_1 = Σ a_i p_i, r_2 = Σ b_i p_i.
  static Strains strains(const BeamStrainPoints& points, Eigen::Index row) {
    double a[kVectors], b[kVectors];
    for (size_t k = 0; k < kVectors; ++k) {
      a[k] = points.d_1(row, kShapeOf[k]);
      b[k] = points.d_2(row, kShapeOf[k]);
    }
    Strains out;
    for (int i = 0; i < kVectors; ++i)
      for (int j = 0; j <= i; ++j)
        out.col(pair(i, j)) << a[i] * a[j], b[i] * b[j], a[i] * b[j] + a[j] * b[i];
    return out;
  }

  /// Returns Λ of the points, then of the sections on the axis.
  std::vector<Strains> strains(const BeamStrainPoints& points) const {
    std::vector<Strains> out;
    const Eigen::Index n = points.n_points(), n_sections = points.sample(0) - n;
    for (Eigen::Index row = 0; row < n + n_sections; ++row) out.push_back(strains(points, row));
    if (kind_.strains == BeamStrains::displacement) return out;
    for (Eigen::Index s = 0; s < n_sections; ++s) {
      Strains change = -out[static_cast<size_t>(points.on_axis(s))];
      for (Eigen::Index k = 0; k < BeamStrainPoints::kSamples; ++k)
        change += points.assumed[static_cast<size_t>(s)].middleCols<3>(3 * k) *
                  strains(points, points.sample(k));
      for (Eigen::Index p = 0; p < n; ++p)
        if (points.section[static_cast<size_t>(p)] == s) out[static_cast<size_t>(p)] += change;
      out[static_cast<size_t>(points.on_axis(s))] += change;
    }
    return out;
  }

  Data integrate(const Element& element, int e, const ScaleFactors& factors,
                 const MatrixXd& reference) {
    const BeamStrainPoints points = beam_strain_points(element, e, factors, reference);
    const std::vector<Strains> lambda = strains(points);
    Eigen::Matrix<double, kPairs, kPairs> W;
    W.setZero();
    const auto add = [&](double area, Eigen::Index row, const Eigen::Matrix3d& D) {
      const Strains& l = lambda[static_cast<size_t>(row)];
      W += width_ * area * l.transpose() * D * l;
    };
    for (Eigen::Index p = 0; p < points.n_points(); ++p) add(points.weight[p], p, volume_);
    if (kind_.mechanics == Mechanics::enhanced)
      for (size_t s = 0; s < points.area.size(); ++s)
        add(points.area[s], points.on_axis(static_cast<Eigen::Index>(s)), coupling_);
    Data out;
    for (int r = 0; r < kPairs; ++r)
      for (int t = 0; t <= r; ++t) out.w[static_cast<size_t>(pair(r, t))] = W(r, t);
    Eigen::Matrix<double, kShapes, kDim, Eigen::RowMajor> X;
    const auto numbers = element.vectors(e);
    for (int k = 0; k < kShapes; ++k) X.row(k) = reference.row(numbers[static_cast<size_t>(k)]);
    double p[kVectors * kDim];
    vectors(X.data(), p);
    products(p, out.reference.data());
    return out;
  }

  PlaneSection section_;
  double width_;
  Eigen::Matrix3d elasticity_, volume_, coupling_;  // D; D or D⁰; 0 or D^ν [Pa]
  Kind kind_;
  std::vector<Data> elements_;
  std::vector<Batched> batches_;
};

constexpr Kind kGcm = {"gcm", Mechanics::general, BeamStrains::assumed},
               kEcm = {"ecm", Mechanics::enhanced, BeamStrains::assumed},
               kGcmFull = {"gcm_full", Mechanics::general, BeamStrains::displacement},
               kEcmFull = {"ecm_full", Mechanics::enhanced, BeamStrains::displacement};

template <const Kind& kind>
TermRow row_of(const char* sentence) {
  return {.name = kind.name,
          .sentence = sentence,
          .role = "beam",
          .domains = {TermDomain::beam},
          .required_in = {TermDomain::beam},
          .keys = {},
          .columns = {},
          .elastic = [](const TermData& data) { return Beam::parts_of(data.section, kind); },
          .make = [](const TermData& data) -> std::unique_ptr<Term> {
            return std::make_unique<Beam>(data.section, kind);
          }};
}

}  // namespace

std::unique_ptr<Term> make_beam_gcm(const PlaneSection& section) {
  return std::make_unique<Beam>(section, kGcm);
}

std::unique_ptr<Term> make_beam_ecm(const PlaneSection& section) {
  return std::make_unique<Beam>(section, kEcm);
}

const TermRow& gcm_row() {
  static const TermRow kRow = row_of<kGcm>(
      "Elastic forces of a beam by general continuum mechanics, with assumed strains on the axis.");
  return kRow;
}

const TermRow& ecm_row() {
  static const TermRow kRow = row_of<kEcm>(
      "Elastic forces of a beam by enhanced continuum mechanics, with assumed strains on the axis. "
      "This term locks neither in thick nor in slender beams.");
  return kRow;
}

const TermRow& gcm_full_row() {
  static const TermRow kRow = row_of<kGcmFull>(
      "Elastic forces of a beam by general continuum mechanics, without assumed strains. This term "
      "locks in large bending of slender beams.");
  return kRow;
}

const TermRow& ecm_full_row() {
  static const TermRow kRow = row_of<kEcmFull>(
      "Elastic forces of a beam by enhanced continuum mechanics, without assumed strains. This "
      "term locks in large bending of slender beams.");
  return kRow;
}

}  // namespace flexmorph::fem
