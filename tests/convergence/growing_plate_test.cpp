// Shows for the extending, rotating plate of P 4.2 that nodes are inserted at the right times with
// negligible changes, that energy and momentum balance with order 2, that coarse steps are stable,
// and that a retracting plate loses nodes without alternating changes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "fem/dynamics/integrators/generalized_alpha.h"
#include "fem/dynamics/motion.h"
#include "tests/support/models.h"
#include "tests/support/rates.h"

namespace flexmorph::fem {
namespace {

using testing::RotatingPlate;
using testing::ShapeSet;

struct Outcome {
  MotionResult result;
  double amplitude = 0;               // amplitude of the tip's deflection
  double largest_energy = 0;          // reference of the relative energy error
  double final_error = 0;             // [J]
  std::vector<double> energy_errors;  // energy errors at the stops
};

Outcome run(const RotatingPlate& p, MotionSettings settings, double end = 1) {
  testing::Scene scene = testing::make_scene(p);
  settings.end = end;
  Outcome out;
  out.result = integrate(scene.model, scene.moving_roots, settings, [&](const MotionStep& step) {
    out.amplitude =
        std::max(out.amplitude, std::abs(testing::in_hub(p, step.model, step.x, p.tip()).y()));
    out.largest_energy = std::max(out.largest_energy, step.energies.total());
    out.final_error = step.energy_error;
    if (step.stop) out.energy_errors.push_back(step.energy_error);
  });
  return out;
}

void print(const char* name, const Outcome& o) {
  const MotionResult& r = o.result;
  std::printf(
      "%s: amplitude %.6e m, defect %.2e, drift %.1e m %.1e m/s, %d steps %d Newton %d factors %d "
      "rejected\n",
      name, o.amplitude, r.energy_error, r.constraint_drift, r.velocity_drift, r.counts.steps,
      r.counts.newton, r.counts.factorizations, r.counts.rejected);
  for (const MeshEvent& e : r.events)
    std::printf("  t = %.15g: dT/T %.1e, dU/U %.1e, momentum %.1e, tip %.1e m\n", e.time,
                e.after.kinetic / e.before.kinetic - 1, e.after.strain / e.before.strain - 1,
                (e.momentum_after - e.momentum_before).norm() / e.momentum_before.norm(),
                e.tip_jump);
}

void expect_times(const std::vector<MeshEvent>& events, const std::vector<double>& times) {
  ASSERT_EQ(events.size(), times.size());
  for (size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(events[i].time, times[i], 1e-12);
}

/// A finer mesh is less stiff: when forces are balanced on it, the strain energy falls by less than
/// 1 %, and the plate moves by far less than its deflections of 1 mm and more.
void expect_small_jumps(const std::vector<MeshEvent>& events) {
  for (const MeshEvent& e : events) {
    EXPECT_NEAR(e.after.kinetic / e.before.kinetic, 1, 1e-6) << e.time;
    EXPECT_LT(e.after.strain, e.before.strain) << e.time;
    EXPECT_GT(e.after.strain, 0.99 * e.before.strain) << e.time;
    EXPECT_LT((e.momentum_after - e.momentum_before).norm(), 1e-6 * e.momentum_before.norm());
    EXPECT_LT(e.tip_jump, 1e-6);
  }
}

// The root passes 0.05 m at 0.5 s for v 0.1, and every 0.1 s for v 0.5; no event is made at the end
// of the motion.
TEST(GrowingPlate, SlowGrowthInsertsOnceAndBalances) {
  RotatingPlate p;
  const Outcome o = run(p, {});
  print("v 0.1", o);
  expect_times(o.result.events, {0.5});
  expect_small_jumps(o.result.events);
  EXPECT_LT(o.result.energy_error, 1e-4);
  EXPECT_LT(o.result.constraint_drift, 1e-11);
  EXPECT_EQ(o.result.counts.rejected, 0);
}

TEST(GrowingPlate, FastGrowthInsertsNineTimesAndBalances) {
  RotatingPlate p;
  p.speed = 0.5;
  const Outcome o = run(p, {});
  print("v 0.5", o);
  expect_times(o.result.events, {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9});
  expect_small_jumps(o.result.events);
  EXPECT_LT(o.result.energy_error, 1e-4);
}

TEST(GrowingPlate, IsStableWithCoarseStepsAndDamping) {
  RotatingPlate p;
  p.speed = 0.5;
  MotionSettings fine, coarse;
  coarse.step = 2e-3;
  coarse.alpha.rho_inf = 0.6;
  const Outcome a = run(p, fine), b = run(p, coarse);
  print("v 0.5, 2 ms, rho 0.6", b);
  // Both resolve the bending, whose periods exceed 0.1 s; an instability would cause a much larger
  // difference.
  EXPECT_NEAR(b.amplitude / a.amplitude, 1, 0.02);
  EXPECT_LT(b.result.energy_error, 1e-3);
  EXPECT_EQ(b.result.counts.rejected, 0);
}

// Incomplete shapes cannot represent the field after an insertion. The strain energy changes by
// less than 1 %, as with complete shapes in expect_small_jumps(), but no balance of forces
// guarantees that it falls.
TEST(GrowingPlate, IncompleteShapesJumpAtInsertions) {
  RotatingPlate p;
  p.speed = 0.5;
  p.shapes = ShapeSet::h12;
  const Outcome o = run(p, {});
  print("h12, v 0.5", o);
  EXPECT_EQ(o.result.events.size(), 9u);
  for (const MeshEvent& e : o.result.events) {
    EXPECT_NEAR(e.after.kinetic / e.before.kinetic, 1, 1e-4);
    EXPECT_NEAR(e.after.strain / e.before.strain, 1, 0.01);
    EXPECT_LT(e.tip_jump, 1e-6);
  }
}

// The order is 2 up to the first insertion; the loss by an insertion has another cause (see the
// next test).
TEST(EnergyBalance, IsOfOrderTwoBetweenChangesOfTheMesh) {
  for (const double speed : {0.1, 0.5}) {
    RotatingPlate p;
    p.speed = speed;
    const auto rate = testing::fit_rate({2e-3, 1e-3, 5e-4, 2.5e-4}, [&](double h) {
      MotionSettings settings;
      settings.step = h;
      return std::abs(run(p, settings, 0.1).final_error);
    });
    std::printf("v %.1f: defect [J] after 0.1 s\n%s", speed, rate.table().c_str());
    EXPECT_NEAR(rate.order(), 2, 0.2) << rate.table();
  }
}

/// Returns the energy loss [J] within 5 ms after the first insertion in a plate of n x n/5
/// elements, with steps h there and steps of 0.25 ms before. `strain` receives the strain energy.
double loss_after_insertion(int nx, double h, double* strain = nullptr) {
  RotatingPlate p;
  p.speed = 0.5;
  p.nx = nx;
  p.ny = nx / 5;
  testing::Scene scene = testing::make_scene(p);
  MotionSettings settings;
  settings.step = 2.5e-4;
  settings.end = p.length / nx / p.speed;  // the boundary element is then two times as long
  State x = integrate(scene.model, scene.moving_roots, settings, [](const MotionStep&) {}).final;
  change_mesh(scene.model, scene.model.bodies()[0], MeshChange::insertion, x);
  GeneralizedAlpha alpha(scene.model, settings.alpha);
  EnergyBalance balance;
  const auto power = [&] { return powers(scene.model, x); };
  if (strain) *strain = scene.model.energies(x).strain;
  balance.begin(x.t, scene.model.energies(x), power());
  const double start = x.t;
  const int n = static_cast<int>(std::lround(5e-3 / h));
  for (int k = 1; k <= n; ++k)
    alpha.advance(x, start + k * h,
                  [&](const State&) { balance.add(x.t, scene.model.energies(x), power()); });
  return -balance.energy_error();
}

// After an insertion the state is unchanged, but it is no equilibrium of the richer mesh: it
// relaxes by the interpolation error of the old mesh, in modes with frequencies far above the
// step's resolution, which generalized-alpha damps. Therefore the loss decreases with the element
// size, does not depend on steps that leave those modes unresolved, and nearly vanishes when the
// steps resolve them.
TEST(EnergyBalance, LossAfterAnInsertionIsTheRelaxationOfTheRicherMesh) {
  std::vector<double> relative;
  for (const int nx : {5, 10, 20}) {
    double strain = 0;
    const double loss = loss_after_insertion(nx, 2.5e-4, &strain);
    relative.push_back(loss / strain);
    std::printf("%d x %d: loss %.2e J of %.2e J strain energy\n", nx, nx / 5, loss, strain);
  }
  EXPECT_LT(relative[1], 0.6 * relative[0]);
  EXPECT_LT(relative[2], 0.6 * relative[1]);
  const double half = loss_after_insertion(10, 1.25e-4), resolved = loss_after_insertion(10, 1e-5);
  std::printf("10 x 2, h = 0.125 ms: %.2e J, h = 0.01 ms: %.2e J\n", half, resolved);
  EXPECT_NEAR(half / loss_after_insertion(10, 2.5e-4), 1, 0.2);
  EXPECT_LT(resolved, 0.1 * half);
}

/// Returns the largest error of  P(t) - P(0) = ∫ (reactions + ρ h (-ṁ₀) ∫ ṙ dn) dt, relative to the
/// largest P.
double momentum_error(double h) {
  RotatingPlate p;
  p.speed = 0.5;
  testing::Scene scene = testing::make_scene(p);
  Vec2 start, last_force, impulse = Vec2::Zero();
  double last = 0, worst = 0, largest = 0;
  MotionSettings settings;
  settings.step = h;
  settings.end = 0.1;
  integrate(scene.model, scene.moving_roots, settings, [&](const MotionStep& step) {
    const Body& body = step.model.body("plate");
    const LineGrid& plate = grid_of(body);
    // A translation is a virtual displacement of positions only; therefore exactly the reactions on
    // positions count.
    Constraints c;
    step.model.constraints(step.x, c);
    VectorXd reaction = VectorXd::Zero(step.x.q.size());
    step.model.add_constraint_force(c, step.x.lambda, reaction);
    Vec2 force = Vec2::Zero();
    for (int k = 0; k < plate.n_vectors(); ++k)
      if (plate.is_position(k)) force -= reaction.segment<2>(2 * k);
    for (int j = 0; j < plate.n_n(); ++j)
      for (size_t g = 0; g < 2; ++g) {
        const double width = plate.line_n(j + 1).value - plate.line_n(j).value;
        const double n = plate.line_n(j).value + width * gauss(2).points[g];
        force -= p.section.density * p.section.thickness * plate.line_m(0).rate * width *
                 gauss(2).weights[g] *
                 point_motion(body, step.x, {plate.line_m(0).value, n}).velocity;
      }
    // This momentum includes the mass at the tip.
    const Vec2 now = Vec2(step.model.momentum(step.x).head<2>()) +
                     p.tip_mass * point_motion(body, step.x, p.tip()).velocity;
    if (step.x.t == 0) {
      start = now;
    } else {
      impulse += 0.5 * (step.x.t - last) * (force + last_force);
      worst = std::max(worst, (now - start - impulse).norm());
    }
    largest = std::max(largest, now.norm());
    last = step.x.t;
    last_force = force;
  });
  return worst / largest;
}

TEST(MomentumBalance, HoldsWithOrderTwo) {
  const auto rate = testing::fit_rate({2e-3, 1e-3, 5e-4, 2.5e-4}, momentum_error);
  std::printf("relative defect of the momentum over 0.1 s\n%s", rate.table().c_str());
  EXPECT_NEAR(rate.order(), 2, 0.3) << rate.table();
  EXPECT_LT(rate.error[1], 1e-4);
}

// From 0.5 m to 0.4 m in 1 s, boundary elements are merged at 0.03 m and never split.
TEST(ShrinkingPlate, LosesNodesWithoutChatter) {
  RotatingPlate p;
  p.speed = -0.1;
  const Outcome o = run(p, {});
  print("v -0.1", o);
  expect_times(o.result.events, {0.2, 0.7});
  for (const MeshEvent& e : o.result.events) {
    EXPECT_EQ(e.change, MeshChange::removal);
    EXPECT_NEAR(e.after.strain / e.before.strain, 1, 0.01);
    EXPECT_NEAR(e.after.kinetic / e.before.kinetic, 1, 1e-3);
    EXPECT_LT(e.tip_jump, 1e-6);
  }
  EXPECT_LT(o.result.energy_error, 1e-3);
  RotatingPlate fine = p;
  fine.nx = 20;
  fine.ny = 4;
  const Outcome finer = run(fine, {}, 0.5);
  const Outcome same = run(p, {}, 0.5);
  EXPECT_NEAR(same.amplitude / finer.amplitude, 1, 0.02);
}

// A boundary element that is too long at the start is split at once, without a step of length 0.
TEST(GrowingPlate, SplitsATooLongElementAtTheStart) {
  RotatingPlate p;
  testing::Scene scene = testing::make_scene(p);
  scene.moving_roots[0].max_length = 0.04;
  scene.moving_roots[0].min_length = 0.01;
  MotionSettings settings;
  settings.end = 0.05;
  const MotionResult r =
      integrate(scene.model, scene.moving_roots, settings, [](const MotionStep&) {});
  ASSERT_EQ(r.events.size(), 1u);
  EXPECT_NEAR(r.events[0].time, 0, 1e-12);
  EXPECT_EQ(r.counts.steps, 50);
  EXPECT_EQ(r.counts.rejected, 0);
  EXPECT_LT(r.energy_error, 1e-4);
}

}  // namespace
}  // namespace flexmorph::fem
