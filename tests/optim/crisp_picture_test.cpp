// Shows that the derivatives of crisp designs are correct: areas against exact areas of the union
// of moved components, compliances against those of moved crisp designs.

#include "optim/mmc/problem/crisp_picture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "optim/mmc/cycles/combined_problem.h"
#include "tests/optim/mmc_small.h"

namespace flexmorph::mmc::test {
namespace {

std::vector<Component> moved(std::vector<Component> all, const VectorXd& by) {
  for (size_t c = 0; c < all.size(); ++c) {
    std::array<double, Component::kParameters> p = all[c].parameters();
    for (size_t q = 0; q < p.size(); ++q)
      p[q] += by[static_cast<Eigen::Index>(Component::kParameters * c + q)];
    all[c] = Component::from_parameters(p.data());
  }
  return all;
}

/// Returns the derivative of the enclosed area with respect to every parameter.
VectorXd area_gradient(const BodyProblem& p, const std::vector<Component>& components) {
  const Eigen::SparseMatrix<double> slopes = CrispPicture(p).slopes(components);
  const VectorXd ones = VectorXd::Ones(p.grid.n_cells());
  return kGrid.dx() * kGrid.dy() * (slopes.transpose() * ones);
}

// Crossing bars, a bar that ends in the solid strip, and a bar cut by the border. The derivative
// with respect to each parameter is compared with central differences of the area of the exact
// union.
TEST(CrispPicture, TheAreaChangesAsTheExactUnionDoes) {
  const std::vector<Component> all = {
      bar({0.05, -0.03}, {0.3, 0.03}, 0.010), bar({0.05, 0.03}, {0.3, -0.03}, 0.012),
      bar({0.25, 0.01}, {0.62, 0.0}, 0.014), bar({0.35, -0.05}, {0.5, -0.045}, 0.013)};
  const BodyProblem p = body_of(Design(kGrid, all, kScale), {tdf_settings()});
  const VectorXd found = area_gradient(p, all);
  const double step = 0.05 * kGrid.dx();
  const auto exact_area = [&](const VectorXd& by) {
    return area(regions_of(p, moved(all, by), 1e-4 * kGrid.dx()));
  };
  for (Eigen::Index k = 0; k < found.size(); ++k) {
    const double arm = k % Component::kParameters == 3 ? 0.15 : 1, h = step / arm;
    VectorXd by = VectorXd::Zero(found.size());
    by[k] = h;
    const double quotient = (exact_area(by) - exact_area(-by)) / (2 * h);
    // The location of the outline is uncertain by half a piece, a fortieth of a cell, at each
    // crossing; there are four.
    EXPECT_NEAR(found[k], quotient, 0.1 * kGrid.dx() * arm) << k;
  }
}

// A bar along the border, whose outer half does not count. Reference: a superellipse of order 6
// fills Γ(7/6)² / Γ(4/3) = 0.9638 of its rectangle. Outlines within the solid strip do not
// contribute.
TEST(CrispPicture, BordersAndSolidRegionsDoNotMove) {
  const double L = 0.2, g = 0.012, part = std::pow(std::tgamma(7. / 6), 2) / std::tgamma(4. / 3);
  const std::vector<Component> one = {{{0.3, -0.05}, L, 0, g, g, g}};
  const BodyProblem p = body_of(Design(kGrid, one, kScale), {tdf_settings()});
  const VectorXd slopes = area_gradient(p, one);
  EXPECT_NEAR(slopes[0], 0, 1e-6);
  EXPECT_NEAR(slopes[1], 2 * L, 1e-3 * L);
  EXPECT_NEAR(slopes[2], part * 2 * g, 0.01 * g);
  EXPECT_NEAR(slopes[4] + slopes[5] + slopes[6], part * 2 * L, 0.01 * L);
  const std::vector<Component> hidden = {{{0.59, 0}, 0.008, 0, 0.007, 0.007, 0.007}};
  EXPECT_EQ(area_gradient(p, hidden).norm(), 0);
}

// Two bars that meet under the load are made thicker or moved apart; compliance and volume use
// sampled area fractions. A sample changes them by a 64th of a cell. The void has a quarter of the
// stiffness, so that the first sample of a cell does not have a larger effect than the next ones.
TEST(CrispPicture, TheComplianceChangesAsItsGradientSays) {
  Design design(kGrid, {bar({-0.02, -0.03}, {0.6, 0}, 0.012), bar({-0.02, 0.03}, {0.6, 0}, 0.012)},
                kScale);
  TdfSettings tdf = tdf_settings();
  tdf.alpha = 0.5;
  BodyProblem body = body_of(design, {tdf});
  ComplianceEvaluator loads = tip_load();
  const Ersatz ersatz = ersatz_of(body);
  const CrispPicture picture(body);
  MmcProblem problem(
      {.plate = kPlate, .design = body.design, .ersatz = ersatz, .loads = loads, .crisp = &picture},
      tdf, body.goal);
  const VectorXd x = problem.start(), unit = cells_of(design);
  const double log_c = problem.evaluate(x).f;
  const CellScaleFactors crisp =
      ersatz_of(body).crisp(fractions_of(body, body.design.components()));
  EXPECT_NEAR(log_c, std::log(loads.sum(crisp.stiffness, crisp.mass)), 1e-12);
  for (const bool thicker : {true, false}) {
    VectorXd d = VectorXd::Zero(x.size());
    for (const Eigen::Index c : {0, 1}) {
      const Eigen::Index first = Component::kParameters * c;
      if (thicker)
        for (const Eigen::Index q : {4, 5, 6}) d[first + q] = 0.2 * unit[first + q];
      else
        d[first + 1] = (c == 0 ? -0.2 : 0.2) * unit[first + 1];
    }
    // Cells at the outline cause small oscillations, therefore the gradient is integrated along the
    // path.
    constexpr int kSteps = 40;
    double by_gradient = 0, volume = 0;
    for (int s = 0; s < kSteps; ++s) {
      const optim::ProblemValues at = problem.evaluate(x + ((s + 0.5) / kSteps * 2 - 1) * d);
      by_gradient += 2. / kSteps * at.df.dot(d);
      volume += 2. / kSteps * at.dg.row(0).dot(d);
    }
    const optim::ProblemValues up = problem.evaluate(x + d), down = problem.evaluate(x - d);
    EXPECT_LT(by_gradient, -0.1);
    EXPECT_NEAR(up.f - down.f, by_gradient, 0.02 * std::abs(by_gradient)) << thicker;
    EXPECT_NEAR(up.g[0] - down.g[0], volume, 4e-3) << thicker;
  }
}

}  // namespace
}  // namespace flexmorph::mmc::test
