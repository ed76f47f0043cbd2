#include "fem/rigid.h"

#include <cmath>

#include "fem/load_term.h"

namespace flexmorph::fem {
namespace {

void check(const RigidSection& s) {
  if (!(s.mass > 0) || !(s.inertia > 0) || !std::isfinite(s.mass) || !std::isfinite(s.inertia))
    throw Error::input(
        "rigid body: the mass [kg] and the mass moment of inertia [kg m²] must be positive");
  if (!s.center.allFinite()) throw Error::input("rigid body: its centre of mass is not finite");
}

void check(const Element& element, const std::string& term) {
  if (!element.is_rigid())
    throw Error::input("term '" + term + "' is only available for rigid bodies");
}

/// Returns X 1 + Y J, J a rotation by 90 degrees; it maps u to X u + Y v.
Eigen::Matrix2d arm(const Vec2& point) {
  Eigen::Matrix2d out;
  out << point.x(), -point.y(), point.y(), point.x();
  return out;
}

/// Inertia of a rigid body, T = ½ ∫ |ṙ + X u̇ + Y v̇|² dm: with c the centre of mass and J = I + m
/// |c|² about the point r,
///
///   M = [ m 1     m A ]     A = c_X 1 + c_Y (rotation by 90 degrees)
///       [ m Aᵀ    J 1 ]     since |X u̇ + Y v̇|² = (X² + Y²) |u̇|²
///
/// Source: García de Jalón & Bayo (1994), ch. 4.2.
class RigidInertia final : public Term, public LinearMeanForce<RigidInertia> {
 public:
  explicit RigidInertia(const RigidSection& s) {
    check(s);
    mass_.setZero();
    mass_.topLeftCorner<2, 2>() = s.mass * Eigen::Matrix2d::Identity();
    mass_.topRightCorner<2, 2>() = s.mass * arm(s.center);
    mass_.bottomLeftCorner<2, 2>() = s.mass * arm(s.center).transpose();
    mass_.bottomRightCorner<2, 2>() =
        (s.inertia + s.mass * s.center.squaredNorm()) * Eigen::Matrix2d::Identity();
  }

  std::unique_ptr<Term> clone() const override { return std::make_unique<RigidInertia>(*this); }
  void prepare(const Element& element, const ScaleFactors&, bool) override {
    check(element, name());
  }
  void add_force(int, const Local& x, LocalRows& force) const override {
    const Eigen::Vector4d f = mass_ * column(x.a);
    for (int i = 0; i < 4; ++i) force.data()[i] += f[i];
  }
  void add_tangent(int, const Local&, const Weights& w, LocalTangent& tangent) const override {
    tangent += w.a * mass_;
  }
  Energies energies(int, const Local& x) const override {
    return {.kinetic = 0.5 * column(x.v).dot(mass_ * column(x.v))};
  }
  Vec3 momentum(int, const Local& x) const override {
    Vec3 out = Vec3::Zero();
    out.head<2>() = mass_.topRows<2>() * column(x.v);
    return out;
  }
  std::string name() const override { return "rigid inertia"; }

 private:
  static Eigen::Vector4d column(const LocalRows& x) {
    return Eigen::Map<const Eigen::Vector4d>(x.data());
  }
  Eigen::Matrix4d mass_;
};

/// Weight of a rigid body, V = -m g · (r + c_X u + c_Y v), linear in the unknowns; constant gravity
/// only.
class RigidGravity final : public LoadTerm, public LinearMeanForce<RigidGravity> {
 public:
  RigidGravity(const RigidSection& s, const LoadLaw& gravity) : LoadTerm(gravity) {
    check(s);
    if (gravity.size() != 2)
      throw Error::input("the gravity of a planar rigid body must have 2 components");
    mass_ << s.mass * Eigen::Matrix2d::Identity(), s.mass * arm(s.center).transpose();
  }

  std::unique_ptr<Term> clone() const override { return std::make_unique<RigidGravity>(*this); }
  void prepare(const Element& element, const ScaleFactors&, bool) override {
    check(element, name());
  }
  void add_force(int, const Local&, LocalRows& force) const override {
    const Eigen::Vector4d f = weight();
    for (int i = 0; i < 4; ++i) force.data()[i] -= f[i];
  }
  void add_tangent(int, const Local&, const Weights&, LocalTangent&) const override {}
  Energies energies(int, const Local& x) const override {
    if (!has_potential()) return {};
    return {.potential = -weight().dot(Eigen::Map<const Eigen::Vector4d>(x.q.data()))};
  }
  std::string name() const override { return "rigid gravity"; }

 private:
  /// Returns the generalized force of the weight.
  Eigen::Vector4d weight() const { return factor() * (mass_ * load().head<2>()); }

  Eigen::Matrix<double, 4, 2> mass_;
};

}  // namespace

std::unique_ptr<Term> make_rigid_inertia(const RigidSection& section) {
  return std::make_unique<RigidInertia>(section);
}

std::unique_ptr<Term> make_rigid_gravity(const RigidSection& section, const LoadLaw& gravity) {
  return std::make_unique<RigidGravity>(section, gravity);
}

}  // namespace flexmorph::fem
