#pragma once

#include "fem/load_law.h"
#include "fem/term.h"

namespace flexmorph::fem {

/// A term that loads its body.
///
/// A load that keeps its size and direction has a potential, -F · r, among its energies(). One that
/// varies in time or turns with the body has none: what it does to the body is power that enters.
class LoadTerm : public Term, public ScaledLoad {
 public:
  /// Its components at a time; said before prepare().
  void load_to(double t) { law_.to(t); }
  bool has_potential() const { return !follows_ && !law_.varies(); }
  /// Power of the load on one element, 0 where it has a potential [W].
  double power(int e, const Local& x) const {
    if (has_potential()) return 0;
    LocalRows force = LocalRows::Zero(x.q.rows(), x.q.cols());
    add_load(e, x, force);
    return -force.cwiseProduct(x.v).sum();
  }

  void scale_load(double factor) override { factor_ = factor; }

 protected:
  /// @param follows  does it turn with the body?
  /// @throws Error (input) for a number that is not finite.
  explicit LoadTerm(LoadLaw law, bool follows = false) : law_(std::move(law)), follows_(follows) {
    if (!law_.now().allFinite()) throw Error::input("load: a number that is not finite");
  }

  /// What add_force() adds of the load alone, without inertia.
  virtual void add_load(int e, const Local& x, LocalRows& force) const { add_force(e, x, force); }

  const VectorXd& load() const { return law_.now(); }
  double factor() const { return factor_; }

 private:
  LoadLaw law_;
  bool follows_;
  double factor_ = 1;
};

/// The matrix of x ×, which the slopes of loads that turn with a body in space are made of (3 x 3).
inline Eigen::Matrix3d skew(const Vec3& x) {
  Eigen::Matrix3d out;
  out << 0, -x[2], x[1], x[2], 0, -x[0], -x[1], x[0], 0;
  return out;
}

}  // namespace flexmorph::fem
