// Shows that large static deflections of the beam's elastic terms agree with the shooting method
// for other kinematics: the beam of T Fig. 15 on a roller; gcm locks by Poisson's effect and ecm
// does not; a stretched bar at partial and full clamps; welds equal held nodes.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "fem/body_joints.h"
#include "fem/elements/ancf_beam.h"
#include "fem/loads.h"
#include "fem/solve/statics.h"
#include "fem/terms.h"
#include "tests/support/rates.h"
#include "tests/support/reissner_statics.h"
#include "tests/support/sections.h"

namespace flexmorph::fem {
namespace {

// T Fig. 15: the beam is 1 x 0.05 x 0.05 m.
constexpr double kLength = 1, kHeight = 0.05;
const reference::BeamSection kReference{kHeight, 0.05, 2e8, 0.3};

VectorXd vector(double x, double y) {
  VectorXd out(2);
  out << x, y;
  return out;
}

Workspace beam_model(const std::string& term, int n, const Vec2& at, const VectorXd& force) {
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_term(term, kBeamSection));
  terms.push_back(make_point_force(at, force));
  Workspace model;
  model.add_body("beam", std::make_unique<AncfBeam>(kLength, kHeight, n), kBeamSection,
                 std::move(terms));
  return model;
}

Vec2 position(const Workspace& model, const State& x, const Vec2& material) {
  return model.location_motion({"beam", material}, x).position;
}

/// Returns the deflection of the middle of a beam on a pin and a roller.
double on_roller(const std::string& term, int n, double force) {
  Workspace model = beam_model(term, n, {kLength / 2, 0}, vector(0, -force));
  model.add_joint(make_hold("supports", "beam",
                            {{HoldLocation::at({0, 0}), NodeVector::r, {0, 1}, {}},
                             {HoldLocation::at({kLength, 0}), NodeVector::r, {1}, {}}}));
  State x = model.reference();
  solve_static(model, x);
  return -position(model, x, {kLength / 2, 0}).y();
}

testing::Rate against(const std::string& term, const std::vector<double>& sizes, double force,
                      double exact) {
  return testing::fit_rate(sizes, [&](double size) {
    const int n = static_cast<int>(std::lround(kLength / size));
    return std::abs(on_roller(term, n, force) / exact - 1);
  });
}

class Roller : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Forces, Roller, ::testing::Values(3000.0, 6000.0), [](const auto& f) {
  return "force_" + std::to_string(static_cast<int>(f.param));
});

// Deflections are a third of the length, strains 0.13 and 0.2 at the faces. The material is St.
// Venant-Kirchhoff: for such sections the shooting method and a fine mesh agree to the error of the
// mesh; the linear sections of Reissner differ by 0.2 %.
TEST_P(Roller, EnhancedModelMeetsShooting) {
  const double force = GetParam();
  const double linear =
      reference::roller_deflection(reference::linear_law(kReference), kLength, force);
  const double kirchhoff =
      reference::roller_deflection(reference::kirchhoff_law(kReference), kLength, force);
  const double ecm = on_roller("ecm_full", 32, force), fine = on_roller("ecm_full", 128, force);
  std::cout << "  Reissner " << linear << " m, SVK sections " << kirchhoff << " m, ecm_full " << ecm
            << " m, on 128 elements " << fine << " m, gcm " << on_roller("gcm", 32, force)
            << " m\n";
  EXPECT_NEAR(ecm, linear, 3e-3 * linear);
  EXPECT_NEAR(fine, kirchhoff, 1e-4 * kirchhoff);
}

// Strains from the interpolation and assumed strains converge to one displacement, which is
// extrapolated from 128 and 256 elements with the order of convergence. It is larger by 4e-5 and
// 1.1e-4 (relative) than that of a model of cross-sections, which has no energy of the derivative
// of the stretch λ of the height. With assumed
// strains coarse meshes are closer to the limit.
TEST_P(Roller, AssumedStrainsHaveTheSameLimitAndComeCloser) {
  const double force = GetParam();
  const double kirchhoff =
      reference::roller_deflection(reference::kirchhoff_law(kReference), kLength, force);
  const auto limit = [&](const std::string& term) {
    return (4 * on_roller(term, 256, force) - on_roller(term, 128, force)) / 3;
  };
  const double assumed = limit("ecm"), full = limit("ecm_full");
  std::cout << "  limits over the sections: assumed " << assumed / kirchhoff - 1 << ", full "
            << full / kirchhoff - 1 << '\n';
  EXPECT_NEAR(assumed, full, 1e-5 * full);
  for (const int n : {8, 16, 32})
    EXPECT_LT(std::abs(on_roller("ecm", n, force) - assumed),
              std::abs(on_roller("ecm_full", n, force) - full));
}

// A fully parameterized element with linear r_y has mild shear locking: the order is 2.
TEST_P(Roller, ConvergesWithOrderTwo) {
  const double exact =
      reference::roller_deflection(reference::kirchhoff_law(kReference), kLength, GetParam());
  const testing::Rate rate = against("ecm", {1.0 / 16, 1.0 / 32, 1.0 / 64}, GetParam(), exact);
  std::cout << rate.table();
  EXPECT_NEAR(rate.order(), 2, 0.35) << rate.table();
}

