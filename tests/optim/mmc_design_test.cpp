// Shows that the conversions from scaled variables to scale factors of cells and back are correct:
// components are preserved, bounds are those of the design, and both chain rules agree with
// differences.

#include <gtest/gtest.h>

#include "tests/optim/mmc_small.h"
#include "tests/support/differences.h"

namespace flexmorph::mmc::test {
namespace {

constexpr int kN = Component::kParameters;

VectorXd parameters_of(const std::vector<Component>& components) {
  VectorXd p(kN * static_cast<Eigen::Index>(components.size()));
  for (size_t c = 0; c < components.size(); ++c) {
    const auto each = components[c].parameters();
    for (int k = 0; k < kN; ++k) p[static_cast<Eigen::Index>(kN * c) + k] = each[k];
  }
  return p;
}

VectorXd random_vector(Eigen::Index n, double lower, double upper, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(lower, upper);
  VectorXd v(n);
  for (double& each : v) each = uniform(engine);
  return v;
}

TEST(Design, KeepsItsComponents) {
  const std::vector<Component> start = random_layout(1);
  const Design design(kGrid, start, kScale);
  EXPECT_EQ(design.n_variables(), kN * 24);
  // Each parameter is subject to one product and one quotient.
  const VectorXd p = parameters_of(start);
  EXPECT_LT((parameters_of(design.components()) - p).cwiseAbs().maxCoeff(), 1e-15);
  std::vector<Component> out;
  design.components(design.x(), out);
  EXPECT_EQ(parameters_of(out), parameters_of(design.components()));
}

TEST(Design, IsMeasuredInComponentSizes) {
  const Design design(kGrid, layout(), kScale);
  // A variable changed by one means: a component's length 2 L, half a turn, half a length.
  const double size = 2 * kScale.half_length, pi = std::numbers::pi;
  const double units[kN] = {size, size, size, pi, size / 2, size / 2, size / 2};
  const VectorXd before = parameters_of(design.components());
  for (int k = 0; k < kN; ++k) {
    VectorXd x = design.x();
    x[5 * kN + k] += 1;
    std::vector<Component> moved;
    design.components(x, moved);
    VectorXd change = parameters_of(moved) - before;
    EXPECT_NEAR(change[5 * kN + k], units[k], 1e-14) << k;
    change[5 * kN + k] = 0;
    EXPECT_EQ(change.norm(), 0) << k;
  }
}

TEST(Design, BoundsAreThoseOfTheDomain) {
  std::vector<Component> start = layout();
  start[0].c1 = 1e-5;             // below c_min
  start[1].center = Vec2(-1, 2);  // outside the domain
  start[2].half_length = 10;      // longer than the upper bound
  const Design design(kGrid, start, kScale);
  EXPECT_TRUE((design.lower().array() < design.upper().array()).all());
  EXPECT_TRUE((design.x().array() >= design.lower().array()).all());
  EXPECT_TRUE((design.x().array() <= design.upper().array()).all());
  std::vector<Component> low, high;
  design.components(design.lower(), low);
  design.components(design.upper(), high);
  for (size_t c = 0; c < low.size(); ++c) {
    EXPECT_NEAR(low[c].center.x(), 0, 1e-15);
    EXPECT_NEAR(high[c].center.x(), 0.6, 1e-15);
    EXPECT_NEAR(low[c].center.y(), -0.05, 1e-15);
    EXPECT_NEAR(high[c].center.y(), 0.05, 1e-15);
    EXPECT_GE(low[c].half_length, kScale.min_thickness);
    for (const double thickness : {low[c].c1, low[c].c2, low[c].c3})
      EXPECT_NEAR(thickness, kScale.min_thickness, 1e-16);
    for (const double thickness : {high[c].c1, high[c].c2, high[c].c3})
      EXPECT_NEAR(thickness, kScale.max_thickness, 1e-16);
    EXPECT_NEAR(high[c].angle - low[c].angle, 4 * std::numbers::pi, 1e-14);
  }
  const std::vector<Component> kept = design.components();
  EXPECT_NEAR(kept[0].c1, kScale.min_thickness, 1e-16);
  EXPECT_NEAR((kept[1].center - Vec2(0, 0.05)).norm(), 0, 1e-15);
}

// A bound of the thickness far above the length of the first components still leaves a valid
// interval.
TEST(Design, BoundsDoNotCrossWhateverTheScale) {
  const DesignScale stubby{.half_length = 1e-4, .min_thickness = 0.005, .max_thickness = 0.03};
  const Design design(kGrid, layout(), stubby);
  EXPECT_TRUE((design.lower().array() < design.upper().array()).all());
}

TEST(Design, ScalesGradients) {
  const Design design(kGrid, random_layout(2), kScale);
  const VectorXd weight = random_vector(design.n_variables(), -1, 1, 3);
  const VectorXd along = random_vector(design.n_variables(), -1, 1, 4);
  // f = Σ w_i sin p_i as a function of the parameters p.
  const auto f = [&](const VectorXd& x) {
    std::vector<Component> components;
    design.components(x, components);
    return weight.dot(parameters_of(components).array().sin().matrix());
  };
  VectorXd gradient = weight.array() * parameters_of(design.components()).array().cos();
  design.scale_gradient(gradient);
  // The difference is of fourth order: its errors are 1e-3^4 of the fifth derivative and 1e-16 /
  // 1e-3 of round-off.
  const double slope =
      testing::first_difference([&](double h) { return f(design.x() + h * along); }, 1e-3);
  EXPECT_NEAR(gradient.dot(along), slope, 1e-11 * gradient.cwiseAbs().sum());
}

TEST(Design, MovesToWhereItIsSent) {
  Design design(kGrid, layout(), kScale);
  VectorXd x = design.x();
  x[3] -= 0.25;
  x[8] += 0.125;
  EXPECT_EQ(design.move_to(x), 0.25);
  EXPECT_EQ(design.x(), x);
  EXPECT_EQ(design.move_to(x), 0);
}

// Image components move together with their originals; the area fractions are symmetric.
TEST(Symmetry, OfDesignsIsKeptByTheirVariables) {
  const double y = kGrid.y0 + 0.5 * kGrid.height, x = kGrid.x0 + 0.5 * kGrid.width;
  for (const Symmetry& symmetry : {Symmetry{{}, y}, Symmetry{x, {}}, Symmetry{x, y}}) {
    const Design all(kGrid, layout(), kScale);
    ASSERT_TRUE(is_symmetric(all.components(), symmetry));
    Design design(kGrid, one_side(layout(), symmetry), kScale, symmetry);
    EXPECT_EQ(design.n_variables() * static_cast<int>(design.n_images()),
              Component::kParameters * design.n_components());
    EXPECT_EQ(design.n_components(), all.n_components());
    const VectorXd moved = design.x() + 0.01 * random_vector(design.n_variables(), -1, 1, 5);
    design.move_to(moved);
    EXPECT_TRUE(is_symmetric(design.components(), symmetry));
    EXPECT_FALSE(is_symmetric(random_layout(1), symmetry));
    const VectorXd area = area_fractions(kGrid, design.components(), 0.005, {}, {});
    double apart = 0;
    for (int i = 0; i < kGrid.nx; ++i)
      for (int j = 0; j < kGrid.ny; ++j)
        apart = std::max(apart, std::abs(area[kGrid.cell(i, j)] -
                                         area[kGrid.cell(symmetry.x ? kGrid.nx - 1 - i : i,
                                                         symmetry.y ? kGrid.ny - 1 - j : j)]));
    EXPECT_LT(apart, 0.05);  // samples on outlines
    // with() may exchange an image and its original.
    const Design again = design.with(design.components());
    EXPECT_EQ(again.n_components(), design.n_components());
    const VectorXd same = area_fractions(kGrid, again.components(), 0.005, {}, {});
    EXPECT_LT((same - area).cwiseAbs().maxCoeff(), 0.05);
  }
}

TEST(Symmetry, GradientsOfImagesAreAdded) {
  const double y = kGrid.y0 + 0.5 * kGrid.height;
  const Symmetry symmetry{kGrid.x0 + 0.5 * kGrid.width, y};
  const Design design(kGrid, one_side(layout(), symmetry), kScale, symmetry);
  const auto all = static_cast<Eigen::Index>(Component::kParameters * design.n_components());
  const VectorXd weight = random_vector(all, -1, 1, 3);
  const VectorXd along = random_vector(design.n_variables(), -1, 1, 4);
  const auto f = [&](const VectorXd& x) {
    std::vector<Component> components;
    design.components(x, components);
    return weight.dot(parameters_of(components).array().sin().matrix());
  };
  VectorXd gradient = weight.array() * parameters_of(design.components()).array().cos();
  MatrixXd rows = gradient.transpose();
  design.scale_gradient(gradient);
  ASSERT_EQ(gradient.size(), design.n_variables());
  const double slope =
      testing::first_difference([&](double h) { return f(design.x() + h * along); }, 1e-3);
  EXPECT_NEAR(gradient.dot(along), slope, 1e-11 * gradient.cwiseAbs().sum());
  design.scale_gradients(rows);
  EXPECT_LT((rows.transpose() - gradient).cwiseAbs().maxCoeff(), 1e-15 * gradient.norm() + 1e-15);
}

VectorXd at_nodes(double value) { return VectorXd::Constant(kGrid.n_nodes(), value); }

const std::vector<std::vector<Vec2>> kEmpty = {corners_of({{0.1, -0.02}, {0.2, 0.02}})};

// The stiffness is the square of the eroded density; the mass is the density above that of the
// void.
TEST(Ersatz, OfConstantDensityIsItsPower) {
  const double alpha = 1e-2;
  const Ersatz ersatz(kGrid, alpha, {}, {});
  CellScaleFactors factors;
  for (const double h : {alpha, 0.25, 0.5, 1.0}) {
    for (const double eroded : {alpha, 0.3, 1.0}) {
      ersatz.factors(at_nodes(h), at_nodes(eroded), factors);
      EXPECT_NEAR(factors.stiffness.minCoeff(), eroded * eroded, 1e-15);
      EXPECT_NEAR(factors.stiffness.maxCoeff(), eroded * eroded, 1e-15);
      EXPECT_NEAR(factors.mass.minCoeff(), (h - alpha) / (1 - alpha), 1e-15);
      EXPECT_NEAR(factors.mass.maxCoeff(), (h - alpha) / (1 - alpha), 1e-15);
    }
  }
}

TEST(Ersatz, PassiveRegionsAreWhatTheySay) {
  const double alpha = 1e-2;
  const std::vector<std::vector<Vec2>> solid = strip();
  const Ersatz ersatz(kGrid, alpha, solid, kEmpty);
  CellScaleFactors factors;
  ersatz.factors(at_nodes(0.3), at_nodes(0.3), factors);
  int n_solid = 0, n_empty = 0;
  for (int i = 0; i < kGrid.nx; ++i) {
    for (int j = 0; j < kGrid.ny; ++j) {
      const int cell = kGrid.cell(i, j);
      if (factors.mass[cell] == 1) {
        ++n_solid;
        EXPECT_EQ(factors.stiffness[cell], 1);
        EXPECT_GE(i, 58);
      } else if (factors.mass[cell] == 0) {
        ++n_empty;
        EXPECT_EQ(factors.stiffness[cell], alpha * alpha);
        EXPECT_LT((kGrid.cell_center(i, j) - Vec2(0.15, 0)).cwiseAbs().maxCoeff(), 0.05);
      }
    }
  }
  EXPECT_EQ(n_solid, 2 * 10);
  EXPECT_EQ(n_empty, 10 * 4);

  // Where solid and void regions overlap, there is material.
  const Ersatz both(kGrid, alpha, solid, solid);
  both.factors(at_nodes(0.3), at_nodes(0.3), factors);
  EXPECT_EQ(factors.mass[kGrid.cell(59, 4)], 1);
}

TEST(Ersatz, PullBackAgreesWithDifferences) {
  const std::vector<std::vector<Vec2>> solid = strip();
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Ersatz ersatz(kGrid, 1e-2, solid, kEmpty);
    const VectorXd h = random_vector(kGrid.n_nodes(), 0.01, 1, seed);
    const VectorXd eroded = random_vector(kGrid.n_nodes(), 0.01, 1, seed + 40);
    const VectorXd along = random_vector(kGrid.n_nodes(), -1, 1, seed + 10);
    const VectorXd eroded_along = random_vector(kGrid.n_nodes(), -1, 1, seed + 50);
    const VectorXd by_stiffness = random_vector(kGrid.n_cells(), -1, 1, seed + 20);
    const VectorXd by_mass = random_vector(kGrid.n_cells(), -1, 1, seed + 30);
    VectorXd d_h, d_eroded;
    ersatz.pull_back(eroded, by_stiffness, by_mass, d_h, d_eroded);
    CellScaleFactors factors;
    // The scale factors are quadratic in both densities, therefore the difference quotient is
    // exact.
    const double slope = testing::first_difference(
        [&](double t) {
          ersatz.factors(h + t * along, eroded + t * eroded_along, factors);
          return by_stiffness.dot(factors.stiffness) + by_mass.dot(factors.mass);
        },
        0.5);
    EXPECT_NEAR(d_h.dot(along) + d_eroded.dot(eroded_along), slope,
                1e-13 * by_mass.cwiseAbs().sum())
        << seed;
  }
}

TEST(Ersatz, SharpPicturesBlendBetweenVoidAndMaterial) {
  const double alpha = 1e-2;
  const Ersatz ersatz(kGrid, alpha, {}, {});
  const VectorXd fractions = random_vector(kGrid.n_cells(), 0, 1, 5);
  const CellScaleFactors crisp = ersatz.crisp(fractions);
  EXPECT_EQ(crisp.mass, fractions);
  const CellScaleFactors dynamic = Ersatz::dynamic(fractions, 1e-4, 1e-3);
  for (int c = 0; c < kGrid.n_cells(); ++c) {
    const double f = fractions[c];
    EXPECT_NEAR(crisp.stiffness[c], f + (1 - f) * alpha * alpha, 1e-15);
    EXPECT_NEAR(dynamic.stiffness[c], f + (1 - f) * 1e-4, 1e-15);
    EXPECT_NEAR(dynamic.mass[c], f + (1 - f) * 1e-3, 1e-15);
  }
  // For pure void and pure material the smoothed and crisp factors agree.
  CellScaleFactors smoothed;
  ersatz.factors(at_nodes(alpha), at_nodes(alpha), smoothed);
  const CellScaleFactors empty = ersatz.crisp(VectorXd::Zero(kGrid.n_cells()));
  EXPECT_NEAR((smoothed.stiffness - empty.stiffness).norm(), 0, 1e-15);
  EXPECT_NEAR((smoothed.mass - empty.mass).norm(), 0, 1e-15);
}

}  // namespace
}  // namespace flexmorph::mmc::test
