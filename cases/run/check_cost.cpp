#include "cases/run/check_cost.h"

#include <algorithm>

#include "cases/scene/elements/row.h"

namespace flexmorph::cases {
namespace {

// Of Newton's method: evaluations of the force in a step, the energies counted as one more, and
// tangents; where material flows a tangent is soon out of date.
constexpr double kForces = 7, kSolutions = 5, kTangents = 0.1, kTangentsOfFlow = 0.4;
constexpr double kStaticIterations = 3;  // of a step of a path, each with a tangent of its own

// Sparse solvers copy, order and scatter more than they multiply: per n b² of a band b.
constexpr double kFactor = 6;

// Of a moving element: its matrices, with those of its neighbours where they are alike; its power.
constexpr double kRefresh = 1e6, kPower = 3e5;
// Of a Gauss point of an element in a body with free lines, tables and forces.
constexpr double kFreePoint = 1e4;
// Of a rigid body, a joint row or a spring.
constexpr double kRigid = 1e3;

/// Gauss points of an element.
double points_of(const Body& body) {
  const double n = body.number("bending_points");
  return 49 + n * n;
}

}  // namespace

StepOperations step_operations(const Scene& scene, const Mechanism& mechanism) {
  StepOperations out;
  const auto times = [&](double in_time) { return scene.statics ? kStaticIterations : in_time; };
  for (const Body& body : scene.bodies) {
    const fem::Body& built = mechanism.model.body(body.name);
    const fem::Element& element = *built.element;
    const double n = element.n_elements(),
                 tangents = times(body.flow ? kTangentsOfFlow : kTangents);
    const ElementOperations each = body.row->operations(body, element);
    out.forces +=
        times(kForces) * n * (body.has_free_lines() ? kFreePoint * points_of(body) : each.force);
    out.tangents += tangents * n * each.tangent;
    // Nodes in order along the shorter side: a band of one row of them and a bit.
    const double vectors = element.n_shapes() / (body.row->across ? 4.0 : 2.0);
    const double across = body.row->across ? std::min(body.elements[0], body.elements[1]) + 2 : 1;
    const double band = across * vectors * element.dim();
    out.solver += built.n_dofs() * band * (tangents * kFactor * band + 4 * times(kSolutions));
    if (body.flow) out.flow += kRefresh + body.elements[1] * kPower;
  }
  const auto rows = static_cast<double>(4 * scene.rigid_bodies.size() + scene.springs.size()) +
                    mechanism.model.n_constraints();
  out.forces += times(kForces) * kRigid * rows;
  return out;
}

}  // namespace flexmorph::cases
