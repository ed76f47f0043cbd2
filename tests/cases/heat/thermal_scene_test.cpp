// Shows the meaning of beams, heat and measures in case files, and that wrong input is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include "cases/assembly/build.h"
#include "cases/assembly/heat.h"
#include "cases/results/body_measures.h"
#include "fem/elements/ancf_beam.h"
#include "tests/cases/scenes.h"
#include "tests/io/scratch.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

TEST(ThermalScene, BeamIsReadAndBuilt) {
  const Scene scene = read("slider_crank_heated");
  const Body& rod = scene.body("rod");
  EXPECT_EQ(rod.term_domain(), fem::TermDomain::beam);
  EXPECT_EQ(rod.elements, (std::array{6, 1}));
  EXPECT_EQ(rod.width, 5.76e-3);     // in the plane of the motion
  EXPECT_EQ(rod.thickness, 5.5e-3);  // across the plane
  const Mechanism mechanism = build_mechanism(scene);
  const fem::Body& built = mechanism.model.body("rod");
  const auto& beam = dynamic_cast<const fem::AncfBeam&>(*built.element);
  EXPECT_EQ(beam.height(), 5.76e-3);
  EXPECT_EQ(built.section->thickness, 5.5e-3);
  // The start is undeformed at the position of the case file and has the velocities of the rigid
  // mechanism: the crank pin moves up at r ω, the slider is static.
  fem::Workspace& model = const_cast<fem::Workspace&>(mechanism.model);
  const fem::State x = fem::start_state(model, mechanism.moving_roots, 0, mechanism.motion.start,
                                        mechanism.motion.body_poses);
  const fem::PointMotion pin = fem::point_motion(built, x, {0, 0}),
                         middle = fem::point_motion(built, x, {0.152, 0}),
                         slider = fem::point_motion(built, x, {0.304, 0});
  EXPECT_NEAR((pin.position - Vec2(0.152, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((pin.velocity - Vec2(0, 0.152 * std::numbers::pi)).norm(), 0, 1e-12);
  EXPECT_NEAR((middle.velocity - Vec2(0, 0.076 * std::numbers::pi)).norm(), 0, 1e-12);
  EXPECT_NEAR(slider.velocity.norm(), 0, 1e-12);
}

TEST(ThermalScene, HeatOfABodyIsThatOfTheModel) {
  const Scene scene = read("slider_crank_heated", {"body.heat.start=0.2"});
  ASSERT_TRUE(scene.has_heat());
  const BodyHeat& heat = *scene.body("rod").heat;
  EXPECT_EQ(heat.profile, "quartic");
  EXPECT_TRUE(heat.force);
  const Mechanism mechanism = build_mechanism(scene);
  const std::optional<fem::Heat>& hot = mechanism.model.body("rod").heat;
  ASSERT_TRUE(hot.has_value());
  EXPECT_EQ(hot->volume_exponent(), 3);
  EXPECT_EQ(hot->temperature(0.1).value, 0);
  const double u = 0.25;  // 6u² - 8u³ + 3u⁴
  EXPECT_NEAR(hot->temperature(0.45).value, 50 * (6 * u * u - 8 * u * u * u + 3 * u * u * u * u),
              1e-12);
  EXPECT_EQ(hot->temperature(1.5).value, 50);
  EXPECT_EQ(hot->expansion, 80e-6);
  // Steps end where the acceleration of the temperature jumps: s'' jumps by 12 at the start of the
  // profile and is 0 at its end.
  const auto stops_at = [](const Mechanism& m, double discontinuity) {
    return std::any_of(m.motion.discontinuities.begin(), m.motion.discontinuities.end(),
                       [&](double t) { return std::abs(t - discontinuity) < 1e-12; });
  };
  EXPECT_TRUE(stops_at(mechanism, 0.2));
  const Mechanism linear = build_mechanism(
      read("slider_crank_heated", {"body.heat.start=0.2", "body.heat.profile=linear"}));
  for (const double discontinuity : {0.2, 1.2})
    EXPECT_TRUE(stops_at(linear, discontinuity)) << discontinuity;
}

TEST(ThermalScene, DriveMaySayTheTemperature) {
  const Scene scene =
      read("slider_crank_heated", {"body.heat={expansion=1e-5, rise=\"warm\"}",
                                   "drive=[{name=\"turn\", formula=\"pi*t\"}, {name=\"warm\", "
                                   "formula=\"20*sin(t)\"}]"});
  const Mechanism mechanism = build_mechanism(scene);
  const fem::Motion at = mechanism.model.body("rod").heat->temperature(0.5);
  EXPECT_NEAR(at.value, 20 * std::sin(0.5), 1e-13);
  EXPECT_NEAR(at.acceleration, -20 * std::sin(0.5), 1e-13);
  EXPECT_TRUE(mechanism.motion.discontinuities.empty());
}

TEST(ThermalScene, ColdSceneHasNothingOfIt) {
  const Mechanism cold = build_mechanism(read("four_bar"));
  for (const fem::Body& body : cold.model.bodies()) EXPECT_FALSE(body.heat.has_value());
  EXPECT_TRUE(cold.model.force_elements().empty());
  EXPECT_TRUE(cold.motion.stops.empty());
}

// The thermal force is a force element. It exists if the case requests it and if the profile has an
// acceleration of the temperature.
TEST(ThermalScene, ThermalForceIsThereWhenItActs) {
  const auto links = [](const Changes& changes) {
    return build_mechanism(read("free_beam_heated", changes)).model.force_elements().size();
  };
  EXPECT_EQ(links({}), 1u);
  EXPECT_EQ(links({"body.heat.force=false"}), 0u);
  EXPECT_EQ(links({"body.heat.profile=step"}), 0u);
}

TEST(ThermalScene, UndeformedArcLiesOnItsCircle) {
  Body body;
  body.length = 2;
  body.arc = 0.5 * std::numbers::pi;
  const double R = 2 / body.arc;
  EXPECT_NEAR((undeformed_location(body, {2, 0}) - Vec2(R, R)).norm(), 0, 1e-14);
  EXPECT_NEAR((undeformed_location(body, {1, 0.1}) -
               (Vec2(0, R) + (R - 0.1) * Vec2(std::sin(1 / R), -std::cos(1 / R))))
                  .norm(),
              0, 1e-14);
}

TEST(ThermalScene, ErrorsNameFileLineAndKey) {
  std::ifstream in(std::string(FLEXMORPH_CASES) + "/free_beam_heated.toml");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  text.replace(text.find("\"quartic\""), 9, "\"abrupt\"");
  const auto line = 1 + std::count(text.begin(), text.begin() + long(text.find("abrupt")), '\n');
  const Scratch scratch;
  const std::string file = scratch.write("wrong.toml", text);
  const std::string error =
      testing::error_of(Error::Kind::input, [&] { read_scene(io::CaseFile(file)); });
  EXPECT_TRUE(testing::mentions_all(
      error, {"'quartic', 'cosine', 'quintic', 'linear', 'step'"},
      file + ":" + std::to_string(line) + ":11: body.heat.profile = \"abrupt\": "));
}

struct Bad {
  const char* what;
  const char* scene;
  Changes changes;
  std::vector<std::string> parts;  ///< Parts of the message after its location.
};
void PrintTo(const Bad& bad, std::ostream* out) { *out << bad.what; }
class BadThermal : public ::testing::TestWithParam<Bad> {};

TEST_P(BadThermal, IsRefusedAtItsLocation) {
  const std::string text =
      testing::error_of(Error::Kind::input, [&] { read(GetParam().scene, GetParam().changes); });
  EXPECT_TRUE(testing::mentions_all(
      text, GetParam().parts, location_in(text, shipped(GetParam().scene), GetParam().changes)));
}

constexpr const char* kFree = "free_beam_heated";
constexpr const char* kCrankCase = "slider_crank_heated";
constexpr const char* kHeld = "beam_heated_held";
const std::vector<Bad> kBad = {
    {"plate_term",
     kFree,
     {"body.terms=[\"inertia\", \"membrane\"]"},
     {"'inertia', 'gcm', 'ecm', 'gcm_full', 'ecm_full', 'damping'"}},
    {"two_models",
     kFree,
     {"body.terms=[\"inertia\", \"gcm\", \"ecm\"]"},
     {"ecm", "gcm", "alternatives"}},
    {"no_inertia", kFree, {"body.terms=[\"gcm\"]"}, {"inertia"}},
    {"plate_elements", kFree, {"body.elements=[2, 1]"}, {"whole number", "100000"}},
    {"thickness", kFree, {"body.thickness=0.1"}, {"`height`", "`width`"}},
    {"beam_in_space", kFree, {"body.space=space"}, {"'plane'"}},
    {"flow", kFree, {"body.flow={speed=0.1, max_length=1}"}, {"element", "ale_ancf_plate"}},
    {"lines", kFree, {"body.line=[{index=0, free=true}]"}, {"beam", "[[body.line]]"}},
    {"tight_arc", kFree, {"body.arc=6", "body.height=0.4"}, {"height", "radius", "0.1667 m"}},
    {"no_expansion",
     kFree,
     {"body.heat={rise=1, duration=1}"},
     {"body.heat.expansion", "missing", "[1/K]"}},
    {"no_settle",
     kFree,
     {"body.heat={rise=1, expansion=1e-4}"},
     {"body.heat.duration", "missing", "[s]"}},
    {"profile",
     kFree,
     {"body.heat.profile=cubic"},
     {"'quartic', 'cosine', 'quintic', 'linear', 'step'"}},
    {"volume", kFree, {"body.heat.volume=shrunk"}, {"'grown', 'grown_plane', 'reference'"}},
    {"too_cold", kFree, {"body.heat.rise=-20000"}, {"expansion * rise", "positive"}},
    {"drive", kFree, {"body.heat.rise=warm"}, {"drive"}},
    {"unknown_key",
     kFree,
     {"body.heat.colour=red"},
     {"duration, expansion, force, profile, rise, start, volume"}},
    {"profile_of_drive",
     kCrankCase,
     {"body.heat.rise=turn"},
     {"body.heat.profile", "drive", "rise"}},
    {"profile_at_rest", kHeld, {"body.heat.profile=linear"}, {"[static]", "static.grows"}},
    {"force_at_rest", kHeld, {"body.heat.force=true"}, {"[static]", "inertia force"}},
    {"grows", kHeld, {"static.grows=everything"}, {"'loads', 'temperatures', 'both'"}},
    {"no_load_grows", kHeld, {"static.grows=both", "load=[]"}, {"load", "gravity"}},
    {"cold_grows",
     "cantilever_roll_up",
     {"static.grows=temperatures"},
     {"temperature", "[body.heat]"}},
    {"quantity",
     kFree,
     {"measure.quantities=[\"colour\"]"},
     {"'end_displacements', 'end_slopes', 'end_velocity'"}},
    {"velocity_at_rest",
     kHeld,
     {"measure.quantities=[\"end_velocity\"]"},
     {"end_velocity", "[static]"}},
    {"cold_temperature",
     "four_bar",
     {"measure=[{body=\"rocker\", quantities=[\"temperature\"]}]"},
     {"measure.quantities", "temperature", "'rocker'", "[body.heat]"}},
    {"load",
     kHeld,
     {"load=[{type=\"edge\", body=\"beam\", edge=\"free_end\", force=[0, 1]}]"},
     {"load.type = \"edge\"", "point", "line", "torque"}},
    {"design",
     kCrankCase,
     {"design=[{body='rod', cell=0.001, components=[4, 1], max_volume=0.5, min_thickness=0.0005}]",
      "esl.every=0.1"},
     {"design.body = 'rod'", "beams"}},
    {"force_with_flow",
     "rotating_plate_v05",
     {"body.heat={expansion=1e-5, rise=10, duration=1, force=true}"},
     {"body.heat.force = true", "flow"}},
};
INSTANTIATE_TEST_SUITE_P(Inputs, BadThermal, ::testing::ValuesIn(kBad),
                         [](const auto& test) { return std::string(test.param.what); });

}  // namespace
}  // namespace flexmorph::cases
