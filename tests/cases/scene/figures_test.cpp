// Shows that the plausibility checks of bending and rotation agree with linearized models, and that
// they detect wrong units.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "cases/check/plausibility.h"
#include "cases/check/ready.h"
#include "tests/cases/scenes.h"
#include "tests/io/scratch.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

/// Small motions of a scene about its reference configuration: natural frequencies [Hz], and the
/// displacements under all its forces.
struct Linear {
  std::vector<double> frequencies;
  VectorXd displacement;
};

Linear linearized(const Scene& scene) {
  Mechanism mechanism = build_mechanism(scene);
  fem::Workspace& model = mechanism.model;
  const fem::State x = model.reference();
  const Eigen::Index n = model.n_dofs();
  fem::Constraints c;
  model.constraints(x, c);
  fem::SparseMatrix stiffness, mass;
  model.kkt(x, c, {1, 0, 0}, 1, stiffness);
  model.kkt(x, c, {0, 0, 1}, 1, mass);
  const MatrixXd K = MatrixXd(stiffness).topLeftCorner(n, n),
                 M = MatrixXd(mass).topLeftCorner(n, n);
  MatrixXd Phi = MatrixXd::Zero(c.value.size(), n);
  for (const auto& entry : c.jacobian) Phi(entry.row(), entry.col()) += entry.value();
  const MatrixXd Z = Phi.fullPivLu().kernel();
  VectorXd force;
  model.force(x, force);
  const MatrixXd k = Z.transpose() * K * Z, m = Z.transpose() * M * Z;
  Linear out;
  out.displacement = Z * k.ldlt().solve(-Z.transpose() * force);
  const VectorXd squared = Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(k, m).eigenvalues();
  for (const double each : squared)
    out.frequencies.push_back(std::sqrt(std::max(0.0, each)) / (2 * std::numbers::pi));
  return out;
}

/// Returns the largest displacement of a node across the surface, from the first vector of every
/// node.
double largest_rise(const VectorXd& displacement) {
  double out = 0;
  for (Eigen::Index i = 2; i < displacement.size(); i += 12)
    out = std::max(out, std::abs(displacement[i]));
  return out;
}

const Changes kStrip = {"gravity=[0, 0, -9.81]", "body.density=7800",
                        "load=", "body.terms=[\"inertia\", \"membrane_assumed\", \"bending\"]"};

// A strip in space with Poisson's ratio 0: the formulas of a cantilever agree with the model up to
// the error of its mesh of 16 elements.
TEST(Figures, OfACantileverAreThoseOfItsModel) {
  const Scene scene = read("cantilever_roll_up", kStrip);
  const BendingFigures f = bending_figures(scene).at(0);
  EXPECT_EQ(f.support, Support::cantilever);
  EXPECT_EQ(f.slenderness(), 100);
  const Linear found = linearized(scene);
  EXPECT_NEAR(f.frequencies[0], found.frequencies[0], 0.01 * f.frequencies[0]);
  EXPECT_NEAR(f.frequencies[1], found.frequencies[1], 0.02 * f.frequencies[1]);
  ASSERT_TRUE(f.sag.has_value());
  EXPECT_NEAR(*f.sag, largest_rise(found.displacement), 0.01 * *f.sag);
  EXPECT_FALSE(f.bend.has_value());
  EXPECT_EQ(f.step_frequency, 0);
}

TEST(Figures, LoadsBendAsTheModelDoes) {
  // The moment of the case rolls the strip up: 2 pi E I / L, which deflects it by pi lengths in
  // linear theory.
  EXPECT_NEAR(*bending_figures(read("cantilever_roll_up")).at(0).bend, std::numbers::pi, 1e-9);
  const Changes by_edge = {"load.type=edge", "load.moment=", "load.force=[0, 0, 0.1]",
                           "body.density=1"};
  const Scene scene = read("cantilever_roll_up", by_edge);
  const BendingFigures f = bending_figures(scene).at(0);
  ASSERT_TRUE(f.bend.has_value());
  EXPECT_NEAR(*f.bend, largest_rise(linearized(scene).displacement), 0.01 * *f.bend);
}

