// Shows that the energy balance holds with heat: for any motion, a solution or not, the energy of a
// hot body changes by the work of the forces, of driven lines and of the temperature; for supported
// heated bodies the energy error of a run is of second order; and at a constant temperature the
// energy-momentum scheme conserves the energy of a hot beam to round-off.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "fem/dynamics/balance.h"
#include "fem/dynamics/integrators/integrator.h"
#include "fem/terms.h"
#include "tests/support/energy_rate.h"
#include "tests/support/rates.h"
#include "tests/thermal/hot_models.h"

namespace flexmorph::fem {
namespace {

using testing::HotBeam;
using testing::ShapeSet;
using testing::swinging_line;

const PlaneSection kSofterSection{0.01, 1e6, 0.3, 2700};

/// Returns a plate with lines at 0.1, 0.21, 0.3 m: d driven, f free, | fixed.
Workspace plate_of(const std::string& kinds) {
  const double at[] = {0.1, 0.21, 0.3};
  std::vector<MaterialLine> lines;
  for (size_t i = 0; i < kinds.size(); ++i)
    lines.push_back(kinds[i] == 'd' ? swinging_line(at[i], 0.02, 1.3 + 0.4 * static_cast<double>(i))
                                    : MaterialLine{at[i], {}, kinds[i] == 'f'});
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(kSofterSection));
  terms.push_back(make_membrane(kSofterSection));
  terms.push_back(make_bending(kSofterSection, 15));  // negligible quadrature error
  Workspace model;
  Body& body = model.add_body(
      "plate",
      std::make_unique<AncfPlate>(3, ShapeSet::h16, lines, testing::uniform_lines(-0.05, 0.07, 1)),
      kSofterSection, std::move(terms));
  heat(body, testing::moving_heat());
  return model;
}

class AnyMotion : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Lines, AnyMotion, ::testing::Values("|||", "d||", "dd|", "f||", "df|"));

TEST_P(AnyMotion, ChangesTheEnergyByThePowers) {
  Workspace model = plate_of(GetParam());
  const testing::SmoothMotion motion = testing::any_motion(model);
  for (const double time : {0.3, 0.9}) {
    const auto [rate, work, p] = testing::energy_rate(model, motion, time);
    EXPECT_NEAR(work + p.total(), rate,
                1e-8 * (std::abs(work) + std::abs(p.feed) + std::abs(p.heat)));
    EXPECT_GT(std::abs(p.heat), 1e-3 * std::abs(rate));
  }
}

/// Returns the largest energy error relative to the largest energy of a run from rest.
double energy_error(Workspace& model, double end, double h) {
  model.prepare(0.0);
  State x = model.reference();
  const auto alpha = make_integrator(model, {});
  alpha->make_consistent(x);
  EnergyBalance balance;
  balance.begin(0, model.energies(x), powers(model, x));
  const int n = static_cast<int>(std::lround(end / h));
  double heat = 0;
  for (int k = 1; k <= n; ++k)
    alpha->advance(x, end * k / n, [&](const State& at) {
      const Powers p = powers(model, at);
      heat = std::max(heat, std::abs(p.heat));
      balance.add(at.t, model.energies(at), p);
    });
  EXPECT_GT(heat, 0);
  return std::abs(balance.energy_error()) / model.energies(x).total();
}

// The beam is softer than that of Shabana et al. (2023), so that the steps resolve its motion, and
// its root is fully clamped, so that it is strained.
TEST(HeldBeam, BalanceHasADefectOfSecondOrder) {
  for (const bool force : {true, false}) {
    const auto rate = testing::fit_rate({8e-3, 4e-3, 2e-3, 1e-3}, [&](double h) {
      HotBeam beam;
      beam.n = 2;
      beam.thermal_force = force;
      beam.section.youngs_modulus = 2e4;
      beam.rise = {Profile::quartic, 2000, 0, 0.5};
      Workspace model = beam.model();
      const HoldLocation root = HoldLocation::at({0, 0});
      model.add_joint(make_hold("clamp", "beam",
                                {{root, NodeVector::r, {0, 1}},
                                 {root, NodeVector::r_m, {0, 1}},
                                 {root, NodeVector::r_n, {0, 1}}}));
      return energy_error(model, 0.4, h);
    });
    EXPECT_NEAR(rate.order(), 2, 0.2) << rate.table();
    std::cout << rate.table();
  }
}

TEST(HeldPlate, BalanceHasADefectOfSecondOrder) {
  const auto rate = testing::fit_rate({8e-3, 4e-3, 2e-3, 1e-3}, [&](double h) {
    const PlaneSection section{0.01, 1e4, 0.3, 2700};
    std::vector<std::unique_ptr<Term>> terms;
    terms.push_back(make_inertia(section));
    terms.push_back(make_membrane(section));
    Workspace model;
    Body& body = model.add_body(
        "plate",
        std::make_unique<AncfPlate>(2, ShapeSet::h16, testing::uniform_lines(0, 0.4, 2),
                                    testing::uniform_lines(-0.1, 0.2, 1)),
        section, std::move(terms));
    const Heat hot{1e-4, make_temperature({Profile::quartic, 1000, 0, 0.5}), ThermalVolume::grown};
    heat(body, hot);
    model.add_force_element(std::make_unique<ThermalForce>("thermal force", "plate", hot, 27));
    model.add_joint(
        make_hold("clamp", "plate",
                  {{{"root"}, NodeVector::r, {0, 1}}, {{"root"}, NodeVector::r_n, {0, 1}}}));
    return energy_error(model, 0.4, h);
  });
  EXPECT_NEAR(rate.order(), 2, 0.2) << rate.table();
  std::cout << rate.table();
}

// A hot beam vibrates when it is released from its cold size; the temperature does no work.
TEST(HotBeam, KeepsItsEnergyAtConstantTemperature) {
  for (const char* term : {"gcm", "ecm"}) {
    HotBeam beam;
    beam.n = 2;
    beam.term = term;
    beam.rise = {Profile::step, 500, 0, 0};
    Workspace model = beam.model();
    model.prepare(0.0);
    State x = model.reference();
    const auto scheme = make_integrator(model, {"energy_momentum", {}, {}, {}});
    scheme->make_consistent(x);
    const double first = model.energies(x).total();
    double drift = 0, kinetic = 0;
    for (int k = 1; k <= 200; ++k)
      scheme->advance(x, 2e-4 * k, [&](const State& at) {
        const Energies e = model.energies(at);
        drift = std::max(drift, std::abs(e.total() / first - 1));
        kinetic = std::max(kinetic, e.kinetic);
      });
    EXPECT_LT(drift, 1e-10) << term;
    EXPECT_GT(kinetic, 0.3 * first);
    std::cout << "  " << term << ": drift of the energy " << drift << '\n';
  }
}

}  // namespace
}  // namespace flexmorph::fem
