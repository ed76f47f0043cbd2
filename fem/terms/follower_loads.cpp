#include <Eigen/Geometry>
#include <cmath>

#include "fem/load_term.h"
#include "fem/loads.h"

namespace flexmorph::fem {
namespace {

using Mat3 = Eigen::Matrix3d;

/// Returns Σ_k row_k q_k.
template <class Row>
Vec3 at(const Row& row, const LocalRows& q) {
  Vec3 out = Vec3::Zero();
  for (Eigen::Index k = 0; k < q.rows(); ++k)
    for (int c = 0; c < 3; ++c) out[c] += row[k] * q(k, c);
  return out;
}

void check(const Element& element, const std::string& what) {
  if (element.dim() != 3) throw Error::input(what + " needs a three-dimensional body");
}

void check_still(const Element& element, int e, const std::string& what) {
  if (element.moving(e))
    throw Error::input(what + " cannot act on an element whose material lines move");
}

/// Pressure that follows the surface:  δW = ∫ p (r_m × r_n) · δr dA  over the reference area. It is
/// the pressure on the deformed area. The tangent
///
///   K_kl = -∫ p N_k (N_l,n [r_m]× - N_l,m [r_n]×) dA
///
/// is unsymmetric except for closed or suitably held surfaces. Integrands are polynomials of degree
/// 8.
class Pressure final : public LoadTerm {
 public:
  explicit Pressure(const LoadLaw& pressure) : LoadTerm(pressure, true) {}

  std::unique_ptr<Term> clone() const override { return std::make_unique<Pressure>(*this); }
  void prepare(const Element& element, const ScaleFactors&, bool all) override {
    check(element, "pressure");
    if (!all) return;
    tables_.resize(static_cast<size_t>(element.n_elements()));
    for (int e = 0; e < element.n_elements(); ++e) check_still(element, e, "pressure");
    for (int e = 0; e < element.n_elements(); ++e)
      element.tabulate(e, 8, Tabulate::gradient, {}, ScaleFactorKind::none,
                       tables_[static_cast<size_t>(e)]);
  }
  void add_force(int e, const Local& x, LocalRows& force) const override {
    const ShapeTable& t = tables_[static_cast<size_t>(e)];
    for (Eigen::Index p = 0; p < t.weight.size(); ++p) {
      const Vec3 r_m = at(t.N_m.row(p), x.q), r_n = at(t.N_n.row(p), x.q);
      const Vec3 push = factor() * load()[0] * t.weight[p] * r_m.cross(r_n);
      force.noalias() -= t.N.row(p).transpose() * push.transpose();
    }
  }
  void add_tangent(int e, const Local& x, const Weights& w, LocalTangent& tangent) const override {
    if (w.q == 0) return;
    const ShapeTable& t = tables_[static_cast<size_t>(e)];
    for (Eigen::Index p = 0; p < t.weight.size(); ++p) {
      const Vec3 r_m = at(t.N_m.row(p), x.q), r_n = at(t.N_n.row(p), x.q);
      const double size = w.q * factor() * load()[0] * t.weight[p];
      const Mat3 by_m = -size * skew(r_n), by_n = size * skew(r_m);
      for (Eigen::Index l = 0; l < t.N.cols(); ++l) {
        const Mat3 column = t.N_m(p, l) * by_m + t.N_n(p, l) * by_n;
        for (Eigen::Index k = 0; k < t.N.cols(); ++k)
          tangent.block<3, 3>(3 * k, 3 * l) -= t.N(p, k) * column;
      }
    }
  }
  std::string name() const override { return "pressure"; }

 private:
  std::vector<ShapeTable> tables_;
};

/// Moment per length of an edge, about the edge, that rotates with it:
///
///   δW = ∫ M δθ ds,   δθ = σ n̂ · δs / |s|,   n̂ = r_m × r_n / |r_m × r_n|
///
/// s is the position gradient across the edge (r_m at root and free end, r_n at the sides). σ = 1
/// where it points out of the body (free_end, side_high), -1 where it points into it. A positive
/// moment rotates the outward gradient towards n̂, so that on opposite edges it bends with κ > 0.
/// The force h = σ M n̂/|s| on s has the derivative
///
///   ∂h = σ M ( (1 - n̂ n̂ᵀ) ∂n / (|n| |s|) - n̂ (s · ∂s) / |s|³ )
class EdgeMoment final : public LoadTerm, public EulerianLineTerm {
 public:
  EdgeMoment(std::string edge, const LoadLaw& moment)
      : LoadTerm(moment, true), edge_(std::move(edge)) {}

