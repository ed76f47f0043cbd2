// Shows that the union of components on a grid is right: culling loses nothing, the smooth maximum
// is within its bounds, and the chain rule passes the Taylor test.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/components/tdf.h"
#include "tests/geometry/random_components.h"

namespace flexmorph {
namespace {

using test::RandomComponents;
using Kind = TdfSettings::Kind;

const Grid kGrid{.x0 = -0.1, .y0 = 0.2, .width = 2, .height = 1, .nx = 60, .ny = 30};

TdfSettings union_settings(Kind kind) {
  TdfSettings s;
  s.kind = kind;
  s.band = kind == Kind::paper ? 0.4 : 1.5 * kGrid.dx();
  s.sharpness = 2 / kGrid.dx();
  s.min_half_thickness = 0.03;
  return s;
}

/// Returns components in and around the domain of kGrid.
std::vector<Component> random_design(unsigned seed, int count = 20) {
  RandomComponents random(seed);
  std::vector<Component> all = random.several(count, 2.2, 1.2);
  for (Component& c : all) c.center += Vec2(-0.2, 0.1);
  return all;
}

/// Returns φ from every component at every node, directly by the definition.
VectorXd brute_force(const std::vector<Component>& components, const TdfSettings& s) {
  const double cut = -s.band - (s.kind == Kind::paper ? 1 : 10 / s.sharpness);
  VectorXd phi(kGrid.n_nodes());
  for (int i = 0; i <= kGrid.nx; ++i) {
    for (int j = 0; j <= kGrid.ny; ++j) {
      const Vec2 at = kGrid.node_position(i, j);
      double sum = 0, highest = cut;
      for (const Component& c : components) {
        const double each = component_tdf(c, s, at.x(), at.y(), nullptr);
        highest = std::max(highest, each);
        const double t = std::clamp(0.5 * s.sharpness * (each - cut), 0.0, 1.0);
        sum += t * t * t * (10 - 15 * t + 6 * t * t) * std::exp(s.sharpness * each);
      }
      const double smooth = std::max(cut, std::log(sum) / s.sharpness);
      phi[kGrid.node(i, j)] = s.kind == Kind::paper ? highest : smooth;
    }
  }
  return phi;
}

class EveryUnion : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Tdf, EveryUnion, ::testing::Values(Kind::distance, Kind::paper));

TEST_P(EveryUnion, CullingLosesNothing) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    std::vector<Component> design = random_design(seed);
    design[0].c1 = 1e-6;  // a needle: its end value is the minimum, its reach is the longest
    // lines x = constant and y = constant of the frame are parallel to the grid
    design[1].angle = 0;
    design[2].angle = std::acos(0.0);
    const TdfSettings s = union_settings(GetParam());
    UnionTdf tdf(kGrid, s);
    tdf.evaluate(design);
    const VectorXd expected = brute_force(design, s);
    EXPECT_LT((tdf.phi() - expected).cwiseAbs().maxCoeff(), 1e-13) << seed;
    for (int n = 0; n < kGrid.n_nodes(); ++n) {
      ASSERT_NEAR(tdf.density()[n], heaviside(expected[n], s).value, 1e-12);
    }
  }
}

TEST_P(EveryUnion, NodesNoComponentReachesAreVoid) {
  const TdfSettings s = union_settings(GetParam());
  UnionTdf tdf(kGrid, s);
  VectorXd gradient;
  tdf.evaluate({});
  EXPECT_EQ(tdf.density().maxCoeff(), s.alpha);
  EXPECT_LT(tdf.phi().maxCoeff(), -s.band);
  tdf.pull_back(VectorXd::Ones(kGrid.n_nodes()), gradient);
  EXPECT_EQ(gradient.size(), 0);

  const Component far{.center = {50, 50}};
  tdf.evaluate({&far, 1});
  EXPECT_EQ(tdf.density().maxCoeff(), s.alpha);
  tdf.pull_back(VectorXd::Ones(kGrid.n_nodes()), gradient);
  EXPECT_EQ(gradient.norm(), 0);
}

// The bounds are max <= KS <= max + log(n)/λ.
TEST(SmoothMaximum, StaysBetweenItsBounds) {
  const TdfSettings s = union_settings(Kind::distance);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const std::vector<Component> design = random_design(seed);
    UnionTdf tdf(kGrid, s);
    tdf.evaluate(design);
    const double n = static_cast<double>(design.size());
    for (int i = 0; i <= kGrid.nx; ++i) {
      for (int j = 0; j <= kGrid.ny; ++j) {
        const Vec2 at = kGrid.node_position(i, j);
        double highest = -1e300;
        for (const Component& c : design) {
          highest = std::max(highest, component_tdf(c, s, at.x(), at.y(), nullptr));
        }
        if (highest < -s.band) continue;
        const double phi = tdf.phi()[kGrid.node(i, j)];
        EXPECT_GE(phi, highest - 1e-15);
        EXPECT_LE(phi, highest + std::log(n) / s.sharpness + 1e-15);
      }
    }
  }
}

