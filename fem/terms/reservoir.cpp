#include <cmath>

#include "fem/load_term.h"
#include "fem/material_reservoir.h"
#include "fem/reservoir_matrices.h"

namespace flexmorph::fem {

void check(const MaterialReservoir& s) {
  if (!s.outlet.allFinite() || !s.at.allFinite() || !std::isfinite(s.angle))
    throw Error::input("material reservoir: a location is not finite");
  if (!(s.width > 0) || !(s.area_density > 0))
    throw Error::input("material reservoir: width [m] and density [kg/m²] must be positive");
}

Eigen::Matrix2d arm_of(const Vec2& point) {
  Eigen::Matrix2d out;
  out << point.x(), -point.y(), point.y(), point.x();
  return out;
}

Vec2 axis_of(const MaterialReservoir& s) { return {std::cos(s.angle), std::sin(s.angle)}; }

Eigen::Matrix4d mass_matrix(double mass, const Vec2& center, double square) {
  const Eigen::Matrix2d one = Eigen::Matrix2d::Identity(), arm = arm_of(center);
  Eigen::Matrix4d out;
  out << mass * one, mass * arm, mass * arm.transpose(), square * one;
  return out;
}

Eigen::Matrix4d sliding_matrix(double mass, const Vec2& center, const MaterialReservoir& s) {
  Eigen::Matrix4d out = Eigen::Matrix4d::Zero();
  if (s.kind == MaterialReservoir::Kind::coil) return out;
  const Eigen::Matrix2d along = arm_of(axis_of(s));
  out.topRightCorner<2, 2>() = mass * along;
  out.bottomRightCorner<2, 2>() = mass * arm_of(center).transpose() * along;
  return out;
}

Eigen::Matrix4d mass_across(const MaterialReservoir& s, const Vec2& middle) {
  const double mass = s.area_density * s.width;
  return mass_matrix(mass, middle, mass * (middle.squaredNorm() + s.width * s.width / 12));
}

ReservoirState reservoir_at(const MaterialReservoir& s, double t) {
  const double length = s.length(t).value;
  ReservoirState out{s.area_density * s.width * length, 0, s.at};
  double square = s.width * s.width;
  if (s.kind == MaterialReservoir::Kind::rod) {
    out.center -= 0.5 * length * axis_of(s);
    square += length * length;
  }
  out.inertia = out.mass * square / 12;
  return out;
}

namespace {

using Column4 = Eigen::Vector4d;

Column4 column(const LocalRows& x) { return Eigen::Map<const Column4>(x.data()); }

double time_of(const Element& element, const std::string& term) {
  const auto* body = dynamic_cast<const RigidClock*>(&element);
  if (!body || !element.moving(0))
    throw Error::input("term '" + term +
                       "' is only available for rigid bodies with a material reservoir");
  return body->time();
}

class ReservoirInertia final : public Term,
                               public LinearMeanForce<ReservoirInertia>,
                               public FlowTerm {
 public:
  explicit ReservoirInertia(const MaterialReservoir& s)
      : reservoirs_(s), leaving_(mass_across(s, s.at)) {
    check(s);
    across_ = sliding_matrix(s.area_density * s.width, s.at, s);
  }

  std::unique_ptr<Term> clone() const override { return std::make_unique<ReservoirInertia>(*this); }
  void prepare(const Element& element, const ScaleFactors&, bool) override {
    const double t = time_of(element, name());
    const ReservoirState now = reservoir_at(reservoirs_, t);
    const Motion length = reservoirs_.length(t);
    speed_ = -length.rate;
    acceleration_ = -length.acceleration;
    line_ = now.mass;
    mass_ = mass_matrix(now.mass, now.center, now.inertia + now.mass * now.center.squaredNorm());
    slide_ = sliding_matrix(now.mass, now.center, reservoirs_);
  }
  void add_force(int, const Local& x, LocalRows& force) const override {
    const Column4 f = force_of(x);
    for (int i = 0; i < 4; ++i) force.data()[i] += f[i];
  }
  void add_tangent(int, const Local&, const Weights& w, LocalTangent& tangent) const override {
    tangent += w.a * mass_ + (2 * w.v * speed_ + w.q * acceleration_) * slide_;
  }

  /// Returns T = ½ ∫ ρc |N q̇ + s D q|² dA.
  Energies energies(int, const Local& x) const override {
    return {.kinetic = energy(x, mass_, slide_, line_)};
  }
  Vec3 momentum(int, const Local& x) const override {
    Vec3 out = Vec3::Zero();
    out.head<2>() = (mass_ * column(x.v) + speed_ * slide_ * column(x.q)).head<2>();
    return out;
  }
  /// Returns ∫ ρc s D q · r̈ dA - ½ ρc s ∫ |ṙ|² dy, the last integral over the line where material
  /// leaves the reservoir.
  double flow_power(int, const Local& x) const override {
    double out =
        -speed_ * energy(x, leaving_, across_, reservoirs_.area_density * reservoirs_.width);
    if (reservoirs_.kind == MaterialReservoir::Kind::rod) {
      const Vec2 along = arm_of(axis_of(reservoirs_)) * column(x.q).tail<2>();
      out += speed_ * along.dot(force_of(x).head<2>());
    }
    return out;
  }
  std::string name() const override { return "stored inertia"; }

 private:
  Column4 force_of(const Local& x) const {
    return mass_ * column(x.a) + slide_ * (2 * speed_ * column(x.v) + acceleration_ * column(x.q));
  }
  double energy(const Local& x, const Eigen::Matrix4d& mass, const Eigen::Matrix4d& slide,
                double amount) const {
    const Column4 q = column(x.q), v = column(x.v);
    double out = 0.5 * v.dot(mass * v) + speed_ * v.dot(slide * q);
    if (reservoirs_.kind == MaterialReservoir::Kind::rod)
      out += 0.5 * amount * speed_ * speed_ * q.tail<2>().squaredNorm();
    return out;
  }

  MaterialReservoir reservoirs_;
  Eigen::Matrix4d leaving_, across_;  // M and B per unit length of the leaving material
  double speed_ = 0, acceleration_ = 0, line_ = 0;
  Eigen::Matrix4d mass_, slide_;
};

/// Weight of the material reservoir, V = -m g · (r + c_X u + c_Y v), m and c the present mass and
/// centre of the stored material.
class ReservoirWeight final : public LoadTerm,
                              public LinearMeanForce<ReservoirWeight>,
                              public FlowTerm {
 public:
  ReservoirWeight(const MaterialReservoir& s, const LoadLaw& gravity)
      : LoadTerm(gravity), reservoirs_(s) {
    check(s);
    if (gravity.size() != 2)
      throw Error::input("the gravity of a material reservoir must have 2 components");
  }

  std::unique_ptr<Term> clone() const override { return std::make_unique<ReservoirWeight>(*this); }
  void prepare(const Element& element, const ScaleFactors&, bool) override {
    const double t = time_of(element, name());
    const ReservoirState now = reservoir_at(reservoirs_, t);
    const Motion length = reservoirs_.length(t);
    const double line = reservoirs_.area_density * reservoirs_.width;
    Vec2 leaves = reservoirs_.at;  // d(ℓ c)/dℓ: position of the end at which the reservoir shortens
    if (reservoirs_.kind == MaterialReservoir::Kind::rod)
      leaves -= length.value * axis_of(reservoirs_);
    by_ << now.mass * Eigen::Matrix2d::Identity(), now.mass * arm_of(now.center).transpose();
    rate_ << Eigen::Matrix2d::Identity(), arm_of(leaves).transpose();
    rate_ *= line * length.rate;
  }
  void add_force(int, const Local&, LocalRows& force) const override {
    const Column4 f = factor() * (by_ * load().head<2>());
    for (int i = 0; i < 4; ++i) force.data()[i] -= f[i];
  }
  void add_tangent(int, const Local&, const Weights&, LocalTangent&) const override {}
  Energies energies(int, const Local& x) const override {
    if (!has_potential()) return {};
    return {.potential = -factor() * (by_ * load().head<2>()).dot(column(x.q))};
  }
  /// Returns ∂V/∂t at constant unknowns.
  double flow_power(int, const Local& x) const override {
    if (!has_potential()) return 0;
    return -factor() * (rate_ * load().head<2>()).dot(column(x.q));
  }
  std::string name() const override { return "stored weight"; }

 private:
  MaterialReservoir reservoirs_;
  Eigen::Matrix<double, 4, 2> by_, rate_;  // ∫ρc Nᵀ dA and its rate
};

}  // namespace

std::unique_ptr<Term> make_reservoir_inertia(const MaterialReservoir& reservoirs) {
  return std::make_unique<ReservoirInertia>(reservoirs);
}

std::unique_ptr<Term> make_reservoir_weight(const MaterialReservoir& reservoirs,
                                            const LoadLaw& gravity) {
  return std::make_unique<ReservoirWeight>(reservoirs, gravity);
}

}  // namespace flexmorph::fem
