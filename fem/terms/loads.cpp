#include "fem/term.h"

namespace flexmorph::fem {
namespace {

/// Weight of a body: f = -∫ ρh N dA gᵀ, potential V = -∫ ρh g·r dA.
class Gravity final : public Term {
 public:
  Gravity(const PlaneSection& s, VectorXd gravity)
      : area_density_(s.density * s.thickness), gravity_(std::move(gravity)) {}

  void prepare(const Element& element, const Factors& factors, bool all) override {
    mass_.resize(static_cast<size_t>(element.n_elements()));
    rate_.resize(mass_.size());
    ShapeTable table;
    for (int e = 0; e < element.n_elements(); ++e) {
      if (!all && !element.moving(e)) continue;
      element.tabulate(e, 3, Tabulate::position_rates, factors, FactorKind::mass, table);
      mass_[static_cast<size_t>(e)] = area_density_ * table.N.transpose() * table.weight;
      rate_[static_cast<size_t>(e)] =
          element.moving(e) ? VectorXd(area_density_ * table.N_t.transpose() * table.weight)
                            : VectorXd();
    }
  }
  void add_force(int e, const Local&, LocalRows& force) const override {
    force.noalias() -= mass_[static_cast<size_t>(e)] * gravity_.transpose();
  }
  void add_tangent(int, const Local&, const Weights&, LocalTangent&) const override {}
  double potential_energy(int e, const Local& x) const override {
    return -mass_[static_cast<size_t>(e)].dot(x.q * gravity_);
  }
  double flow_power(int e, const Local& x) const override {
    return -rate_[static_cast<size_t>(e)].dot(x.q * gravity_);
  }

 private:
  double area_density_;
  VectorXd gravity_;
  std::vector<VectorXd> mass_, rate_;  // ∫ρh N, ∫ρh Ṅ per element (n_shapes)
};

/// Mass at a material point: f = m N (r̈ - g)ᵀ with r̈ as in the inertia of the body.
class PointMass final : public Term {
 public:
  PointMass(double mass, const Vec2& material, VectorXd gravity)
      : mass_(mass), material_(material), gravity_(std::move(gravity)) {}

  void prepare(const Element& element, const Factors&, bool) override {
    element_ = element.locate(material_, Tabulate::position_rates, table_);
    flows_ = table_.N_t.size() > 0;
  }
  void add_force(int e, const Local& x, LocalRows& force) const override {
    if (e != element_) return;
    force.noalias() += mass_ * table_.N.transpose() * felt_acceleration(x);
  }
  void add_tangent(int e, const Local& x, const Weights& w, LocalTangent& tangent) const override {
    if (e != element_) return;
    Eigen::RowVectorXd row = w.a * table_.N;
    if (flows_) row += 2 * w.v * table_.N_t + w.q * table_.N_tt;
    const auto d = x.q.cols();
    for (Eigen::Index k = 0; k < row.size(); ++k)
      for (Eigen::Index l = 0; l < row.size(); ++l)
        for (Eigen::Index c = 0; c < d; ++c)
          tangent(d * k + c, d * l + c) += mass_ * table_.N(0, k) * row[l];
  }
  double kinetic_energy(int e, const Local& x) const override {
    if (e != element_) return 0;
    Eigen::RowVectorXd velocity = table_.N * x.v;
    if (flows_) velocity += table_.N_t * x.q;
    return 0.5 * mass_ * velocity.squaredNorm();
  }
  double potential_energy(int e, const Local& x) const override {
    if (e != element_ || gravity_.size() == 0) return 0;
    return -mass_ * (table_.N * x.q * gravity_)(0);
  }
  double flow_power(int e, const Local& x) const override {
    if (e != element_ || !flows_) return 0;
    return mass_ * (table_.N_t * x.q * felt_acceleration(x).transpose())(0);
  }

 private:
  Eigen::RowVectorXd felt_acceleration(const Local& x) const {
    Eigen::RowVectorXd out = table_.N * x.a;
    if (flows_) out += 2 * table_.N_t * x.v + table_.N_tt * x.q;
    if (gravity_.size() > 0) out -= gravity_.transpose();
    return out;
  }

  double mass_;
  Vec2 material_;
  VectorXd gravity_;
  int element_ = -1;
  bool flows_ = false;
  ShapeTable table_;
};

}  // namespace

std::unique_ptr<Term> make_gravity(const PlaneSection& section, const VectorXd& gravity) {
  return std::make_unique<Gravity>(section, gravity);
}

std::unique_ptr<Term> make_point_mass(double mass, const Vec2& material, const VectorXd& gravity) {
  return std::make_unique<PointMass>(mass, material, gravity);
}

}  // namespace flexmorph::fem
