// Shows free material lines in whole models: a sleeve pushes a bent strip out with the
// configurational force M²/(2 EI), and with the acceleration that follows from it; a free line that
// a joint drives moves the plate exactly as a prescribed line; a strip on both sides of a sleeve
// conserves its energy; lines of nodes are inserted and removed next to a free root line.
#include <gtest/gtest.h>

#include <cmath>

#include "fem/dynamics/integrators/generalized_alpha.h"
#include "fem/dynamics/motion.h"
#include "fem/loads.h"
#include "fem/terms.h"
#include "tests/support/rates.h"
#include "tests/support/space_plates.h"

namespace flexmorph::fem {
namespace {

using testing::ShapeSet;
using testing::uniform_lines;
using testing::vector;

FrameDrive at_rest(const Vec2& origin) {
  return [origin](double) {
    FrameMotion out;
    out.origin = origin;
    return out;
  };
}

AlphaSettings damped(double rho_inf) {
  AlphaSettings out;
  out.rho_inf = rho_inf;
  return out;
}

/// A strip in space that leaves a sleeve at the origin along x; its root line is free.
struct Strip {
  double length = 0.5, width = 0.05;
  int n = 8;
  PlaneSection section{0.005, 1e8, 0.0, 2700};
  double bending() const {  // EI [N m²]
    return section.youngs_modulus * std::pow(section.thickness, 3) / 12 * width;
  }
  double mass() const { return section.density * section.thickness * width * length; }

