#include "fem/elements/rigid_body.h"

#include <array>
#include <cmath>

namespace flexmorph::fem {

RigidBody::RigidBody(double length, bool moves)
    : Element(Kind<RigidBody>{}, {.dim = 2, .n_shapes = 2, .n_elements = 1, .n_vectors = 2}),
      length_(length),
      moves_(moves) {
  if (!(length > 0) || !std::isfinite(length))
    throw Error::input("rigid body: the length must be positive [m]");
}

std::unique_ptr<Element> make_rigid_body(double length, bool moves) {
  return std::make_unique<RigidBody>(length, moves);
}

std::span<const int> RigidBody::vectors(int) const {
  static constexpr std::array<int, 2> kVectors = {0, 1};
  return kVectors;
}

MatrixXd RigidBody::reference() const {
  MatrixXd q(2, 2);
  q << 0, 0, 1, 0;
  return q;
}

}  // namespace flexmorph::fem
