// Shows that the compliance of equivalent static loads of a link between two pins is correct:
// derivatives of both supports, whose balance depends on the design, pass Taylor's test and agree
// with differences; a slender link bends as a beam on two supports; balanced loads need no support.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "optim/mmc/loads/compliance_evaluator.h"
#include "tests/optim/smooth_design.h"
#include "tests/support/sections.h"

namespace flexmorph::mmc {
namespace {

const Grid kLinkGrid{0, -0.05, 0.6, 0.1, 36, 6};
/// The line of the pins is oblique to the grid.
const std::array<int, 2> kPins = {kLinkGrid.node(2, 1), kLinkGrid.node(33, 5)};

/// Returns n loads of a link that rotates and swings, with forces at its pins and a mass between
/// them. These loads are not balanced.
fem::EslSets swinging_link(int n) {
  fem::EslSets loads{kLinkGrid, {}, kPins};
  for (int k = 0; k < n; ++k) {
    const double t = 0.37 * k, spin = 9 * std::sin(2 * t), turn = 40 * std::cos(2 * t);
    fem::EslSet set;
    set.time = t;
    set.weight = (1 + 0.3 * std::sin(5 * t)) / n;
    set.acceleration.resize(2 * kLinkGrid.n_nodes());
    for (int i = 0; i <= kLinkGrid.nx; ++i)
      for (int j = 0; j <= kLinkGrid.ny; ++j) {
        const Vec2 at = kLinkGrid.node_position(i, j);
        set.acceleration.segment<2>(2 * kLinkGrid.node(i, j)) =
            Vec2(20 * std::cos(t), 20 * std::sin(t)) - spin * spin * at +
            turn * Vec2(-at.y(), at.x()) + Vec2(0, 30 * std::cos(3 * t) * std::sin(5 * at.x()));
      }
    const int middle = kLinkGrid.node(20, 3);
    set.forces = {{kPins[0], {10 * std::cos(t), 5}},
                  {kPins[1], {7, 20 * std::sin(t)}},
                  {middle, -0.2 * set.acceleration.segment<2>(2 * middle)}};
    loads.sets.push_back(std::move(set));
  }
  return loads;
}

struct LinkLoads {
  LoadDefinition loads;
  Support support;
  std::string name;
};

class EveryLink : public ::testing::TestWithParam<LinkLoads> {
 protected:
  ComplianceSettings settings(bool compress) const {
    return {GetParam().loads, GetParam().support, compress, 1e-10};
  }
};

INSTANTIATE_TEST_SUITE_P(
    Table, EveryLink,
    ::testing::Values(LinkLoads{LoadDefinition::inertia, Support::pins, "inertia_pins"},
                      LinkLoads{LoadDefinition::inertia, Support::floating, "inertia_floating"},
                      LinkLoads{LoadDefinition::frozen, Support::pins, "frozen_pins"},
                      LinkLoads{LoadDefinition::frozen, Support::floating, "frozen_floating"}),
    [](const auto& choice) { return choice.param.name; });

TEST_P(EveryLink, TaylorRemainderIsOfSecondOrder) {
  const fem::EslSets loads = swinging_link(12);
  for (const bool compress : {false, true})
    for (const unsigned seed : {1u, 2u, 3u}) {
      const SmoothDesign start(kLinkGrid, seed + 10), design(kLinkGrid, seed);
      ComplianceEvaluator compliance(loads, fem::kThinSection, settings(compress),
                                     start.stiffness(0), start.mass(0));
      ComplianceEvaluator::Value at;
      compliance.evaluate(design.stiffness(0), design.mass(0), at);
      const double f = at.f;
      const double slope =
          at.d_stiffness.dot(design.d_stiffness(0)) + at.d_mass.dot(design.d_mass(0));
      std::vector<double> log_h, log_r;
      for (double h = 1e-2; h > 0.9e-5; h /= std::sqrt(10.0)) {
        compliance.evaluate(design.stiffness(h), design.mass(h), at);
        log_h.push_back(std::log(h));
        log_r.push_back(std::log(std::abs(at.f - f - h * slope)));
      }
      const double order = (log_r.front() - log_r.back()) / (log_h.front() - log_h.back());
      EXPECT_NEAR(order, 2.0, 0.05) << "seed " << seed << (compress ? " compressed" : "");
    }
}

// Compares the derivatives with differences, cell by cell; the weighted sum of all loads is the
// total.
TEST_P(EveryLink, GradientsAgreeWithDifferences) {
  const fem::EslSets loads = swinging_link(3);
  const SmoothDesign start(kLinkGrid, 5), design(kLinkGrid, 6);
  ComplianceEvaluator compliance(loads, fem::kThinSection, settings(false), start.stiffness(0),
                                 start.mass(0));
  const VectorXd k = design.stiffness(0), m = design.mass(0);
  ComplianceEvaluator::Value value;
  compliance.evaluate(k, m, value);
  ComplianceEvaluator::Each each;
  compliance.evaluate_each(k, m, each);
  const VectorXd one_by_one = compliance.individual(k, m);
  // The two values are solutions of one system whose condition number is about 5 E t / λ / s: E t =
  // 1e6 N/m, λ = E I (π / L)^4 L / n = 56 N/m (first bending mode between pins: E I = 83 N m^2, L =
  // 0.6 m, n = 671 nodes), s = 10^-1.5 is the geometric mean of the stiffness scale factors.
  const double allowed = 5e6 / 56 / 0.03 * std::numeric_limits<double>::epsilon();
  double sum = 0;
  for (Eigen::Index l = 0; l < 3; ++l) {
    sum += loads.sets[static_cast<std::size_t>(l)].weight * each.f[l];
    EXPECT_NEAR(one_by_one[l], each.f[l], allowed * each.f[l]);
  }
  EXPECT_NEAR(sum, value.f, 1e-12 * value.f);
  for (const int cell : {0, 77, 111, 215}) {
    for (const bool of_mass : {false, true}) {
      const double h = 1e-2;  // fourth order; a smaller step would show round-off
      const auto at = [&](double dx) {
        VectorXd moved = of_mass ? m : k;
        moved[cell] *= 1 + dx;
        return compliance.individual(of_mass ? k : moved, of_mass ? moved : m);
      };
      const VectorXd slope =
          (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h * (of_mass ? m : k)[cell]);
      for (Eigen::Index l = 0; l < 3; ++l) {
        const double found = !of_mass                  ? each.d_stiffness(l, cell)
                             : each.d_mass.size() == 0 ? 0
                                                       : each.d_mass(l, cell);
        EXPECT_NEAR(found, slope[l], 1e-5 * std::abs(slope[l]) + 1e-8 * each.f[l])
            << "cell " << cell << (of_mass ? " mass" : " stiffness");
      }
    }
  }
}

TEST_P(EveryLink, CompressionChangesNothing) {
  const fem::EslSets loads = swinging_link(40);
  const SmoothDesign start(kLinkGrid, 20), design(kLinkGrid, 1);
  ComplianceEvaluator all(loads, fem::kThinSection, settings(false), start.stiffness(0),
                          start.mass(0));
  ComplianceEvaluator few(loads, fem::kThinSection, settings(true), start.stiffness(0),
                          start.mass(0));
  EXPECT_EQ(all.n_right_hand_sides(), 40);
  // shifts, rotation, centrifugal and swing terms, three forces of two components; some coincide
  EXPECT_LE(few.n_right_hand_sides(), 11);
  ComplianceEvaluator::Value a, b;
  all.evaluate(design.stiffness(0), design.mass(0), a);
  few.evaluate(design.stiffness(0), design.mass(0), b);
  EXPECT_NEAR(b.f, a.f, 1e-8 * a.f);
  EXPECT_LT((b.d_stiffness - a.d_stiffness).norm(), 1e-6 * a.d_stiffness.norm());
  EXPECT_LE((b.d_mass - a.d_mass).norm(), 1e-6 * a.d_mass.norm());
}

// Hᵀ u = 0: with `pins` the line of the pins does not move across itself; with `floating` the mean
// translation and rotation, weighted by mass, vanish.
TEST_P(EveryLink, DisplacementsAreThoseOfTheSupport) {
  const SmoothDesign design(kLinkGrid, 3);
  const VectorXd k = design.stiffness(0), m = design.mass(0);
  ComplianceEvaluator compliance(swinging_link(2), fem::kThinSection, settings(true), k, m);
  const VectorXd u = compliance.displacement(k, m, 1);
  const double small = 1e-10 * u.lpNorm<Eigen::Infinity>();
  const auto position = [](int node) {
    return kLinkGrid.node_position(node / (kLinkGrid.ny + 1), node % (kLinkGrid.ny + 1));
  };
  if (GetParam().support == Support::pins) {
    const Vec2 line = (position(kPins[1]) - position(kPins[0])).normalized();
    EXPECT_LT(u.segment<2>(2 * kPins[0]).norm(), small);
    EXPECT_LT(std::abs(u.segment<2>(2 * kPins[1]).dot(Vec2(-line.y(), line.x()))), small);
    return;
  }
  // The mass of a cell is integrated by Simpson's rule, which is exact for products of linear
  // functions.
  Vec2 linear(0, 0);
  double angular = 0;
  constexpr double kWeights[] = {1, 4, 1};
  for (int i = 0; i < kLinkGrid.nx; ++i)
    for (int j = 0; j < kLinkGrid.ny; ++j)
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) {
          const double s = 0.5 * a, t = 0.5 * b;
          const auto corner = [&](int p, int q) {
            return Vec2(u.segment<2>(2 * kLinkGrid.node(i + p, j + q)));
          };
          const Vec2 here = (1 - s) * ((1 - t) * corner(0, 0) + t * corner(0, 1)) +
                            s * ((1 - t) * corner(1, 0) + t * corner(1, 1));
          const Vec2 at =
              kLinkGrid.node_position(i, j) + Vec2(s * kLinkGrid.dx(), t * kLinkGrid.dy());
          const double w = kWeights[a] * kWeights[b] / 36 * m[kLinkGrid.cell(i, j)];
          linear += w * here;
          angular += w * (at.x() * here.y() - at.y() * here.x());
        }
  EXPECT_LT(linear.norm(), kLinkGrid.n_cells() * small);
  EXPECT_LT(std::abs(angular), kLinkGrid.n_cells() * small);
}

/// A slender link with pins in the middle of its ends.
struct Slender {
  Grid grid{0, -0.005, 0.4, 0.01, 320, 8};
  fem::PlaneSection section{0.01, 2e9, 0, 1000};
  std::array<int, 2> pins{grid.node(0, 4), grid.node(320, 4)};
  double q = section.density * section.thickness * grid.height * 50;  // for 50 m/s² [N/m]
  VectorXd ones = VectorXd::Ones(grid.n_cells());

