#include <cmath>
#include <numbers>
#include <numeric>

#include "fem/body_joints.h"
#include "fem/joints/pair_joint.h"

namespace flexmorph::fem {
namespace {

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

/// See make_gear(). The angles θ of vectors in the plane are determined up to whole turns. Because
/// p and q are integers, whole turns change q Φ by multiples of 2 π, which std::remainder()
/// removes.
class Gear final : public PairJoint {
 public:
  Gear(std::string name, MarkerLocation a, MarkerLocation b, const GearData& wheels)
      : PairJoint(std::move(name), std::move(a), std::move(b),
                  {{bits({Part::kAxisA, Part::kAxisB})},
                   {{Part::kAxisA, Part::kAxisA}, {Part::kAxisB, Part::kAxisB}}}) {
    if (wheels.teeth_a < 1 || wheels.teeth_b < 1)
      throw Error::input("joint '" + this->name() + "': a wheel must have at least one tooth");
    const int common = std::gcd(wheels.teeth_a, wheels.teeth_b);
    p_ = (wheels.inner ? -1.0 : 1.0) * wheels.teeth_a / common;
    q_ = 1.0 * wheels.teeth_b / common;
    start_ = p_ * wheels.angle_a + q_ * wheels.angle_b;
  }
  std::unique_ptr<Joint> clone() const override { return std::make_unique<Gear>(*this); }

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

}  // namespace

std::unique_ptr<Joint> make_gear(std::string name, MarkerLocation a, MarkerLocation b,
                                 const GearData& wheels) {
  return std::make_unique<Gear>(std::move(name), std::move(a), std::move(b), wheels);
}

}  // namespace flexmorph::fem
