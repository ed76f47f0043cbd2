#pragma once

#include <vector>

#include "fem/model/model.h"
#include "fem/solve/turned_vectors.h"
#include "geometry/memory.h"

namespace flexmorph::fem {

/// How far the bodies in the plane have turned since the tangent was factored. Elastic forces and
/// inertia turn with a body, so that a factor that turns with it is still that of a tangent nearby,
/// however far a body has swung round; what is left is that it deforms.
///
/// The angle of a body is that of the best rotation from its undeformed vectors X_k to q_k,
///
///   tan θ = Σ X_k × q_k / Σ X_k · q_k,   positions from their means.
class BodyTurns {
 public:
  /// They are counted from here.
  void begin(const Model& model, const VectorXd& q);
  /// Looks where they are.
  /// @returns whether one has turned noticeably since the last look, or begin()
  bool follow(const Model& model, const VectorXd& q);
  /// Since begin(), as of the last follow() that said so.
  std::vector<TurnedVectors> turns(const Model& model) const;
  void remember(Memory& memory);

 private:
  std::vector<double> start_, now_;  // angles of the bodies [rad]
};

}  // namespace flexmorph::fem