  /// Returns a transverse acceleration, optionally with the reactions of the pins as forces.
  fem::EslSets loads(bool with_forces) const {
    fem::EslSets out{grid, {{}}, pins};
    out.sets[0].acceleration = VectorXd::Zero(2 * grid.n_nodes());
    for (int n = 0; n < grid.n_nodes(); ++n) out.sets[0].acceleration(2 * n + 1) = 50;
    const Vec2 half(0, 0.5 * q * grid.width);
    if (with_forces) out.sets[0].forces = {{pins[0], half}, {pins[1], half}};
    return out;
  }
};

// Reference: C = q² L⁵ / (120 E I) of a beam on two supports. The support `pins` produces the
// reactions itself. The support `floating` needs the joint forces; without them the link
// accelerates freely and is not strained.
TEST(Link, BendsLikeABeamOnTwoSupports) {
  const Slender link;
  const double I = link.section.thickness * std::pow(link.grid.height, 3) / 12;
  const double beam =
      link.q * link.q * std::pow(link.grid.width, 5) / (120 * link.section.youngs_modulus * I);
  const auto compliance = [&](Support support, bool with_forces) {
    ComplianceEvaluator c(link.loads(with_forces), link.section,
                          {LoadDefinition::inertia, support, true, 1e-10}, {}, {});
    return c.individual(link.ones, link.ones)[0];
  };
  // Bilinear cells are too stiff by about (h / ny)² / h²; shear makes the link softer by 3 (h /
  // L)².
  EXPECT_NEAR(compliance(Support::pins, false) / beam, 1, 0.02);
  EXPECT_NEAR(compliance(Support::pins, true), compliance(Support::pins, false), 1e-8 * beam);
  EXPECT_NEAR(compliance(Support::floating, true), compliance(Support::pins, true), 1e-8 * beam);
  EXPECT_LT(compliance(Support::floating, false), 1e-12 * beam);
}

TEST(Link, BadInputIsRefused) {
  const VectorXd ones = VectorXd::Ones(kLinkGrid.n_cells());
  const auto make = [&](const fem::EslSets& loads, LoadDefinition definition, Support support) {
    return ComplianceEvaluator(loads, fem::kThinSection, {definition, support, true, 1e-10}, ones,
                               ones);
  };
  const fem::EslSets good = swinging_link(2);
  EXPECT_NO_THROW(make(good, LoadDefinition::inertia, Support::pins));
  EXPECT_THROW(make(good, LoadDefinition::stiffness, Support::pins), Error);
  EXPECT_THROW(ComplianceEvaluator(good, fem::kThinSection, {}, ones, ones), Error);
  EXPECT_THROW(make(good, LoadDefinition::inertia, Support::moving_root), Error);
  fem::EslSets bad = good;
  bad.pins.reset();
  EXPECT_THROW(make(bad, LoadDefinition::inertia, Support::floating), Error);
  bad.pins = {kPins[0], kPins[0]};
  EXPECT_THROW(make(bad, LoadDefinition::inertia, Support::floating), Error);
  bad.pins = {kPins[0], kLinkGrid.n_nodes()};
  EXPECT_THROW(make(bad, LoadDefinition::inertia, Support::pins), Error);
  bad = good;
  bad.sets[1].root_column = 3;
  EXPECT_THROW(make(bad, LoadDefinition::inertia, Support::pins), Error);
  bad = good;
  bad.sets[0].thermal_stretch = 1e-3;
  EXPECT_THROW(make(bad, LoadDefinition::inertia, Support::pins), Error);
}

}  // namespace
}  // namespace flexmorph::mmc