  Workspace model(std::unique_ptr<Term> load, bool inertia) const {
    std::vector<std::unique_ptr<Term>> terms;
    terms.push_back(make_membrane(section));
    terms.push_back(make_bending(section));
    if (inertia) terms.push_back(make_inertia(section));
    terms.push_back(std::move(load));
    auto lines = uniform_lines(0, length, n);
    lines[0].free = true;
    Workspace out;
    out.add_body("strip",
                 std::make_unique<AncfPlate>(3, ShapeSet::h16, lines, uniform_lines(0, width, 1)),
                 section, std::move(terms));
    out.add_joint(make_weld("sleeve", "strip", "root", at_rest({0, 0}), WeldMode::direction));
    return out;
  }
};

std::unique_ptr<Joint> hold_line(int scalar, double at) {
  return make_line_drive("feed", "strip", scalar, [at](double) { return Motion{at, 0, 0}; });
}

/// Returns the force out of the sleeve on the free line of a strip bent by a load, in equilibrium
/// [N].
double force_of_the_sleeve(const Strip& strip, std::unique_ptr<Term> load) {
  Workspace model = strip.model(std::move(load), false);
  model.add_joint(hold_line(0, 0));
  State x = model.reference();
  solve_static(model, x);
  return -x.lambda[x.lambda.size() - 1];
}

// Bigoni et al. (2015): the force is M²/(2 EI) at the exit of a frictionless sleeve for any load
// that bends the strip.
TEST(Sleeve, FeelsTheConfigurationalForce) {
  std::vector<double> h, error;
  for (const int n : {2, 4, 8}) {
    Strip strip;
    strip.n = n;
    const double curvature = 1.5, moment = strip.bending() * curvature;  // 43 degrees in total
    const double expected = moment * moment / (2 * strip.bending());
    const double force =
        force_of_the_sleeve(strip, make_edge_moment("free_end", moment / strip.width));
    h.push_back(1.0 / n);
    error.push_back(std::abs(force / expected - 1));
  }
  std::printf("configurational force of an end moment\n%s",
              testing::Rate{h, error}.table().c_str());
  EXPECT_LT(error.back(), 0.01);
  EXPECT_LT(error[2], error[0]);
}

TEST(Sleeve, FeelsTheConfigurationalForceOfATipLoad) {
  Strip strip;
  const double load = 0.02;  // tip deflection 1.6 % of the length
  const double moment = load * strip.length;
  const double force =
      force_of_the_sleeve(strip, make_edge_load("free_end", vector(0, 0, load / strip.width)));
  EXPECT_NEAR(force / (moment * moment / (2 * strip.bending())), 1, 0.01);
}

/// Returns the acceleration out of the sleeve, relative to M²/(2 EI m), of a strip that a constant
/// end moment bends to an arc, released from rest.
double released(double curvature) {
  const Strip strip;
  const double moment = strip.bending() * curvature;
  Workspace held = strip.model(make_edge_moment("free_end", moment / strip.width), false);
  held.add_joint(hold_line(0, 0));
  State bent = held.reference();
  solve_static(held, bent);

  Workspace model = strip.model(make_edge_moment("free_end", moment / strip.width), true);
  State x = model.reference();
  x.q = bent.q;
  GeneralizedAlpha integrator(model, damped(0.8));
  integrator.make_consistent(x);
  // The acceleration is a least-squares fit of -p = ½ a t² over 0.1 s, which is many periods of the
  // axial waves (5 ms) that the release excites.
  double top = 0, bottom = 0;
  const auto line = x.q.size() - 1;
  while (x.t < 0.1 - 1e-9)
    integrator.advance(x, x.t + 5e-4, [&](const State& at) {
      const double unit = 0.5 * at.t * at.t;
      top += -at.q[line] * unit;
      bottom += unit * unit;
    });
  return top / bottom / (moment * moment / (2 * strip.bending()) / strip.mass());
}

// Every point slides along the arc, so that m v' = M²/(2 EI), except for the moments of the strip's
// own inertia about its curved axis, which are of the order of the square of the angle.
TEST(Sleeve, ReleasesABentStripWithTheRightAcceleration) {
  const double half = released(0.5), quarter = released(0.25);  // 14 and 7 degrees
  std::printf("acceleration / (M^2/(2 EI m)): %.5f, %.5f\n", half, quarter);
  EXPECT_NEAR(quarter, 1, 0.01);
  EXPECT_NEAR((half - 1) / (quarter - 1), 4, 1);
}

// P 4.2 with a prescribed root line must equal P 4.2 with a free root line driven by a constraint.
TEST(EulerianLine, DrivenByAJointMovesAsAPrescribedOne) {
  const auto drive = [](double t) { return Motion{0.5 - 0.4 * t, -0.4, 0}; };
  const auto spin = [](double t) {
    FrameMotion out;
    out.angle = 6 * t;
    out.angle_rate = 6;
    return out;
  };
  const PlaneSection section{0.01, 1e8, 0.3, 2700};
  const auto run = [&](bool free) {
    auto lines = uniform_lines(0.5, 1, 4);
    lines[0].free = free;
    if (!free) lines[0].drive = drive;
    std::vector<std::unique_ptr<Term>> terms;
    terms.push_back(make_membrane(section));
    terms.push_back(make_inertia(section));
    terms.push_back(make_point_mass(0.5, {1, 0}, VectorXd()));
    Workspace model;
    model.add_body(
        "strip",
        std::make_unique<AncfPlate>(2, ShapeSet::h16, lines, uniform_lines(-0.05, 0.05, 2)),
        section, std::move(terms));
    model.add_joint(make_weld("hub", "strip", "root", spin, WeldMode::edge));
    if (free) model.add_joint(make_line_drive("feed", "strip", 0, drive));
    State x = model.reference();
    const auto n = 2 * model.bodies()[0].element->n_vectors();
    for (Eigen::Index k = 0; k < n; k += 2) {
      if (model.bodies()[0].element->is_position(static_cast<int>(k / 2))) x.q[k] -= 0.5;
      x.v[k] = -6 * x.q[k + 1];  // a rigid rotation ...
      x.v[k + 1] = 6 * x.q[k];
    }
    for (Eigen::Index k = 0; k < n; k += 2)  // ... and all material moves out of the hub
      if (model.bodies()[0].element->is_position(static_cast<int>(k / 2)) && x.q[k] > 1e-9)
        x.v[k] += 0.4;
    if (free) x.v[n] = drive(0).rate;
    GeneralizedAlpha integrator(model, AlphaSettings{});
    integrator.project_velocity(x);
    integrator.make_consistent(x);
    while (x.t < 0.1 - 1e-9) integrator.advance(x, x.t + 1e-3, [](const State&) {});
    if (free) {
      EXPECT_NEAR(x.q[n], drive(0.1).value, 1e-12);
    }
    return VectorXd(x.q.head(n));
  };
  const VectorXd prescribed = run(false), free = run(true);
  EXPECT_LT((prescribed - free).lpNorm<Eigen::Infinity>(), 1e-8);
}

// The strip is on both sides of a sleeve: an inner line is free, and no material leaves the model.
TEST(EulerianLine, AnInnerSleeveKeepsEnergyAndOrder) {
  const PlaneSection section{0.005, 1e6, 0.3, 2700};
  const double whole = 0.8, at = 0.3;
  const auto run = [&](double h, double* drift) {
    auto lines = uniform_lines(0, whole, 8);
    lines[3].value = at;
    lines[3].free = true;
    std::vector<std::unique_ptr<Term>> terms;
    terms.push_back(make_membrane(section));
    terms.push_back(make_bending(section));
    terms.push_back(make_inertia(section));
    terms.push_back(make_gravity(section, vector(1.0, 0, -2.0)));
    Workspace model;
    model.add_body("strip",
                   std::make_unique<AncfPlate>(3, ShapeSet::h16, lines, uniform_lines(0, 0.05, 1)),
                   section, std::move(terms));
    model.add_joint(make_weld("sleeve", "strip", "line 3", at_rest({at, 0}), WeldMode::direction));
    State x = model.reference();
    GeneralizedAlpha integrator(model, damped(0.9));
    integrator.make_consistent(x);
    const double energy = model.energies(x).total();
    double exchanged = 0;
    while (x.t < 0.1 - 1e-9) {
      integrator.advance(x, x.t + h, [](const State&) {});
      exchanged = std::max(exchanged, std::abs(model.energies(x).potential));
    }
    *drift = std::abs(model.energies(x).total() - energy) / exchanged;
    return x.q[x.q.size() - 1];
  };
  double drift = 0;
  const std::vector<double> h = {1e-3, 5e-4, 2.5e-4, 1.25e-4};
  std::vector<double> p;
  for (const double each : h) p.push_back(run(each, &drift));
  std::printf("line at %.6f m, drift of energy %.1e\n", p.back(), drift);
  EXPECT_LT(drift, 1e-7);
  // A rigid body would slide by ½ g_x t²; the effect of bending is of the order of the squared
  // slope.
  EXPECT_NEAR((at - p.back()) / (0.5 * 1.0 * 0.1 * 0.1), 1, 0.03);
  const double order = std::log2(std::abs((p[2] - p[1]) / (p[3] - p[2])));
  EXPECT_NEAR(order, 2, 0.3);
}

/// A strip that its weight pulls out of a sleeve (or that is pushed back into it), while it sags.
struct Pulled {
  double line = 0;          // position of the free line at the end [m]
  Vec3 tip = Vec3::Zero();  // [m]
  // largest change of energies, momentum (relative) and tip by an insertion
  double jump = 0;
  std::vector<MeshEvent> events;
};
Pulled pulled(int n, double max_length, double speed, double along) {
  Strip strip;
  strip.length = 0.3;
  strip.n = n;
  strip.section.youngs_modulus = 1e9;
  Workspace model = strip.model(make_gravity(strip.section, vector(along, 0, -4)), true);
  const std::vector<MovingRoot> moving_roots = {
      {"strip", at_rest({0, 0}), max_length, max_length < 1 ? 0.3 * max_length : 0, 0, speed}};
  MotionSettings settings;
  settings.end = 0.2;
  settings.start = Start::rigid;
  Pulled out;
  const MotionResult r = integrate(model, moving_roots, settings, [](const MotionStep&) {});
  out.line = r.final.q[r.final.q.size() - 1];
  out.tip = point_position(model.bodies()[0], r.final, {strip.length, 0});
  out.events = r.events;
  for (const MeshEvent& e : r.events)
    out.jump = std::max({out.jump, std::abs(e.after.kinetic / e.before.kinetic - 1),
                         std::abs(e.after.strain / e.before.strain - 1),
                         (e.momentum_after - e.momentum_before).norm() / e.momentum_before.norm(),
                         e.tip_jump});
  std::printf("%2d elements, limit %.3f m: line at %.6f m, tip (%.6f, %.6f) m, %zu events, %.1e\n",
              n, max_length, out.line, out.tip.x(), out.tip.z(), out.events.size(), out.jump);
  return out;
}

// Lines of nodes are inserted where the material comes out, at the end of the step that passes the
// limit.
TEST(FreeRootLine, GetsNewLinesWhereTheStripIsPulledOut) {
  const Pulled grown = pulled(5, 0.12, 0, 9.81), finer = pulled(10, 0.06, 0, 9.81),
               without = pulled(10, 1, 0, 9.81);
  EXPECT_GE(grown.events.size(), 2u);
  EXPECT_TRUE(without.events.empty());
  for (const MeshEvent& e : grown.events) EXPECT_EQ(e.change, MeshChange::insertion);
  // Forces are balanced after an insertion; the tolerance is the difference in stiffness to the
  // finer mesh.
  EXPECT_LT(grown.jump, 1e-3);
  EXPECT_LT((grown.tip - without.tip).norm(), 0.002 * std::abs(without.tip.z()));
  EXPECT_LT((finer.tip - without.tip).norm(), 0.002 * std::abs(without.tip.z()));
  EXPECT_NEAR(grown.line / without.line, 1, 1e-4);
  // Material enters with its speed, so that all of it falls freely except for the sag.
  EXPECT_NEAR(grown.line / (-0.5 * 9.81 * 0.2 * 0.2), 1, 0.03);
}

TEST(FreeRootLine, LosesLinesWhereTheStripGoesIn) {
  const Pulled merged = pulled(5, 0.12, 0.5, 0), finer = pulled(20, 0.03, 0.5, 0);
  EXPECT_GE(merged.events.size(), 1u);
  for (const MeshEvent& e : merged.events) EXPECT_EQ(e.change, MeshChange::removal);
  EXPECT_LT((finer.tip - merged.tip).norm(), 0.02 * std::abs(finer.tip.z()));
  EXPECT_NEAR(merged.line / finer.line, 1, 1e-4);
}

}  // namespace
}  // namespace flexmorph::fem
