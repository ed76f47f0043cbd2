#pragma once

#include <functional>
#include <vector>

#include "geometry/base.h"

namespace flexmorph::fem {

/// The components of a load or of gravity: constant, or functions of time.
class LoadLaw {
 public:
  using Component = std::function<double(double t)>;

  LoadLaw(double constant) : now_(VectorXd::Constant(1, constant)) {}
  template <class Derived>
  LoadLaw(const Eigen::MatrixBase<Derived>& constant) : now_(constant) {}
  /// @throws what the functions throw at t = 0
  LoadLaw(std::vector<Component> components)
      : now_(static_cast<Eigen::Index>(components.size())), components_(std::move(components)) {
    to(0);
  }

  Eigen::Index size() const { return now_.size(); }
  bool varies() const { return !components_.empty(); }
  /// Its value at the time of the last to(); of a constant one at all times.
  const VectorXd& now() const { return now_; }
  void to(double t) {
    for (size_t c = 0; c < components_.size(); ++c)
      now_[static_cast<Eigen::Index>(c)] = components_[c](t);
  }
  /// All components times a factor.
  LoadLaw times(double factor) const {
    LoadLaw out = *this;
    out.now_ *= factor;
    for (Component& each : out.components_)
      each = [factor, of = std::move(each)](double t) { return factor * of(t); };
    return out;
  }
  /// Its value at another time.
  VectorXd at(double t) const {
    LoadLaw copy = *this;
    copy.to(t);
    return copy.now_;
  }

 private:
  VectorXd now_;
  std::vector<Component> components_;
};

}  // namespace flexmorph::fem
