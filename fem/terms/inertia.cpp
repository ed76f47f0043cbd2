#include <algorithm>
#include <array>
#include <cmath>

#include "fem/terms.h"
#include "fem/terms/eulerian_work.h"
#include "fem/terms/factor_moments.h"

namespace flexmorph::fem {
namespace {

/// Inertia of a body, with material flow through its mesh, P (16), (23).
///
///   f = ∫ ρ h N r̈ dA,   r̈ = Qᵈᵈᵀ N + 2 Qᵈᵀ Ṅ + Qᵀ N̈      (P (5), material acceleration)
///     = M Qᵈᵈ + C Qᵈ + P Q,   M = ∫ρh N Nᵀ,  C = 2 ∫ρh N Ṅᵀ,  P = ∫ρh N N̈ᵀ
///
///   N (n_k)     shape functions; Ṅ, N̈ their rates at a fixed material point
///   h, ρ        thickness [m], density [kg/m³]; the weights contain the mass factor of the design
///
/// C and P exist for elements whose lines move. The lines are prescribed, so that the force is
/// linear in Q, Qᵈ and Qᵈᵈ and the tangent is exact. The mean force is exact with a constant mass,
/// M (v₁ - v₀)/h · (q₁ - q₀) = T₁ - T₀; where lines move it is taken at mid-step.
class Inertia final : public Term,
                      public BatchTerm,
                      public LinearMeanForce<Inertia>,
                      public EulerianLineTerm,
                      public DesignedTerm,
                      public FlowTerm {
 public:
  explicit Inertia(const PlaneSection& s)
      : section_(s), area_density_(s.density * s.thickness), of_free_(area_density_, {}, true) {}

  /// Creates an unprepared term, because prepared data would be recomputed anyway.
  std::unique_ptr<Term> clone() const override { return make_inertia(section_); }
  void prepare(const Element& element, const ScaleFactors& factors, bool all) override {
    element_ = &element;
    factors_ = &factors;
    free_.prepare(element, kDegree, Tabulate::position, factors);
    matrices_.resize(static_cast<size_t>(element.n_elements()));
    moments_.follow(element, factors, factors.mass, kDegree + 1, all);
    for (int e = 0; e < element.n_elements(); ++e)
      if ((all || element.moving(e)) && !free_.has(e)) integrate(element, e, factors);
    if (element.n_scalars() > 0) return;  // evaluated one by one, without batches
    batches_.resize((matrices_.size() + kLanes - 1) / kLanes);
    for (size_t b = 0; b < batches_.size(); ++b) {
      const auto first = static_cast<int>(b) * kLanes,
                 last = std::min(first + kLanes, element.n_elements());
      bool changes = all;
      for (int e = first; e < last; ++e) changes |= element.moving(e);
      if (changes) side_by_side(first, last, batches_[b]);
    }
  }

  void add_force(int e, const Local& x, LocalRows& force) const override {
    const Matrices& m = matrices_[static_cast<size_t>(e)];
    force.noalias() += m.mass * x.a;
    if (!m.flows) return;
    force.noalias() += m.convection * x.v;
    force.noalias() += m.transport * x.q;
  }

  void add_tangent(int e, const Local& x, const Weights& w, LocalTangent& tangent) const override {
    const Matrices& m = matrices_[static_cast<size_t>(e)];
    LocalSquare scalar = w.a * m.mass;
    if (m.flows) scalar += w.v * m.convection + w.q * m.transport;
    const auto d = x.q.cols();
    for (Eigen::Index k = 0; k < scalar.rows(); ++k)
      for (Eigen::Index l = 0; l < scalar.cols(); ++l)
        for (Eigen::Index c = 0; c < d; ++c) tangent(d * k + c, d * l + c) += scalar(k, l);
  }

  void add_forces(const Batch& x, Pack* force) const override {
    const LaneMatrices& m = batches_[static_cast<size_t>(x.first / kLanes)];
    run_batch_kernel([&]<class V>() {
      add_product<V>(m.mass, x.a, x, force);
      if (m.convection.empty()) return;
      add_product<V>(m.convection, x.v, x, force);
      add_product<V>(m.transport, x.q, x, force);
    });
  }

  void add_tangents(const Batch& x, const Weights& w, Pack* tangent) const override {
    const LaneMatrices& m = batches_[static_cast<size_t>(x.first / kLanes)];
    const auto n = static_cast<size_t>(x.n_shapes), d = static_cast<size_t>(x.dim);
    run_batch_kernel([&]<class V>() {
      const V *mass = packs_as<V>(m.mass.data()), *convection = packs_as<V>(m.convection.data()),
              *transport = packs_as<V>(m.transport.data());
      V* out = packs_as<V>(tangent);
      for (size_t l = 0; l < n; ++l)
        for (size_t k = 0; k < n; ++k) {
          const size_t at = l * n + k;
          V entry = w.a * mass[at];
          if (!m.convection.empty()) entry += w.v * convection[at] + w.q * transport[at];
          for (size_t c = 0; c < d; ++c) out[(d * l + c) * n * d + d * k + c] += entry;
        }
    });
  }

  void add_eulerian_force(int e, const Local& x, EulerianForce& force) const override {
    of_free_.add_force(free_.of(e), x, force);
  }
  void add_eulerian_tangent(int e, const Local& x, const Weights& w,
                            EulerianTangent& tangent) const override {
    of_free_.add_tangent(free_.of(e), x, w, tangent);
  }

  std::string name() const override { return "inertia"; }

  /// Returns T = ½ ∫ ρh |ṙ|² dA, ṙ = Qᵈᵀ N + Qᵀ Ṅ.
  Energies energies(int e, const Local& x) const override {
    if (free_.has(e)) return {.kinetic = of_free_.kinetic_energy(free_.of(e), x)};
    const Matrices& m = matrices_[static_cast<size_t>(e)];
    double twice = bilinear_form(x.v, m.mass, x.v);
    if (m.flows)
      twice += bilinear_form(x.v, m.convection, x.q) + bilinear_form(x.q, m.rate_product, x.q);
    return {.kinetic = 0.5 * twice};
  }

  void add_scale_factor_gradient(int e, const Local& x, const LocalRows& psi,
                                 ScaleFactorGradient& out) const override {
    const CellRange at = element_->cells(e, factors_->grid);
    if (x.q.rows() == 4 && at.single() && !element_->moving(e)) {
      out.mass[factors_->grid.cell(at.i0, at.j0)] += bilinear_derivative(at.area, x, psi);
      return;
    }
    static thread_local ShapeTable t;
    element_->tabulate(e, kDegree, Tabulate::position_rates, *factors_, ScaleFactorKind::mass, t);
    MatrixXd acceleration = t.N * x.a;
    if (t.N_t.size() > 0) acceleration += 2 * t.N_t * x.v + t.N_tt * x.q;
    const VectorXd values = area_density_ * (t.N * psi).cwiseProduct(acceleration).rowwise().sum();
    element_->add_cell_integrals(e, kDegree, values, factors_->grid, out.mass);
  }

  /// Returns ∫ ρh ṙ dA.
  Vec3 momentum(int e, const Local& x) const override {
    if (free_.has(e)) return of_free_.momentum(free_.of(e), x);
    const Matrices& m = matrices_[static_cast<size_t>(e)];
    Vec3 out = Vec3::Zero();
    for (Eigen::Index c = 0; c < x.v.cols(); ++c) {
      out[c] = m.first.dot(x.v.col(c));
      if (m.flows) out[c] += m.first_rate.dot(x.q.col(c));
    }
    return out;
  }

  /// Returns ∫ ρh (Qᵀ Ṅ) · r̈ dA.
  double flow_power(int e, const Local& x) const override {
    const Matrices& m = matrices_[static_cast<size_t>(e)];
    return 0.5 * bilinear_form(x.a, m.convection, x.q) +
           2 * bilinear_form(x.v, m.rate_product, x.q) + bilinear_form(x.q, m.rate_transport, x.q);
  }

  void add_line_energy(std::span<const ShapeTable> line, const Local& x,
                       LineEnergy& out) const override {
    for (size_t g = 0; g < line.size(); ++g) {
      Eigen::RowVectorXd velocity = line[g].N * x.v;
      if (line[g].N_t.size() > 0) velocity += line[g].N_t * x.q;
      out.mass[static_cast<Eigen::Index>(g)] += 0.5 * area_density_ * velocity.squaredNorm();
    }
  }

 private:
  using LocalSquare =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxShapes, kMaxShapes>;
  /// Matrices of an element, of its size: with space for kMaxShapes they would not fit into caches.
  struct Matrices {
    bool flows = false;
    MatrixXd mass;
    VectorXd first;  // ∫ρh N
    // Only of elements whose lines move; rates are ∫ρh Ṅ, ∫ρh Ṅ Ṅᵀ, ∫ρh Ṅ N̈ᵀ.
    MatrixXd convection, transport, rate_product, rate_transport;
    VectorXd first_rate;
  };

  /// Matrices of eight elements, by columns; convection and transport only where lines of one of
  /// them move.
  struct LaneMatrices {
    std::vector<Pack> mass, convection, transport;  // (n_shapes²)
  };

  /// Returns Σ_kl x_k · A_kl y_l. For few shape functions it is several times as fast as products
  /// of matrices of variable size.
  static double bilinear_form(const LocalRows& x, const MatrixXd& A, const LocalRows& y) {
    const Eigen::Index n = A.rows(), d = x.cols();
    const double *px = x.data(), *py = y.data(), *entry = A.data();
    double out = 0;
    for (Eigen::Index l = 0; l < n; ++l, py += d)
      for (Eigen::Index k = 0; k < n; ++k, ++entry) {
        double dot = 0;
        for (Eigen::Index c = 0; c < d; ++c) dot += px[d * k + c] * py[c];
        out += *entry * dot;
      }
    return out;
  }

  void side_by_side(int first, int last, LaneMatrices& out) const {
    const auto flows = [](const Matrices& m) { return m.flows; };
    const bool any = std::any_of(matrices_.begin() + first, matrices_.begin() + last, flows);
    const auto size = static_cast<size_t>(matrices_[static_cast<size_t>(first)].mass.size());
    out.mass.resize(size);
    out.convection.resize(any ? size : 0);
    out.transport.resize(any ? size : 0);
    for (int lane = 0; lane < kLanes; ++lane) {
      const Matrices& m = matrices_[static_cast<size_t>(std::min(first + lane, last - 1))];
      for (size_t k = 0; k < size; ++k) {
        out.mass[k][lane] = m.mass.data()[k];
        if (!any) continue;
        out.convection[k][lane] = m.flows ? m.convection.data()[k] : 0;
        out.transport[k][lane] = m.flows ? m.transport.data()[k] : 0;
      }
    }
  }

  /// Adds matrix times x to the force, for every SIMD lane.
  template <class V>
  static void add_product(const std::vector<Pack>& matrix, const Pack* x, const Batch& batch,
                          Pack* force) {
    const int n = batch.n_shapes, d = batch.dim;
    const V *entries = packs_as<V>(matrix.data()), *factors = packs_as<V>(x);
    V* out = packs_as<V>(force);
    for (int c = 0; c < d; ++c)
      for (int k = 0; k < n; ++k) {
        V sum = out[d * k + c];
        for (int l = 0; l < n; ++l) sum += entries[l * n + k] * factors[d * l + c];
        out[d * k + c] = sum;
      }
  }

  void tabulate(const Element& element, int e, const ScaleFactors& factors) {
    if (!moments_.weigh(e, weights_))
      return element.tabulate(e, kDegree, Tabulate::position_rates, factors, ScaleFactorKind::mass,
                              table_);
    // The number of points is that of an integration with scale factors in the weights, twice the
    // usual degree.
    element.tabulate(e, 2 * kDegree, Tabulate::position_rates, {}, ScaleFactorKind::none, table_);
    for (Eigen::Index g = 0; g < weights_.rows(); ++g)
      for (Eigen::Index h = 0; h < weights_.cols(); ++h)
        table_.weight[g * weights_.cols() + h] = weights_(g, h);
  }

  void integrate(const Element& element, int e, const ScaleFactors& factors) {
    tabulate(element, e, factors);
    Matrices& m = matrices_[static_cast<size_t>(e)];
    m.flows = element.moving(e);
    weighted_.noalias() = (area_density_ * table_.weight).asDiagonal() * table_.N;
    m.first = weighted_.colwise().sum().transpose();
    m.mass.noalias() = weighted_.transpose() * table_.N;
    if (!m.flows) return;
    m.convection.noalias() = 2 * weighted_.transpose() * table_.N_t;
    m.transport.noalias() = weighted_.transpose() * table_.N_tt;
    weighted_.noalias() = (area_density_ * table_.weight).asDiagonal() * table_.N_t;
    m.first_rate = weighted_.colwise().sum().transpose();
    m.rate_product.noalias() = weighted_.transpose() * table_.N_t;
    m.rate_transport.noalias() = weighted_.transpose() * table_.N_tt;
  }

  /// Returns ψ · M a of a full bilinear cell, M = ρh A/36 [4 2 1 2; ...] with corners in turn
  /// around it.
  double bilinear_derivative(double area, const Local& x, const LocalRows& psi) const {
    double sum = 0;
    for (Eigen::Index k = 0; k < 4; ++k)
      for (Eigen::Index l = 0; l < 4; ++l) {
        const int apart = static_cast<int>(std::abs(k - l));
        const double share = apart == 0 ? 4 : apart == 2 ? 1 : 2;
        sum += share * psi.row(k).dot(x.a.row(l));
      }
    return area_density_ * area / 36 * sum;
  }

  static constexpr int kDegree = 6;  // polynomial degree of N Nᵀ
  const Element* element_ = nullptr;
  const ScaleFactors* factors_ = nullptr;
  PlaneSection section_;
  double area_density_;
  EulerianInertia of_free_;
  EulerianTables free_;
  std::vector<Matrices> matrices_;
  std::vector<LaneMatrices> batches_;
  ScaleFactorMoments moments_;
  ShapeTable table_;
  MatrixXd weighted_, weights_;
};

}  // namespace

std::unique_ptr<Term> make_inertia(const PlaneSection& section) {
  return std::make_unique<Inertia>(section);
}

const TermRow& inertia_row() {
  static const TermRow kRow{
      .name = "inertia",
      .sentence = "Inertia forces of a body; material may flow through its mesh.",
      .role = "inertia",
      .domains = {TermDomain::plane, TermDomain::space, TermDomain::beam},
      .required_in = {},
      .moves = true,
      .on_cells = true,
      .keys = {},
      .columns = {},
      .make = [](const TermData& data) { return make_inertia(data.section); }};
  return kRow;
}

}  // namespace flexmorph::fem