TEST(SmoothMaximum, OfCoincidentComponentsIsLogTwoHigher) {
  const TdfSettings s = union_settings(Kind::distance);
  const Component c{.center = {0.9, 0.7}, .half_length = 0.4, .angle = 0.3};
  const std::vector<Component> two = {c, c};
  UnionTdf one_tdf(kGrid, s), two_tdf(kGrid, s);
  one_tdf.evaluate({&c, 1});
  two_tdf.evaluate(two);
  int inside = 0;
  for (int n = 0; n < kGrid.n_nodes(); ++n) {
    if (one_tdf.phi()[n] < 0) continue;
    EXPECT_NEAR(two_tdf.phi()[n] - one_tdf.phi()[n], std::log(2.0) / s.sharpness, 1e-14);
    ++inside;
  }
  EXPECT_GT(inside, 50);
}

// φ is continuous where a component comes into reach. One level bar is just below a node (φ₁ = -0.9
// ε), and one above it is 1e-9 before and after the cut by its φ₂. If the sum were not continuous,
// φ would jump by exp(λ (cut - φ₁))/λ, about 4e-7 here.
TEST(SmoothMaximum, IsContinuousWhereComponentsComeIntoReach) {
  const TdfSettings s = union_settings(Kind::distance);
  const double g = 0.1, cut = -s.band - 10 / s.sharpness;
  const Vec2 node = kGrid.node_position(30, 15);
  std::vector<Component> bars(2, {.half_length = 5, .c1 = g, .c2 = g, .c3 = g});
  bars[0].center = node - Vec2(0, g + 0.9 * s.band);
  UnionTdf tdf(kGrid, s);
  std::vector<double> phi;
  for (const double step : {1e-9, -1e-9}) {
    bars[1].center = node + Vec2(0, g - cut + step);
    tdf.evaluate(bars);
    phi.push_back(tdf.phi()[kGrid.node(30, 15)]);
  }
  EXPECT_NEAR(phi[0], -0.9 * s.band, 1e-6);
  EXPECT_NEAR(phi[0], phi[1], 1e-12);
}

// Of two level bars, the second one is z = λ (φ₂ - φ_cut) above its reach, within and beyond the
// range of 2 over which it gains its weight. The second derivative of the density by the height of
// the second bar, although small, must equal differences of the first derivative from the beginning
// of the reach.
TEST(SmoothMaximum, BendsOnlyGraduallyWhereComponentsComeIntoReach) {
  const TdfSettings s = union_settings(Kind::distance);
  const double g = 0.1, cut = -s.band - 10 / s.sharpness;
  const Vec2 node = kGrid.node_position(30, 15);
  const int at = kGrid.node(30, 15), height = 8;
  std::vector<Component> bars(2, {.half_length = 5, .c1 = g, .c2 = g, .c3 = g});
  bars[0].center = node - Vec2(0, g + 0.6 * s.band);
  VectorXd picked = VectorXd::Zero(kGrid.n_nodes());
  picked[at] = 1;
  const VectorXd none = VectorXd::Zero(kGrid.n_nodes());
  UnionTdf tdf(kGrid, s);
  const auto slope = [&](double z) {
    bars[1].center = node + Vec2(0, g - cut - z / s.sharpness);
    tdf.evaluate(bars);
    VectorXd out;
    tdf.pull_back(picked, out);
    return out[height];
  };
  const auto bend = [&](double z) {
    slope(z);
    return tdf.curvature({picked, none, none}, tdf.slopes())(height, height);
  };
  const double largest = std::abs(bend(3)), h = 1e-4;
  ASSERT_GT(largest, 0);
  for (const double z : {0.3, 1.0, 1.7, 3.0})
    EXPECT_NEAR(bend(z), (slope(z - h) - slope(z + h)) * s.sharpness / (2 * h), 1e-6 * largest)
        << z;
  for (const double z : {0.0, 2.0})  // third derivatives of S are below 15: 15 times 2e-6
    EXPECT_NEAR(bend(z - 1e-6), bend(z + 1e-6), 1e-4 * largest) << z;
  EXPECT_EQ(slope(-1e-3), 0);
}

std::vector<Component> moved(const std::vector<Component>& design, const VectorXd& direction,
                             double h) {
  std::vector<Component> result;
  for (std::size_t c = 0; c < design.size(); ++c) {
    auto p = design[c].parameters();
    for (int q = 0; q < 7; ++q) p[q] += h * direction[7 * static_cast<Eigen::Index>(c) + q];
    result.push_back(Component::from_parameters(p.data()));
  }
  return result;
}

