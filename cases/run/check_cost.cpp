#include "cases/run/check_cost.h"

#include <algorithm>

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

/// Gauss points of the bending; 0 where none is.
double bending_points(const Body& body) {
  const double n = body.number("bending_points");
  return n * n;
}
double points_of(const Body& body) { return 49 + bending_points(body); }

}  // namespace

double force_operations(const Body& body, const fem::Element& element) {
  const double n = element.n_shapes(), d = element.dim();
  if (body.is_beam()) return 15 * 300;  // Gauss points
  // Gram form: n_p pairs of vectors in four classes, products and sums for d directions.
  const double pairs = 0.5 * n * (n + 1);
  double out = 2 * n * n * d * (body.flow ? 3 : 1);  // inertia
  out += 0.5 * pairs * pairs + 2 * pairs * d + 2 * n * n * d;
  return out + bending_points(body) * (2 * n * d * (5 + 3) + 150);
}

double tangent_operations(const Body& body, const fem::Element& element) {
  const double n = element.n_shapes(), d = element.dim();
  if (body.is_beam()) return 15 * 4 * n * d * n * d;
  const double pairs = 0.5 * n * (n + 1);
  return n * d * (n * pairs + n * n * d) + 2 * bending_points(body) * n * d * n * d;
}

StepOperations step_operations(const Scene& scene, const Mechanism& mechanism) {
  StepOperations out;
  const auto times = [&](double in_time) { return scene.statics ? kStaticIterations : in_time; };
  for (const Body& body : scene.bodies) {
    const fem::Body& built = mechanism.model.body(body.name);
    const fem::Element& element = *built.element;
    const double n = element.n_elements(),
                 tangents = times(body.flow ? kTangentsOfFlow : kTangents);
    const double points = points_of(body);
    out.forces += times(kForces) * n *
                  (body.has_free_lines() ? kFreePoint * points : force_operations(body, element));
    out.tangents += tangents * n * tangent_operations(body, element);
    // Nodes in order along the shorter side: a band of one row of them and a bit.
    const double vectors = element.n_shapes() / (body.is_beam() ? 2.0 : 4.0);
    const double across = body.is_beam() ? 1 : std::min(body.elements[0], body.elements[1]) + 2;
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
