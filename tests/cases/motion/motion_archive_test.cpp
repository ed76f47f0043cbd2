// Shows that a motion resumed from a checkpoint between two steps equals the uninterrupted motion
// bit for bit: for every integrator, shape set and kind of body, for meshes that change and for
// adaptive steps; and that saving a checkpoint changes nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "cases/assembly/build.h"
#include "geometry/archive.h"
#include "tests/cases/scenes.h"
#include "tests/io/scratch.h"

namespace flexmorph::cases {
namespace {

/// The observed values of all steps of a motion, as bytes.
using DesignView = std::vector<std::string>;

std::string bytes_of(const fem::MotionStep& step) {
  Archive m;
  fem::State x = step.x;
  fem::Energies e = step.energies;
  fem::Powers p = step.powers;
  double sums[] = {step.work, step.dissipated, step.energy_error};
  bool stop = step.stop;
  m(x.t, x.q, x.v, x.a, x.lambda, x.turned, e, p, sums[0], sums[1], sums[2], stop);
  return m.bytes();
}

std::string bytes_of(const fem::MotionResult& result) {
  Archive m;
  fem::MotionResult r = result;
  m(r.final.t, r.final.q, r.final.v, r.final.a, r.final.lambda, r.counts, r.smallest_step,
    r.largest_step, r.energy_error, r.energy_gain, r.start_change, r.cut.number, r.cut.since,
    r.cut.shortest, r.constraint_drift, r.velocity_drift, r.condition, r.smallest_area_ratio);
  size_t n[] = {r.events.size(), r.near_singular.size()};
  m(n[0], n[1]);
  for (fem::MeshEvent& event : r.events) m(event.time, event.body, event.before, event.tip_jump);
  for (fem::Conditioning& each : r.near_singular) m(each.t, each.condition, each.joints);
  if (r.alternation) m(r.alternation->time, r.alternation->part);
  return m.bytes();
}

struct Motion {
  DesignView steps;
  std::string result;
  int events = 0;
  /// Checkpoints: the number of steps observed before each one, and its contents.
  std::vector<std::pair<size_t, std::string>> memories;
};

/// Computes a motion, resumed from `memory` if this is not empty. @param every  number of steps
/// between checkpoints; 0 for none
Motion move(const Scene& scene, const std::string& memory, size_t every) {
  Mechanism mechanism = build_mechanism(scene);
  fem::MotionSettings& settings = mechanism.motion;
  settings.memory = memory;
  settings.condition = true;
  for (int k = 1; k < 5; ++k) settings.stops.push_back(0.19 * k * settings.end);
  Motion out;
  size_t n = 0;
  if (every > 0)
    settings.between_steps = [&](const fem::SaveCheckpoint& save_checkpoint) {
      if (++n % every == 0) out.memories.emplace_back(out.steps.size(), save_checkpoint());
    };
  const fem::MotionResult result =
      fem::integrate(mechanism.model, mechanism.moving_roots, settings,
                     [&](const fem::MotionStep& step) { out.steps.push_back(bytes_of(step)); });
  out.result = bytes_of(result);
  out.events = static_cast<int>(result.events.size());
  return out;
}

/// Describes the first step that differs; empty if all are equal.
std::string difference(const DesignView& whole, const DesignView& rest, size_t from) {
  if (whole.size() != from + rest.size())
    return std::to_string(rest.size()) + " steps after " + std::to_string(from) + " of " +
           std::to_string(whole.size());
  for (size_t k = 0; k < rest.size(); ++k)
    if (whole[from + k] != rest[k]) return "step " + std::to_string(k + 1) + " of the rest";
  return "";
}

struct Case {
  const char* name;
  std::string scene;
  Changes changes;
  size_t every = 7;
  int events = 0;  ///< least number of changes of the mesh
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

/// @param locations  number of checkpoints from which the motion is resumed
void expect_same(const Scene& scene, const Case& c, size_t locations) {
  const Motion undisturbed = move(scene, "", 0), watched = move(scene, "", c.every);
  EXPECT_EQ(difference(undisturbed.steps, watched.steps, 0), "")
      << "checkpoint: the data end too early";
  // no EXPECT_EQ, because the bytes are not readable
  EXPECT_TRUE(watched.result == undisturbed.result);
  EXPECT_GE(undisturbed.events, c.events);
  ASSERT_GE(watched.memories.size(), 3U);
  const size_t n = watched.memories.size();
  for (size_t i = 0; i < locations; ++i) {  // evenly spaced checkpoints, each tested separately
    const auto& [from, memory] = watched.memories[(2 * i + 1) * n / (2 * locations)];
    const Motion rest = move(scene, memory, i % 2 == 0 ? 0 : c.every);
    EXPECT_EQ(difference(undisturbed.steps, rest.steps, from), "") << "after " << from << " steps";
    EXPECT_TRUE(rest.result == undisturbed.result) << "after " << from << " steps";
  }
}

class MotionCheckpointState : public ::testing::TestWithParam<Case> {};

TEST_P(MotionCheckpointState, GoesOnBitForBit) {
  const Case& c = GetParam();
  expect_same(read(c.scene, c.changes), c, 3);
}

class LongMotionMemory : public MotionCheckpointState {};

TEST_P(LongMotionMemory, GoesOnBitForBitFromTenLocations) {
  const Case& c = GetParam();
  expect_same(read(c.scene, c.changes), c, 10);
}

const Changes kRetracting = {"time.end=0.35", "body.0.flow.speed=-0.5",
                             "body.0.flow.min_length=0.03"};

// Drives with discontinuities and loads that jump; some steps end at such a time, where a
// checkpoint is saved.
const Changes kDiscontinuities = {
    "time.end=0.2",
    "constants.w=2",
    "body.elements=4",
    "gravity=[0.0, \"g\"]",
    "drive=[{name=\"turn\", formula=\"piecewise(w*t^2/0.2, 0.1, w*(t - 0.05))\"}, {name=\"g\", "
    "formula=\"-9.81*step(t - 0.05)\"}]",
    "load=[{type=\"point\", body=\"beam\", point=[10.0, 0.0], force=[\"g\", 1.0], turns=true}]"};
Changes discontinuities_by(const std::string& step) {
  Changes out = kDiscontinuities;
  out.push_back("time.step=" + step);
  return out;
}

// The model is large enough for a factorization with a border, which is kept between insertions of
// lines.
const Changes kOnCells = {"time.end=0.03",
                          "body.0.shape=q4",
                          "body.0.elements=[60, 12]",
                          "body.0.flow.max_length=",
                          "design=",
                          "optimizer=",
                          "esl=",
                          "verify=",
                          "cycle="};

const auto kCases = ::testing::Values(
    Case{"growing", "rotating_plate_v05", {"time.end=0.3"}, 7, 1},
    Case{"growing_h12", "rotating_plate_v05", {"time.end=0.3", "body.0.shape=h12"}, 7, 1},
    Case{"growing_cells", "rotating_plate_v05", kOnCells, 3, 2},
    Case{"growing_uniform",
         "rotating_plate_v05",
         {"time.end=0.2", "body.0.flow.mesh=uniform", "body.0.flow.max_length="},
         7,
         0},
    Case{"retracting", "rotating_plate_v05", kRetracting, 9, 1},
    Case{"growing_adaptive",
         "rotating_plate_v05",
         {"time.end=0.5", "time.step=adaptive", "time.tolerance=1e-3"},
         2,
         2},
    Case{"growing_energy_momentum",
         "rotating_plate_v05",
         {"time.end=0.25", "time.integrator=energy_momentum", "time.rho_inf=", "verify="},
         7,
         1},
    Case{"four_bar", "four_bar", {"time.end=0.3"}, 11},
    Case{"four_bar_adaptive", "four_bar", {"time.end=0.3", "time.step=adaptive"}, 3},
    Case{"four_bar_energy_momentum",
         "four_bar",
         {"time.end=0.2", "time.integrator=energy_momentum", "time.rho_inf=", "verify="},
         11},
    Case{"plate_in_space", "plate_pendulum", {"time.end=0.05"}, 3},
    Case{"plate_in_space_energy_momentum",
         "plate_pendulum",
         {"time.end=0.02", "time.integrator=energy_momentum",
          "time.rho_inf=", "body.0.elements=[4, 4]"},
         2},
    Case{"growing_in_space", "deploying_plate", {"time.end=0.25", "body.flow.mesh=split"}, 20, 1},
    Case{"plate_in_space_minimal_coordinates",
         "plate_pendulum",
         {"time.end=0.02", "time.integrator=minimal_coordinates",
          "time.rho_inf=", "body.0.elements=[3, 3]"},
         2},
    Case{"sleeve", "elastic_sleeve", {"time.end=0.1"}, 6},
    Case{"discontinuities", "spin_up", discontinuities_by("0.003"), 1},
    Case{"kinks_adaptive", "spin_up", discontinuities_by("adaptive"), 1},
    Case{"platform",
         "motion_platform",
         {"time.end=0.1", "design=", "optimizer=", "esl=", "verify=", "cycle="},
         9},
    Case{"crane",
         "telescopic_crane",
         {"time.end=0.8", "design=", "optimizer=", "esl=", "verify=", "cycle="},
         30});
const auto name_of = [](const auto& info) { return std::string(info.param.name); };
INSTANTIATE_TEST_SUITE_P(Cases, MotionCheckpointState, kCases, name_of);
INSTANTIATE_TEST_SUITE_P(Long, LongMotionMemory, kCases, name_of);

/// Scenes that no shipped case contains.
struct Written {
  const char* name;
  const char* text;
  Case expected;
};
void PrintTo(const Written& w, std::ostream* out) { *out << w.name; }

class WrittenMotionMemory : public ::testing::TestWithParam<Written> {};

TEST_P(WrittenMotionMemory, GoesOnBitForBit) {
  const Scratch scratch;
  const std::string path = scratch.write("scene.toml", GetParam().text);
  expect_same(read_scene(io::CaseFile(path, {})), GetParam().expected, 3);
}

/// This pendulum passes positions at which other coordinates become the independent ones.
constexpr const char* kDoublePendulum = R"toml(
gravity = [0.0, -9.81]
[time]
end = 1.5
step = 0.02
start = "rigid"
integrator = "minimal_coordinates"
[[rigid_body]]
name = "upper"
mass = 1.0
size = [1.0, 0.1]
center = [0.5, 0.0]
angle = 0.3
[[rigid_body]]
name = "lower"
mass = 1.0
size = [1.0, 0.1]
center = [0.5, 0.0]
position = [0.955336489125606, 0.29552020666133955]
angle = -0.5
[[joint]]
type = "revolute"
b = "upper"
[[joint]]
type = "revolute"
a = "upper"
point_a = [1.0, 0.0]
b = "lower"
)toml";

/// The root line of this strip is free: new elements leave the bearing as the strip falls.
constexpr const char* kFallingStrip = R"toml(
gravity = [0.0, -9.81]
[time]
end = 0.2
step = 1e-3
start = "rigid"
[[rigid_body]]
name = "bearing"
mass = 1.0
size = [0.1, 0.1]
angle = -1.5707963267948966
[[body]]
name = "strip"
element = "ancf_plate"
space = "plane"
terms = ["inertia", "membrane"]
length = 0.4
width = 0.05
thickness = 0.01
density = 2700.0
youngs_modulus = 1e9
poisson_ratio = 0.3
elements = [5, 1]
[[body.line]]
index = 0
free = true
max_length = 0.12
[[joint]]
type = "revolute"
b = "bearing"
[[joint]]
type = "angle_drive"
b = "bearing"
angle = -1.5707963267948966
[[joint]]
type = "weld"
body = "strip"
edge = "root"
to = "bearing"
point = [0.05, 0.0]
)toml";

INSTANTIATE_TEST_SUITE_P(
    Scenes, WrittenMotionMemory,
    ::testing::Values(Written{"minimal_coordinates", kDoublePendulum, {"", "", {}, 4}},
                      Written{"free_root", kFallingStrip, {"", "", {}, 12, 1}}),
    [](const auto& info) { return std::string(info.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Hot, MotionCheckpointState,
    ::testing::Values(Case{"beam", "free_beam_heated", {"time.end=0.1"}, 6},
                      Case{"slider_crank", "slider_crank_heated", {"time.end=0.1"}, 6},
                      Case{"boom", "heated_boom", {"time.end=0.3"}, 9}),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace flexmorph::cases