// For a small load w = F L³/(48 E I) + F L/(4 G A). The bending stiffness of gcm is too large by
// 1/(1 - ν²) on every mesh, which gives 9 % less deflection.
TEST(Roller, GeneralModelLocksByPoissonsEffect) {
  const double area = kHeight * 0.05, inertia = area * kHeight * kHeight / 12, force = 1,
               bending = force / (48 * 2e8 * inertia), shear = force / (4 * 2e8 / 2.6 * area);
  const testing::Rate ecm = against("ecm", {1.0 / 8, 1.0 / 16, 1.0 / 32}, force, bending + shear);
  const testing::Rate gcm =
      against("gcm", {1.0 / 8, 1.0 / 16, 1.0 / 32}, force, 0.91 * bending + shear);
  std::cout << ecm.table() << gcm.table();
  for (const testing::Rate& r : {ecm, gcm}) {
    EXPECT_NEAR(r.order(), 2, 0.05) << r.table();
    EXPECT_LT(r.error.back(), 1.2e-3) << r.table();
  }
  const double ratio = on_roller("gcm", 32, force) / on_roller("ecm", 32, force);
  std::cout << "gcm/ecm " << ratio << "\n";
  EXPECT_NEAR(ratio, 0.91, 2e-3);
}

FrameMotion still(double) { return {}; }

// A bar is pulled by F at its end. With free contraction (partial clamp) it is in uniform uniaxial
// stress: S₁₁ = E ε₁₁, ε₂₂ = -ν ε₁₁, F = A λ₁ S₁₁, to round-off. The full clamp keeps its height;
// in the middle of the bar, 50 boundary layers of h √(G/(12 E)) away, this has no effect.
TEST(Clamps, PartialLetsContractAndFullDoesNot) {
  const double area = kHeight * 0.05, strain = 0.06, l1 = std::sqrt(1 + 2 * strain),
               l2 = std::sqrt(1 - 2 * 0.3 * strain), force = area * l1 * 2e8 * strain;
  for (const char* term : {"gcm", "ecm"})
    for (const WeldMode mode :
         {WeldMode::partial, WeldMode::edge, WeldMode::direction, WeldMode::full}) {
      Workspace model = beam_model(term, 40, {kLength, 0}, vector(force, 0));
      model.add_joint(make_weld("clamp", "beam", "root", still, mode));
      State x = model.reference();
      solve_static(model, x);
      const Vec2 tip = position(model, x, {kLength, 0});
      const Vec2 root = x.q.segment<2>(4), middle = x.q.segment<2>(2 * (3 * 20 + 2));
      EXPECT_NEAR(middle.y(), l2, 1e-7);
      EXPECT_NEAR(model.joint_wrench(0, "beam", Vec3::Zero(), x).force.x(), -force, 1e-10 * force);
      EXPECT_NEAR(tip.y(), 0, 1e-12);
      if (mode == WeldMode::partial) {
        EXPECT_NEAR(tip.x(), l1 * kLength, 1e-11);
        EXPECT_NEAR(root.y(), l2, 1e-11);
        EXPECT_NEAR(model.smallest_area_ratio(x), l1 * l2, 1e-10);
      } else {
        EXPECT_NEAR(root.y(), 1, 1e-13);
        EXPECT_LT(tip.x(), l1 * kLength - 1e-5);
        EXPECT_GT(tip.x(), l1 * kLength - 0.1 * kHeight);
      }
    }
}

// A cantilever must have equal deflections with held nodes, a driven weld and a weld to the ground.
TEST(Clamps, WeldsAreTheHoldsTheySay) {
  const auto tip = [](const std::function<std::unique_ptr<Joint>()>& joint) {
    Workspace model = beam_model("ecm", 8, {kLength, 0}, vector(20, -60));
    model.add_joint(joint());
    State x = model.reference();
    solve_static(model, x);
    return position(model, x, {kLength, 0});
  };
  const auto hold = [](std::vector<int> r_m, std::vector<int> r_n) {
    std::vector<Held> held = {{{.edge = "root"}, NodeVector::r, {0, 1}, {}}};
    if (!r_m.empty()) held.push_back({{.edge = "root"}, NodeVector::r_m, r_m, {}});
    if (!r_n.empty()) held.push_back({{.edge = "root"}, NodeVector::r_n, r_n, {}});
    return make_hold("hold", "beam", held);
  };
  for (const WeldMode mode :
       {WeldMode::partial, WeldMode::edge, WeldMode::direction, WeldMode::full}) {
    const Vec2 expected = tip([&] {
      if (mode == WeldMode::partial) return hold({}, {0});
      if (mode == WeldMode::direction) return hold({1}, {0, 1});
      return mode == WeldMode::edge ? hold({}, {0, 1}) : hold({0, 1}, {0, 1});
    });
    EXPECT_LT(expected.y(), -0.15);
    const Vec2 driven = tip([&] { return make_weld("weld", "beam", "root", still, mode); });
    const Vec2 ground = tip([&] { return make_edge_weld("weld", "beam", "root", {}, mode); });
    EXPECT_LT((driven - expected).norm(), 1e-10);
    EXPECT_LT((ground - expected).norm(), 1e-10);
  }
}

}  // namespace
}  // namespace flexmorph::fem
