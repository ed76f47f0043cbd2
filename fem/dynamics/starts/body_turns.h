#pragma once

#include <vector>

#include "fem/model/model.h"
#include "fem/solve/turned_vectors.h"
#include "geometry/archive.h"

namespace flexmorph::fem {

/// Rotation angles of the planar bodies since the tangent was factored. Elastic forces and inertia
/// rotate with a body; therefore a factorization that is rotated with the body still approximates
/// its tangent, however far the body has rotated. Only the deformation of the body adds an error.
///
/// The angle of a body is the angle of the best rotation from its undeformed vectors X_k to q_k,
///
///   tan θ = Σ X_k × q_k / Σ X_k · q_k,   positions relative to their means.
class BodyTurns {
 public:
  /// Sets the reference angles to those of the bodies at the positions q.
  void begin(const Model& model, const VectorXd& q);
  /// Updates the angles to the positions q if a body has rotated noticeably since the last update
  /// or begin().
  /// @returns true if the angles were updated.
  bool follow(const Model& model, const VectorXd& q);
  /// Returns the rotations of all planar bodies from begin() to the last update by follow().
  std::vector<TurnedVectors> turns(const Model& model) const;
  /// Saves or restores the angles (geometry/archive.h).
  void archive(Archive& memory);

 private:
  std::vector<double> start_, now_;  // angles of the bodies at begin() and at the last update [rad]
};

}  // namespace flexmorph::fem
