// Shows slender beams in large bending: Mattiasson's cantilever and a curved one agree with the
// elastica, at L/h = 1000 as well as at 50, as beams and as a plate in the plane; the order of
// convergence is two; the frequencies of slender beams are right.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>

#include "fem/elements/ancf_beam.h"
#include "fem/elements/ancf_plate.h"
#include "fem/loads.h"
#include "fem/model/workspace.h"
#include "fem/solve/statics.h"
#include "fem/terms.h"
#include "tests/support/dense.h"
#include "tests/support/elastica.h"
#include "tests/support/models.h"
#include "tests/support/rates.h"

namespace flexmorph::fem {
namespace {

constexpr double kModulus = 2.1e11, kWidth = 0.01;

PlaneSection section() { return {kWidth, kModulus, 0.3, 7850}; }
double bending_stiffness(double height) { return kModulus * kWidth * std::pow(height, 3) / 12; }

Workspace cantilever(const std::string& term, std::unique_ptr<AncfBeam> beam,
                     const VectorXd& force) {
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(section()));
  terms.push_back(make_term(term, section()));
  if (force.size() > 0) terms.push_back(make_point_force({1, 0}, force));
  Workspace model;
  model.add_body("beam", std::move(beam), section(), std::move(terms));
  model.add_joint(make_hold("clamp", "beam",
                            {{HoldLocation::at({0, 0}), NodeVector::r, {0, 1}},
                             {HoldLocation::at({0, 0}), NodeVector::r_n, {0, 1}}}));
  return model;
}

/// Returns the tip of a straight cantilever of length 1 with P L²/(E I) = 5.
reference::ElasticaTip tip(const std::string& term, double slenderness, int n) {
  VectorXd force(2);
  force << 0, 5 * bending_stiffness(1 / slenderness);
  Workspace model = cantilever(term, std::make_unique<AncfBeam>(1, 1 / slenderness, n), force);
  State x = model.reference();
  EXPECT_TRUE(solve_static(model, x).completed);
  const Vec2 at = model.location_motion({"beam", {1, 0}}, x).position;
  return {at.x(), at.y()};
}

/// Returns the distance from the elastica relative to the length of the displacement.
double error(const reference::ElasticaTip& is) {
  const reference::ElasticaTip should = reference::elastica(5);
  return std::hypot(is.x - should.x, is.z - should.z) / std::hypot(1 - should.x, should.z);
}

// Mattiasson (1981), Int. J. Numer. Meth. Eng. 17, 145-153: w/L = 0.71379, u/L = 0.38763.
TEST(Mattiasson, TableIsTheElastica) {
  const reference::ElasticaTip exact = reference::elastica(5);
  EXPECT_NEAR(exact.z, 0.71379, 5e-6);
  EXPECT_NEAR(1 - exact.x, 0.38763, 5e-6);
}

// The curvature is constant in an element, which leaves an error of the order (1/8)². The elastica
// neglects shear and squares of strains, 5e-4 at L/h = 50.
TEST(Mattiasson, EightElementsAreEnoughHoweverSlender) {
  const reference::ElasticaTip exact = reference::elastica(5);
  for (const double slenderness : {50, 200, 500, 1000}) {
    const reference::ElasticaTip is = tip("ecm", slenderness, 8);
    std::cout << "  L/h " << slenderness << ": w " << 100 * (is.z / exact.z - 1) << " %, u "
              << 100 * ((1 - is.x) / (1 - exact.x) - 1) << " %, tip " << 100 * error(is)
              << " %, full " << 100 * error(tip("ecm_full", slenderness, 8)) << " %\n";
    EXPECT_LT(error(is), 0.01) << slenderness;
    EXPECT_NEAR(is.z, exact.z, 0.005 * exact.z) << slenderness;
    EXPECT_NEAR(is.x, exact.x, 0.01 * exact.x) << slenderness;
  }
}

TEST(Mattiasson, ConvergesWithOrderTwo) {
  for (const double slenderness : {500, 1000}) {
    const testing::Rate rate = testing::fit_rate({1.0 / 8, 1.0 / 16, 1.0 / 32}, [&](double size) {
      return error(tip("ecm", slenderness, static_cast<int>(std::lround(1 / size))));
    });
    std::cout << rate.table();
    EXPECT_NEAR(rate.order(), 2, 0.1) << rate.table();
  }
}

/// Returns the tip of the cantilever modelled as a plate in the plane, one element high.
reference::ElasticaTip plate_tip(const std::string& term, double slenderness, int n) {
  const double height = 1 / slenderness;
  VectorXd force(2);
  force << 0, 5 * bending_stiffness(height);
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(section()));
  terms.push_back(make_term(term, section()));
  terms.push_back(make_point_force({1, 0}, force));
  Workspace model;
  model.add_body(
      "plate",
      std::make_unique<AncfPlate>(2, AncfPlate::ShapeSet::h16, testing::uniform_lines(0, 1, n),
                                  testing::uniform_lines(-height / 2, height / 2, 1)),
      section(), std::move(terms));
  model.add_joint(make_hold("clamp", "plate",
                            {{{.edge = "root"}, NodeVector::r, {0, 1}, {}},
                             {{.edge = "root"}, NodeVector::r_n, {0, 1}, {}}}));
  State x = model.reference();
  EXPECT_TRUE(solve_static(model, x).completed);
  const Vec2 at = model.location_motion({"plate", {1, 0}}, x).position;
  return {at.x(), at.y()};
}

