// Shows that equilibria with known solutions are found: the stretch and the root tension of a
// rotating bar, and the in-plane bending of a clamped strip, where the complete shape set converges
// faster.
#include "fem/solve/statics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fem/loads.h"
#include "fem/terms.h"
#include "fem/triangles/triangle_plate.h"
#include "tests/support/models.h"

namespace flexmorph::fem {
namespace {

using testing::RotatingPlate;
using testing::ShapeSet;

/// Returns the equilibrium of a plate that rotates steadily with its hub.
State spinning(const RotatingPlate& p, testing::Scene& scene) {
  State x = scene.model.reference();
  for (int k = 0; k < scene.model.bodies()[0].element->n_vectors(); ++k)
    if (scene.model.bodies()[0].element->is_position(k)) x.q[2 * k] -= p.whole() - p.length;
  const VectorXd spin = VectorXd::Constant(x.q.size(), p.omega * p.omega);
  solve_rotating_equilibrium(scene.model, spin, VectorXd::Zero(x.q.size()), x);
  return x;
}

// The bar has no lateral contraction; the linear closed form ρ ω² L³ / (3 E) neglects strains,
// which are below 1e-4.
TEST(Statics, RotatingBarStretchesByTheClosedForm) {
  RotatingPlate p;
  p.speed = p.tip_mass = 0;
  p.section.poisson_ratio = 0;
  for (const ShapeSet shapes : {ShapeSet::h12, ShapeSet::h16}) {
    p.shapes = shapes;
    testing::Scene scene = testing::make_scene(p);
    const State x = spinning(p, scene);
    const double stretch = testing::in_hub(p, scene.model, x, p.tip()).x() - p.length;
    const double linear = p.section.density * p.omega * p.omega * std::pow(p.length, 3) /
                          (3 * p.section.youngs_modulus);
    EXPECT_NEAR(stretch / linear, 1, 2e-4);
  }
}

// The sum of the root's reactions must equal the centrifugal force ∫ ρ h ω² r dA + m ω² r_tip of
// the stretched plate, to round-off.
TEST(Statics, HubHoldsTheCentrifugalForce) {
  RotatingPlate p;
  p.speed = 0;
  testing::Scene scene = testing::make_scene(p);
  const State x = spinning(p, scene);
  const Body& body = scene.model.bodies()[0];
  Constraints c;
  scene.model.constraints(x, c);
  VectorXd reaction = VectorXd::Zero(x.q.size());
  scene.model.add_constraint_force(c, x.lambda, reaction);
  double pull = 0;
  for (int k = 0; k < body.element->n_vectors(); ++k)
    if (body.element->is_position(k)) pull += reaction[2 * k];
  const VectorRows q = rows_of(body, x.q);
  double moment = p.tip_mass * point_motion(body, x, p.tip()).position.x();
  ShapeTable t;
  for (int e = 0; e < body.element->n_elements(); ++e) {
    body.element->tabulate(e, 3, Tabulate::position, {}, ScaleFactorKind::none, t);
    moment += p.section.density * p.section.thickness *
              t.weight.dot(t.N * testing::rows_of_element(*body.element, q, e).col(0));
  }
  const double centrifugal = p.omega * p.omega * moment;
  EXPECT_NEAR(pull, centrifugal, 1e-11 * centrifugal);
}

/// Returns the deflection of Timoshenko's beam under a unit force at its end.
double timoshenko(const RotatingPlate& p) {
  const double inertia = p.section.thickness * std::pow(p.width(), 3) / 12,
               e = p.section.youngs_modulus;
  return std::pow(p.length, 3) / (3 * e * inertia) +
         1.2 * p.length * 2 * (1 + p.section.poisson_ratio) / (e * p.section.thickness * p.width());
}

/// Returns the tip deflection of the strip 0.5 x 0.1 under a small shear force distributed
/// uniformly over its end, relative to Timoshenko's beam.
double strip(ShapeSet shapes, int nx, int ny) {
  RotatingPlate p;
  p.speed = p.omega = p.tip_mass = 0;
  p.shapes = shapes;
  p.nx = nx;
  p.ny = ny;
  testing::Scene scene = testing::make_scene(p);
  // The weights of masses at the Gauss points of the end are exactly its uniform traction.
  Workspace model;
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_membrane(p.section));
  const double force = 1e-3;  // rotations of 1e-5: linear
  for (int j = 0; j < ny; ++j)
    for (size_t g = 0; g < 4; ++g)
      terms.push_back(make_point_mass(force / ny * gauss(4).weights[g],
                                      {p.length, -0.05 + 0.1 * (j + gauss(4).points[g]) / ny},
                                      Vec2(0, 1)));
  model.add_body("plate", grid_of(scene.model.bodies()[0]).copy(), p.section, std::move(terms));
  model.add_joint(
      make_weld("root", "plate", "root", scene.moving_roots[0].hub.drive(), WeldMode::edge));
  State x = model.reference();
  const VectorXd zero = VectorXd::Zero(x.q.size());
  solve_rotating_equilibrium(model, zero, zero, x);
  const double deflection = testing::in_hub(p, model, x, p.tip()).y();
  return deflection / (force * timoshenko(p));
}

/// Returns the mean deflection of the end of this strip by six-node triangles, relative to
/// Timoshenko's beam.
double strip_of_triangles() {
  const RotatingPlate p;
  const double half = 0.5 * p.width();
  const std::vector<Region> part = {{corners_of({{0, -half}, {p.length, half}}), {}}};
  PartMesher mesher(part, {});
  mesher.refine(SizeField({{0, -half}, {p.length, half}}, 0.005));
  const PartMesh mesh = mesher.mesh();
  TrianglePlateSupports supports;
  for (int k = 0; k < static_cast<int>(mesh.points.size()); ++k)
    if (mesh.point(k).x() < 1e-12)
      for (const int c : {0, 1}) supports.held.push_back({k, c});
  TrianglePlate plate(mesh, p.section, supports);
  plate.factorize();
  VectorXd force = VectorXd::Zero(plate.n_unknowns());
  for (const auto& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      if (std::min(mesh.point(a).x(), mesh.point(b).x()) < p.length - 1e-9) continue;
      const double part_of_edge = (mesh.point(b) - mesh.point(a)).norm() / p.width();
      for (const auto& [node, share] :
           {std::pair(a, 1. / 6), std::pair(b, 1. / 6), std::pair(t[3 + k], 4. / 6)})
        force[plate.row(node, 1)] += share * part_of_edge;
    }
  MatrixXd u = force.transpose();
  plate.solve(u, std::vector<int>{0});
  return u.row(0).dot(force) / timoshenko(p);
}

// The reference are six-node triangles. The clamped edge of the continuum prevents lateral
// contraction, which reduces the beam's deflection by 0.4 %. Displacement elements are too stiff,
// finer ones less so. Singularities at the corners of the clamp limit convergence to about first
// order; the complete set has a fourth of the error.
TEST(Statics, StripBendsAsByTriangles) {
  const double exact = strip_of_triangles();
  EXPECT_NEAR(exact, 0.996, 5e-4);
  double last = 2e-3;
  for (const int n : {1, 2}) {
    const double h12 = exact - strip(ShapeSet::h12, 10 * n, 2 * n);
    const double h16 = exact - strip(ShapeSet::h16, 10 * n, 2 * n);
    EXPECT_GT(h16, 0);
    EXPECT_LT(h16, 0.6 * last);
    EXPECT_LT(h16, h12 / 4) << h16 << " " << h12;
    last = h16;
  }
}

TEST(Statics, SaysWhenThereIsNoEquilibrium) {
  RotatingPlate p;
  p.speed = 0;
  p.omega = 400;  // no equilibrium exists at this centrifugal force
  testing::Scene scene = testing::make_scene(p);
  EXPECT_THROW(spinning(p, scene), Error);
}

}  // namespace
}  // namespace flexmorph::fem
