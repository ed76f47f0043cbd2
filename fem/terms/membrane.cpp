#include <memory>

#include "fem/term.h"

namespace flexmorph::fem {
namespace {

/// In-plane elastic force of a thin St. Venant-Kirchhoff plate in Gram form.
///
///   U = h/2 ∫ εᵀ C ε dA,   ε = (½(r_m·r_m - 1), ½(r_n·r_n - 1), r_m·r_n)      P (6)-(8)
///
/// N_k multiplies the identity, so ε depends on the unknowns only through the Gram matrix
/// G_kl = q_k · q_l, and linearly: ε = Λ(X) (g - g°), g = the distinct entries of G, g° those of
/// the undeformed element. Hence U is exactly quadratic,
///
///   U = ½ (g - g°)ᵀ W (g - g°),   W = h ∫ Λᵀ C Λ dA,
///   force   F_k = Σ_l S_kl q_l,   S_kl = (1 + δ_kl) s_kl,   s = W (g - g°)
///   tangent K = S ⊗ 1 + Dᵀ W D,   D = ∂g/∂q
///
/// and W is built once per design (per time for an element whose lines move), at the same cost of
/// evaluation for uniform and for designed material. Positions enter relative to the first one:
/// the force is the same (rigid translations strain nothing) and loses no digits far from the
/// origin.
///
/// Replaces P (11)-(15) and the tensors of the appendix; design.md section 2.
class Membrane final : public Term {
 public:
  explicit Membrane(const PlaneSection& s) : elasticity_(s.thickness * s.elasticity()) {}

  void prepare(const Element& element, const Factors& factors, bool all) override {
    element_ = &element;
    factors_ = &factors;
    n_shapes_ = element.n_shapes();
    tabulated_ = -1;
    pair_.resize(n_shapes_, n_shapes_);
    for (int k = 0, p = 0; k < n_shapes_; ++k)
      for (int l = k; l < n_shapes_; ++l, ++p) pair_(k, l) = pair_(l, k) = p;
    invariants_.resize(static_cast<size_t>(element.n_elements()));
    const MatrixXd reference = element.reference();
    for (int e = 0; e < element.n_elements(); ++e)
      if (all || element.moving(e)) integrate(element, e, factors, reference);
  }

  void add_force(int e, const Local& x, LocalRows& force) const override {
    LocalRows q;
    relative(e, x.q, q);
    force.noalias() += stress(e, q) * q;
  }

  void add_tangent(int e, const Local& x, const Weights& w, LocalTangent& tangent) const override {
    if (w.q == 0) return;
    LocalRows q;
    relative(e, x.q, q);
    const Square s = stress(e, q);
    const auto d = q.cols();
    const MatrixXd& invariant = *invariants_[static_cast<size_t>(e)].w;

    // T = W D, a column for unknown (l, c): ∂g_{li}/∂q_lc = (1 + δ_li) q_ic.
    Eigen::Matrix<double, kMaxPairs, 1, 0, kMaxPairs, 1> column(kMaxPairs);
    const auto n_pairs = invariant.rows();
    for (int l = 0; l < n_shapes_; ++l)
      for (Eigen::Index c = 0; c < d; ++c) {
        auto t = column.head(n_pairs);
        t.setZero();
        for (int i = 0; i < n_shapes_; ++i)
          t += (i == l ? 2 : 1) * q(i, c) * invariant.col(pair_(l, i));
        for (int k = 0; k < n_shapes_; ++k)
          for (Eigen::Index b = 0; b < d; ++b) {
            double sum = 0;
            for (int i = 0; i < n_shapes_; ++i)
              sum += (i == k ? 2 : 1) * q(i, b) * t[pair_(k, i)];
            tangent(d * k + b, d * l + c) += w.q * (sum + (b == c ? s(k, l) : 0.0));
          }
      }
  }

  double strain_energy(int e, const Local& x) const override {
    LocalRows q;
    relative(e, x.q, q);
    GramVector g = gram_difference(e, q);
    return 0.5 * g.dot(*invariants_[static_cast<size_t>(e)].w * g);
  }

  /// ∫ h εᵀ C ε̇ dA at fixed unknowns, by points: the rates of r_m and r_n at fixed material point.
  double flow_power(int e, const Local& x) const override {
    ShapeTable t;
    element_->tabulate(e, 12, Tabulate::gradient_rates, *factors_, FactorKind::stiffness, t);
    const MatrixXd r_m = t.N_m * x.q, r_n = t.N_n * x.q, r_mt = t.N_mt * x.q, r_nt = t.N_nt * x.q;
    double power = 0;
    for (Eigen::Index p = 0; p < t.weight.size(); ++p) {
      const Vec3 strain(0.5 * (r_m.row(p).squaredNorm() - 1), 0.5 * (r_n.row(p).squaredNorm() - 1),
                        r_m.row(p).dot(r_n.row(p)));
      const Vec3 rate(r_m.row(p).dot(r_mt.row(p)), r_n.row(p).dot(r_nt.row(p)),
                      r_mt.row(p).dot(r_n.row(p)) + r_m.row(p).dot(r_nt.row(p)));
      power += t.weight[p] * strain.dot(elasticity_ * rate);
    }
    return power;
  }