  std::unique_ptr<Term> clone() const override { return std::make_unique<EdgeMoment>(*this); }
  void prepare(const Element& element, const ScaleFactors&, bool all) override {
    check(element, "moment of edge '" + edge_ + "'");
    if (!all) return;
    const std::vector<NodeVectors> nodes = element.edge(edge_);
    along_m_ = edge_ == "root" || edge_ == "free_end";
    outward_ = edge_ == "free_end" || edge_ == "side_high" ? 1 : -1;
    points_.assign(static_cast<size_t>(element.n_elements()), {});
    const GaussRule& rule = gauss(5);  // the integrand is rational where |s| varies along the edge
    ShapeTable table;
    for (size_t i = 0; i + 1 < nodes.size(); ++i) {
      const Vec2 from = nodes[i].material, along = nodes[i + 1].material - from;
      for (size_t g = 0; g < rule.points.size(); ++g) {
        const int e = element.locate(from + rule.points[g] * along, Tabulate::gradient, table);
        check_still(element, e, "moment of edge '" + edge_ + "'");
        points_[static_cast<size_t>(e)].push_back(
            {rule.weights[g] * along.norm(), table.N_m.row(0), table.N_n.row(0)});
      }
    }
  }
  void add_force(int e, const Local& x, LocalRows& force) const override {
    for (const Point& p : points_[static_cast<size_t>(e)]) {
      const Slopes s(p, x, along_m_);
      const Vec3 push = outward_ * factor() * load()[0] * p.weight / s.across.norm() * s.normal;
      force.noalias() -= (along_m_ ? p.N_m : p.N_n).transpose() * push.transpose();
    }
  }
  void add_tangent(int e, const Local& x, const Weights& w, LocalTangent& tangent) const override {
    if (w.q == 0) return;
    for (const Point& p : points_[static_cast<size_t>(e)]) {
      const Slopes s(p, x, along_m_);
      const double size = w.q * outward_ * factor() * load()[0] * p.weight, l = s.across.norm();
      const Mat3 by_normal =
          size / (s.area * l) * (Mat3::Identity() - s.normal * s.normal.transpose());
      const Mat3 by_length = size / (l * l * l) * s.normal * s.across.transpose();
      Mat3 by_m = -by_normal * skew(s.r_n), by_n = by_normal * skew(s.r_m);
      (along_m_ ? by_m : by_n) -= by_length;
      const Eigen::RowVectorXd& row = along_m_ ? p.N_m : p.N_n;
      for (Eigen::Index j = 0; j < row.size(); ++j) {
        const Mat3 column = p.N_m[j] * by_m + p.N_n[j] * by_n;
        for (Eigen::Index k = 0; k < row.size(); ++k)
          tangent.block<3, 3>(3 * k, 3 * j) -= row[k] * column;
      }
    }
  }
  // Edges of elements whose lines move are not accepted, so that free elements have no load.
  void add_eulerian_force(int, const Local&, EulerianForce&) const override {}
  void add_eulerian_tangent(int, const Local&, const Weights&, EulerianTangent&) const override {}
  std::string name() const override { return "edge moment"; }

 private:
  struct Point {
    double weight;  // length of the edge [m]
    Eigen::RowVectorXd N_m, N_n;
  };
  struct Slopes {
    Slopes(const Point& p, const Local& x, bool along_m)
        : r_m(at(p.N_m, x.q)), r_n(at(p.N_n, x.q)) {
      normal = r_m.cross(r_n);
      area = normal.norm();
      normal /= area;
      across = along_m ? r_m : r_n;
    }
    Vec3 r_m, r_n, normal, across;
    double area;
  };

  std::string edge_;
  double outward_ = 1;
  bool along_m_ = true;
  std::vector<std::vector<Point>> points_;  // per element
};

}  // namespace

std::unique_ptr<Term> make_pressure(const LoadLaw& pressure) {
  return std::make_unique<Pressure>(pressure);
}

std::unique_ptr<Term> make_edge_moment(const std::string& edge, const LoadLaw& moment) {
  return std::make_unique<EdgeMoment>(edge, moment);
}

}  // namespace flexmorph::fem
