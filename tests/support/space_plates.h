#pragma once

#include <Eigen/Geometry>

#include "fem/solve/statics.h"
#include "fem/terms.h"
#include "tests/support/disturbance.h"
#include "tests/support/models.h"

/// Plates in space for tests: a rectangle with terms selected by name, loads and held nodes.
namespace flexmorph::testing {

inline VectorXd vector(double x, double y, double z) {
  VectorXd out(3);
  out << x, y, z;
  return out;
}

/// A rectangle from the origin in the plane z = 0.
struct SpacePlate {
  double length = 1, width = 1;
  int nx = 8, ny = 8;
  ShapeSet shapes = ShapeSet::h16;
  fem::PlaneSection section{0.01, 1e9, 0.3, 1000};
  std::vector<std::string> terms = {"membrane", "bending"};
  std::vector<fem::Held> held;

  /// Returns the bending stiffness E c³ / (12 (1 - ν²)) [N m].
  double stiffness() const {
    return section.elasticity()(0, 0) * std::pow(section.thickness, 3) / 12;
  }

  void hold(const std::vector<fem::Held>& more) {
    held.insert(held.end(), more.begin(), more.end());
  }

  template <class... Loads>
  fem::Workspace model(Loads... loads) const {
    const fem::PlaneSection section = disturbed(this->section);
    std::vector<std::unique_ptr<fem::Term>> all;
    for (const std::string& name : terms) all.push_back(fem::make_term(name, section));
    (all.push_back(std::move(loads)), ...);
    fem::Workspace out;
    out.add_body("plate",
                 std::make_unique<AncfPlate>(3, shapes, uniform_lines(0, length, nx),
                                             uniform_lines(0, width, ny)),
                 section, std::move(all));
    if (!held.empty()) out.add_joint(fem::make_hold("held", "plate", held));
    return out;
  }
};

/// Returns the position, or the displacement, at a material point from all unknowns of a model of
/// one body.
inline Vec3 at_point(const fem::Model& model, const VectorXd& q, const Vec2& material) {
  const fem::Body& body = model.bodies()[0];
  fem::ShapeTable t;
  const int e = body.element->locate(material, fem::Tabulate::position, t);
  Vec3 out = Vec3::Zero();
  const auto vectors = body.element->vectors(e);
  for (size_t k = 0; k < vectors.size(); ++k)
    out += t.N(0, static_cast<Eigen::Index>(k)) * q.segment<3>(body.first_dof + 3 * vectors[k]);
  return out;
}

}  // namespace flexmorph::testing
