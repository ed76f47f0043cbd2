// Scenes in space: the shipped cases hold the data of their sources; every new key is accepted and
// reaches the model; every bad input is refused with one message that says where and why.
#include <gtest/gtest.h>

#include "cases/build/build.h"
#include "cases/run/run.h"
#include "tests/cases/scenes.h"

namespace flexmorph::cases {
namespace {

std::string complaint(const std::string& name, const Changes& changes) {
  try {
    build_scene(read(name, changes));
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), Error::Kind::input);
    return e.what();
  }
  return "";
}

/// Constraint rows of the built scene.
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
  EXPECT_EQ(s.time.start, Start::rigid);  // nothing drives it
  const Mechanism m = build_mechanism(s);
  EXPECT_EQ(m.model.n_dofs(), 3 * 4 * 81);
  EXPECT_EQ(m.model.n_constraints(), 3);
  EXPECT_TRUE(m.growths.empty());
  // The rectangle begins at its pinned corner: its weight's potential is zero in the plane z = 0.
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
  // Four clamped edges of 8 x 8 elements: every node of the boundary holds r, both slopes but the
  // length of the one across, and of r_mn likewise. Corners, which belong to two edges, once.
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
  // Generalized forces on positions add up to the resultant: N sums to one.
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

TEST(SpaceScene, FreeLinesAndSleevesReachTheModel) {
  const Scene s = read("elastic_sleeve");
  ASSERT_EQ(s.bodies[0].lines.size(), 1u);
  EXPECT_EQ(*s.bodies[0].lines[0].at, 0.42);
  EXPECT_EQ(s.joints[0].mode, fem::WeldMode::direction);
  const Mechanism m = build_mechanism(s);
  EXPECT_EQ(m.model.bodies()[0].element->n_scalars(), 1);
  // Two nodes with r, r_n; z of r_m, r_mn; and both across the axis.
  EXPECT_EQ(m.model.n_constraints(), 2 * (3 + 3 + 2 + 2));
  const Pose pose = start_pose(s, s.bodies[0]);
  EXPECT_EQ(pose.place({0.42, 0.01}), Vec3(0, 0.01, 0));

  // Turned and shifted: the body starts where the sleeve is.
  const Scene turned = read("elastic_sleeve", {"joint.0.position=[1, 2]", "joint.0.angle=0.5"});
  Mechanism other = build_mechanism(turned);
  const fem::State x = fem::start_state(other.model, other.growths, 0, fem::Start::rigid);
  fem::Constraints c;
  other.model.constraints(x, c);
  EXPECT_LT(c.value.lpNorm<Eigen::Infinity>(), 1e-15);

  // A driven line takes the strip along: rows of the drive and of the sleeve hold at the start.
  const Scene driven =
      read("elastic_sleeve", {"joint=[{type='sleeve', body='strip', edge='line 3', angle=0.3}, "
                              "{type='line_drive', body='strip', line=3, speed=-0.2}]"});
  Mechanism fed = build_mechanism(driven);
  const fem::State y = fem::start_state(fed.model, fed.growths, 0, fem::Start::rigid);
  fem::Constraints d;
  fed.model.constraints(y, d);
  VectorXd rate = d.rate;
  for (const auto& entry : d.jacobian) rate[entry.row()] += entry.value() * y.v[entry.col()];
  EXPECT_EQ(rate.size(), 21);
  EXPECT_LT(d.value.lpNorm<Eigen::Infinity>() + rate.lpNorm<Eigen::Infinity>(), 1e-15);
  EXPECT_NEAR(y.v[0], 0.2 * std::cos(0.3), 1e-15);  // all material comes out at 0.2 m/s
  EXPECT_NEAR(y.v[1], 0.2 * std::sin(0.3), 1e-15);
}

constexpr const char* kRootSleeve = "joint=[{type='sleeve', body='strip', edge='root'}]";

