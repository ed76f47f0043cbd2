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
    Square spread(n_shapes_, n_shapes_);
    LocalRows block(n_shapes_, d);
    for (int l = 0; l < n_shapes_; ++l)
      for (Eigen::Index c = 0; c < d; ++c) {
        auto t = column.head(n_pairs);
        t.setZero();
        for (int i = 0; i < n_shapes_; ++i)
          t += (i == l ? 2 : 1) * q(i, c) * invariant.col(pair_(l, i));
        // Dᵀ T: the column as a symmetric matrix (diagonal twice) times q.
        for (int k = 0, p = 0; k < n_shapes_; ++k) {
          spread(k, k) = 2 * t[p++];
          for (int i = k + 1; i < n_shapes_; ++i, ++p) spread(k, i) = spread(i, k) = t[p];
        }
        block.noalias() = spread * q;
        for (int k = 0; k < n_shapes_; ++k) {
          block(k, c) += s(k, l);
          for (Eigen::Index b = 0; b < d; ++b) tangent(d * k + b, d * l + c) += w.q * block(k, b);
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
    if (!element.tabulate_products(e, 12, factors, FactorKind::stiffness, table_))
      throw Error::input("term 'membrane' needs shape functions that are products along m and n");
    const auto equal = [](const MatrixXd& x, const MatrixXd& y) {
      return x.rows() == y.rows() && x.cols() == y.cols() && x.isApprox(y, 1e-13);
    };
    const bool same = e > 0 && tabulated_ == e - 1 && equal(previous_.weight, table_.weight) &&
                      equal(previous_.f_m, table_.f_m) && equal(previous_.f_n, table_.f_n);
    tabulated_ = e;
    out.w = same ? invariants_[static_cast<size_t>(e - 1)].w : invariant();

    const auto vectors = element.vectors(e);
    LocalRows q(n_shapes_, 2);
    out.is_position.assign(static_cast<size_t>(n_shapes_), 0);
    for (int k = 0; k < n_shapes_; ++k) {
      q.row(k) = reference.row(vectors[static_cast<size_t>(k)]).head<2>();
      out.is_position[static_cast<size_t>(k)] =
          element.is_position(vectors[static_cast<size_t>(k)]);
    }
    const LocalRows origin = q.row(0);
    for (int k = 0; k < n_shapes_; ++k)
      if (out.is_position[static_cast<size_t>(k)]) q.row(k) -= origin.row(0);
    out.reference = GramVector::Zero(n_shapes_ * (n_shapes_ + 1) / 2);
    out.reference = gram_difference(e, q);
  }

  /// W = Σ_points Λᵀ C Λ. With N_k = f_i(m) g_a(n) every entry of Λᵀ C Λ is a sum of products of
  /// four functions of m and four of n, so all of W is made of three matrices, each summed over m
  /// first and over n then,
  ///
  ///   X (p q, r s) = Σ_gh w_gh (x_p y_q)(m_g) (y_r x_s)(n_h)     p, q, r, s: pairs of functions
  ///
  /// with f' f' f' f' (11), f f f f (22) or f' f' f f (all others) along m.
  std::shared_ptr<const MatrixXd> invariant() {
    const MatrixXd dd_m = pairs(table_.d_m), ff_m = pairs(table_.f_m), dd_n = pairs(table_.d_n),
                   ff_n = pairs(table_.f_n);
    const MatrixXd& w = table_.weight;
    const MatrixXd x11 = products(dd_m, dd_m) * w * products(ff_n, ff_n).transpose();
    const MatrixXd x22 = products(ff_m, ff_m) * w * products(dd_n, dd_n).transpose();
    const MatrixXd x12 = products(dd_m, ff_m) * w * products(ff_n, dd_n).transpose();

    const auto n = static_cast<int>(table_.f_m.cols()), n_pairs_1d = n * (n + 1) / 2;
    const auto pair = [n](int i, int j) {  // number of {i, j} among the pairs
      if (i > j) std::swap(i, j);
      return i * (2 * n - i + 1) / 2 + j - i;
    };
    Eigen::MatrixXi m_pair(n_shapes_, n_shapes_), n_pair(n_shapes_, n_shapes_);
    for (int k = 0; k < n_shapes_; ++k)
      for (int l = 0; l < n_shapes_; ++l) {
        const auto at = [](const std::vector<int>& x, int i) { return x[static_cast<size_t>(i)]; };
        m_pair(k, l) = pair(at(table_.function_m, k), at(table_.function_m, l));
        n_pair(k, l) = pair(at(table_.function_n, k), at(table_.function_n, l));
      }
    // Entry of one of the three: pairs (p, q) along m and the same unknowns (r, s) along n.
    const auto entry = [&](const MatrixXd& x, int p_m, int q_m, int p_n, int q_n) {
      return x(p_m * n_pairs_1d + q_m, p_n * n_pairs_1d + q_n);
    };
    const double c11 = elasticity_(0, 0), c22 = elasticity_(1, 1), c12 = elasticity_(0, 1),
                 c33 = elasticity_(2, 2);
    const int n_pairs = n_shapes_ * (n_shapes_ + 1) / 2;
    auto out = std::make_shared<MatrixXd>(n_pairs, n_pairs);
    for (int k = 0, p = 0; k < n_shapes_; ++k)
      for (int l = k; l < n_shapes_; ++l, ++p)
        for (int r = 0, q = 0; q <= p; ++r)
          for (int s = r; s < n_shapes_ && q <= p; ++s, ++q) {
            const int kl_m = m_pair(k, l), kl_n = n_pair(k, l), rs_m = m_pair(r, s),
                      rs_n = n_pair(r, s), kr_m = m_pair(k, r), kr_n = n_pair(k, r),
                      ls_m = m_pair(l, s), ls_n = n_pair(l, s), ks_m = m_pair(k, s),
                      ks_n = n_pair(k, s), lr_m = m_pair(l, r), lr_n = n_pair(l, r);
            // ε₁₁ and ε₂₂ have N_k,m N_l,m and N_k,n N_l,n; 2ε₁₂ the symmetric N_k,m N_l,n.
            const double normal =
                c11 * entry(x11, kl_m, rs_m, kl_n, rs_n) +
                c22 * entry(x22, kl_m, rs_m, kl_n, rs_n) +
                c12 * (entry(x12, kl_m, rs_m, kl_n, rs_n) + entry(x12, rs_m, kl_m, rs_n, kl_n));
            const double shear =
                entry(x12, kr_m, ls_m, kr_n, ls_n) + entry(x12, ks_m, lr_m, ks_n, lr_n) +
                entry(x12, lr_m, ks_m, lr_n, ks_n) + entry(x12, ls_m, kr_m, ls_n, kr_n);
            const double twice = (k == l ? 0.5 : 1) * (r == s ? 0.5 : 1);
            (*out)(p, q) = (*out)(q, p) = twice * (normal + c33 * shear);
          }
    return out;
  }

  /// Products of two functions at all points: a row per pair i <= j.
  static MatrixXd pairs(const MatrixXd& f) {
    MatrixXd out(f.cols() * (f.cols() + 1) / 2, f.rows());
    for (Eigen::Index i = 0, p = 0; i < f.cols(); ++i)
      for (Eigen::Index j = i; j < f.cols(); ++j, ++p)
        out.row(p) = f.col(i).cwiseProduct(f.col(j)).transpose();
    return out;
  }
  /// Products of rows of x and rows of y at all points: row p y.rows() + q.
  static MatrixXd products(const MatrixXd& x, const MatrixXd& y) {
    MatrixXd out(x.rows() * y.rows(), x.cols());
    for (Eigen::Index p = 0; p < x.rows(); ++p)
      out.middleRows(p * y.rows(), y.rows()) = y * x.row(p).asDiagonal();
    return out;
  }

  Eigen::Matrix3d elasticity_;        // h C [N/m]
  const Element* element_ = nullptr;  // of the last prepare()
  const Factors* factors_ = nullptr;
  int n_shapes_ = 0;
  Eigen::MatrixXi pair_;
  std::vector<Invariant> invariants_;
  ProductTable table_, previous_;
  int tabulated_ = -1;  // element of table_
};

}  // namespace

std::unique_ptr<Term> make_membrane(const PlaneSection& section) {
  return std::make_unique<Membrane>(section);
}

}  // namespace flexmorph::fem
