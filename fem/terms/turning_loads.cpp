#include <Eigen/Geometry>
#include <cmath>

#include "fem/load_term.h"
#include "fem/loads.h"

namespace flexmorph::fem {
namespace {

using Mat3 = Eigen::Matrix3d;

/// Points of one element: their weights, and the rows of their shape function tables.
struct Points {
  VectorXd weight;
  MatrixXd N, N_m, N_n;

  void add(double w, const ShapeTable& table) {
    const Eigen::Index p = weight.size(), n = table.N.cols();
    weight.conservativeResize(p + 1);
    weight[p] = w;
    for (auto [all, row] :
         {std::pair{&N, &table.N}, std::pair{&N_m, &table.N_m}, std::pair{&N_n, &table.N_n}}) {
      all->conservativeResize(p + 1, n);
      all->row(p) = row->row(0);
    }
  }
};

/// Returns Σ_k row_k q_k; the third entry is 0 in the plane.
Vec3 at(const MatrixXd& rows, Eigen::Index p, const LocalRows& q) {
  Vec3 out = Vec3::Zero();
  for (Eigen::Index k = 0; k < q.rows(); ++k)
    for (Eigen::Index c = 0; c < q.cols(); ++c) out[c] += rows(p, k) * q(k, c);
  return out;
}

/// Axes that rotate with the body at a point, and the derivatives of f = Σ f_i e_i with respect to
/// r_m and r_n:
///
///   e₁ = r_m / |r_m|,   e₃ = r_m × r_n / |r_m × r_n| (plane: z),   e₂ = e₃ × e₁
///   ∂e₁ = (1 - e₁ e₁ᵀ) ∂r_m / |r_m|,   ∂e₃ = (1 - e₃ e₃ᵀ) ∂(r_m × r_n) / |r_m × r_n|
struct Axes {
  Mat3 e;  // columns

  Axes(const Vec3& r_m, const Vec3& r_n, bool in_plane) : m(r_m), n(r_n), plane(in_plane) {
    e.col(0) = m.normalized();
    e.col(2) = plane ? Vec3(0, 0, 1) : Vec3(m.cross(n).normalized());
    e.col(1) = e.col(2).cross(e.col(0));
  }
  void slopes(const Vec3& f, Mat3& by_m, Mat3& by_n) const {
    const Mat3 one = Mat3::Identity();
    const Mat3 first = (one - e.col(0) * e.col(0).transpose()) / m.norm();
    by_m = (f[0] * one + f[1] * skew(e.col(2))) * first;
    by_n.setZero();
    if (plane) return;
    const Mat3 of_third = f[2] * one - f[1] * skew(e.col(0));
    const Mat3 third = of_third * (one - e.col(2) * e.col(2).transpose()) / m.cross(n).norm();
    by_m -= third * skew(n);
    by_n = third * skew(m);
  }

 private:
  Vec3 m, n;
  bool plane;
};

/// Forces with components along axes that rotate with the body:  δW = Σ_p w_p (Σ_i f_i e_i) · δr.
class TurningForce : public LoadTerm {
 public:
  void prepare(const Element& element, const ScaleFactors&, bool all) override {
    if (load().size() != element.dim())
      throw Error::input(name() + ": " + std::to_string(load().size()) +
                         " components are given, but the body has " +
                         std::to_string(element.dim()) + " dimensions");
    if (element.n_scalars() > 0)
      throw Error::input(name() + ": a body with free material lines is not supported");
    if (all) points_.assign(static_cast<size_t>(element.n_elements()), {});
    find(element, all);
  }
  void add_force(int e, const Local& x, LocalRows& force) const override {
    const Points& p = points_[static_cast<size_t>(e)];
    for (Eigen::Index i = 0; i < p.weight.size(); ++i) {
      const Vec3 f = factor() * p.weight[i] * (axes(p, i, x).e * entries());
      for (Eigen::Index c = 0; c < x.q.cols(); ++c) force.col(c) -= f[c] * p.N.row(i).transpose();
    }
  }
  void add_tangent(int e, const Local& x, const Weights& w, LocalTangent& tangent) const override {
    if (w.q == 0) return;
    const Points& p = points_[static_cast<size_t>(e)];
    const Eigen::Index dim = x.q.cols();
    Mat3 by_m, by_n;
    for (Eigen::Index i = 0; i < p.weight.size(); ++i) {
      axes(p, i, x).slopes(w.q * factor() * p.weight[i] * entries(), by_m, by_n);
      for (Eigen::Index l = 0; l < p.N.cols(); ++l) {
        const Mat3 column = p.N_m(i, l) * by_m + p.N_n(i, l) * by_n;
        for (Eigen::Index k = 0; k < p.N.cols(); ++k)
          for (Eigen::Index c = 0; c < dim; ++c)
            for (Eigen::Index d = 0; d < dim; ++d)
              tangent(dim * k + c, dim * l + d) -= p.N(i, k) * column(c, d);
      }
    }
  }
  std::string name() const override { return "load that follows"; }

 protected:
  explicit TurningForce(LoadLaw law) : LoadTerm(std::move(law), true) {}
  /// Writes the points of all elements, or only of elements whose lines move, to points_.
  virtual void find(const Element& element, bool all) = 0;

  void add_still(const Element& element, const Vec2& material, double weight) {
    const int e = element.locate(material, Tabulate::gradient, table_);
    if (element.moving(e))
      throw Error::input(name() + ": an element whose material lines move is not supported");
    points_[static_cast<size_t>(e)].add(weight, table_);
  }

  std::vector<Points> points_;  // per element
  ShapeTable table_;