TEST(SpaceScene, LimitsOfAFreeRootLineReachTheModel) {
  const Scene s =
      read("elastic_sleeve", {"body.line=[{index=0, free=true, max_length=0.2}]", kRootSleeve});
  const Mechanism m = build_mechanism(s);
  EXPECT_EQ(m.growths.at(0).max_length, 0.2);
  EXPECT_NEAR(m.growths.at(0).min_length, 0.06, 1e-15);
  const Mechanism never =
      build_mechanism(read("elastic_sleeve", {"body.line=[{index=0, free=true}]", kRootSleeve}));
  EXPECT_TRUE(std::isinf(never.growths.at(0).max_length));
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

struct Bad {
  const char* what;
  const char* scene;
  Changes changes;
  std::string message;  ///< its end
};
void PrintTo(const Bad& bad, std::ostream* out) { *out << bad.what; }

class BadSpace : public ::testing::TestWithParam<Bad> {};

TEST_P(BadSpace, IsRefusedWithOneMessage) {
  const std::string message = complaint(GetParam().scene, GetParam().changes);
  ASSERT_FALSE(message.empty()) << GetParam().changes[0];
  EXPECT_TRUE(message.ends_with(GetParam().message)) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

constexpr const char *kPendulum = "plate_pendulum", *kTwist = "square_plate_twist",
                     *kRoll = "cantilever_roll_up", *kSleeve = "elastic_sleeve",
                     *kDeploy = "deploying_plate", *kPlanar = "rotating_plate_v01";

const Bad kBad[] = {
    {"unknown_space", kPendulum, {"body.space=hyper"}, "a space is one of 'plane', 'space'"},
    {"two_spaces",
     kPendulum,
     {"body=[{name='a', element='ancf_plate', space='space', terms=['inertia', 'membrane', "
      "'bending'], length=1, width=1, thickness=1, density=1, youngs_modulus=1, poisson_ratio=0, "
      "elements=[1, 1]}, {name='b', element='ancf_plate', space='plane', terms=['inertia']}]"},
     "all bodies of a scene live in the plane, or all in space"},
    {"bending_in_the_plane",
     kPlanar,
     {"body.terms=[\"inertia\", \"bending\"]"},
     "a term is one of 'inertia', 'membrane', 'damping', none twice"},
    {"space_without_bending",
     kPendulum,
     {"body.terms=[\"inertia\", \"membrane\"]"},
     "a plate in space has \"bending\" and \"membrane\" or \"membrane_assumed\""},
    {"two_membranes",
     kPendulum,
     {"body.terms=[\"inertia\", \"membrane\", \"membrane_assumed\", \"bending\"]"},
     "\"membrane_assumed\" stands in place of \"membrane\""},
    {"planar_gravity",
     kPendulum,
     {"gravity=[0, -9.81]"},
     "a list of 3: gravity is a finite number [m/s^2]"},
    {"unknown_integrator",
     kPendulum,
     {"time.integrator=euler"},
     "an integrator is one of 'generalized_alpha', 'energy_momentum', 'minimal_coordinates'"},
    {"start_without_a_hub",
     kPendulum,
     {"time.start=prestretched"},
     "\"prestretched\" is for bodies in hubs whose lines are not free"},
    {"energy_momentum_with_free_lines",
     kSleeve,
     {"time.integrator=energy_momentum"},
     "free material lines ([[body.line]]) need \"generalized_alpha\": \"energy_momentum\" does not "
     "know them"},
    {"minimal_coordinates_with_free_lines",
     kSleeve,
     {"time.integrator=minimal_coordinates"},
     "need \"generalized_alpha\": \"minimal_coordinates\" does not know them"},
    {"tolerance_of_another_integrator",
     kPendulum,
     {"time.tolerance=1e-8"},
     "only step = \"adaptive\" and \"minimal_coordinates\" have one"},
    {"tolerance_too_small",
     kPendulum,
     {"time.integrator=minimal_coordinates", "time.tolerance=1e-15"},
     "a tolerance lies between 1e-13 and 0.1"},
    {"energy_momentum_with_pressure",
     kPendulum,
     {"time.integrator=energy_momentum", "load=[{type='pressure', body='plate', pressure=1}]"},
     "a load that follows the plate needs integrator = \"generalized_alpha\""},
    {"unknown_joint",
     kPendulum,
     {"joint.0.type=hinge"},
     "'slider', 'angle_drive', 'distance', 'point_drive', 'gear'"},
    {"pin_outside",
     kPendulum,
     {"joint.0.point=[0.4, 0]"},
     "a material point of 'plate' lies in [0, 0.3] x [0, 0.3] [m]"},
    {"pin_without_point",
     kPendulum,
     {"joint=[{type='pin', body='plate'}]"},
     "joint.point is missing: a list of 2: a material coordinate is a finite number [m]"},
    {"unknown_component",
     kTwist,
     {"joint.1.components=[\"w\"]"},
     "a list: a component is one of 'x', 'y', 'z', none twice"},
    {"unknown_edge",
     kRoll,
     {"joint.0.edges=[\"top\"]"},
     "a list: an edge is one of 'root', 'free_end', 'side_low', 'side_high', none twice"},
    {"key_of_another_joint",
     kRoll,
     {"joint.0.point=[0, 0]"},
     "unknown key; known here: body edges mode type"},
    {"clamp_in_the_plane",
     kPlanar,
     {"joint=[{type='weld', body='plate', edge='root', to='hub'}, {type='clamp', body='plate', "
      "edges=['free_end']}]"},
     "edges are held in space; bodies in the plane have hubs"},
    {"clamp_in_a_sleeve",
     kSleeve,
     {"joint=[{type='sleeve', body='strip', edge='line 3'}, {type='clamp', body='strip', "
      "edges=['root']}]"},
     "'strip' sits in a hub or sleeve: hold it there"},
    {"two_sleeves",
     kSleeve,
     {"joint=[{type='sleeve', body='strip', edge='line 3'}, {type='sleeve', body='strip', "
      "edge='line 4'}]"},
     "'strip' sits in a hub or sleeve already"},
    {"line_beyond_the_mesh",
     kSleeve,
     {"joint.0.edge=\"line 7\""},
     "an edge is 'root', 'line 0' to 'line 6'"},
    {"line_of_a_growing_body", kDeploy, {"joint.0.edge=\"line 2\""}, "an edge is 'root'"},
    {"sleeve_on_a_growing_body",
     kDeploy,
     {"joint=[{type='sleeve', body='plate', edge='root'}]"},
     "material flows out of a hub, see \"weld\", not out of a sleeve"},
    {"free_line_of_a_growing_body",
     kDeploy,
     {"body.line=[{index=3, free=true}]"},
     "material flows through 'plate': its lines come and go"},
    {"limits_of_an_inner_line",
     kSleeve,
     {"body.line=[{index=3, free=true, max_length=0.2}]"},
     "lines of nodes come and go next to a free root line: index = 0, free = true"},
    {"limits_that_chatter",
     kSleeve,
     {"body.line=[{index=0, free=true, max_length=0.2, min_length=0.1}]", kRootSleeve},
     "min_length + 0.5 max_length stays below 0.9 max_length, or elements are split and merged in "
     "turn"},
    {"limits_that_are_passed_at_the_start",
     kSleeve,
     {"body.line=[{index=0, free=true, max_length=0.1}]", kRootSleeve},
     "m long at the start: between min_length and max_length [m]"},
    {"limits_and_other_lines",
     kSleeve,
     {"body.line=[{index=0, free=true, max_length=0.2}, {index=3, at=0.42}]", kRootSleeve},
     "lines come and go next to the root: no other line has a number to name it"},
    {"edge_by_a_number_that_changes",
     kSleeve,
     {"body.line=[{index=0, free=true, max_length=0.2}]",
      "joint=[{type='sleeve', body='strip', edge='line 3'}]"},
     "an edge is 'root'"},
    {"free_line_without_a_joint",
     kPendulum,
     {"body.line=[{index=3, free=true}]"},
     "nothing holds the free line 3: a [[joint]] \"sleeve\" or \"weld\" with edge = \"line 3\", or "
     "a \"line_drive\", is missing"},
    {"line_of_nothing",
     kPendulum,
     {"body.line=[{index=3}]"},
     "a line is `free`, or `at` a place of its own, or both"},
    {"lines_out_of_order",
     kSleeve,
     {"body.line=[{index=3, free=true, at=0.6}]"},
     "lines 3 and 4 begin at 0.6 m and 0.5333 m: they must increase"},
    {"line_too_many",
     kSleeve,
     {"body.line=[{index=9, free=true}]"},
     "the number of an m-line before the free end is a whole number between 0 and 5"},
    {"drive_of_a_fixed_line",
     kSleeve,
     {"joint=[{type='sleeve', body='strip', edge='line 3'}, {type='line_drive', body='strip', "
      "line=2}]"},
     "only a free line is driven: see [[body.line]]"},
    {"unknown_load",
     kTwist,
     {"load.0.type=wind"},
     "a load is one of 'point', 'edge', 'surface', 'pressure', 'edge_moment'"},
    {"planar_force",
     kTwist,
     {"load.0.force=[0, 1]"},
     "a list of 3: a force is a finite number [N]"},
    {"load_outside",
     kTwist,
     {"load.0.point=[1, 2]"},
     "a material point of 'plate' lies in [0, 1] x [0, 1] [m]"},
    {"load_on_an_unknown_edge",
     kRoll,
     {"load.0.edge=end"},
     "an edge is 'root', 'free_end', 'side_low', 'side_high', 'line 0' to 'line 16'"},
    {"moment_in_the_plane",
     kPlanar,
     {"load=[{type='edge_moment', body='plate', edge='free_end', moment=1}]"},
     "this load acts on a plate in space"},
    {"surface_load_on_free_lines",
     kSleeve,
     {"load=[{type='surface', body='strip', force=[0, 0, 1]}]"},
     "surface load: on a body with free material lines"},
    {"load_between_moving_lines",
     kSleeve,
     {"load=[{type='point', body='strip', point=[0.4, 0.02], force=[0, 0, 1]}]"},
     "next to a free material line only points on fixed lines can be loaded"},
    {"observed_twice",
     kTwist,
     {"observe=[{name='a', body='plate', point=[0, 0]}, {name='a', body='plate', point=[1, 1]}]"},
     "there is another 'a' of 'plate'"},
    {"observed_nowhere",
     kTwist,
     {"observe=[{name='a', body='plate'}]"},
     "an observed point has either a `point` or `at` = \"free_end\""},
    {"observed_in_the_hub",
     kDeploy,
     {"observe=[{name='a', body='plate', point=[0.3, 0]}]"},
     "a material point of 'plate' lies in [0.5, 0.9] x [0, 0.1] [m]"},
    {"static_with_time", kRoll, {"time.end=1"}, "a scene with a [static] analysis has no 'time'"},
    {"unknown_path", kRoll, {"static.path=steep"}, "a path is one of 'load', 'arc_length'"},
    {"no_steps",
     kRoll,
     {"static.steps=0"},
     "a number of steps is a whole number between 1 and 1000000"},
    {"nowhere_to_go", kRoll, {"static.to=0"}, "the load factor grows from 0 to another value"},
    {"nothing_loads",
     kRoll,
     {"load=[]"},
     "nothing loads the bodies: gravity, a [[load]] or [body.heat] is missing"},
    {"static_flow",
     kRoll,
     {"body.element=ale_ancf_plate", "body.flow={speed=0.1, max_length=0.2, min_length=0.01}"},
     "in a [static] analysis no material flows"},
    {"weight_without_density",
     kRoll,
     {"gravity=[0, 0, -1]"},
     "body.density is missing: a density is positive [kg/m^3]"},
    {"design_in_space",
     kDeploy,
     {"design=[{body='plate', cell=0.01, components=[4, 1], max_volume=0.5, min_thickness=0.005}]",
      "esl.every=0.1", "body.terms=[\"inertia\", \"membrane\", \"bending\"]"},
     "a designed body lives in the plane and has no free lines"},
};
INSTANTIATE_TEST_SUITE_P(Inputs, BadSpace, ::testing::ValuesIn(kBad),
                         [](const auto& test) { return std::string(test.param.what); });

}  // namespace
}  // namespace flexmorph::cases