/// Returns the slope of log |f(p + h d) - f(p) - h df·d| over log h, h = h0 ... h0/1000 in 13
/// steps, where d moves components by up to one cell per unit of h.
///
/// f = Σ w_k H_k is of order 100. With random signs of w_k the curvatures of the nodes would nearly
/// cancel; with the sign of H_k'' along d they add up: the remainder is about 70 h², which at h =
/// 1e-6 is 1000 times round-off. At h0 = 1e-3 few nodes cross a line where H is only C1.
double taylor_order(Kind kind, unsigned seed, double h0) {
  const std::vector<Component> design = random_design(seed);
  RandomComponents random(seed + 100);
  VectorXd direction(7 * static_cast<Eigen::Index>(design.size()));
  for (double& d : direction) d = random.uniform(-1, 1) * kGrid.dx();
  UnionTdf tdf(kGrid, union_settings(kind));
  tdf.evaluate(moved(design, direction, 1e-3));
  VectorXd bend = tdf.density();
  tdf.evaluate(moved(design, direction, -1e-3));
  bend += tdf.density();
  tdf.evaluate(design);
  const VectorXd start = tdf.density();
  bend -= 2 * start;
  VectorXd weight(kGrid.n_nodes()), gradient;
  for (int n = 0; n < kGrid.n_nodes(); ++n) {
    weight[n] = std::copysign(random.uniform(0.5, 1), bend[n]);
  }
  tdf.pull_back(weight, gradient);
  const double slope = gradient.dot(direction);

  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  constexpr int kSteps = 13;
  for (int step = 0; step < kSteps; ++step) {
    const double h = h0 * std::pow(10.0, -3.0 * step / (kSteps - 1));
    tdf.evaluate(moved(design, direction, h));
    const double change = weight.dot(tdf.density() - start);
    const double x = std::log(h), y = std::log(std::abs(change - h * slope));
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (kSteps * sxy - sx * sy) / (kSteps * sxx - sx * sx);
}

TEST(UnionTdf, PullBackPassesTheTaylorTest) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    EXPECT_NEAR(taylor_order(Kind::distance, seed, 1e-3), 2, 0.05) << seed;
  }
}

TEST(UnionTdf, PullBackOfThePaperPassesTheTaylorTest) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    EXPECT_NEAR(taylor_order(Kind::paper, seed, 1e-3), 2, 0.05) << seed;
  }
}

TEST_P(EveryUnion, ManyFunctionsAtOnceAreThoseOneByOne) {
  TdfSettings s = union_settings(GetParam());
  s.erosion = 0.3 * s.band;
  UnionTdf tdf(kGrid, s);
  tdf.evaluate(random_design(3));
  std::srand(7);
  const MatrixXd by_h = MatrixXd::Random(5, kGrid.n_nodes());
  const MatrixXd by_eroded = MatrixXd::Random(5, kGrid.n_nodes());
  MatrixXd all, without_h;
  tdf.pull_back(by_h, by_eroded, all);
  tdf.pull_back(MatrixXd(), by_eroded, without_h);
  for (int f = 0; f < 5; ++f) {
    VectorXd one;
    tdf.pull_back(VectorXd(by_h.row(f)), VectorXd(by_eroded.row(f)), one);
    EXPECT_LT((all.row(f).transpose() - one).norm(), 1e-12 * one.norm());
    tdf.pull_back(VectorXd::Zero(kGrid.n_nodes()), VectorXd(by_eroded.row(f)), one);
    EXPECT_LT((without_h.row(f).transpose() - one).norm(), 1e-12 * one.norm());
  }
}

TEST(UnionTdf, InfluenceIsWhatTakingAComponentOutChanges) {
  TdfSettings s = union_settings(Kind::distance);
  s.erosion = 0.3 * s.band;
  std::vector<Component> design = random_design(4);
  design.push_back({.center = {50, 50}});  // far outside
  design.push_back({.center = {0.9, 0.7}, .half_length = 0.6, .c1 = 0.3, .c2 = 0.3, .c3 = 0.3});
  design.push_back({.center = {0.9, 0.7}, .half_length = 0.2, .c1 = 0.1, .c2 = 0.1, .c3 = 0.1});
  UnionTdf tdf(kGrid, s), less(kGrid, s);
  tdf.evaluate(design);
  std::vector<signed char> counts(static_cast<std::size_t>(kGrid.n_nodes()), 1);
  for (std::size_t n = 0; n < 200; ++n) counts[n] = 0;
  const std::vector<double> influence = tdf.influence(counts);
  ASSERT_EQ(influence.size(), design.size());
  for (std::size_t c = 0; c < design.size(); ++c) {
    std::vector<Component> rest = design;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(c));
    less.evaluate(rest);
    const Eigen::Index kept = kGrid.n_nodes() - 200;
    const double expected =
        std::max((tdf.density() - less.density()).tail(kept).cwiseAbs().maxCoeff(),
                 (tdf.eroded() - less.eroded()).tail(kept).cwiseAbs().maxCoeff());
    // When the largest term of a sum is removed, the remaining sum has its round-off.
    EXPECT_NEAR(influence[c], expected, 1e-6) << c;
  }
  EXPECT_EQ(influence[design.size() - 3], 0);
  EXPECT_LT(influence.back(), 1e-5);  // inside a larger one, to the accuracy of the smooth maximum
  EXPECT_GT(influence[design.size() - 2], 0.5);
}