 private:
  static constexpr int kMaxPairs = kMaxShapes * (kMaxShapes + 1) / 2;
  using GramVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxPairs, 1>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxShapes, kMaxShapes>;

  struct Invariant {
    std::shared_ptr<const MatrixXd> w;  // shared by neighbours of equal size and material
    GramVector reference;               // g°
    std::vector<char> is_position;      // shape functions that carry positions
  };

  void relative(int e, const LocalRows& x, LocalRows& q) const {
    q = x;
    const auto& is_position = invariants_[static_cast<size_t>(e)].is_position;
    for (int k = 0; k < n_shapes_; ++k)
      if (is_position[static_cast<size_t>(k)]) q.row(k) -= x.row(0);
  }

  GramVector gram_difference(int e, const LocalRows& q) const {
    const Square g = q * q.transpose();
    GramVector out(n_shapes_ * (n_shapes_ + 1) / 2);
    for (int k = 0, p = 0; k < n_shapes_; ++k)
      for (int l = k; l < n_shapes_; ++l, ++p) out[p] = g(k, l);
    return out - invariants_[static_cast<size_t>(e)].reference;
  }

  /// S of the docstring.
  Square stress(int e, const LocalRows& q) const {
    const GramVector s = *invariants_[static_cast<size_t>(e)].w * gram_difference(e, q);
    Square out(n_shapes_, n_shapes_);
    for (int k = 0, p = 0; k < n_shapes_; ++k)
      for (int l = k; l < n_shapes_; ++l, ++p) out(k, l) = out(l, k) = k == l ? 2 * s[p] : s[p];
    return out;
  }

  void integrate(const Element& element, int e, const Factors& factors, const MatrixXd& reference) {
    Invariant& out = invariants_[static_cast<size_t>(e)];
    std::swap(previous_, table_);
    element.tabulate(e, 12, Tabulate::gradient, factors, FactorKind::stiffness, table_);
    const bool same = e > 0 && tabulated_ == e - 1 && previous_.weight.size() == table_.weight.size() &&
                      previous_.weight.isApprox(table_.weight, 1e-13) &&
                      previous_.N_m.isApprox(table_.N_m, 1e-13) &&
                      previous_.N_n.isApprox(table_.N_n, 1e-13);
    tabulated_ = e;
    out.w = same ? invariants_[static_cast<size_t>(e - 1)].w : invariant();

    const auto vectors = element.vectors(e);
    LocalRows q(n_shapes_, 2);
    out.is_position.assign(static_cast<size_t>(n_shapes_), 0);
    for (int k = 0; k < n_shapes_; ++k) {
      q.row(k) = reference.row(vectors[static_cast<size_t>(k)]).head<2>();
      out.is_position[static_cast<size_t>(k)] = element.is_position(vectors[static_cast<size_t>(k)]);
    }
    const LocalRows origin = q.row(0);
    for (int k = 0; k < n_shapes_; ++k)
      if (out.is_position[static_cast<size_t>(k)]) q.row(k) -= origin.row(0);
    out.reference = GramVector::Zero(n_shapes_ * (n_shapes_ + 1) / 2);
    out.reference = gram_difference(e, q);
  }

  /// W = Σ_points Λᵀ C Λ, the weights in the points.
  std::shared_ptr<const MatrixXd> invariant() {
    const auto n_points = table_.weight.size();
    const int n_pairs = n_shapes_ * (n_shapes_ + 1) / 2;
    lambda_.resize(3 * n_points, n_pairs);
    for (int k = 0, p = 0; k < n_shapes_; ++k)
      for (int l = k; l < n_shapes_; ++l, ++p) {
        const double twice = k == l ? 1 : 2;
        const auto mk = table_.N_m.col(k).array(), ml = table_.N_m.col(l).array();
        const auto nk = table_.N_n.col(k).array(), nl = table_.N_n.col(l).array();
        lambda_.col(p).head(n_points) = 0.5 * twice * mk * ml;
        lambda_.col(p).segment(n_points, n_points) = 0.5 * twice * nk * nl;
        lambda_.col(p).tail(n_points) = 0.5 * twice * (mk * nl + ml * nk);
      }
    stress_.resize(3 * n_points, n_pairs);
    const auto block = [&](MatrixXd& x, int i) { return x.middleRows(i * n_points, n_points); };
    for (int i = 0; i < 3; ++i) {
      auto to = block(stress_, i);
      to.setZero();
      for (int j = 0; j < 3; ++j)
        if (elasticity_(i, j) != 0)
          to += (elasticity_(i, j) * table_.weight).asDiagonal() * block(lambda_, j);
    }
    auto w = std::make_shared<MatrixXd>(n_pairs, n_pairs);
    w->noalias() = lambda_.transpose() * stress_;
    return w;
  }

  Eigen::Matrix3d elasticity_;          // h C [N/m]
  const Element* element_ = nullptr;    // of the last prepare()
  const Factors* factors_ = nullptr;
  int n_shapes_ = 0;
  Eigen::MatrixXi pair_;
  std::vector<Invariant> invariants_;
  ShapeTable table_, previous_;
  int tabulated_ = -1;  // element of table_
  MatrixXd lambda_, stress_;
};

}  // namespace

std::unique_ptr<Term> make_membrane(const PlaneSection& section) {
  return std::make_unique<Membrane>(section);
}

}  // namespace flexmorph::fem
