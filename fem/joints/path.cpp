#include <algorithm>
#include <cmath>

#include "fem/body_joints.h"
#include "fem/joints/pair_joint.h"
#include "geometry/text.h"

namespace flexmorph::fem {
namespace {

/// See make_path(). The foot c(s) of the point p = (e_a · d, n_a · d), d = p_b - p_a, is no
/// unknown. With the unit tangent τ = c'/|c'|, n = τ turned by +90 degrees and the curvature κ = n
/// · c''/|c'|²,
///
///   Φ = n · (p - c),   Φ_p = n,   Φ_pp = -κ/(1 - κ Φ) τ τᵀ
class Path final : public PairJoint {
 public:
  Path(std::string name, MarkerLocation a, MarkerLocation b, PlaneCurve curve)
      : PairJoint(std::move(name), std::move(a), std::move(b),
                  {{bits({Part::kPositionA, Part::kAxisA, Part::kPositionB})},
                   {{Part::kPositionA, Part::kPositionA},
                    {Part::kPositionA, Part::kAxisA},
                    {Part::kPositionA, Part::kPositionB},
                    {Part::kAxisA, Part::kAxisA},
                    {Part::kAxisA, Part::kPositionB},
                    {Part::kPositionB, Part::kPositionB}}}),
        curve_(std::move(curve)) {}
  std::unique_ptr<Joint> clone() const override { return std::make_unique<Path>(*this); }

 private:
  void fill(double t, const Values& y, std::vector<PairRow>& rows) const override {
    const Vec2 e = y.segment<2>(Part::kAxisA),
               d = y.segment<2>(Part::kPositionB) - y.segment<2>(Part::kPositionA);
    const Vec2 p(e.dot(d), e.x() * d.y() - e.y() * d.x());
    const double s = curve_.nearest(p);
    check_end(t, s);
    const PlaneCurve::At c = curve_.at(s);
    const Vec2 tau = c.c_s.normalized(), n(-tau.y(), tau.x());
    const double kappa = n.dot(c.c_ss) / c.c_s.squaredNorm();

    // Jacobian p_y, with blocks for e_a and d.
    Eigen::Matrix<double, 2, 8> p_y = Eigen::Matrix<double, 2, 8>::Zero();
    Eigen::Matrix2d by_d, by_e;
    by_d << e.x(), e.y(), -e.y(), e.x();
    by_e << d.x(), d.y(), d.y(), -d.x();
    p_y.block<2, 2>(0, Part::kAxisA) = by_e;
    p_y.block<2, 2>(0, Part::kPositionB) = by_d;
    p_y.block<2, 2>(0, Part::kPositionA) = -by_d;
    // n · p = e · (N d) with N = n₁ 1 + n₂ J, where e · (J d) = e × d; N is the mixed derivative.
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

  /// Returns x with |x| >= 0.1. The factor 1 - κ Φ vanishes at the centre of curvature, which no
  /// motion comes near, but an iterate of Newton's method may.
  static double bounded(double x) { return std::copysign(std::max(std::abs(x), 0.1), x); }

  /// The limits have a tolerance of 5 %, because an iterate of Newton's method may lie beyond the
  /// end.
  void check_end(double t, double s) const {
    const double until = curve_.until();
    if (curve_.is_closed() || (s > -0.05 * until && s < 1.05 * until)) return;
    const std::string where = formatted(
        "': at t = %.6g s its point is beyond an end of its curve; the parameter is %.6g, but it "
        "lies between 0 and %.6g",
        t, s, until);
    throw Error::numerical("joint '" + name() + where);
  }

  PlaneCurve curve_;
};

}  // namespace

std::unique_ptr<Joint> make_path(std::string name, MarkerLocation a, MarkerLocation b,
                                 PlaneCurve curve) {
  return std::make_unique<Path>(std::move(name), std::move(a), std::move(b), std::move(curve));
}

}  // namespace flexmorph::fem
