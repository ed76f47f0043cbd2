#include "fem/stop.h"

#include <cmath>

#include "fem/force_elements/pair_coordinate.h"

namespace flexmorph::fem {
namespace {

using Coordinate = StopData::Coordinate;

class UnilateralStop final : public PairForceElement, public TurningForceElement {
 public:
  UnilateralStop(const std::string& name, MarkerLocation a, MarkerLocation b, const StopData& data)
      : PairForceElement(name, std::move(a), std::move(b), parts(data.coordinate), true),
        data_(data) {
    const auto size = [](double x) { return x >= 0 && std::isfinite(x); };
    if (!(data.stiffness > 0) || !size(data.stiffness) || !size(data.damping) || !size(data.onset))
      throw Error::input("force element '" + name +
                         "': the stiffness of a stop must be positive, and its damping and onset "
                         "must not be negative");
    if (!(data.least < data.most) || (!std::isfinite(data.least) && !std::isfinite(data.most)))
      throw Error::input(
          "force element '" + name +
          "': a stop must have a limit, and its lower limit must be below its upper limit");
  }

  std::unique_ptr<ForceElement> clone() const override {
    return std::make_unique<UnilateralStop>(*this);
  }
  bool counts_turns() const override { return data_.coordinate == Coordinate::angle; }
  double turned(const State& x) const override {
    pair().evaluate(x.t, x.q, x.v);
    return at(x, pair().y()).z;
  }
  Energies energies(const State& x) const override {
    pair().evaluate(x.t, x.q, x.v);
    const double beyond = beyond_limit(at(x, pair().y()).z).way, k = data_.stiffness,
                 w = data_.onset;
    if (beyond <= 0) return {};
    if (beyond < w) return {.strain = k * beyond * beyond * beyond / (6 * w)};
    return {.strain = 0.5 * k * (beyond - 0.5 * w) * (beyond - 0.5 * w) + k * w * w / 24};
  }

 private:
  static std::vector<Part> parts(Coordinate coordinate) {
    switch (coordinate) {
      case Coordinate::along:
        return {Part::kPositionA, Part::kAxisA, Part::kPositionB};
      case Coordinate::distance:
        return {Part::kPositionA, Part::kPositionB};
      case Coordinate::angle:
        return {Part::kAxisA, Part::kAxisB};
    }
    return {};
  }

  PairCoordinate at(const State& x, const Values& y) const {
    if (data_.coordinate == Coordinate::along) return coordinate_along(y, 0);
    if (data_.coordinate == Coordinate::distance) return distance_between(y);
    return angle_between(
        y, location() < x.turned.size() ? x.turned[location()] : data_.start_angle.value_or(0));
  }

  /// The displacement δ beyond a limit, and ∂δ/∂z = 1 or -1.
  struct Beyond {
    double way, sign;
  };
  Beyond beyond_limit(double z) const {
    return z > data_.most ? Beyond{z - data_.most, 1} : Beyond{data_.least - z, -1};
  }

  void fill(const State& x, const Values& y, const Values& rate, PairForce& out) const override {
    const PairCoordinate c = at(x, y);
    const auto [way, sign] = beyond_limit(c.z);
    if (!(way > 0)) return;
    if (data_.coordinate == Coordinate::distance && !(c.z > 0))
      throw Error::numerical("stop '" + name() +
                             "': its points coincide, so that it has no direction");
    const double k = data_.stiffness, w = data_.onset;
    const bool full = way >= w;
    // Fraction of k and c that acts within the transition.
    const double share = full ? 1 : way / w, way_t = sign * c.z_y.dot(rate);
    const double push = full ? k * (way - 0.5 * w) : 0.5 * k * way * share;
    const double total = push + data_.damping * share * way_t;
    CoordinateForce n;
    n.elastic = sign * push;
    if (total > 0) {
      n.total = sign * total;
      n.by_z = k * share + (full ? 0 : data_.damping * way_t / w);
      n.by_rate = data_.damping * share;
    }
    add_along(c, rate, n, out);
  }

  StopData data_;
};

}  // namespace

std::unique_ptr<ForceElement> make_stop(std::string name, MarkerLocation a, MarkerLocation b,
                                        const StopData& stop) {
  return std::make_unique<UnilateralStop>(std::move(name), std::move(a), std::move(b), stop);
}

}  // namespace flexmorph::fem
