// Shows that a uniform rotating plate of cells agrees with h16 elements and with a beam over a
// fraction of the motions in tests/README.md. Bilinear cells are of second order; with 20 cells
// across, they are as close to h16 as 20 x 4 of those elements are to the beam.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/support/reissner_beam.h"
#include "tests/support/tip_history.h"

namespace flexmorph {
namespace {

using testing::RotatingPlate, testing::ShapeSet, testing::rms_apart, testing::tip_history;

class CellsBesideOthers : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Speeds, CellsBesideOthers, ::testing::Values(0.1, 0.5),
                         [](const auto& v) { return v.param < 0.3 ? "v01" : "v05"; });

TEST_P(CellsBesideOthers, Deflection) {
  constexpr double kEnd = 0.2;
  constexpr int kTimes = 20;
  reference::ReissnerBeam b;
  b.speed = GetParam();
  const VectorXd beam =
      reference::simulate(b, VectorXd::LinSpaced(kTimes, kEnd / kTimes, kEnd)).deflection;
  RotatingPlate p;
  p.speed = GetParam();
  p.longest = p.length + p.speed;
  p.nx = 20;
  p.ny = 4;
  const VectorXd h16 = tip_history(p, kEnd, kTimes).deflection;
  p.shapes = ShapeSet::q4;
  std::vector<VectorXd> on_cells;
  for (const int across : {5, 10, 20}) {
    p.nx = 5 * across;
    p.ny = across;
    on_cells.push_back(tip_history(p, kEnd, kTimes).deflection);
    std::printf("v %.1f, %d cells across: %.3f %% from h16, %.3f %% from the beam\n", p.speed,
                across, 100 * rms_apart(on_cells.back(), h16),
                100 * rms_apart(on_cells.back(), beam));
  }
  const double order =
      std::log2((on_cells[1] - on_cells[0]).norm() / (on_cells[2] - on_cells[1]).norm());
  std::printf("h16 %.3f %% from the beam, order %.2f\n", 100 * rms_apart(h16, beam), order);
  EXPECT_LT(rms_apart(on_cells.back(), h16), 0.005);
  EXPECT_LT(rms_apart(on_cells.back(), beam), rms_apart(h16, beam) + 0.005);
  EXPECT_NEAR(order, 2, 0.3);
}

}  // namespace
}  // namespace flexmorph
