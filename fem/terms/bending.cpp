#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <memory>

#include "fem/gram_gradient.h"
#include "fem/term.h"
#include "fem/terms/free_work.h"

namespace flexmorph::fem {
namespace {

using Mat3 = Eigen::Matrix3d;

/// Matrix of the cross product from the left: skew(x) y = x × y.
Mat3 skew(const Vec3& x) {
  Mat3 out;
  out << 0, -x[2], x[1], x[2], 0, -x[0], -x[1], x[0], 0;
  return out;
}

/// Bending energy density at one point, and its derivatives by y = (r_m, r_n, r_mm, r_nn, r_mn).
///
///   n = r_m × r_n,   ν = n/|n|³,   a = (r_mm, r_nn, 2 r_mn),   κ_i = a_i · ν
///   u = ½ κᵀ D κ,    μ = D κ
///
///   δν = J δn,   J = |n|⁻³ (1 - 3 n̂ n̂ᵀ),   δn = [δr_m] r_n + r_m [δr_n]  (cross products)
///   δu = Σ μ_i (δa_i · ν) + p · δn,   p = J A,   A = Σ μ_i a_i
///   δ²u = δκᵀ D Δκ + Σ μ_i (δa_i · J Δn + Δa_i · J δn) + p · δ²n + δnᵀ Q Δn
///   Q = ∂p/∂n = |n|⁻⁵ (-3 (A nᵀ + n Aᵀ + (A·n) 1) + 15 (A·n) n̂ n̂ᵀ)
struct AtPoint {
  static constexpr std::array<double, 3> kFactor = {1, 1, 2};  // a_i = kFactor_i y_(2+i)

  AtPoint(const Eigen::Matrix<double, 5, 3>& y, const Mat3& stiffness)
      : r_m(y.row(0)), r_n(y.row(1)) {
    const Vec3 n = r_m.cross(r_n);
    length = n.norm();
    normal = n / length;
    const double cube = 1 / (length * length * length);
    nu = cube * normal * length;
    for (int i = 0; i < 3; ++i) {
      a.col(i) = kFactor[static_cast<size_t>(i)] * y.row(2 + i).transpose();
      kappa[i] = a.col(i).dot(nu);
    }
    moment = stiffness * kappa;
    J = cube * (Mat3::Identity() - 3 * normal * normal.transpose());
    p = J * (a * moment);
  }

  double energy() const { return 0.5 * kappa.dot(moment); }

  /// ∂u/∂y, a row per vector.
  Eigen::Matrix<double, 5, 3> force() const {
    Eigen::Matrix<double, 5, 3> out;
    out.row(0) = r_n.cross(p);
    out.row(1) = p.cross(r_m);
    for (int i = 0; i < 3; ++i)
      out.row(2 + i) = kFactor[static_cast<size_t>(i)] * moment[i] * nu.transpose();
    return out;
  }

  /// ∂²u/∂y², rows and columns 3 vector + direction; symmetric.
  void tangent(const Mat3& stiffness, Eigen::Matrix<double, 15, 15>& out) const {
    Eigen::Matrix<double, 3, 15> dk = Eigen::Matrix<double, 3, 15>::Zero();
    for (int i = 0; i < 3; ++i) {
      const Vec3 ja = J * a.col(i);
      dk.block<1, 3>(i, 0) = r_n.cross(ja);
      dk.block<1, 3>(i, 3) = ja.cross(r_m);
      dk.block<1, 3>(i, 6 + 3 * i) = kFactor[static_cast<size_t>(i)] * nu.transpose();
    }
    out.noalias() = dk.transpose() * (stiffness * dk);

    const Mat3 by_m = -skew(r_n), by_n = skew(r_m);  // ∂n/∂r_m, ∂n/∂r_n
    for (int i = 0; i < 3; ++i) {
      const Mat3 mixed = kFactor[static_cast<size_t>(i)] * moment[i] * J;
      const Mat3 with_m = mixed * by_m, with_n = mixed * by_n;
      out.block<3, 3>(6 + 3 * i, 0) += with_m;
      out.block<3, 3>(6 + 3 * i, 3) += with_n;
      out.block<3, 3>(0, 6 + 3 * i) += with_m.transpose();
      out.block<3, 3>(3, 6 + 3 * i) += with_n.transpose();
    }
    const Vec3 A = a * moment;
    const double along = A.dot(normal), l4 = 1 / (length * length * length * length);
    const Mat3 Q = l4 * (-3 * (A * normal.transpose() + normal * A.transpose()) +
                         along * (15 * normal * normal.transpose() - 3 * Mat3::Identity()));
    out.block<3, 3>(0, 0) += by_m.transpose() * Q * by_m;
    out.block<3, 3>(3, 3) += by_n.transpose() * Q * by_n;
    const Mat3 across = by_m.transpose() * Q * by_n - skew(p);
    out.block<3, 3>(0, 3) += across;
    out.block<3, 3>(3, 0) += across.transpose();
  }

