#include <algorithm>
#include <cmath>
#include <limits>

#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"
#include "fem/joints/pair_joint.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using fem::PairRow;

using Coordinate = std::function<fem::Motion(double)>;

/// A curve c(s) in the plane, 0 <= s <= until [m], with c' and c''; closed where both ends agree.
/// Points and tangents of kParts + 1 parameters are kept, to begin a search from.
class Curve {
 public:
  static constexpr int kParts = 512;
  struct At {
    Vec2 c, c_s, c_ss;
  };

  Curve(Coordinate x, Coordinate y, double until)
      : x_(std::move(x)), y_(std::move(y)), until_(until) {
    for (int i = 0; i <= kParts; ++i) samples_.push_back(at(until_ * i / kParts).c);
    const At first = at(0), last = at(until_);
    closed_ = (first.c - last.c).norm() <= 1e-6 * length() &&
              (first.c_s - last.c_s).norm() <= 1e-4 * first.c_s.norm();
  }

  At at(double s) const {
    const fem::Motion x = x_(s), y = y_(s);
    return {{x.value, y.value}, {x.rate, y.rate}, {x.acceleration, y.acceleration}};
  }
  double until() const { return until_; }
  bool closed() const { return closed_; }
  double length() const {
    double out = 0;
    for (size_t i = 0; i < kParts; ++i) out += (samples_[i + 1] - samples_[i]).norm();
    return out;
  }

  /// A parameter without a direction, or where the direction turns by more than a quarter from one
  /// kept point to the next: a corner; -1 where there is none.
  double corner() const {
    Vec2 before(0, 0);
    for (int i = 0; i <= kParts; ++i) {
      const Vec2 c_s = at(until_ * i / kParts).c_s;
      if (!(c_s.norm() > 1e-9 * length() / until_) || (i > 0 && c_s.dot(before) <= 0))
        return until_ * i / kParts;
      before = c_s;
    }
    return -1;
  }

  /// Do two of its chords cross, or meet?
  bool crosses_itself() const {
    // Do x and y lie on one side of the line through a and b? Round-off is no side.
    const auto aside = [](const Vec2& a, const Vec2& b, const Vec2& x, const Vec2& y) {
      const Vec2 n(a.y() - b.y(), b.x() - a.x());
      const double slack = 1e-9 * n.squaredNorm(), u = n.dot(x - a), v = n.dot(y - a);
      return (u > slack && v > slack) || (u < -slack && v < -slack);
    };
    for (size_t i = 0; i < kParts; ++i)
      for (size_t j = i + 2; j < kParts; ++j) {
        if (closed_ && i == 0 && j == kParts - 1) continue;  // neighbours
        const Vec2 &a = samples_[i], &b = samples_[i + 1], &c = samples_[j], &d = samples_[j + 1];
        const double near = 0.5 * ((b - a).norm() + (d - c).norm());
        if ((0.5 * (a + b - c - d)).norm() > near) continue;  // also along a straight line
        if (!aside(a, b, c, d) && !aside(c, d, a, b)) return true;
      }
    return false;
  }

  /// The parameter of the point of the curve that is next to p, by Newton's method for
  /// (p - c) · c' = 0 from the next kept point: a function of p alone, whatever came before.
  double nearest(const Vec2& p) const {
    size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i <= kParts; ++i)
      if (const double d = (samples_[i] - p).squaredNorm(); d < least) least = d, best = i;
    const double part = until_ / kParts;
    double s = part * static_cast<double>(best);
    for (int k = 0; k < 50; ++k) {
      const At c = at(inside(s));
      const double square = c.c_s.squaredNorm();
      // Where p is beyond the centre of curvature the slope of Gauss and Newton goes downhill.
      const double slope = std::max(square - (p - c.c).dot(c.c_ss), 0.1 * square);
      const double step = std::clamp((p - c.c).dot(c.c_s) / slope, -2 * part, 2 * part);
      s += step;
      if (std::abs(step) < 1e-15 * until_) break;
    }
    return inside(s);
  }

 private:
  /// Around a closed curve; beyond its ends an open one goes on (see Drive).
  double inside(double s) const { return closed_ ? s - until_ * std::floor(s / until_) : s; }

  Coordinate x_, y_;
  double until_;
  bool closed_ = false;
  std::vector<Vec2> samples_;
};

/// The point of b, p = (e_a · d, n_a · d) in the axes of a with d = p_b - p_a, lies on a curve c(s)
/// there: Φ = signed distance of p from it, 1 row [m]. With s where c is next to p, unit tangent
/// τ = c'/|c'|, n = τ turned by +90 degrees and the curvature κ = n · c''/|c'|²,
///
///   Φ = n · (p - c),   Φ_p = n,   Φ_pp = -κ/(1 - κ Φ) τ τᵀ
///
/// so that s is no unknown. The multiplier is the force [N] across the curve on b, with the sign
/// turned: no friction.
class Path final : public fem::PairJoint {
 public:
  Path(const std::string& name, const fem::MarkerPlace& a, const fem::MarkerPlace& b, Curve curve)
      : PairJoint(name, a, b,
                  {{bits({Part::kPositionA, Part::kAxisA, Part::kPositionB})},
                   {{Part::kPositionA, Part::kPositionA},
                    {Part::kPositionA, Part::kAxisA},
                    {Part::kPositionA, Part::kPositionB},
                    {Part::kAxisA, Part::kAxisA},
                    {Part::kAxisA, Part::kPositionB},
                    {Part::kPositionB, Part::kPositionB}}}),
        curve_(std::move(curve)) {}
  std::unique_ptr<fem::Joint> clone() const override { return std::make_unique<Path>(*this); }

