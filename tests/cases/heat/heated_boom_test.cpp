// Shows that the heated boom is built as its case file says, that without a temperature it moves as
// the cold boom, that its energies are balanced, and that its equivalent static loads and the
// gradient of its design problem are correct.
#include <gtest/gtest.h>

#include <cmath>

#include "cases/check/ready.h"
#include "cases/run/motion_run.h"
#include "optim/mmc/problem/mmc_problem.h"
#include "tests/cases/scenes.h"
#include "tests/support/errors.h"
#include "tests/support/gradient_check.h"

namespace flexmorph::cases {
namespace {

/// Returns changes that make the boom run within seconds: a coarse mesh of the motion, cells of 1
/// cm.
Changes quick(const Changes& more = {}) {
  Changes out = {"output.vtk=false",          "body.elements=[5,2]", "body.flow.max_length=0.15",
                 "body.flow.mesh=split",      "design.cell=0.01",    "design.components=[10,1]",
                 "design.min_thickness=0.01", "esl.every=0.02"};
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

MotionOutcome move(const Scene& scene, bool loads = false) {
  MotionRequest request;
  request.loads = loads;
  return run_motion(PreparedCase(scene), request);
}

TEST(HeatedBoom, ScenesAreBuilt) {
  for (const char* name : {"heated_boom", "heated_boom_held"}) {
    const Scene scene = read(name);
    require_buildable(PreparedCase(scene));
    ASSERT_TRUE(scene.body("plate").heat) << name;
    EXPECT_NEAR(scene.body("plate").heat->expansion * scene.body("plate").heat->rise.value, 0.02,
                1e-15);
    EXPECT_EQ(scene.designs.size(), 1u);
    EXPECT_EQ(scene.is_mechanism(), std::string(name) == "heated_boom_held");
    // The quintic profile has no discontinuities, the cosine profile has two.
    EXPECT_TRUE(build_mechanism(scene).motion.discontinuities.empty());
  }
  const Scene cosine = read("heated_boom", {"body.heat.profile=cosine", "body.heat.start=0.113"});
  EXPECT_EQ(build_mechanism(cosine).motion.discontinuities, (std::vector<double>{0.113, 0.613}));
}

TEST(HeatedBoom, IsNotMadeOfCells) {
  try {
    read("heated_boom", {"body.shape=\"q4\"", "body.flow.max_length="});
    FAIL();
  } catch (const Error& error) {
    EXPECT_TRUE(testing::mentions_all(error.what(), {"[body.heat]", "cells"},
                                      shipped("heated_boom") + ":"));
  }
}

TEST(HeatedBoom, HasNoExactGradient) {
  for (const char* asks : {"cycle.correct=first_order", "certificate.checkpoints=0"}) {
    try {
      read("heated_boom", {asks});
      ADD_FAILURE() << asks;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), Error::Kind::input);
      EXPECT_TRUE(testing::mentions_all(error.what(), {"gradient", "[body.heat]"},
                                        std::string("--set ") + asks + ": "));
    }
  }
}

// With rise = 0 or expansion = 0 the heated boom moves as rotating_plate_v05; the tolerances allow
// for the different order of sums.
TEST(HeatedBoom, WithoutTemperatureIsTheColdBoom) {
  const Changes both = quick({"time.end=0.12", "time.step=2e-3", "esl.every=0.02"});
  const MotionRecord cold = move(read("rotating_plate_v05", both)).record;
  for (const char* none : {"body.heat.rise=0", "body.heat.expansion=0"}) {
    Changes changes = both;
    changes.emplace_back(none);
    const MotionRecord hot = move(read("heated_boom", changes)).record;
    ASSERT_EQ(hot.time().size(), cold.time().size());
    for (size_t k = 0; k < hot.time().size(); ++k) {
      EXPECT_NEAR(hot.table.at("plate.tip_deflection")[k], cold.table.at("plate.tip_deflection")[k],
                  1e-11)
          << none;
      EXPECT_NEAR(hot.table.at(kStrainColumn)[k], cold.table.at(kStrainColumn)[k],
                  1e-9 * cold.table.at(kStrainColumn).back())
          << none;
      EXPECT_NEAR(hot.table.at(kKineticColumn)[k], cold.table.at(kKineticColumn)[k],
                  1e-10 * cold.table.at(kKineticColumn).back())
          << none;
    }
  }
}

// The error of the energy balance is of second order in the step. The balance contains the work of
// the drives, the energy that the material brings along and the power of the heat. The root element
// is not split within this time.
TEST(HeatedBoom, EnergyBalanceIsOfSecondOrder) {
  const auto energy_error = [](const char* step) {
    const MotionRecord r =
        move(read("heated_boom", quick({"time.end=0.08", "body.heat.duration=0.08",
                                        std::string("time.step=") + step})))
            .record;
    EXPECT_TRUE(r.result.events.empty());
    EXPECT_GT(r.table.at(kStrainColumn).back(), 0.2);  // [J], in the held root
    return std::abs(r.table.at(kEnergyErrorColumn).back());
  };
  const double coarse = energy_error("1e-3"), fine = energy_error("5e-4"),
               finest = energy_error("2.5e-4");
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3) << coarse << " " << fine;
  EXPECT_NEAR(std::log2(fine / finest), 2, 0.3) << fine << " " << finest;
}

