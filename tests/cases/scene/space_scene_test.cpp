// Shows that the shipped cases in space have the data of their sources, and that all their keys are
// accepted and change the model.
#include <gtest/gtest.h>

#include "cases/assembly/build.h"
#include "cases/run/run.h"
#include "tests/cases/scenes.h"

namespace flexmorph::cases {
namespace {

/// Returns the number of constraint rows of the model of a scene.
int rows(const Scene& scene) { return build_mechanism(scene).model.n_constraints(); }

TEST(SpaceScene, PendulumIsThatOfThePaper) {
  const Scene s = read("plate_pendulum");
  const Body& plate = s.bodies.at(0);
  EXPECT_TRUE(s.in_space());
  EXPECT_EQ(plate.length, 0.3);
  EXPECT_EQ(plate.width, 0.3);
  EXPECT_EQ(plate.thickness, 0.01);
  EXPECT_EQ(plate.density, 7810);
  EXPECT_EQ(plate.youngs_modulus, testing::disturbed(1e5));
  EXPECT_EQ(plate.poisson_ratio, 0.3);
  EXPECT_EQ(plate.elements, (std::array{8, 8}));
  EXPECT_EQ(*s.gravity, Vec3(0, 0, -9.81));
  EXPECT_EQ(s.time.start, Start::rigid);  // the motion has no drive
  const Mechanism m = build_mechanism(s);
  EXPECT_EQ(m.model.n_dofs(), 3 * 4 * 81);
  EXPECT_EQ(m.model.n_constraints(), 3);
  EXPECT_TRUE(m.moving_roots.empty());
  // The rectangle begins at its pinned corner; the potential of its weight is zero in the plane z =
  // 0.
  const VectorXd q = m.model.reference().q;
  EXPECT_EQ(q.minCoeff(), 0);
}

TEST(SpaceScene, PlanarScenesKnowNothingOfIt) {
  const Scene s = read("rotating_plate_v01");
  EXPECT_FALSE(s.in_space());
  EXPECT_FALSE(s.statics);
  EXPECT_TRUE(s.loads.empty() && s.observed.empty() && s.bodies[0].lines.empty());
  EXPECT_EQ(s.time.integrator, "generalized_alpha");
  EXPECT_EQ(s.bodies[0].low(), -0.05);
}

TEST(SpaceScene, EdgesOfABodyAreHeldTogether) {
  // Clamped edges of a plate of 8 x 8 elements: each node of an edge has constraints for r, for
  // both slopes except the length of the one across the edge, and for r_mn in the same form.
  // Corners belong to two edges but are constrained only once.
  const std::string twist = "square_plate_twist";
  const auto held = [&](const std::string& joints) {
    return rows(read(twist, {"joint=[" + joints + "]"}));
  };
  const std::string root = "{type='clamp', body='plate', edges=['root']}",
                    low = "{type='clamp', body='plate', edges=['side_low']}",
                    both = "{type='clamp', body='plate', edges=['root', 'side_low']}";
  EXPECT_EQ(held(root), 9 * (3 + 3 + 1 + 1));
  EXPECT_EQ(held(root + ", " + low), held(both));
  EXPECT_LT(held(both), 2 * held(root));
  EXPECT_EQ(held("{type='clamp', body='plate', edges=['root'], mode='full'}"), 9 * 12);
  EXPECT_EQ(held("{type='support', body='plate', edges=['root']}"), 9 * 2);
  EXPECT_EQ(held("{type='symmetry', body='plate', edges=['free_end']}"), 9 * (1 + 1 + 2 + 2));
  EXPECT_EQ(held("{type='pin', body='plate', point=[0, 0], components=['z']}"), 1);
}

TEST(SpaceScene, EveryLoadReachesTheModel) {
  // Generalized forces on positions sum up to the resultant, because the shape functions N sum up
  // to one.
  const auto resultant = [](const std::string& load) {
    const Scene s = read("square_plate_twist", {"load=[{body='plate', " + load + "}]"});
    Mechanism m = build_mechanism(s);
    const fem::State x = m.model.reference();
    m.model.prepare(x);
    VectorXd force;
    m.model.force(x, force);
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < m.model.n_dofs() / 3; k += 4) sum -= force.segment<3>(3 * k);
    return sum;
  };
  EXPECT_LT((resultant("type='point', point=[0.3, 0.4], force=[1, 2, 3]") - Vec3(1, 2, 3)).norm(),
            1e-12);
  EXPECT_LT((resultant("type='edge', edge='side_high', force=[1, 2, 3]") - Vec3(1, 2, 3)).norm(),
            1e-12);
  EXPECT_LT((resultant("type='edge', edge='line 2', force=[0, 0, 3]") - Vec3(0, 0, 3)).norm(),
            1e-12);
  EXPECT_LT((resultant("type='surface', force=[1, 2, 3]") - Vec3(1, 2, 3)).norm(), 1e-12);
  EXPECT_LT((resultant("type='pressure', pressure=5") - Vec3(0, 0, 5)).norm(), 1e-12);
  EXPECT_LT(resultant("type='edge_moment', edge='free_end', moment=5").norm(), 1e-12);
}

// Under a small rigid rotation about the edge the virtual work of the forces is that of the moment.
TEST(SpaceScene, EdgeMomentsReachTheModel) {
  const Scene s = read("square_plate_twist",
                       {"load=[{body='plate', type='edge_moment', edge='free_end', moment=5}]"});
  Mechanism m = build_mechanism(s);
  const fem::State x = m.model.reference();
  m.model.prepare(x);
  VectorXd force;
  m.model.force(x, force);
  double work = 0;
  for (int k = 0; k < m.model.n_dofs() / 3; ++k)
    work -= force.segment<3>(3 * k).dot(Vec3::UnitY().cross(Vec3(x.q.segment<3>(3 * k))));
  EXPECT_NEAR(std::abs(work), 5 * s.bodies[0].width, 1e-12);
}

TEST(SpaceScene, EulerianLinesAndSleevesReachTheModel) {
  const Scene s = read("elastic_sleeve");
  ASSERT_EQ(s.bodies[0].lines.size(), 1u);
  EXPECT_EQ(*s.bodies[0].lines[0].at, 0.42);
  EXPECT_EQ(s.joints[0].mode, fem::WeldMode::direction);
  const Mechanism m = build_mechanism(s);
  EXPECT_EQ(m.model.bodies()[0].element->n_scalars(), 1);
  // Two nodes have constraints for r and r_n, for z of r_m and r_mn, and for both across the axis.
  EXPECT_EQ(m.model.n_constraints(), 2 * (3 + 3 + 2 + 2));
  const fem::ReferencePose pose = start_pose(s, s.bodies[0]);
  EXPECT_EQ(pose.location({0.42, 0.01}), Vec3(0, 0.01, 0));

  // If the sleeve is rotated and shifted, the body starts at the sleeve.
  const Scene turned = read("elastic_sleeve", {"joint.0.position=[1, 2]", "joint.0.angle=0.5"});
  Mechanism other = build_mechanism(turned);
  const fem::State x = fem::start_state(other.model, other.moving_roots, 0, fem::Start::rigid);
  fem::Constraints c;
  other.model.constraints(x, c);
  EXPECT_LT(c.value.lpNorm<Eigen::Infinity>(), 1e-15);

  // A driven line carries the strip along; the constraints of drive and sleeve are satisfied at the
  // start.
  const Scene driven =
      read("elastic_sleeve", {"joint=[{type='sleeve', body='strip', edge='line 3', angle=0.3}, "
                              "{type='line_drive', body='strip', line=3, speed=-0.2}]"});
  Mechanism fed = build_mechanism(driven);
  const fem::State y = fem::start_state(fed.model, fed.moving_roots, 0, fem::Start::rigid);
  fem::Constraints d;
  fed.model.constraints(y, d);
  VectorXd rate = d.rate;
  for (const auto& entry : d.jacobian) rate[entry.row()] += entry.value() * y.v[entry.col()];
  EXPECT_EQ(rate.size(), 21);
  EXPECT_LT(d.value.lpNorm<Eigen::Infinity>() + rate.lpNorm<Eigen::Infinity>(), 1e-15);
  EXPECT_NEAR(y.v[0], 0.2 * std::cos(0.3), 1e-15);  // all material leaves at 0.2 m/s
  EXPECT_NEAR(y.v[1], 0.2 * std::sin(0.3), 1e-15);
}

constexpr const char* kRootSleeve = "joint=[{type='sleeve', body='strip', edge='root'}]";

TEST(SpaceScene, LimitsOfAFreeRootLineReachTheModel) {
  const Scene s =
      read("elastic_sleeve", {"body.line=[{index=0, free=true, max_length=0.2}]", kRootSleeve});
  const Mechanism m = build_mechanism(s);
  EXPECT_EQ(m.moving_roots.at(0).max_length, 0.2);
  EXPECT_NEAR(m.moving_roots.at(0).min_length, 0.06, 1e-15);
  const Mechanism never =
      build_mechanism(read("elastic_sleeve", {"body.line=[{index=0, free=true}]", kRootSleeve}));
  EXPECT_TRUE(std::isinf(never.moving_roots.at(0).max_length));
}

TEST(SpaceScene, AnalysisAndIntegratorAreRead) {
  const Scene roll =
      read("cantilever_roll_up", {"static.path=arc_length", "static.steps=7", "static.max_steps=9",
                                  "static.max_iterations=11", "static.to=-0.5"});
  ASSERT_TRUE(roll.statics);
  EXPECT_EQ(roll.statics->path, fem::StaticSettings::Path::arc_length);
  EXPECT_EQ(roll.statics->steps, 7);
  EXPECT_EQ(roll.statics->max_steps, 9);
  EXPECT_EQ(roll.statics->max_iterations, 11);
  EXPECT_EQ(roll.statics->to, -0.5);
  EXPECT_EQ(roll.observed.at(0).point, Vec2(1, 0.1));
  const Scene free = read("plate_pendulum", {"time.integrator=energy_momentum"});
  EXPECT_EQ(build_mechanism(free).motion.integrator, "energy_momentum");
  const Scene minimal =
      read("plate_pendulum", {"time.integrator=minimal_coordinates", "time.tolerance=1e-6"});
  EXPECT_EQ(build_mechanism(minimal).motion.integrator, "minimal_coordinates");
  EXPECT_EQ(build_mechanism(minimal).motion.minimal_coordinates.tolerance, 1e-6);
  EXPECT_EQ(read("deploying_plate").observed.at(0).point, Vec2(0.9, 0.05));
}

// An insertion of a line does not change the shape of the plate; energies are compared before
// forces are balanced. The bending energy is a rational function of the unknowns: its apparent jump
// is the error of its quadrature, which vanishes with more points. (Assumed membrane strains are
// interpolated again, therefore their energy does change.)
TEST(NewLines, DoNotChangeTheEnergyButForItsQuadrature) {
  const auto jump = [](const char* points) {
    const Scene scene = read("deploying_plate", {"time.end=0.1", "body.flow.mesh=split",
                                                 "body.terms=['inertia', 'membrane', 'bending']",
                                                 std::string("body.bending_points=") + points});
    Mechanism m = build_mechanism(scene);
    fem::State x =
        fem::integrate(m.model, m.moving_roots, m.motion, [](const fem::MotionStep&) {}).final;
    const double before = m.model.energies(x).strain;
    fem::change_mesh(m.model, m.model.bodies().front(), fem::MeshChange::insertion, x);
    return std::abs(m.model.energies(x).strain - before) / before;
  };
  EXPECT_LT(jump("5"), 1e-6);
  EXPECT_LT(jump("11"), 1e-10);
}

}  // namespace
}  // namespace flexmorph::cases