  Vec3 r_m, r_n, normal, nu, kappa, moment, p;
  double length;  // |n|
  Mat3 a, J;
};

class BendingDensity final : public EnergyDensity {
 public:
  explicit BendingDensity(const Mat3& stiffness) : stiffness_(stiffness) {}
  std::span<const Measure> measures() const override {
    static constexpr Measure kList[] = {{1, 0}, {0, 1}, {2, 0}, {0, 2}, {1, 1}};
    return kList;
  }
  double energy(const Measures& z, Measures* gradient, MeasureHessian* hessian) const override {
    const AtPoint at(z, stiffness_);
    if (gradient) *gradient = at.force();
    if (hessian) {
      Eigen::Matrix<double, 15, 15> h;
      at.tangent(stiffness_, h);
      *hessian = h;
    }
    return at.energy();
  }

 private:
  Mat3 stiffness_;
};

/// Bending of a thin plate in space.
///
///   U = ½ ∫ κᵀ D κ dA,   κ = (r_mm·n, r_nn·n, 2 r_mn·n)/|n|³,   n = r_m × r_n       P (7)
///   D = c³/12 C [N m],   C plane stress in Voigt order 11, 22, 12
///
/// κ is a rational function of the unknowns, so it is integrated at Gauss points; tables of shape
/// functions are shared by neighbours of equal size and material.
///
/// Source: Sun, Tian, Hu, Pedersen 2018, eq. (7); design.md section 2.
class Bending final : public Term {
 public:
  Bending(const PlaneSection& s, int n_points)
      : stiffness_(s.thickness * s.thickness * s.thickness / 12 * s.elasticity()),
        degree_(2 * n_points - 2),
        density_(stiffness_) {}

  void prepare(const Element& element, const Factors& factors, bool all) override {
    if (element.dim() != 3) throw Error::input("term 'bending' needs a body in space");
    gradient_.prepare(element);
    free_.prepare(element, degree_, Tabulate::curvature, factors);
    tables_.resize(static_cast<size_t>(element.n_elements()));
    int tabulated = -1;  // element of fresh_
    for (int e = 0; e < element.n_elements(); ++e) {
      if ((!all && !element.moving(e)) || free_.has(e)) continue;
      element.tabulate(e, degree_, Tabulate::curvature, factors, FactorKind::stiffness, table_);
      if (table_.N_mm.size() == 0)
        throw Error::input("term 'bending' needs curvature, and the element has none");
      const bool same =
          tabulated >= 0 && tabulated == e - 1 && equal(*tables_[static_cast<size_t>(e - 1)]);
      tables_[static_cast<size_t>(e)] = same ? tables_[static_cast<size_t>(e - 1)] : points();
      tabulated = e;
    }
  }

  void add_force(int e, const Local& x, LocalRows& force) const override {
    const Points& t = *tables_[static_cast<size_t>(e)];
    Values y;
    for (Eigen::Index first = 0; first < t.weight.size(); first += kGroup) {
      const auto shapes = group(t, first);
      y.noalias() = shapes * x.q;
      for (Eigen::Index g = 0; 5 * g < y.rows(); ++g)
        y.middleRows<5>(5 * g) =
            t.weight[first + g] * AtPoint(y.middleRows<5>(5 * g), stiffness_).force();
      force.noalias() += shapes.transpose() * y;
    }
  }

  void add_tangent(int e, const Local& x, const Weights& w, LocalTangent& tangent) const override {
    if (w.q == 0) return;
    const Points& t = *tables_[static_cast<size_t>(e)];
    const auto n_shapes = t.N.cols();
    Values y;
    Eigen::Matrix<double, 15, 15> h;
    Spread spread;
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxShapes, 3 * kMaxShapes> product;
    for (Eigen::Index first = 0; first < t.weight.size(); first += kGroup) {
      const auto shapes = group(t, first);
      y.noalias() = shapes * x.q;
      for (Spread::Rows& rows : spread.by_direction) rows.resize(y.rows(), 3 * n_shapes);
      for (Eigen::Index g = 0; 5 * g < y.rows(); ++g) {
        AtPoint(y.middleRows<5>(5 * g), stiffness_).tangent(stiffness_, h);
        h *= w.q * t.weight[first + g];
        spread.set(5 * g, h, shapes.middleRows<5>(5 * g));
      }
      for (int b = 0; b < 3; ++b) {
        product.noalias() = shapes.transpose() * spread.by_direction[static_cast<size_t>(b)];
        for (Eigen::Index k = 0; k < n_shapes; ++k)
          for (int c = 0; c < 3; ++c)
            for (Eigen::Index l = 0; l < n_shapes; ++l)
              tangent(3 * k + b, 3 * l + c) += product(k, c * n_shapes + l);
      }
    }
  }

  void add_free_force(int e, const Local& x, FreeForce& force) const override {
    FreeElastic(density_, free_.of(e)).add_force(x.q, force);
  }
  void add_free_tangent(int e, const Local& x, const Weights& w,
                        FreeTangent& tangent) const override {
    if (w.q != 0) FreeElastic(density_, free_.of(e)).add_tangent(x.q, w.q, tangent);
  }