// The shapes are cubic along the beam and over its height. Strains of the displacements lock, at
// larger slenderness than in beams; assumed strains do not. The error of 8 elements is 0.1 %, and
// shear contributes as much at L/h = 50.
TEST(SlenderPlate, InThePlaneBendsAsTheElasticaWhereStrainsAreAssumed) {
  for (const double slenderness : {50, 200, 500, 1000}) {
    const double assumed = error(plate_tip("membrane_assumed", slenderness, 8)),
                 full = error(plate_tip("membrane", slenderness, 8));
    std::cout << "  L/h " << slenderness << ": assumed " << 100 * assumed << " %, full "
              << 100 * full << " %\n";
    EXPECT_LT(assumed, 3e-3) << slenderness;
  }
}

// An end load bends an arc of 60 degrees further. The sections of the reference rotate along it.
TEST(SlenderArc, BendsAsTheElastica) {
  const double turn = std::numbers::pi / 3;
  const reference::ElasticaTip exact = reference::elastica(2, turn);
  for (const double slenderness : {50, 200, 1000}) {
    const auto off = [&](double size) {
      const int n = static_cast<int>(std::lround(1 / size));
      const double height = 1 / slenderness;
      VectorXd force(2);
      force << 0, 2 * bending_stiffness(height);
      auto beam =
          std::make_unique<AncfBeam>(uniform_nodes(1, n), height, arc_reference(1, turn, n));
      Workspace model = cantilever("ecm", std::move(beam), force);
      State x = model.reference();
      EXPECT_TRUE(solve_static(model, x).completed);
      const Vec2 at = model.location_motion({"beam", {1, 0}}, x).position;
      return std::hypot(at.x() - exact.x, at.y() - exact.z);
    };
    const testing::Rate rate = testing::fit_rate({1.0 / 8, 1.0 / 16, 1.0 / 32}, off);
    std::cout << "  L/h " << slenderness << '\n' << rate.table();
    EXPECT_LT(rate.error.front(), 0.01);
    // At 50 the terms that the elastica neglects, 1.5e-4, are as large as the error of the mesh.
    if (slenderness > 100) {
      EXPECT_NEAR(rate.order(), 2, 0.15) << rate.table();
    }
  }
}

/// Returns the angular frequencies of a free beam of L/h = 200, without those of rigid motions.
VectorXd angular_frequencies(const std::string& term, int n) {
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(section()));
  terms.push_back(make_term(term, section()));
  Workspace model;
  model.add_body("beam", std::make_unique<AncfBeam>(1, 1.0 / 200, n), section(), std::move(terms));
  const State x = model.reference();
  model.prepare(0.0);
  Constraints none;
  model.constraints(x, none);
  SparseMatrix stiffness, mass;
  model.kkt(x, none, {1, 0, 0}, 1, stiffness);
  model.kkt(x, none, {0, 0, 1}, 1, mass);
  const testing::Modes modes = testing::modes(MatrixXd(stiffness), MatrixXd(mass));
  return modes.values.tail(modes.values.size() - 3).cwiseSqrt();
}

// ω = β² √(E I/(ρ A)), cos β cosh β = 1; shear and rotary inertia reduce it by about 1e-5 (1 + E/G)
// β²/24 of itself. Elements of constant curvature have order 2. To first order about a straight
// beam, assumed strains equal the strains of the displacements.
TEST(SlenderBeam, HasTheFrequenciesOfBernoulliAndEuler) {
  const double beta[] = {4.7300407, 7.8532046, 10.9956078},
               unit = std::sqrt(kModulus / (12 * 7850.0)) / 200;
  for (int mode = 0; mode < 3; ++mode) {
    const testing::Rate rate = testing::fit_rate({1.0 / 8, 1.0 / 16, 1.0 / 32}, [&](double size) {
      const int n = static_cast<int>(std::lround(1 / size));
      const double omega = angular_frequencies("ecm", n)[mode];
      EXPECT_NEAR(omega, angular_frequencies("ecm_full", n)[mode], 1e-6 * omega);
      return std::abs(omega / (beta[mode] * beta[mode] * unit) - 1);
    });
    std::cout << "  bending " << mode + 1 << '\n' << rate.table();
    EXPECT_NEAR(rate.order(), 2, 0.15) << rate.table();
  }
}

}  // namespace
}  // namespace flexmorph::fem
