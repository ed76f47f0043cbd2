// Shows that every bad input of scenes in space is refused with one message that gives location and
// reason.
#include <gtest/gtest.h>

#include "cases/check/ready.h"
#include "tests/cases/scenes.h"

namespace flexmorph::cases {
namespace {

std::string complaint(const std::string& name, const Changes& changes) {
  try {
    require_buildable(PreparedCase(read(name, changes)));
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), Error::Kind::input);
    return e.what();
  }
  return "";
}

constexpr const char* kRootSleeve = "joint=[{type='sleeve', body='strip', edge='root'}]";

struct Bad {
  const char* what;
  const char* scene;
  Changes changes;
  std::string message;  ///< End of the message.
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
     "all bodies of a scene are in the plane, or all are in space"},
    {"bending_in_the_plane",
     kPlanar,
     {"body.terms=[\"inertia\", \"bending\"]"},
     "a term is one of 'inertia', 'membrane', 'membrane_assumed', 'damping', each name at most "
     "once"},
    {"space_without_bending",
     kPendulum,
     {"body.terms=[\"inertia\", \"membrane\"]"},
     "a plate in space needs \"bending\" and \"membrane\" or \"membrane_assumed\""},
    {"two_membranes",
     kPendulum,
     {"body.terms=[\"inertia\", \"membrane\", \"membrane_assumed\", \"bending\"]"},
     "\"membrane_assumed\" and \"membrane\" are alternatives; only one of them is allowed"},
    {"planar_gravity",
     kPendulum,
     {"gravity=[0, -9.81]"},
     "a list of 3: gravity is a finite number [m/s^2], or the name of a drive"},
    {"unknown_integrator",
     kPendulum,
     {"time.integrator=euler"},
     "an integrator is one of 'generalized_alpha', 'energy_momentum', 'minimal_coordinates'"},
    {"start_without_a_hub",
     kPendulum,
     {"time.start=prestretched"},
     "\"prestretched\" needs bodies in hubs, without free material lines"},
    {"energy_momentum_with_free_lines",
     kSleeve,
     {"time.integrator=energy_momentum"},
     "free material lines ([[body.line]]) need integrator = \"generalized_alpha\"; "
     "\"energy_momentum\" does not support them"},
    {"minimal_coordinates_with_free_lines",
     kSleeve,
     {"time.integrator=minimal_coordinates"},
     "need integrator = \"generalized_alpha\"; \"minimal_coordinates\" does not support them"},
    {"tolerance_of_another_integrator",
     kPendulum,
     {"time.tolerance=1e-8"},
     "this key needs step = \"adaptive\" or integrator = \"minimal_coordinates\""},
    {"tolerance_too_small",
     kPendulum,
     {"time.integrator=minimal_coordinates", "time.tolerance=1e-15"},
     "a tolerance lies between 1e-13 and 0.1"},
    {"energy_momentum_with_pressure",
     kPendulum,
     {"time.integrator=energy_momentum", "load=[{type='pressure', body='plate', pressure=1}]"},
     "a load that turns with the body needs time.integrator = \"generalized_alpha\""},
    {"unknown_joint",
     kPendulum,
     {"joint.0.type=hinge"},
     "'slider', 'angle_drive', 'distance', 'point_drive', 'gear', 'path', did you mean "
     "'revolute'?"},
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
     "a list: a component is one of 'x', 'y', 'z', each name at most once"},
    {"unknown_edge",
     kRoll,
     {"joint.0.edges=[\"top\"]"},
     "a list: an edge is one of 'root', 'free_end', 'side_low', 'side_high', each name at most "
     "once"},
    {"key_of_another_joint",
     kRoll,
     {"joint.0.point=[0, 0]"},
     "unknown key; the keys allowed here are body, edges, mode, type"},
    {"clamp_in_the_plane",
     kPlanar,
     {"joint=[{type='weld', body='plate', edge='root', to='hub'}, {type='clamp', body='plate', "
      "edges=['free_end']}]"},
     "this joint holds edges of plates in space; bodies in the plane are welded to hubs"},
    {"clamp_in_a_sleeve",
     kSleeve,
     {"joint=[{type='sleeve', body='strip', edge='line 3'}, {type='clamp', body='strip', "
      "edges=['root']}]"},
     "'strip' is held in a hub, a sleeve or a rigid body, therefore its edges cannot be held by "
     "this joint"},
    {"two_sleeves",
     kSleeve,
     {"joint=[{type='sleeve', body='strip', edge='line 3'}, {type='sleeve', body='strip', "
      "edge='line 4'}]"},
     "'strip' is held in another hub, sleeve or rigid body already"},
    {"line_beyond_the_mesh",
     kSleeve,
     {"joint.0.edge=\"line 7\""},
     "an edge is 'root', 'line 0' to 'line 6'"},
    {"line_of_a_growing_body",
     kDeploy,
     {"joint.0.edge=\"line 2\""},
     "an edge is 'root', 'free_end'"},
    {"sleeve_on_a_growing_body",
     kDeploy,
     {"joint=[{type='sleeve', body='plate', edge='root'}]"},
     "a body with material flow is held by a \"weld\" to a hub or a rigid body, not by a sleeve"},
    {"free_line_of_a_growing_body",
     kDeploy,
     {"body.line=[{index=3, free=true}]"},
     "'plate' has material flow, which controls its lines: it has no [[body.line]]"},
    {"limits_of_an_inner_line",
     kSleeve,
     {"body.line=[{index=3, free=true, max_length=0.2}]"},
     "lines of nodes are inserted and removed only at a free root line: index = 0, free = true"},
    {"limits_that_chatter",
     kSleeve,
     {"body.line=[{index=0, free=true, max_length=0.2, min_length=0.1}]", kRootSleeve},
     "min_length is at most 0.4 max_length; otherwise elements are split and merged again and "
     "again"},
    {"limits_that_are_passed_at_the_start",
     kSleeve,
     {"body.line=[{index=0, free=true, max_length=0.1}]", kRootSleeve},
     "m long at the start; this length must lie between min_length and max_length [m]"},
    {"limits_and_other_lines",
     kSleeve,
     {"body.line=[{index=0, free=true, max_length=0.2}, {index=3, at=0.42}]", kRootSleeve},
     "lines are inserted and removed at the root, which changes their numbers: no other "
     "[[body.line]] is allowed"},
    {"edge_by_a_number_that_changes",
     kSleeve,
     {"body.line=[{index=0, free=true, max_length=0.2}]",
      "joint=[{type='sleeve', body='strip', edge='line 3'}]"},
     "an edge is 'root'"},
    {"free_line_without_a_joint",
     kPendulum,
     {"body.line=[{index=3, free=true}]"},
     "no joint holds the free line 3: the case needs a [[joint]] \"sleeve\" or \"weld\" with edge "
     "= \"line 3\", or a \"line_drive\""},
    {"line_of_nothing",
     kPendulum,
     {"body.line=[{index=3}]"},
     "a line needs free = true, a material coordinate `at`, or both"},
    {"lines_out_of_order",
     kSleeve,
     {"body.line=[{index=3, free=true, at=0.6}]"},
     "lines 3 and 4 begin at 0.6 m and 0.5333 m; the material coordinates of lines must increase"},
    {"line_too_many",
     kSleeve,
     {"body.line=[{index=9, free=true}]"},
     "the number of an m-line before the free end is a whole number between 0 and 5"},
    {"drive_of_a_fixed_line",
     kSleeve,
     {"joint=[{type='sleeve', body='strip', edge='line 3'}, {type='line_drive', body='strip', "
      "line=2}]"},
     "a driven line is free, see [[body.line]]"},
    {"unknown_load",
     kTwist,
     {"load.0.type=wind"},
     "a load is one of 'point', 'edge', 'surface', 'line', 'torque', 'pressure', 'edge_moment'"},
    {"planar_force",
     kTwist,
     {"load.0.force=[0, 1]"},
     "a list of 3: a force is a finite number [N], or the name of a drive"},
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
     "this load acts on plates in space only"},
    {"surface_load_on_free_lines",
     kSleeve,
     {"load=[{type='surface', body='strip', force=[0, 0, 1]}]"},
     "a surface load cannot act on a body with free material lines"},
    {"load_between_moving_lines",
     kSleeve,
     {"load=[{type='point', body='strip', point=[0.4, 0.02], force=[0, 0, 1]}]"},
     "a point next to a free material line can only be loaded if it is on a fixed line"},
    {"observed_twice",
     kTwist,
     {"observe=[{name='a', body='plate', point=[0, 0]}, {name='a', body='plate', point=[1, 1]}]"},
     "there is another point 'a' of 'plate'"},
    {"observed_nowhere",
     kTwist,
     {"observe=[{name='a', body='plate'}]"},
     "an observed point needs either a `point` or at = \"free_end\""},
    {"observed_in_the_hub",
     kDeploy,
     {"observe=[{name='a', body='plate', point=[0.3, 0]}]"},
     "a material point of 'plate' lies in [0.5, 0.9] x [0, 0.1] [m]"},
    {"static_with_time", kRoll, {"time.end=1"}, "a scene with a [static] analysis has no 'time'"},
    {"unknown_path", kRoll, {"static.path=steep"}, "a path method is one of 'load', 'arc_length'"},
    {"no_steps",
     kRoll,
     {"static.steps=0"},
     "a number of steps is a whole number between 1 and 1000000"},
    {"nowhere_to_go", kRoll, {"static.to=0"}, "a load factor at the end of the path is not 0"},
    {"nothing_loads",
     kRoll,
     {"load=[]"},
     "the bodies have no load: the case needs gravity, a [[load]] or [body.heat]"},
    {"static_flow",
     kRoll,
     {"body.element=ale_ancf_plate", "body.flow={speed=0.1, max_length=0.2, min_length=0.01}"},
     "a [static] analysis has no material flow"},
    {"weight_without_density",
     kRoll,
     {"gravity=[0, 0, -1]"},
     "body.density is missing: a density is positive [kg/m^3]"},
    {"design_in_space",
     kDeploy,
     {"design=[{body='plate', cell=0.01, components=[4, 1], max_volume=0.5, min_thickness=0.005}]",
      "esl.every=0.1", "body.terms=[\"inertia\", \"membrane\", \"bending\"]"},
     "must not have lines whose material coordinate is an unknown"},
};
INSTANTIATE_TEST_SUITE_P(Inputs, BadSpace, ::testing::ValuesIn(kBad),
                         [](const auto& test) { return std::string(test.param.what); });

}  // namespace
}  // namespace flexmorph::cases