 private:
  void fill(double t, const Values& y, std::vector<PairRow>& rows) const override {
    const Vec2 e = y.segment<2>(Part::kAxisA),
               d = y.segment<2>(Part::kPositionB) - y.segment<2>(Part::kPositionA);
    const Vec2 p(e.dot(d), e.x() * d.y() - e.y() * d.x());
    const double s = curve_.nearest(p);
    check_end(t, s);
    const Curve::At c = curve_.at(s);
    const Vec2 tau = c.c_s.normalized(), n(-tau.y(), tau.x());
    const double kappa = n.dot(c.c_ss) / c.c_s.squaredNorm();

    // p_y: rows of e, d.
    Eigen::Matrix<double, 2, 8> p_y = Eigen::Matrix<double, 2, 8>::Zero();
    Eigen::Matrix2d by_d, by_e;
    by_d << e.x(), e.y(), -e.y(), e.x();
    by_e << d.x(), d.y(), d.y(), -d.x();
    p_y.block<2, 2>(0, Part::kAxisA) = by_e;
    p_y.block<2, 2>(0, Part::kPositionB) = by_d;
    p_y.block<2, 2>(0, Part::kPositionA) = -by_d;
    // n · p is e · (N d), N = n₁ + n₂ (e × d).
    Eigen::Matrix2d mixed;
    mixed << n.x(), n.y(), -n.y(), n.x();

    PairRow& row = rows[0];
    row.f = n.dot(p - c.c);
    row.f_y = p_y.transpose() * n;
    const Values along = p_y.transpose() * tau;
    row.f_yy = -kappa / bounded(1 - kappa * row.f) * along * along.transpose();
    row.f_yy.block<2, 2>(Part::kAxisA, Part::kPositionB) += mixed;
    row.f_yy.block<2, 2>(Part::kPositionB, Part::kAxisA) += mixed.transpose();
    row.f_yy.block<2, 2>(Part::kAxisA, Part::kPositionA) -= mixed;
    row.f_yy.block<2, 2>(Part::kPositionA, Part::kAxisA) -= mixed.transpose();
  }

  /// Zero at the centre of curvature, which no motion is near to; a guess may be.
  static double bounded(double x) { return std::copysign(std::max(std::abs(x), 0.1), x); }

  /// Newton's method may go a little farther than the motion.
  void check_end(double t, double s) const {
    if (curve_.closed() || (s > -0.05 * curve_.until() && s < 1.05 * curve_.until())) return;
    throw Error::numerical("joint '" + name() + "': at t = " + io::to_text(t, 6) +
                           " s its point is beyond an end of its curve, at parameter " +
                           io::to_text(s, 6) + " of 0 to " + io::to_text(curve_.until(), 6));
  }

  Curve curve_;
};

const io::Key& coordinate_key(const char* name) {
  return io::key("joint", name)
      .name_of("a drive")
      .when("path")
      .says("Of the curve, in the axes of `a` around `point_a`: a drive with `until`.");
}
const io::Key &kX = coordinate_key("x"), &kY = coordinate_key("y");

const Drive& read_coordinate(const io::Table& t, const io::Key& key, const Scene& scene) {
  const std::string name = t.choice(key, names_of(scene.drives));
  const Drive& drive = *std::find_if(scene.drives.begin(), scene.drives.end(),
                                     [&](const Drive& d) { return d.name == name; });
  if (!drive.until)
    t.fail(key, "the drive '" + name + "' is one of time: a coordinate of a curve says `until`");
  if (!drive.jump.empty()) t.fail(key, "of the drive '" + name + "', " + drive.jump);
  return drive;
}

Curve read_curve(const io::Table& t, const Scene& scene) {
  const Drive &x = read_coordinate(t, kX, scene), &y = read_coordinate(t, kY, scene);
  if (*x.until != *y.until)
    t.fail(kY, "its parameter ends at " + io::to_text(*y.until) + ", that of `x` at " +
                   io::to_text(*x.until));
  Curve curve(x.motion, y.motion, *x.until);
  if (const double s = curve.corner(); s >= 0)
    t.fail(kX, "the curve has no direction, or a corner, at parameter " + io::to_text(s, 4));
  if (curve.crosses_itself()) t.fail(kX, "the curve crosses itself");
  return curve;
}

void read(const io::Table& t, const Scene& scene, Joint& joint) {
  joint.a = read_anchor(t, kAnchorA, scene, true, true);
  joint.b = read_anchor(t, kAnchorB, scene, true, false);
  joint.a.given = joint.b.given = true;  // on the ground [0, 0]
  if (joint.a.on_ground() && joint.b.on_ground())
    t.fail(
        "a body is missing: `a` carries the curve, `b` the point; one of them may be the ground");
  if (joint.a.body == joint.b.body) t.fail(kAnchorB.body, "a joint is between two bodies");
  joint.own = read_curve(t, scene);
  name_between(t, scene, joint);
}

std::unique_ptr<fem::Joint> make(const Joint& joint, const JointParts& parts) {
  return std::make_unique<Path>(joint.name, parts.a, parts.b,
                                std::any_cast<const Curve&>(joint.own));
}

}  // namespace

extern const JointRow kPath;
const JointRow kPath = {.name = "path",
                        .sentence = "Point b runs along a curve on a: a cam, a slot, a rail.",
                        .read = read,
                        .make = make};

}  // namespace flexmorph::cases
