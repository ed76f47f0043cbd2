#pragma once

#include "fem/load_law.h"
#include "fem/term.h"

namespace flexmorph::fem {

/// A term that loads its body.
///
/// A load of constant size and direction has a potential, -F · r, among its energies(). A load that
/// varies in time or turns with the body has none; its work on the body is power that enters the
/// model.
class LoadTerm : public Term, public ScaledLoad {
 public:
  /// Evaluates the components at time t [s]; call it before prepare().
  void load_to(double t) { law_.to(t); }
  /// Returns true if the load has a potential, that is if it is constant and does not turn with the
  /// body.
  bool has_potential() const { return !follows_ && !law_.varies(); }
  /// Returns the power of the load on one element [W], 0 where it has a potential.
  double power(int e, const Local& x) const {
    if (has_potential()) return 0;
    LocalRows force = LocalRows::Zero(x.q.rows(), x.q.cols());
    add_load(e, x, force);
    return -force.cwiseProduct(x.v).sum();
  }

  void scale_load(double factor) override { factor_ = factor; }

 protected:
  /// @param follows  true if the load turns with the body
  /// @throws Error (input) for a number that is not finite.
  explicit LoadTerm(LoadLaw law, bool follows = false) : law_(std::move(law)), follows_(follows) {
    if (!law_.now().allFinite()) throw Error::input("load: a number is not finite");
  }

  /// Adds the contribution of the load alone, without inertia, to the force of add_force().
  virtual void add_load(int e, const Local& x, LocalRows& force) const { add_force(e, x, force); }

  /// Returns the components at the time of the last load_to().
  const VectorXd& load() const { return law_.now(); }
  /// Returns the load factor.
  double factor() const { return factor_; }

 private:
  LoadLaw law_;
  bool follows_;
  double factor_ = 1;
};

/// Returns the matrix [x]× with [x]× y = x × y (3 x 3); the derivatives of loads that turn with a
/// body in space contain it.
inline Eigen::Matrix3d skew(const Vec3& x) {
  Eigen::Matrix3d out;
  out << 0, -x[2], x[1], x[2], 0, -x[0], -x[1], x[0], 0;
  return out;
}

}  // namespace flexmorph::fem
