// Shows that a run builds one mechanism per mesh and one rigid kinematic model, that motions do not
// change the prepared mechanism, and that a prepared case builds only what is needed.
#include <gtest/gtest.h>

#include "cases/run/compute.h"
#include "cases/run/motion_run.h"
#include "tests/cases/scenes.h"

namespace flexmorph::cases {
namespace {

// Two cycles, each with a motion for its loads and one on the cells of the designs; then motions
// with the designs and with uniform material on both meshes.
TEST(PreparedCase, HasOneMechanismPerMeshInARunOfTwoCycles) {
  const PreparedCase prepared(read(
      "four_bar", {"design.cell=0.025", "design.min_thickness=0.025", "cycle.max_cycles=2",
                   "cycle.tolerance=0", "cycle.load_difference=0", "optimizer.max_iterations=2",
                   "time.end=0.02", "esl.every=0.01", "verify.cells=1", "design.min_feature=0",
                   "output.vtk=false", "output.plots=false", "output.tolerance=1e-3", "expect="}));
  ASSERT_TRUE(prepared.scene().verifies_on_cells());
  const RunResult result = compute(prepared);
  EXPECT_EQ(result.design.cycles, 2);
  ASSERT_TRUE(result.motions.verified && result.motions.verified_uniform);
  ASSERT_TRUE(result.motions.motion && result.motions.uniform);
  const PreparedCase::Counts counts = prepared.counts();
  EXPECT_EQ(counts.mechanisms, 2);  // elements of the case, cells of the designs
  EXPECT_EQ(counts.rigid, 1);
  EXPECT_EQ(counts.design_problems, 1);
}

// A motion of a copy of the prepared mechanism equals a motion of a mechanism that was built for it
// alone.
TEST(PreparedCase, GivesEveryMotionACopy) {
  const PreparedCase prepared(read("deploying_beam", {"time.end=0.05"})),
      fresh(read("deploying_beam", {"time.end=0.05"}));
  const MotionRecord first = run_motion(prepared, {}).record,
                     again = run_motion(prepared, {}).record, alone = run_motion(fresh, {}).record;
  EXPECT_EQ(first.table.values, again.table.values);
  EXPECT_EQ(first.table.values, alone.table.values);
  EXPECT_EQ(prepared.counts().mechanisms, 1);
}

TEST(PreparedCase, BuildsNothingThatNobodyAsksFor) {
  const PreparedCase plate(read("short_beam"));
  EXPECT_EQ(plate.rigid(), nullptr);
  EXPECT_EQ(plate.design_problems().size(), 1u);
  EXPECT_GT(plate.resource_estimate().iterations, 0);
  EXPECT_EQ(plate.counts().mechanisms, 0);
  EXPECT_EQ(plate.counts().rigid, 0);
}

}  // namespace
}  // namespace flexmorph::cases
