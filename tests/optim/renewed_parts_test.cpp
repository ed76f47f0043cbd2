// Components that lie end to end become one, and bars come where a frame misses them.

#include "optim/mmc/renewed_parts.h"

#include <gtest/gtest.h>

#include "tests/optim/mmc_small.h"

namespace flexmorph::mmc::test {
namespace {

constexpr Widths kWidths{0.018, 0};

BodyProblem problem_of(const std::vector<Component>& components) {
  DesignScale scale = kScale;
  scale.half_length = 0.02;
  return body_of(Design(kGrid, {}, scale).with(components), {tdf_settings()}, least_compliance(1));
}

// A straight beam of pieces is a beam of fewer, as heavy, along the same axis, and as good but for
// the half hundredth that joints may cost.
TEST(RenewedParts, PiecesOfABeamAreJoined) {
  std::vector<Component> pieces;
  for (int k = 0; k < 4; ++k)
    pieces.push_back(bar({-0.08 + 0.16 * k, 0.004}, {0.16 + 0.16 * k, 0.004}, 0.02));
  const BodyProblem problem = problem_of(pieces);
  ComplianceEvaluator loads = tip_load();
  UnderRepair design(problem, loads, kWidths);
  const double before = design.merit(pieces);
  const int joined = join_parts(design);
  EXPECT_GE(joined, 1);
  ASSERT_EQ(design.parts.size(), pieces.size() - static_cast<size_t>(joined));
  EXPECT_LE(design.merit(design.parts), 1.005 * before);
  EXPECT_NEAR(design.volume(design.parts), design.volume(pieces), 0.002);
  double left = 1, right = 0;
  for (const Component& c : design.parts) {
    EXPECT_NEAR(std::abs(std::cos(c.angle)), 1, 1e-12);
    EXPECT_NEAR(c.center.y(), 0.004, 1e-12);
    left = std::min(left, c.center.x() - c.half_length);
    right = std::max(right, c.center.x() + c.half_length);
  }
  EXPECT_NEAR(left, -0.08, 1e-12);
  EXPECT_NEAR(right, 0.64, 1e-12);
}

TEST(RenewedParts, CornersAndBranchesStay) {
  const std::vector<Component> frame = {bar({-0.1, 0.03}, {0.6, 0.03}, 0.012),
                                        bar({-0.1, -0.03}, {0.6, 0.03}, 0.012),
                                        bar({0.3, -0.02}, {0.3, 0.03}, 0.012)};
  const BodyProblem problem = problem_of(frame);
  ComplianceEvaluator loads = tip_load();
  UnderRepair design(problem, loads, kWidths);
  EXPECT_EQ(join_parts(design), 0);
  EXPECT_EQ(design.parts.size(), frame.size());
}

// Two flanges without a web are two beams side by side: bars across the void make them one high
// beam, which is stiffer by far more than they weigh.
TEST(RenewedParts, FlangesGetAWeb) {
  const std::vector<Component> flanges = {
      bar({-0.1, 0.037}, {0.3, 0.037}, 0.012), bar({0.26, 0.037}, {0.7, 0.037}, 0.012),
      bar({-0.1, -0.037}, {0.3, -0.037}, 0.012), bar({0.26, -0.037}, {0.7, -0.037}, 0.012)};
  const BodyProblem problem = problem_of(flanges);
  ComplianceEvaluator loads = tip_load();
  UnderRepair design(problem, loads, kWidths);
  const double compliance = design.compliance(design.parts), volume = design.volume(design.parts);
  EXPECT_GE(bear_parts(design), 1);
  // A bar is accepted only if it lowers the product by 0.2 %.
  EXPECT_LT(design.compliance(design.parts) * design.volume(design.parts),
            0.998 * compliance * volume);
  for (size_t k = flanges.size(); k < design.parts.size(); ++k)
    EXPECT_GE(design.parts[k].c1, 0.5 * kWidths.solid);
}

TEST(RenewedParts, AFullPlateMissesNothing) {
  const BodyProblem problem = problem_of({bar({-0.1, 0}, {0.7, 0}, 0.06)});
  ComplianceEvaluator loads = tip_load();
  UnderRepair design(problem, loads, kWidths);
  EXPECT_EQ(bear_parts(design), 0);
}

}  // namespace
}  // namespace flexmorph::mmc::test
