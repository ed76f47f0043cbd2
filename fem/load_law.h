#pragma once

#include <functional>
#include <vector>

#include "geometry/base.h"

namespace flexmorph::fem {

/// The components of a load or of gravity: constants, or functions of time.
class LoadLaw {
 public:
  /// One component as a function of time [s].
  using Component = std::function<double(double t)>;

  /// Creates a law with one constant component.
  LoadLaw(double constant) : now_(VectorXd::Constant(1, constant)) {}
  /// Creates a law with constant components.
  template <class Derived>
  LoadLaw(const Eigen::MatrixBase<Derived>& constant) : now_(constant) {}
  /// Creates a law whose components are functions of time.
  /// @throws any exception that the functions throw at t = 0
  LoadLaw(std::vector<Component> components)
      : now_(static_cast<Eigen::Index>(components.size())), components_(std::move(components)) {
    to(0);
  }

  /// Returns the number of components.
  Eigen::Index size() const { return now_.size(); }
  /// Returns true if the components are functions of time.
  bool varies() const { return !components_.empty(); }
  /// Returns the components at the time of the last call of to(); constant components always.
  const VectorXd& now() const { return now_; }
  /// Evaluates the components at time t [s].
  void to(double t) {
    for (size_t c = 0; c < components_.size(); ++c)
      now_[static_cast<Eigen::Index>(c)] = components_[c](t);
  }
  /// Returns a copy with all components multiplied by a factor.
  LoadLaw times(double factor) const {
    LoadLaw out = *this;
    out.now_ *= factor;
    for (Component& each : out.components_)
      each = [factor, of = std::move(each)](double t) { return factor * of(t); };
    return out;
  }
  /// Returns the components at time t [s] and leaves now() unchanged.
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
