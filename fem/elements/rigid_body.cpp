#include "fem/elements/rigid_body.h"

#include <array>
#include <cmath>

namespace flexmorph::fem {

RigidBody::RigidBody(double length, bool moves) : length_(length), moves_(moves) {
  if (!(length > 0) || !std::isfinite(length))
    throw Error::input("rigid body: its length is positive [m]");
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

std::vector<NodeVectors> RigidBody::edge(const std::string& name) const {
  throw Error::input("edge '" + name + "': a rigid body has no edges");
}

void RigidBody::tabulate(int, int, Tabulate, const Factors&, FactorKind, ShapeTable& out) const {
  out.weight.resize(0);
  out.material.clear();
  for (MatrixXd* table : {&out.N, &out.N_t, &out.N_tt, &out.N_m, &out.N_n, &out.N_mt, &out.N_nt,
                          &out.N_mm, &out.N_nn, &out.N_mn})
    table->resize(0, 0);
}

int RigidBody::locate(const Vec2&, Tabulate, ShapeTable&) const {
  throw Error::input("a rigid body has no material coordinates: its points are places of markers");
}

}  // namespace flexmorph::fem