// A split of the hot root element changes neither energies nor momentum. The values are compared
// before the forces are balanced again.
TEST(HeatedBoom, SplitsAreExact) {
  const Scene scene =
      read("heated_boom",
           quick({"time.end=0.1", "time.step=4e-3", "body.heat.duration=0.2", "esl.every=0.02"}));
  Mechanism m = build_mechanism(scene);
  fem::State x =
      fem::integrate(m.model, m.moving_roots, m.motion, [](const fem::MotionStep&) {}).final;
  const fem::Energies before = m.model.energies(x);
  const Vec3 momentum = m.model.momentum(x);
  fem::change_mesh(m.model, m.model.bodies().back(), fem::MeshChange::insertion, x);
  const fem::Energies after = m.model.energies(x);
  EXPECT_GT(before.strain, 0.02);
  EXPECT_NEAR(after.strain, before.strain, 1e-12 * before.kinetic);
  EXPECT_NEAR(after.kinetic, before.kinetic, 1e-12 * before.kinetic);
  EXPECT_NEAR((m.model.momentum(x) - momentum).norm(), 0, 1e-12 * before.kinetic);
}

/// The design problem of a boom that is heated within 0.1 s.
struct HotProblem {
  Scene scene = read("heated_boom", quick({"time.end=0.2", "time.step=4e-3", "esl.every=0.04",
                                           "body.heat.duration=0.1", "design.jitter=0.1",
                                           "design.half_thickness=0.014"}));
  MotionOutcome motion = move(scene, true);
  mmc::BodyProblem problem = std::move(build_problems(scene).front());
};

// The edge at the hub keeps its width, therefore all of the expansion is held there: α ΔT(t) of the
// quintic profile.
TEST(HeatedBoom, LoadsKnowTheHeldRoot) {
  const HotProblem hot;
  ASSERT_EQ(hot.motion.loads.front().sets.size(), 5u);
  for (const fem::EslSet& set : hot.motion.loads.front().sets) {
    const double u = std::min(1.0, set.time / 0.1);
    const double a = 0.02 * u * u * u * (10 + u * (-15 + 6 * u));
    EXPECT_NEAR(set.thermal_stretch, a, 1e-14);
    EXPECT_NEAR(set.held_stretch, a, 1e-6 * a);
    EXPECT_EQ(set.root_column, static_cast<int>(std::lround((0.1 - 0.5 * set.time) / 0.01)));
  }
}

/// The loads of a boom that is heated within 0.1 s and has full material. of() returns half the
/// compliance of each load divided by the strain energy of the motion. The mesh is fine: elements
/// of 2.5 cm, cells of 5 mm.
struct EnergyRatios {
  EnergyRatios(const std::string& name)
      : scene(read(name, quick({"time.end=0.2", "time.step=4e-3", "esl.every=0.04",
                                "body.heat.duration=0.1", "body.elements=[20,8]",
                                "body.flow.max_length=0.04", "design.cell=0.005"}))),
        loads(std::move(move(scene, true).loads.front())) {}

