
#include "fem/force_elements/pair_force_element.h"

namespace flexmorph::fem {
namespace {

using Values = MarkerPair::Values;
constexpr auto kPosition = MarkerPair::kPositionA, kAxis = MarkerPair::kAxisA;

/// Base class of loads on one marker, constant or variable in time.
class LocationLoad : public PairForceElement, public ScaledLoad {
 public:
  void scale_load(double factor) override { factor_ = factor; }

 protected:
  LocationLoad(const std::string& name, MarkerLocation at, LoadLaw law, Eigen::Index size,
               const std::vector<Part>& parts, bool varies)
      : PairForceElement(name, std::move(at), {}, parts, varies), law_(std::move(law)) {
    if (law_.size() != size || !law_.now().allFinite())
      throw Error::input("force element '" + name +
                         "': its load is not finite, or it has a wrong number of components");
  }
  /// Returns the scaled load at time t; a torque has one entry.
  Vec2 load(double t) const {
    law_.to(t);
    const VectorXd& now = law_.now();
    return factor_ * Vec2(now[0], now.size() > 1 ? now[1] : 0);
  }
  bool is_constant() const { return !law_.varies(); }

 private:
  mutable LoadLaw law_;
  double factor_ = 1;
};

/// Force s = -F on the point; the potential is V = -F · p where F is constant.
class PointForce final : public LocationLoad, public MeanForceElement {
 public:
  PointForce(const std::string& name, MarkerLocation at, const LoadLaw& force)
      : LocationLoad(name, std::move(at), force, 2, {kPosition}, false) {}
  std::unique_ptr<ForceElement> clone() const override {
    return std::make_unique<PointForce>(*this);
  }
  void add_mean_force(const State& mean, const VectorXd&, const VectorXd&,
                      VectorXd& out) const override {
    if (pair().shifts()) refuse_mean_force(name());
    add_force(mean, out);
  }
  void add_mean_tangent(const State&, const VectorXd&, const VectorXd&, const Weights&,
                        std::vector<Eigen::Triplet<double>>&) const override {}
  Energies energies(const State& x) const override {
    if (!is_constant()) return {};
    pair().evaluate(x.t, x.q, x.v);
    return {.potential = -load(x.t).dot(pair().y().segment<2>(kPosition))};
  }

 private:
  void fill(const State& x, const Values&, const Values&, PairForce& out) const override {
    out.s.segment<2>(kPosition) = -load(x.t);
    if (is_constant()) out.conservative = out.s;
  }
};

/// Force s = -(f₁ e + f₂ J e) on the point, with e the axis of the marker and J the rotation by 90
/// degrees. The force has no potential. The length of e is one up to the residual of the
/// constraints.
class TurningForce final : public LocationLoad {
 public:
  TurningForce(const std::string& name, MarkerLocation at, const LoadLaw& force)
      : LocationLoad(name, std::move(at), force, 2, {kPosition, kAxis}, true) {}
  std::unique_ptr<ForceElement> clone() const override {
    return std::make_unique<TurningForce>(*this);
  }

 private:
  void fill(const State& x, const Values& y, const Values&, PairForce& out) const override {
    const Vec2 f = load(x.t);
    Eigen::Matrix2d by_e;
    by_e << f[0], -f[1], f[1], f[0];
    out.s.segment<2>(kPosition) = -by_e * y.segment<2>(kAxis);
    out.s_y.block<2, 2>(kPosition, kAxis) = -by_e;
  }
};

/// Generalized force s = -T θ_e on the axis, θ_e = J e / |e|². There is no energy, because the
/// state does not contain the number of whole turns of the body.
class Torque final : public LocationLoad {
 public:
  Torque(const std::string& name, MarkerLocation at, const LoadLaw& torque)
      : LocationLoad(name, std::move(at), torque, 1, {kAxis}, true) {}
  std::unique_ptr<ForceElement> clone() const override { return std::make_unique<Torque>(*this); }

 private:
  void fill(const State& at, const Values& y, const Values&, PairForce& out) const override {
    const double torque = load(at.t)[0], x = y[kAxis], z = y[kAxis + 1], square = x * x + z * z;
    out.s.segment<2>(kAxis) = -torque / square * Vec2(-z, x);
    Eigen::Matrix2d by_ee;
    by_ee << 2 * x * z, z * z - x * x, z * z - x * x, -2 * x * z;
    out.s_y.block<2, 2>(kAxis, kAxis) = -torque / (square * square) * by_ee;
  }
};

}  // namespace

std::unique_ptr<ForceElement> make_point_force(const std::string& name, MarkerLocation at,
                                               const LoadLaw& force, bool turns) {
  if (turns) return std::make_unique<TurningForce>(name, std::move(at), force);
  return std::make_unique<PointForce>(name, std::move(at), force);
}

std::unique_ptr<ForceElement> make_torque(const std::string& name, MarkerLocation at,
                                          const LoadLaw& torque) {
  return std::make_unique<Torque>(name, std::move(at), torque);
}

}  // namespace flexmorph::fem
