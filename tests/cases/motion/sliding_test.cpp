// Shows that the material of a plate slides freely through a joint on a rigid body.

#include <gtest/gtest.h>

#include "cases/assembly/build.h"
#include "tests/io/scratch.h"

namespace flexmorph::cases {
namespace {

constexpr const char* kFalling = R"toml(
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
[[observe]]
name = "tip"
body = "strip"
at = "free_end"
)toml";

// A strip hangs out of a frictionless bearing that is held upright. It falls freely without strain,
// as ½ g t² says, and new elements leave the bearing.
TEST(FreeSlide, FallsOutOfARigidBody) {
  const Scratch scratch;
  const Scene scene = read_scene(io::CaseFile(scratch.write("falling.toml", kFalling)));
  Mechanism mechanism = build_mechanism(scene);
  const fem::MotionResult r = fem::integrate(
      mechanism.model, mechanism.moving_roots, mechanism.motion, [&](const fem::MotionStep& step) {
        const double t = step.x.t, fallen = 0.5 * 9.81 * t * t;
        const Vec3 tip = fem::point_position(step.model.body("strip"), step.x, {0.4, 0});
        EXPECT_NEAR(tip.x(), 0, 1e-11);
        EXPECT_NEAR(tip.y(), -0.45 - fallen, 1e-10) << t;
        EXPECT_LT(step.energies.strain, 1e-12);
      });
  EXPECT_EQ(r.events.size(), 3u);  // after 0.04, 0.1 and 0.16 m of fall
}

}  // namespace
}  // namespace flexmorph::cases
