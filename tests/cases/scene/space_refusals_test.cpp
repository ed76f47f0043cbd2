// Shows that every bad input of scenes in space is refused with one message that gives location and
// reason.
#include <gtest/gtest.h>

#include "cases/check/ready.h"
#include "tests/cases/scenes.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

std::string refusal_in_space(const std::string& name, const Changes& changes) {
  try {
    require_buildable(PreparedCase(read(name, changes)));
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), Error::Kind::input);
    return e.what();
  }
  return "";
}

constexpr const char* kSleeveAtRoot = "joint=[{type='sleeve', body='strip', edge='root'}]";

struct BadInSpace {
  const char* what;
  const char* scene;
  Changes changes;
  std::vector<std::string> parts;  ///< Parts of the message after its location.
};
void PrintTo(const BadInSpace& bad, std::ostream* out) { *out << bad.what; }

class BadSpace : public ::testing::TestWithParam<BadInSpace> {};

TEST_P(BadSpace, IsRefusedWithOneMessage) {
  const std::string message = refusal_in_space(GetParam().scene, GetParam().changes);
  ASSERT_FALSE(message.empty()) << GetParam().changes[0];
  EXPECT_TRUE(
      testing::mentions_all(message, GetParam().parts,
                            location_in(message, shipped(GetParam().scene), GetParam().changes)));
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

constexpr const char *kPlatePendulum = "plate_pendulum", *kTwist = "square_plate_twist",
                     *kRoll = "cantilever_roll_up", *kSleeve = "elastic_sleeve",
                     *kDeploy = "deploying_plate", *kPlanar = "rotating_plate_v01";

const BadInSpace kBad[] = {
    {"unknown_space", kPlatePendulum, {"body.space=hyper"}, {"'plane', 'space'"}},
    {"two_spaces",
     kPlatePendulum,
     {"body=[{name='a', element='ancf_plate', space='space', terms=['inertia', 'membrane', "
      "'bending'], length=1, width=1, thickness=1, density=1, youngs_modulus=1, poisson_ratio=0, "
      "elements=[1, 1]}, {name='b', element='ancf_plate', space='plane', terms=['inertia']}]"},
     {"body.b.space = 'plane'", "all bodies"}},
    {"bending_in_the_plane",
     kPlanar,
     {"body.terms=[\"inertia\", \"bending\"]"},
     {"'inertia', 'membrane', 'membrane_assumed', 'damping'"}},
    {"space_without_bending",
     kPlatePendulum,
     {"body.terms=[\"inertia\", \"membrane\"]"},
     {"bending", "membrane_assumed"}},
    {"two_membranes",
     kPlatePendulum,
     {"body.terms=[\"inertia\", \"membrane\", \"membrane_assumed\", \"bending\"]"},
     {"membrane_assumed", "alternatives"}},
    {"planar_gravity", kPlatePendulum, {"gravity=[0, -9.81]"}, {"3", "[m/s^2]"}},
    {"unknown_integrator",
     kPlatePendulum,
     {"time.integrator=euler"},
     {"'generalized_alpha', 'energy_momentum', 'minimal_coordinates'"}},
    {"start_without_a_hub", kPlatePendulum, {"time.start=prestretched"}, {"prestretched", "hubs"}},
    {"energy_momentum_with_free_lines",
     kSleeve,
     {"time.integrator=energy_momentum"},
     {"[[body.line]]", "generalized_alpha", "energy_momentum"}},
    {"minimal_coordinates_with_free_lines",
     kSleeve,
     {"time.integrator=minimal_coordinates"},
     {"[[body.line]]", "generalized_alpha", "minimal_coordinates"}},
    {"tolerance_of_another_integrator",
     kPlatePendulum,
     {"time.tolerance=1e-8"},
     {"adaptive", "minimal_coordinates"}},
    {"tolerance_too_small",
     kPlatePendulum,
     {"time.integrator=minimal_coordinates", "time.tolerance=1e-15"},
     {"1e-13", "0.1"}},
    {"energy_momentum_with_pressure",
     kPlatePendulum,
     {"time.integrator=energy_momentum", "load=[{type='pressure', body='plate', pressure=1}]"},
     {"load.type = 'pressure'", "time.integrator", "generalized_alpha"}},
    {"unknown_joint",
     kPlatePendulum,
     {"joint.0.type=hinge"},
     {"'slider', 'angle_drive', 'distance', 'point_drive', 'gear', 'path'", "'revolute'",
      "'revolute'"}},
    {"pin_outside",
     kPlatePendulum,
     {"joint.0.point=[0.4, 0]"},
     {"'plate'", "[0, 0.3] x [0, 0.3] [m]"}},
    {"pin_without_point",
     kPlatePendulum,
     {"joint=[{type='pin', body='plate'}]"},
     {"joint.point", "missing", "[m]"}},
    {"unknown_component", kTwist, {"joint.1.components=[\"w\"]"}, {"'x', 'y', 'z'"}},
    {"unknown_edge",
     kRoll,
     {"joint.0.edges=[\"top\"]"},
     {"'root', 'free_end', 'side_low', 'side_high'"}},
    {"key_of_another_joint", kRoll, {"joint.0.point=[0, 0]"}, {"body, edges, mode, type"}},
    {"clamp_in_the_plane",
     kPlanar,
     {"joint=[{type='weld', body='plate', edge='root', to='hub'}, {type='clamp', body='plate', "
      "edges=['free_end']}]"},
     {"joint.1.type = 'clamp'", "space"}},
    {"clamp_in_a_sleeve",
     kSleeve,
     {"joint=[{type='sleeve', body='strip', edge='line 3'}, {type='clamp', body='strip', "
      "edges=['root']}]"},
     {"joint.1.type = 'clamp'", "'strip'", "sleeve"}},
    {"two_sleeves",
     kSleeve,
     {"joint=[{type='sleeve', body='strip', edge='line 3'}, {type='sleeve', body='strip', "
      "edge='line 4'}]"},
     {"joint.1.edge = 'line 4'", "'strip'", "already"}},
    {"line_beyond_the_mesh",
     kSleeve,
     {"joint.0.edge=\"line 7\""},
     {"'root'", "'line 0'", "'line 6'"}},
    {"line_of_a_growing_body", kDeploy, {"joint.0.edge=\"line 2\""}, {"'root', 'free_end'"}},
    {"sleeve_on_a_growing_body",
     kDeploy,
     {"joint=[{type='sleeve', body='plate', edge='root'}]"},
     {"joint.body = 'plate'", "weld", "sleeve"}},
    {"free_line_of_a_growing_body",
     kDeploy,
     {"body.line=[{index=3, free=true}]"},
     {"'plate'", "flow", "[[body.line]]"}},
    {"limits_of_an_inner_line",
     kSleeve,
     {"body.line=[{index=3, free=true, max_length=0.2}]"},
     {"body.line.max_length = 0.2", "index = 0", "free = true"}},
    {"limits_that_chatter",
     kSleeve,
     {"body.line=[{index=0, free=true, max_length=0.2, min_length=0.1}]", kSleeveAtRoot},
     {"body.line.max_length = 0.2", "min_length", "0.4"}},
    {"limits_that_are_passed_at_the_start",
     kSleeve,
     {"body.line=[{index=0, free=true, max_length=0.1}]", kSleeveAtRoot},
     {"body.line.max_length = 0.1", "0.1333 m", "min_length"}},
    {"limits_and_other_lines",
     kSleeve,
     {"body.line=[{index=0, free=true, max_length=0.2}, {index=3, at=0.42}]", kSleeveAtRoot},
     {"body.line.0", "root", "[[body.line]]"}},
    {"edge_by_a_number_that_changes",
     kSleeve,
     {"body.line=[{index=0, free=true, max_length=0.2}]",
      "joint=[{type='sleeve', body='strip', edge='line 3'}]"},
     {"joint.edge = 'line 3'", "'root'"}},
    {"free_line_without_a_joint",
     kPlatePendulum,
     {"body.line=[{index=3, free=true}]"},
     {"line 3", "[[joint]]", "sleeve", "weld", "line_drive"}},
    {"line_of_nothing",
     kPlatePendulum,
     {"body.line=[{index=3}]"},
     {"body.line", "free = true", "`at`"}},
    {"lines_out_of_order",
     kSleeve,
     {"body.line=[{index=3, free=true, at=0.6}]"},
     {"body.line", "0.6 m", "0.5333 m"}},
    {"line_too_many", kSleeve, {"body.line=[{index=9, free=true}]"}, {"body.line.index = 9", "5"}},
    {"drive_of_a_fixed_line",
     kSleeve,
     {"joint=[{type='sleeve', body='strip', edge='line 3'}, {type='line_drive', body='strip', "
      "line=2}]"},
     {"joint.1.line = 2", "[[body.line]]"}},
    {"unknown_load",
     kTwist,
     {"load.0.type=wind"},
     {"'point', 'edge', 'surface', 'line', 'torque', 'pressure', 'edge_moment'"}},
    {"planar_force", kTwist, {"load.0.force=[0, 1]"}, {"3", "[N]"}},
    {"load_outside", kTwist, {"load.0.point=[1, 2]"}, {"'plate'", "[0, 1] x [0, 1] [m]"}},
    {"load_on_an_unknown_edge",
     kRoll,
     {"load.0.edge=end"},
     {"'root', 'free_end', 'side_low', 'side_high'", "'line 0'", "'line 16'"}},
    {"moment_in_the_plane",
     kPlanar,
     {"load=[{type='edge_moment', body='plate', edge='free_end', moment=1}]"},
     {"load.type = 'edge_moment'", "space"}},
    {"surface_load_on_free_lines",
     kSleeve,
     {"load=[{type='surface', body='strip', force=[0, 0, 1]}]"},
     {"[body]", "'strip'", "surface load"}},
    {"load_between_moving_lines",
     kSleeve,
     {"load=[{type='point', body='strip', point=[0.4, 0.02], force=[0, 0, 1]}]"},
     {"'strip'", "0.4", "0.02", "fixed line"}},
    {"observed_twice",
     kTwist,
     {"observe=[{name='a', body='plate', point=[0, 0]}, {name='a', body='plate', point=[1, 1]}]"},
     {"observe.1.name = 'a'", "'plate'"}},
    {"observed_nowhere",
     kTwist,
     {"observe=[{name='a', body='plate'}]"},
     {"observe", "`point`", "free_end"}},
    {"observed_in_the_hub",
     kDeploy,
     {"observe=[{name='a', body='plate', point=[0.3, 0]}]"},
     {"observe.point = [0.3, 0]", "'plate'", "[0.5, 0.9] x [0, 0.1] [m]"}},
    {"static_with_time", kRoll, {"time.end=1"}, {"[time]", "[static]"}},
    {"unknown_path", kRoll, {"static.path=steep"}, {"'load', 'arc_length'"}},
    {"no_steps", kRoll, {"static.steps=0"}, {"whole number", "1000000"}},
    {"nowhere_to_go", kRoll, {"static.to=0"}, {"load factor"}},
    {"nothing_loads", kRoll, {"load=[]"}, {"[static]", "gravity", "[[load]]", "[body.heat]"}},
    {"static_flow",
     kRoll,
     {"body.element=ale_ancf_plate", "body.flow={speed=0.1, max_length=0.2, min_length=0.01}"},
     {"[static]", "flow"}},
    {"weight_without_density",
     kRoll,
     {"gravity=[0, 0, -1]"},
     {"body.density", "missing", "[kg/m^3]"}},
    {"design_in_space",
     kDeploy,
     {"design=[{body='plate', cell=0.01, components=[4, 1], max_volume=0.5, min_thickness=0.005}]",
      "esl.every=0.1", "body.terms=[\"inertia\", \"membrane\", \"bending\"]"},
     {"design.body = 'plate'", "planar"}},
};
INSTANTIATE_TEST_SUITE_P(Inputs, BadSpace, ::testing::ValuesIn(kBad),
                         [](const auto& test) { return std::string(test.param.what); });

}  // namespace
}  // namespace flexmorph::cases