TEST(UnionTdf, RepeatsItselfBitForBit) {
  const std::vector<Component> design = random_design(1), other = random_design(2, 33);
  const VectorXd seed = VectorXd::LinSpaced(kGrid.n_nodes(), -1, 1);
  UnionTdf fresh(kGrid, union_settings(Kind::distance)),
      used(kGrid, union_settings(Kind::distance));
  VectorXd from_fresh, from_used;
  used.evaluate(other);
  used.pull_back(seed, from_used);
  used.evaluate(design);
  used.pull_back(seed, from_used);
  fresh.evaluate(design);
  fresh.pull_back(seed, from_fresh);
  EXPECT_EQ((used.phi() - fresh.phi()).norm(), 0);
  EXPECT_EQ((from_used - from_fresh).norm(), 0);
}

TEST(UnionTdf, RefusesWhatIsNotANumber) {
  UnionTdf tdf(kGrid, union_settings(Kind::distance));
  std::vector<Component> design = random_design(1);
  design[3].c2 = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(tdf.evaluate(design), Error);
  design[3].c2 = 0.1;
  design[4].half_length = 0;
  EXPECT_THROW(tdf.evaluate(design), Error);
  design[4].half_length = 0.1;
  tdf.evaluate(design);
  VectorXd gradient;
  const VectorXd bad = VectorXd::Constant(kGrid.n_nodes(), std::numeric_limits<double>::infinity());
  EXPECT_THROW(tdf.pull_back(bad, gradient), Error);
  TdfSettings s = union_settings(Kind::distance);
  s.band = 0;
  EXPECT_THROW(UnionTdf(kGrid, s), Error);
}

// The Hessian of f = Σ a H + b E + c E² / 2 over the nodes with random a, b, c is compared with
// central differences of its gradient. For h = 1e-6 the truncation is h² times fourth derivatives,
// 1e-12 / band³.
TEST(Curvature, MeetsDifferencesOfTheGradient) {
  TdfSettings s = union_settings(Kind::distance);
  s.erosion = 0.4 * kGrid.dx();
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const std::vector<Component> design = random_design(seed, 6);
    const Eigen::Index n = 7 * static_cast<Eigen::Index>(design.size());
    RandomComponents random(100 + seed);
    VectorXd a(kGrid.n_nodes()), b = a, c = a;
    for (Eigen::Index k = 0; k < a.size(); ++k) {
      a[k] = random.uniform(-1, 1);
      b[k] = random.uniform(-1, 1);
      c[k] = random.uniform(-1, 1);
    }
    UnionTdf tdf(kGrid, s);
    const auto gradient_at = [&](Eigen::Index q, double step) {
      std::vector<Component> moved = design;
      Component& one = moved[static_cast<std::size_t>(q / 7)];
      auto p = one.parameters();
      p[static_cast<std::size_t>(q % 7)] += step;
      one = Component::from_parameters(p.data());
      tdf.evaluate(moved);
      VectorXd out;
      tdf.pull_back(a, b + c.cwiseProduct(tdf.eroded()), out);
      return out;
    };
    const double h = 1e-6;
    MatrixXd differences(n, n);
    for (Eigen::Index q = 0; q < n; ++q)
      differences.col(q) = (gradient_at(q, h) - gradient_at(q, -h)) / (2 * h);
    tdf.evaluate(design);
    const Eigen::SparseMatrix<double> slopes = tdf.slopes();
    const MatrixXd hessian = tdf.curvature({a, b + c.cwiseProduct(tdf.eroded()), c}, slopes);
    EXPECT_LT((hessian - differences).cwiseAbs().maxCoeff(), 1e-6 * hessian.cwiseAbs().maxCoeff())
        << seed;
    EXPECT_LT((hessian - hessian.transpose()).cwiseAbs().maxCoeff(),
              1e-12 * hessian.cwiseAbs().maxCoeff());
  }
}

}  // namespace
}  // namespace flexmorph