  VectorXd of(const fem::EslSets& sets) const {
    const mmc::BodyProblem problem = std::move(build_problems(scene).front());
    const VectorXd full = VectorXd::Ones(sets.grid.n_cells());
    VectorXd out =
        0.5 * mmc::ComplianceEvaluator(sets, problem.section, problem.compliance, full, full)
                  .individual(full, full);
    for (size_t l = 0; l < sets.sets.size(); ++l)
      out[static_cast<Eigen::Index>(l)] /= sets.sets[l].strain_energy;
    return out;
  }

  Scene scene;
  fem::EslSets loads;
};

// The static analysis is linear, but the plate is 2 % larger than the cold plate. The remaining
// difference is the error of the meshes: the ratios are 0.96 to 0.99 with elements of 5 cm and
// 1.018 to 1.024 with 2.5 cm.
constexpr double kOfSmallStrains = 0.03;

TEST(HeatedBoom, ComplianceIsTheStrainEnergyOfTheMotion) {
  const EnergyRatios boom("heated_boom");
  const VectorXd ratios = boom.of(boom.loads);
  ASSERT_EQ(ratios.size(), 5);
  for (size_t l = 0; l < boom.loads.sets.size(); ++l) {
    EXPECT_GT(boom.loads.sets[l].strain_energy, 0.04);
    EXPECT_NEAR(ratios[static_cast<Eigen::Index>(l)], 1, kOfSmallStrains)
        << boom.loads.sets[l].time;
  }
}

// With a rigid, cold tip the far edge keeps its width, too, and the static loads contain the
// expansion held there: half the compliance of a load is the strain energy of the motion. Without
// the expansion held at the tip it is at least a third smaller.
TEST(HeatedBoom, LoadsKnowTheHeldTip) {
  const EnergyRatios boom("heated_boom_held");
  const VectorXd held = boom.of(boom.loads);
  fem::EslSets without = boom.loads;
  for (fem::EslSet& set : without.sets) {
    EXPECT_NEAR(set.held_end_stretch, set.thermal_stretch, 1e-6 * set.thermal_stretch);
    EXPECT_NEAR(set.held_stretch, set.thermal_stretch, 1e-6 * set.thermal_stretch);
    set.held_end_stretch = 0;
  }
  const VectorXd free = boom.of(without);
  ASSERT_EQ(held.size(), 5);
  for (size_t l = 0; l < boom.loads.sets.size(); ++l) {
    const auto at = static_cast<Eigen::Index>(l);
    EXPECT_NEAR(held[at], 1, kOfSmallStrains) << boom.loads.sets[l].time;
    EXPECT_LT(free[at], 2.0 / 3) << boom.loads.sets[l].time;  // a third is held at the tip
  }
}

// Taylor test of log f of the shipped case along single components. The start is jittered, because
// in the regular layout components lie symmetrically on each other, and the remainder then has
// order 1, hot or cold.
TEST(HeatedBoom, GradientOfTheDesignProblem) {
  HotProblem hot;
  const mmc::BodyProblem& p = hot.problem;
  const fem::EslSets& loads = hot.motion.loads.front();
  const VectorXd full = VectorXd::Ones(loads.grid.n_cells());
  mmc::ComplianceEvaluator compliance(loads, p.section, p.compliance, full, full);
  const mmc::Ersatz ersatz = mmc::ersatz_of(p);
  const mmc::Plate plate = mmc::plate_of(p);
  mmc::MmcProblem problem({plate, p.design, ersatz, compliance}, p.bands.front(), p.goal,
                          p.locations);
  const VectorXd x = problem.start();
  const optim::ProblemValues at = problem.evaluate(x);
  for (const int component : {0, 7, 19}) {
    VectorXd direction = VectorXd::Zero(x.size());
    for (int k = 0; k < Component::kParameters; ++k)
      direction[component * Component::kParameters + k] = k % 2 == 0 ? 1 : -0.6;
    const optim::TaylorTest test =
        optim::taylor_test([&](const VectorXd& y) { return problem.evaluate(y).f; }, at.df, x,
                           direction, 1e-4, 3, 1e-13);
    EXPECT_NEAR(test.order, 2, 0.05) << component << "\n" << test.table();
  }
}

}  // namespace
}  // namespace flexmorph::cases
