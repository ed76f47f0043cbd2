#include "fem/bushing.h"

#include <cmath>

#include "fem/force_elements/pair_coordinate.h"

namespace flexmorph::fem {
namespace {

class Bushing final : public PairForceElement, public TurningForceElement {
 public:
  Bushing(const std::string& name, MarkerLocation a, MarkerLocation b, const BushingData& data)
      : PairForceElement(name, std::move(a), std::move(b), parts(data), true), data_(data) {
    const double numbers[] = {data.stiffness.x(), data.stiffness.y(),     data.damping.x(),
                              data.damping.y(),   data.torsion_stiffness, data.torsion_damping};
    double sum = 0;
    for (const double x : numbers) {
      if (!(x >= 0) || !std::isfinite(x))
        throw Error::input("force element '" + name + "': a stiffness or damping is " +
                           std::to_string(x) + "; it must be finite and not negative");
      sum += x;
    }
    if (sum == 0 || !std::isfinite(data.rest_angle))
      throw Error::input("force element '" + name +
                         "': all stiffnesses and dampings are 0, or a number is not finite");
  }

  std::unique_ptr<ForceElement> clone() const override { return std::make_unique<Bushing>(*this); }
  bool counts_turns() const override { return turns(data_); }
  double turned(const State& x) const override {
    pair().evaluate(x.t, x.q, x.v);
    return angle_between(pair().y(), last(x)).z;
  }
  Energies energies(const State& x) const override {
    pair().evaluate(x.t, x.q, x.v);
    Energies out;
    for (int i = 0; i < 2; ++i) {
      const double d = coordinate_along(pair().y(), i).z;
      out.strain += 0.5 * data_.stiffness[i] * d * d;
    }
    if (!turns(data_)) return out;
    const double phi = angle_between(pair().y(), last(x)).z - data_.rest_angle;
    out.strain += 0.5 * data_.torsion_stiffness * phi * phi;
    return out;
  }

 private:
  static bool turns(const BushingData& d) {
    return d.torsion_stiffness > 0 || d.torsion_damping > 0;
  }
  static std::vector<Part> parts(const BushingData& d) {
    std::vector<Part> out = {Part::kPositionA, Part::kAxisA, Part::kPositionB};
    if (turns(d)) out.push_back(Part::kAxisB);
    return out;
  }
  double last(const State& x) const {
    return location() < x.turned.size() ? x.turned[location()]
                                        : data_.start_angle.value_or(data_.rest_angle);
  }

  /// Adds the force N = k (z - z₀) + c ż along a coordinate.
  static void add_linear(const PairCoordinate& along, double rest, double k, double c,
                         const Values& rate, PairForce& out) {
    const double pull = k * (along.z - rest);
    add_along(along, rate, {pull, pull + c * along.z_y.dot(rate), k, c}, out);
  }

  void fill(const State& x, const Values& y, const Values& rate, PairForce& out) const override {
    for (int i = 0; i < 2; ++i)
      add_linear(coordinate_along(y, i), 0, data_.stiffness[i], data_.damping[i], rate, out);
    if (turns(data_))
      add_linear(angle_between(y, last(x)), data_.rest_angle, data_.torsion_stiffness,
                 data_.torsion_damping, rate, out);
  }

  BushingData data_;
};

}  // namespace

std::unique_ptr<ForceElement> make_bushing(std::string name, MarkerLocation a, MarkerLocation b,
                                           const BushingData& bushing) {
  return std::make_unique<Bushing>(std::move(name), std::move(a), std::move(b), bushing);
}

}  // namespace flexmorph::fem
