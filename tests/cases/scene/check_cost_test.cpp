// Shows that the cost of a step according to `flexmorph check` agrees with instructions that
// valgrind counted, within a factor of two.
#include "cases/check/check_cost.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cases/check/ready.h"

namespace flexmorph::cases {
namespace {

struct Counted {
  std::string name;
  std::vector<std::string> changes;
  double millions;  ///< Instructions of fem::integrate() per step [million], portable build.
};

using Words = std::vector<std::string>;

Words plus(Words a, const Words& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// The reference values are differences between runs of 20 and of 40 or 60 steps, as in
// tests/benchmark/absent_cost.sh; for the static path the count of ten steps minus that of a run
// without them. Bending was counted with 5 x 5 points.
TEST(StepOperations, AreWithinAFactorOfTwoOfCountedInstructions) {
  const Words plate = {"esl=", "design=", "optimizer=", "cycle=", "verify=", "accuracy="},
              at_rest = {"body.flow=", "body.element=ancf_plate"},
              points = {"body.bending_points=5"},
              in_space = {"body.space=space", "body.terms=[\"inertia\",\"membrane\",\"bending\"]",
                          "body.bending_points=5"};
  const std::vector<Counted> all = {
      {"rotating_plate_v05", plate, 7.6},
      {"rotating_plate_v05", plus(plate, in_space), 16.5},
      {"rotating_plate_v05", plus(plate, at_rest), 3.4},
      {"rotating_plate_v05", plus(plus(plate, at_rest), in_space), 8.4},
      {"plate_pendulum", points, 17.6},
      {"slider_crank_heated", {}, 0.39},
      {"elastic_sleeve", points, 25.9},
      {"motion_platform", plate, 14.3},
  };
  for (const Counted& each : all) {
    const Scene scene = read_scene(io::CaseFile(find_case(each.name), each.changes));
    const StepOperations found = step_operations(scene, build_mechanism(scene));
    EXPECT_GT(1e-6 * found.total(), each.millions / 2) << each.name;
    EXPECT_LT(1e-6 * found.total(), each.millions * 2) << each.name;
    EXPECT_EQ(found.flow > 0, scene.bodies.front().flow.has_value()) << each.name;
  }
}

}  // namespace
}  // namespace flexmorph::cases
