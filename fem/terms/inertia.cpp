#include "fem/term.h"

namespace flexmorph::fem {
namespace {

/// Inertia of a body through whose mesh material may flow, P (16), (23).
///
///   f = ∫ ρ h N r̈ dA,   r̈ = Qᵈᵈᵀ N + 2 Qᵈᵀ Ṅ + Qᵀ N̈      (P (5), material acceleration)
///     = M Qᵈᵈ + C Qᵈ + P Q,   M = ∫ρh N Nᵀ,  C = 2 ∫ρh N Ṅᵀ,  P = ∫ρh N N̈ᵀ
///
/// N (n_k)     shape functions; Ṅ, N̈ their rates at a fixed material point
/// h, ρ        thickness [m], density [kg/m³]; the mass factor of the design is in the weights
///
/// C and P exist for elements whose lines move; the lines are prescribed, so the force is linear
/// in Q, Qᵈ and Qᵈᵈ and the tangent is exact.
class Inertia final : public Term {
 public:
  explicit Inertia(const PlaneSection& s) : area_density_(s.density * s.thickness) {}

  void prepare(const Element& element, const Factors& factors, bool all) override {
    matrices_.resize(static_cast<size_t>(element.n_elements()));
    for (int e = 0; e < element.n_elements(); ++e)
      if (all || element.moving(e)) integrate(element, e, factors);
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
    Square scalar = w.a * m.mass;
    if (m.flows) scalar += w.v * m.convection + w.q * m.transport;
    const auto d = x.q.cols();
    for (Eigen::Index k = 0; k < scalar.rows(); ++k)
      for (Eigen::Index l = 0; l < scalar.cols(); ++l)
        for (Eigen::Index c = 0; c < d; ++c) tangent(d * k + c, d * l + c) += scalar(k, l);
  }

  /// T = ½ ∫ ρh |ṙ|² dA,  ṙ = Qᵈᵀ N + Qᵀ Ṅ.
  double kinetic_energy(int e, const Local& x) const override {
    const Matrices& m = matrices_[static_cast<size_t>(e)];
    double twice = x.v.cwiseProduct(m.mass * x.v).sum();
    if (m.flows)
      twice +=
          x.v.cwiseProduct(m.convection * x.q).sum() + x.q.cwiseProduct(m.rate_product * x.q).sum();
    return 0.5 * twice;
  }

  /// ∫ ρh (Qᵀ Ṅ) · r̈ dA.
  double flow_power(int e, const Local& x) const override {
    const Matrices& m = matrices_[static_cast<size_t>(e)];
    return 0.5 * x.a.cwiseProduct(m.convection * x.q).sum() +
           2 * x.v.cwiseProduct(m.rate_product * x.q).sum() +
           x.q.cwiseProduct(m.rate_transport * x.q).sum();
  }

 private:
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxShapes, kMaxShapes>;
  struct Matrices {
    bool flows = false;
    Square mass, convection, transport;
    Square rate_product, rate_transport;  // ∫ρh Ṅ Ṅᵀ, ∫ρh Ṅ N̈ᵀ
  };

  void integrate(const Element& element, int e, const Factors& factors) {
    element.tabulate(e, 6, Tabulate::position_rates, factors, FactorKind::mass, table_);
    Matrices& m = matrices_[static_cast<size_t>(e)];
    m.flows = element.moving(e);
    weighted_.noalias() = (area_density_ * table_.weight).asDiagonal() * table_.N;
    m.mass.noalias() = weighted_.transpose() * table_.N;
    if (!m.flows) return;
    m.convection.noalias() = 2 * weighted_.transpose() * table_.N_t;
    m.transport.noalias() = weighted_.transpose() * table_.N_tt;
    weighted_.noalias() = (area_density_ * table_.weight).asDiagonal() * table_.N_t;
    m.rate_product.noalias() = weighted_.transpose() * table_.N_t;
    m.rate_transport.noalias() = weighted_.transpose() * table_.N_tt;
  }

  double area_density_;
  std::vector<Matrices> matrices_;
  ShapeTable table_;
  MatrixXd weighted_;
};

}  // namespace

std::unique_ptr<Term> make_inertia(const PlaneSection& section) {
  return std::make_unique<Inertia>(section);
}

}  // namespace flexmorph::fem
