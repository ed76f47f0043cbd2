#include <cmath>
#include <numbers>
#include <numeric>

#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"
#include "fem/joints/pair_joint.h"

namespace flexmorph::cases {
namespace {

using fem::PairRow;

/// The angle of a vector e, atan2(e_y, e_x), with its derivatives by e.
struct AngleOf {
  double value;
  Vec2 gradient;
  Eigen::Matrix2d hessian;

  explicit AngleOf(const Vec2& e) : value(std::atan2(e.y(), e.x())) {
    const double r2 = e.squaredNorm();
    gradient = Vec2(-e.y(), e.x()) / r2;
    const double twice_xy = 2 * e.x() * e.y(), difference = e.y() * e.y() - e.x() * e.x();
    hessian << twice_xy, difference, difference, -twice_xy;
    hessian /= r2 * r2;
  }
};

struct Wheels {
  int teeth_a = 1, teeth_b = 1;
  bool inner = false;  ///< one of them has its teeth inside: both turn the same way
};

/// Two wheels that roll on each other without slip: with n_a, n_b teeth, p/q = n_a/n_b in lowest
/// terms and s = 1 for outer, -1 for inner gearing,
///
///   Φ = [s p (θ_a - θ_a0) + q (θ_b - θ_b0)] / q, 1 row [rad]
///
/// Its multiplier is the moment [N m] on b, with the sign turned. θ are the angles of vectors in
/// the plane, known but for whole turns; p and q being whole numbers, turns change q Φ by multiples
/// of 2 π, which are taken off. Other roots, 2 π/q away, are other teeth: a motion cannot reach
/// them.
class Gear final : public fem::PairJoint {
 public:
  Gear(const cases::Joint& joint, const JointParts& parts)
      : PairJoint(joint.name, parts.a, parts.b,
                  {{bits({Part::kAxisA, Part::kAxisB})},
                   {{Part::kAxisA, Part::kAxisA}, {Part::kAxisB, Part::kAxisB}}}) {
    const auto& wheels = std::any_cast<const Wheels&>(joint.own);
    const int common = std::gcd(wheels.teeth_a, wheels.teeth_b);
    p_ = (wheels.inner ? -1.0 : 1.0) * wheels.teeth_a / common;
    q_ = 1.0 * wheels.teeth_b / common;
    start_ = p_ * parts.angle_a + q_ * parts.angle_b;
  }
  std::unique_ptr<fem::Joint> clone() const override { return std::make_unique<Gear>(*this); }

 private:
  void fill(double, const Values& y, std::vector<PairRow>& rows) const override {
    const AngleOf a(y.segment<2>(Part::kAxisA)), b(y.segment<2>(Part::kAxisB));
    PairRow& row = rows[0];
    row.f = std::remainder(p_ * a.value + q_ * b.value - start_, 2 * std::numbers::pi) / q_;
    row.f_y.segment<2>(Part::kAxisA) = p_ / q_ * a.gradient;
    row.f_y.segment<2>(Part::kAxisB) = b.gradient;
    row.f_yy.block<2, 2>(Part::kAxisA, Part::kAxisA) = p_ / q_ * a.hessian;
    row.f_yy.block<2, 2>(Part::kAxisB, Part::kAxisB) = b.hessian;
  }

  double p_, q_, start_;
};

const io::Key& kTeeth = io::key("joint", "teeth")
                            .integers("a number of teeth", 1, 10'000, 2, 2)
                            .when("gear")
                            .says("Of the wheels of `a` and of `b`.");
const io::Key& kInner = io::key("joint", "inner")
                            .boolean()
                            .otherwise(false)
                            .when("gear")
                            .says("One wheel has its teeth inside: both turn the same way.");

void read(const io::Table& t, const Scene& scene, Joint& joint) {
  read_anchors(t, scene, false, true, joint.a, joint.b);
  if (joint.a.on_ground() || joint.b.on_ground())
    t.fail("a gear has two rigid bodies, `a` and `b`; their axles are joints of their own");
  const std::vector<int> teeth = t.integers(kTeeth);
  joint.own = Wheels{teeth[0], teeth[1], t.boolean(kInner)};
  name_between(t, scene, joint);
}

std::unique_ptr<fem::Joint> make(const Joint& joint, const JointParts& parts) {
  return std::make_unique<Gear>(joint, parts);
}

}  // namespace

extern const JointRow kGear;
const JointRow kGear = {.name = "gear",
                        .sentence =
                            "Two rigid bodies turn as wheels that roll on each other: "
                            "their rates are as the numbers of teeth.",
                        .read = read,
                        .make = make,
                        .has_force = false,
                        .has_moment = true};

}  // namespace flexmorph::cases