 private:
  Vec3 entries() const { return {load()[0], load()[1], load().size() > 2 ? load()[2] : 0}; }
  static Axes axes(const Points& p, Eigen::Index i, const Local& x) {
    return {at(p.N_m, i, x.q), at(p.N_n, i, x.q), x.q.cols() == 2};
  }
};

class TurningPointForce final : public TurningForce {
 public:
  TurningPointForce(const Vec2& material, const LoadLaw& force)
      : TurningForce(force), material_(material) {}
  std::unique_ptr<Term> clone() const override {
    return std::make_unique<TurningPointForce>(*this);
  }

 private:
  void find(const Element& element, bool all) override {
    if (all) add_still(element, material_, 1);
  }
  Vec2 material_;
};

class TurningEdgeLoad final : public TurningForce {
 public:
  TurningEdgeLoad(std::string edge, const LoadLaw& load)
      : TurningForce(load), edge_(std::move(edge)) {}
  std::unique_ptr<Term> clone() const override { return std::make_unique<TurningEdgeLoad>(*this); }

 private:
  void find(const Element& element, bool all) override {
    if (!all) return;
    const std::vector<NodeVectors> nodes = element.edge(edge_);
    if (nodes.size() == 1)
      throw Error::input("load of edge '" + edge_ +
                         "': the end of a beam is one node; a point force loads it");
    const GaussRule& rule = gauss(5);  // the integrand is no polynomial where the edge is bent
    for (size_t i = 0; i + 1 < nodes.size(); ++i) {
      const Vec2 from = nodes[i].material, along = nodes[i + 1].material - from;
      for (size_t g = 0; g < rule.points.size(); ++g)
        add_still(element, from + rule.points[g] * along, rule.weights[g] * along.norm());
    }
  }
  std::string edge_;
};

class TurningSurfaceLoad final : public TurningForce {
 public:
  explicit TurningSurfaceLoad(const LoadLaw& load) : TurningForce(load) {}
  std::unique_ptr<Term> clone() const override {
    return std::make_unique<TurningSurfaceLoad>(*this);
  }

 private:
  void find(const Element& element, bool all) override {
    for (int e = 0; e < element.n_elements(); ++e) {
      if (!all && !element.moving(e)) continue;
      element.tabulate(e, kDegree, Tabulate::gradient, {}, ScaleFactorKind::none, table_);
      points_[static_cast<size_t>(e)] = {table_.weight, table_.N, table_.N_m, table_.N_n};
    }
  }
  static constexpr int kDegree = 8;  // as for a pressure
};

/// Moment in the plane at a point, acting on the line across the body there:
///
///   δW = M δθ,   θ the angle of s = r_n,   δθ = J s · δs / |s|²,   J a rotation by 90 degrees
///
/// Its potential -M θ is not used, because the state does not contain the number of turns of the
/// line.
class Moment final : public LoadTerm {
 public:
  Moment(const Vec2& material, const LoadLaw& moment)
      : LoadTerm(moment, true), material_(material) {}
  std::unique_ptr<Term> clone() const override { return std::make_unique<Moment>(*this); }
  void prepare(const Element& element, const ScaleFactors&, bool all) override {
    if (element.dim() != 2)
      throw Error::input("a moment at a point can only act on a body in the plane");
    if (element.n_scalars() > 0)
      throw Error::input("a moment cannot act on a body with free material lines");
    if (!all) return;
    element_ = element.locate(material_, Tabulate::gradient, table_);
    if (element.moving(element_))
      throw Error::input("a moment cannot act on an element whose material lines move");
  }
  void add_force(int e, const Local& x, LocalRows& force) const override {
    if (e != element_) return;
    const Vec3 s = at(table_.N_n, 0, x.q);
    const Vec2 f = factor() * load()[0] / s.squaredNorm() * Vec2(-s.y(), s.x());
    force.noalias() -= table_.N_n.row(0).transpose() * f.transpose();
  }
  void add_tangent(int e, const Local& x, const Weights& w, LocalTangent& tangent) const override {
    if (e != element_ || w.q == 0) return;
    const Vec3 s = at(table_.N_n, 0, x.q);
    const double xy = 2 * s.x() * s.y(), difference = s.y() * s.y() - s.x() * s.x();
    Eigen::Matrix2d by_s;
    by_s << xy, difference, difference, -xy;
    by_s *= w.q * factor() * load()[0] / (s.squaredNorm() * s.squaredNorm());
    for (Eigen::Index l = 0; l < table_.N_n.cols(); ++l)
      for (Eigen::Index k = 0; k < table_.N_n.cols(); ++k)
        tangent.block<2, 2>(2 * k, 2 * l) -= table_.N_n(0, k) * table_.N_n(0, l) * by_s;
  }
  std::string name() const override { return "moment"; }

 private:
  Vec2 material_;
  int element_ = -1;
  ShapeTable table_;
};

}  // namespace

std::unique_ptr<Term> make_turning_point_force(const Vec2& material, const LoadLaw& force) {
  return std::make_unique<TurningPointForce>(material, force);
}

std::unique_ptr<Term> make_turning_edge_load(const std::string& edge, const LoadLaw& load) {
  return std::make_unique<TurningEdgeLoad>(edge, load);
}

std::unique_ptr<Term> make_turning_surface_load(const LoadLaw& load) {
  return std::make_unique<TurningSurfaceLoad>(load);
}

std::unique_ptr<Term> make_moment(const Vec2& material, const LoadLaw& moment) {
  return std::make_unique<Moment>(material, moment);
}

}  // namespace flexmorph::fem