// A force along the axis causes no bending.
TEST(Figures, AtRestAPullAlongTheAxisBendsNothing) {
  const Changes pull = {"load.type=edge", "load.moment=", "load.force=[1e6, 0, 0]"};
  EXPECT_FALSE(bending_figures(read("cantilever_roll_up", pull)).at(0).bend.has_value());
}

TEST(Figures, TurnsAreThoseOfHubsAndDrives) {
  const std::vector<TurnFigures> hub = turn_figures(read("rotating_plate_v01"));
  ASSERT_EQ(hub.size(), 1u);
  EXPECT_NEAR(hub[0].angle, 2 * std::numbers::pi, 1e-12);
  EXPECT_NEAR(hub[0].per_step, 2 * std::numbers::pi / 1000, 1e-12);
  const std::vector<TurnFigures> drive = turn_figures(read("four_bar"));
  ASSERT_EQ(drive.size(), 1u);
  EXPECT_NEAR(drive[0].angle, 5 * std::numbers::pi, 1e-3);  // two and a half turns
}

TEST(Figures, ShippedCasesAreOrdinary) {
  for (const std::string& name : shipped_cases())
    for (const std::string& each : plausibility_remarks(read(name)))
      ADD_FAILURE() << name << ": " << each;
}

// Each row contains one typical mistake.
TEST(Figures, WrongUnitsAreOutOfTheOrdinary) {
  struct Row {
    const char* name;
    std::string change;
    std::vector<std::string> parts;
  };
  for (const Row& row : std::vector<Row>{
           {"deploying_plate", "body.youngs_modulus=7", {"Young's modulus", "7 Pa"}},
           {"deploying_plate", "body.youngs_modulus=7e6", {"gravity", "166"}},
           {"deploying_plate", "body.youngs_modulus=70000", {"Young's modulus", "70000 MPa"}},
           {"l_bracket", "domain.youngs_modulus=210000", {"Young's modulus", "210000 MPa"}},
           {"deploying_plate", "body.density=2.7", {"density", "2.7 kg/m^3"}},
           {"deploying_plate", "body.thickness=5", {"length / thickness", "0.18"}},
           {"deploying_plate", "body.thickness=5e-6", {"length / thickness", "1.8e+05"}},
           {"deploying_plate", "gravity=[0, 0, -9810]", {"gravity", "9.81e+03 m/s^2"}},
           {"deploying_plate", "hub.angular_velocity=90", {"'hub'", "90 rad", "14.3 revolutions"}},
           {"deploying_plate", "hub.angle=45", {"angle", "45 rad"}},
           {"deploying_plate",
            "hub.angular_velocity=3000",
            {"'hub'", "477 revolutions", "3 rad per time step"}},
           {"four_bar", "body.width=50", {"length / width", "0.008"}},
           {"four_bar", "body.youngs_modulus=2", {"bending frequency", "0.0118 Hz"}},
           {"four_bar", "body.length=0.004", {"bending frequency", "rigid"}},
           {"slider_crank_heated",
            "drive.formula=\"180*t\"",
            {"'motor'", "360 rad", "57.3 revolutions"}}}) {
    Changes changes = {row.change};
    for (const char* part :
         {"design=", "esl=", "optimizer=", "cycle=", "verify=", "accuracy=", "expect=", "observe="})
      if (row.name != std::string("l_bracket")) changes.emplace_back(part);
    bool found = false;
    std::string all;
    for (const std::string& each : plausibility_remarks(read(row.name, changes))) {
      found = found || testing::mentions_all(each, row.parts,
                                             location_in(each, shipped(row.name), {row.change}));
      all += each + "\n";
    }
    EXPECT_TRUE(found) << row.name << ", " << row.change << ":\n" << all;
  }
}

}  // namespace
}  // namespace flexmorph::cases