  void add_mean_force(int e, const LocalStep& x, LocalRows& force) const override {
    gradient_.add_force(*this, e, x, force);
  }
  void add_mean_tangent(int e, const LocalStep& x, const Weights& w,
                        LocalTangent& tangent) const override {
    gradient_.add_tangent(*this, e, x, w, tangent);
  }
  std::string name() const override { return "bending"; }

  double strain_energy(int e, const Local& x) const override {
    if (free_.has(e)) return FreeElastic(density_, free_.of(e)).energy(x.q);
    const Points& t = *tables_[static_cast<size_t>(e)];
    Values y;
    double out = 0;
    for (Eigen::Index first = 0; first < t.weight.size(); first += kGroup) {
      y.noalias() = group(t, first) * x.q;
      for (Eigen::Index g = 0; 5 * g < y.rows(); ++g)
        out += t.weight[first + g] * AtPoint(y.middleRows<5>(5 * g), stiffness_).energy();
    }
    return out;
  }

 private:
  /// Shape functions of one element: rows 5 point + vector, vectors r_m, r_n, r_mm, r_nn, r_mn.
  struct Points {
    VectorXd weight;
    MatrixXd N;
  };

  // Points are taken in groups: matrix products of useful size, all work space on the stack.
  static constexpr int kGroup = 7;
  using Values = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 5 * kGroup, 3>;

  static MatrixXd::ConstRowsBlockXpr group(const Points& t, Eigen::Index first) {
    const auto n = std::min<Eigen::Index>(kGroup, t.weight.size() - first);
    return t.N.middleRows(5 * first, 5 * n);
  }

  /// H B of a group of points: for direction b of the row, a row per point and vector and a column
  /// n_shapes c + k per unknown.
  struct Spread {
    using Rows =
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 5 * kGroup, 3 * kMaxShapes>;
    std::array<Rows, 3> by_direction;

    template <class Shapes>
    void set(Eigen::Index row, const Eigen::Matrix<double, 15, 15>& h, const Shapes& shapes) {
      // Rows sorted by direction and padded to whole vector registers.
      Eigen::Matrix<double, 16, 15> sorted = Eigen::Matrix<double, 16, 15>::Zero();
      for (int b = 0; b < 3; ++b)
        for (int i = 0; i < 5; ++i) sorted.row(5 * b + i).noalias() = h.row(3 * i + b);
      for (int c = 0; c < 3; ++c)
        for (Eigen::Index k = 0; k < shapes.cols(); ++k) {
          Eigen::Matrix<double, 16, 1> column = shapes(0, k) * sorted.col(c);
          for (int j = 1; j < 5; ++j) column += shapes(j, k) * sorted.col(3 * j + c);
          for (size_t b = 0; b < 3; ++b)
            for (int i = 0; i < 5; ++i)
              by_direction[b](row + i, c * shapes.cols() + k) = column[5 * static_cast<int>(b) + i];
        }
    }
  };

  bool equal(const Points& old) const {
    if (old.weight.size() != table_.weight.size()) return false;
    const auto close = [](const auto& x, const auto& y) { return x.isApprox(y, 1e-13); };
    const auto of = [&](int vector) {
      return Eigen::Map<const MatrixXd, 0, Eigen::Stride<Eigen::Dynamic, 5>>(
          old.N.data() + vector, old.weight.size(), old.N.cols(),
          Eigen::Stride<Eigen::Dynamic, 5>(old.N.rows(), 5));
    };
    return close(old.weight, table_.weight) && close(of(0), table_.N_m) &&
           close(of(1), table_.N_n) && close(of(2), table_.N_mm) && close(of(3), table_.N_nn) &&
           close(of(4), table_.N_mn);
  }

  std::shared_ptr<const Points> points() const {
    auto out = std::make_shared<Points>();
    out->weight = table_.weight;
    out->N.resize(5 * table_.weight.size(), table_.N.cols());
    for (Eigen::Index g = 0; g < table_.weight.size(); ++g) {
      out->N.row(5 * g) = table_.N_m.row(g);
      out->N.row(5 * g + 1) = table_.N_n.row(g);
      out->N.row(5 * g + 2) = table_.N_mm.row(g);
      out->N.row(5 * g + 3) = table_.N_nn.row(g);
      out->N.row(5 * g + 4) = table_.N_mn.row(g);
    }
    return out;
  }

  Mat3 stiffness_;  // D [N m]
  int degree_;
  BendingDensity density_;
  FreeTables free_;
  GramGradient gradient_;
  std::vector<std::shared_ptr<const Points>> tables_;
  ShapeTable table_;
};

}  // namespace

std::unique_ptr<Term> make_bending(const PlaneSection& section, int n_points) {
  return std::make_unique<Bending>(section, n_points);
}

}  // namespace flexmorph::fem
