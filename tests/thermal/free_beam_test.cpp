// Shows T 11.1, the heated free beam: it ends as in the closed form without stress, and with the
// thermal force also during the rise; kinetic energy and order agree with the closed form. Shows
// for the rotating beam that there is no thermal strain at any angle (unlike T (26)), that momenta
// are kept to round-off, and that the angular velocity falls as the moment of inertia grows.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <iostream>

#include "fem/dynamics/integrators/generalized_alpha.h"
#include "fem/terms.h"
#include "tests/support/errors.h"
#include "tests/support/rates.h"
#include "tests/thermal/hot_models.h"

namespace flexmorph::fem {
namespace {

using testing::HotBeam;
using testing::largest_strain;
using testing::rows_of_body;

constexpr double kStretch = 0.02;  // α ΔT for 200 K

/// Integrates from rest, or from a rotation about the centre; calls `see` after every step.
State run(const HotBeam& beam, double end, double h, const std::function<void(const State&)>& see,
          double spin = 0, const IntegratorSettings& integrator = {},
          StepCounts* counts = nullptr) {
  Workspace model = beam.model();
  model.prepare(0.0);
  State x = model.reference();
  const MatrixXd Y = thermal_matrices(*model.bodies()[0].element, 1).from_centre();
  MatrixXd turning(Y.rows(), 2);
  turning << -spin * Y.col(1), spin * Y.col(0);
  x.v = testing::flat(turning);
  const auto run = make_integrator(model, integrator);
  run->make_consistent(x);
  see(x);
  const int n = static_cast<int>(std::lround(end / h));
  const std::vector<double> bends = discontinuities(beam.rise);
  for (int k = 1; k <= n; ++k) {
    const double t = end * k / n;
    const auto bend = std::find_if(bends.begin(), bends.end(),
                                   [&](double each) { return std::abs(each - t) < 1e-9; });
    run->advance(x, bend == bends.end() ? t : t * (1 - 1e-14), see);
    if (bend == bends.end()) continue;
    x.t = *bend;
    run->cross_discontinuity(x);
  }
  if (counts) *counts = run->counts();
  return x;
}

class Profiles : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Smooth, Profiles, ::testing::Values("quartic", "cosine", "quintic"));

// T 11.1 gives 0.01 m at each end and stretches of 1.02. Without the thermal force the remaining
// strain vibrates at the end of the run: some 1e-6, which is 1e-8 m.
TEST_P(Profiles, BeamGrowsAsTheClosedForm) {
  for (const bool force : {true, false}) {
    HotBeam beam;
    beam.rise.profile = profile_of(GetParam());
    beam.thermal_force = force;
    Workspace model = beam.model();
    double strain = 0;
    StepCounts counts;
    const State x = run(
        beam, 1, GetParam() == "cosine" ? 2.5e-4 : 1e-3,
        [&](const State& at) {
          strain = std::max(strain, largest_strain(model, at.q, beam.heat().stretch(at.t).value));
        },
        0, {}, &counts);
    const MatrixXd q = rows_of_body(model, x.q);
    const double tolerance = force ? 1e-8 : 1e-5;
    EXPECT_NEAR(q(0, 0), -0.01, tolerance);
    EXPECT_NEAR(q(3, 0), 1.01, tolerance);
    for (const int k : {1, 4}) EXPECT_NEAR(q.row(k).norm(), 1 + kStretch, tolerance);
    for (const int k : {2, 5}) EXPECT_NEAR(q.row(k).norm(), 1 + kStretch, tolerance);
    std::cout << "  " << GetParam() << (force ? ", with" : ", without")
              << " thermal force: largest elastic strain " << strain << ", end at "
              << q(3, 0) - 1.01 << " of 1.01, " << counts.newton << " iterations in "
              << counts.steps << " steps\n";
    if (force)
      EXPECT_LE(strain, 1e-8);
    else
      EXPECT_GT(strain, 2e-7);
  }
}

// The expected value is calculated by hand: T = ½ ė_Θᵀ M ė_Θ = ½ (m l²/12 + m h²/12) (α Ṫ)² = 3.03
// kg m² (α Ṫ)², m = 72 kg.
TEST_P(Profiles, KineticEnergyIsThatOfTheThermalMotion) {
  HotBeam beam;
  beam.rise.profile = profile_of(GetParam());
  EXPECT_NEAR(beam.mass(), 72, 1e-12);
  const double inertia = 0.5 * (72 * 1.0 / 12 + 72 * 0.01 / 12);
  EXPECT_NEAR(inertia, 3.03, 1e-12);
  Workspace model = beam.model();
  double largest = 0, error = 0;
  run(beam, 0.6, 1e-3, [&](const State& x) {
    model.prepare(x.t);
    const double T = model.energies(x).kinetic;
    largest = std::max(largest, T);
    error = std::max(error, std::abs(T - inertia * std::pow(beam.heat().stretch(x.t).rate, 2)));
  });
  std::cout << "  " << GetParam() << ": largest kinetic energy " << largest << " J\n";
  EXPECT_LT(error, 2e-3 * largest);
  // The largest rates of the profiles are 16/9, π/2, 15/8 times rise/settle.
  const double peak = GetParam() == "quartic"  ? 16. / 9
                      : GetParam() == "cosine" ? M_PI / 2
                                               : 15. / 8;
  EXPECT_NEAR(largest, inertia * std::pow(peak * kStretch / 0.5, 2), 2e-3 * largest);
}

// A beam is so soft that the steps resolve its motion; its closed form is e_o + e_Θ(t). In the
// stiff beam of the paper the positions follow the temperature, and the velocity is compared.
TEST_P(Profiles, ErrorsAreOfSecondOrder) {
  for (const bool soft : {true, false}) {
    HotBeam beam;
    if (soft) beam.section.youngs_modulus = 7e3;
    IntegratorSettings settings;
    settings.alpha.rho_inf = 0.5;  // damps vibrations
    beam.rise.profile = profile_of(GetParam());
    const auto rate = testing::fit_rate({0.01, 0.005, 0.0025, 0.00125}, [&](double h) {
      const State x = run(
          beam, 0.4, h, [](const State&) {}, 0, settings);
      const Motion s = beam.heat().stretch(0.4);
      return soft ? std::abs(x.q[6] - (0.5 + 0.5 * s.value)) : std::abs(x.v[6] - 0.5 * s.rate);
    });
    EXPECT_NEAR(rate.order(), 2, 0.15) << rate.table();
    std::cout << "  " << GetParam() << (soft ? ", soft: " : ", stiff: ") << rate.order() << '\n'
              << rate.table();
  }
}

/// Returns the elastic strain as printed in T (26), from u_s = r - X - u_Θ with u_Θ in directions
/// of the reference.
double printed_strain(const Element& element, const MatrixXd& q, double a) {
  const MatrixXd all = q - element.reference() - a * thermal_matrices(element, 1).from_centre(),
                 e_s = testing::rows_of_element(element, all, 0);
  ShapeTable t;
  element.tabulate(0, 4, Tabulate::gradient, {}, ScaleFactorKind::none, t);
  const Vec2 J_1 = Vec2(1, 0) + (t.N_m.row(0) * e_s).transpose();
  return 0.5 * (J_1.squaredNorm() - 1);
}

TEST(TurningBeam, IsNotStrainedByItsHeat) {
  HotBeam beam;
  beam.n = 2;
  Workspace model = beam.model();
  model.prepare(1.0);
  const Element& element = *model.bodies()[0].element;
  const MatrixXd hot = element.reference() + kStretch * thermal_matrices(element, 1).from_centre();
  State x = model.reference();
  x.t = 1;
  const double held = model.energies(x).strain;  // if it were held at its cold size
  for (double angle = 0; angle < 6.3; angle += 0.3) {
    const MatrixXd turned = hot * Eigen::Rotation2Dd(angle).toRotationMatrix().transpose();
    x.q = testing::flat(turned);
    EXPECT_LT(largest_strain(model, x.q, 1 + kStretch), 1e-15);
    EXPECT_LT(model.energies(x).strain, 1e-25 * held);
    EXPECT_NEAR(printed_strain(element, turned, kStretch),
                kStretch * (1 + kStretch) * (1 - std::cos(angle)), 1e-14);
  }
}

TEST(ThermalForce, TurnsWithTheBodyAndHasNoMoment) {
  HotBeam beam;
  beam.n = 3;
  Workspace model = beam.model();
  model.prepare(0.1);
  const Element& element = *model.bodies()[0].element;
  const auto& link = dynamic_cast<const ThermalForce&>(*model.force_elements()[0]);
  const MatrixXd X = element.reference(), B = thermal_matrices(element, 720).M *
                                              thermal_matrices(element, 720).from_centre();
  const double a = beam.heat().stretch(0.1).acceleration;
  std::srand(4);
  for (const double angle : {0.0, 0.8, -2.5}) {
    // The beam is rotated, moved far away and deformed.
    MatrixXd q = X + 0.05 * MatrixXd::Random(X.rows(), 2);
    q = q * Eigen::Rotation2Dd(angle).toRotationMatrix().transpose();
    for (int k = 0; k < q.rows(); k += 3) q.row(k) += Eigen::RowVector2d(30, -70);
    State x = model.reference();
    x.t = 0.1;
    x.q = testing::flat(q);
    VectorXd out = VectorXd::Zero(x.q.size());
    link.add_force(x, out);
    const MatrixXd Q = -rows_of_body(model, out);
    const double theta = link.rotation(x.q);
    EXPECT_NEAR(theta, angle, 0.05);
    const MatrixXd should = a * B * Eigen::Rotation2Dd(theta).toRotationMatrix().transpose();
    EXPECT_LT((Q - should).norm(), 1e-12 * should.norm());
    // There is no resultant, and no moment about any point; in directions of the reference there
    // would be a moment.
    const auto moment = [&](const MatrixXd& f) {
      double sum = 0;
      for (int k = 0; k < q.rows(); ++k) sum += q(k, 0) * f(k, 1) - q(k, 1) * f(k, 0);
      return sum;
    };
    double resultant = 0;
    for (int k = 0; k < q.rows(); k += 3) resultant += Q.row(k).sum();
    EXPECT_NEAR(resultant, 0, 1e-12 * Q.norm());
    EXPECT_NEAR(moment(Q), 0, 1e-12 * 76 * Q.norm());
    if (angle != 0) {
      EXPECT_GT(std::abs(moment(a * B)), 0.3 * 6 * std::abs(a));
    }
    // The power is that of the force.
    x.v = VectorXd::Random(x.q.size());
    EXPECT_NEAR(link.power(x), -out.dot(x.v), 1e-12 * out.norm() * x.v.norm());
  }
}

// The beam is heated while it rotates. The energy-momentum scheme conserves the momenta to
// round-off of the steps; generalized-alpha conserves them to second order only.
TEST(TurningBeam, KeepsItsAngularMomentumWhileItIsHeated) {
  for (const bool force : {true, false})
    for (const std::string integrator : {"energy_momentum", "generalized_alpha"}) {
      HotBeam beam;
      beam.n = 2;
      beam.thermal_force = force;
      Workspace model = beam.model();
      const double omega = 2 * M_PI;
      double first = 0, drift = 0;
      StepCounts counts;
      const State x = run(
          beam, 0.8, 2e-3,
          [&](const State& at) {
            const double L = testing::angular_momentum(model, at);
            if (at.t == 0) first = L;
            drift = std::max(drift, std::abs(L / first - 1));
          },
          omega, {integrator, {}, {}, {}}, &counts);
      EXPECT_NEAR(first, 6.06 * omega, 1e-10);
      if (integrator == "energy_momentum")
        EXPECT_LT(drift, 1e-10);
      else
        EXPECT_LT(drift, 1e-3);
      std::cout << "  " << integrator << (force ? ", with" : ", without")
                << " thermal force: drift of the angular momentum " << drift << ", "
                << counts.newton << " iterations, " << counts.factorizations << " factors in "
                << counts.steps << " steps\n";
      // J grows as s²; the centrifugal strain is ρ ω² l²/(8 E) = 5e-5, and it vibrates.
      const MatrixXd q = rows_of_body(model, x.q), v = rows_of_body(model, x.v);
      const Eigen::RowVector2d r = q.row(6) - q.row(0), r_t = v.row(6) - v.row(0);
      const double spin = (r[0] * r_t[1] - r[1] * r_t[0]) / r.squaredNorm();
      EXPECT_NEAR(spin * std::pow(1 + kStretch, 2) / omega, 1, 2e-3);
      EXPECT_NEAR(r.norm(), 1 + kStretch, 5e-4);
    }
}

TEST(ThermalForce, RefusesWhatItDoesNotKnow) {
  using Kind = Error::Kind;
  const Heat heat = testing::constant_heat(0.01);
  EXPECT_TRUE(testing::mentions(testing::error_of(Kind::input,
                                                  [] {
                                                    ThermalForce("q", "b", Heat{1, {}}, 1);
                                                  }),
                                "temperature"));
  EXPECT_TRUE(testing::mentions(
      testing::error_of(Kind::input, [&] { ThermalForce("q", "b", heat, 0); }), "mass"));
  const auto added = [&](std::unique_ptr<Element> element) {
    return testing::error_of(Kind::input, [&] {
      Workspace model;
      model.add_body("arm", std::move(element), {}, {});
      model.add_force_element(std::make_unique<ThermalForce>("q", "arm", heat, 1));
    });
  };
  const std::string in_space = added(std::make_unique<AncfPlate>(
      3, testing::ShapeSet::h16, testing::uniform_lines(0, 1, 1), testing::uniform_lines(0, 1, 1)));
  for (const char* part : {"'q'", "plane", "'arm'", "three-dimensional"})
    EXPECT_TRUE(testing::mentions(in_space, part)) << in_space;
  const std::string moving =
      added(std::make_unique<AncfPlate>(testing::swinging_plate(testing::ShapeSet::h16)));
  EXPECT_TRUE(testing::mentions(moving, "material lines") && testing::mentions(moving, "move"))
      << moving;
}

// The force must use the mass of the body: with scale factors and the model's mass matrix, it
// accelerates the free plate exactly as its material points move in the expanding body about the
// centre of mass.
TEST(ThermalForce, FollowsTheDesignOfThePlate) {
  const PlaneSection section{0.01, 1e6, 0.3, 2700};
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(section));
  terms.push_back(make_membrane(section));
  Workspace model;
  Body& body = model.add_body(
      "plate",
      std::make_unique<AncfPlate>(2, testing::ShapeSet::h16, testing::uniform_lines(0.05, 0.4, 2),
                                  testing::uniform_lines(-0.04, 0.06, 1)),
      section, std::move(terms));
  const Heat hot = testing::heat_of([](double t) { return Motion{0.5 * t * t, t, 1}; });
  heat(body, hot);
  model.add_force_element(std::make_unique<ThermalForce>("thermal force", "plate", hot, 27));
  model.set_factors(body, testing::random_factors(3));
  model.prepare(0.0);
  State x = model.reference();
  x.v = x.a = VectorXd::Zero(model.n_dofs());

  Constraints none;
  model.constraints(x, none);
  SparseMatrix mass;
  model.kkt(x, none, {0, 0, 1}, 1, mass);
  VectorXd force;
  model.force(x, force);
  const VectorXd acceleration = MatrixXd(mass).ldlt().solve(-force);
  // The centre of mass follows from the mass matrix and a unit translation.
  VectorXd along = VectorXd::Zero(model.n_dofs());
  for (int k = 0; k < body.element->n_vectors(); ++k)
    if (body.element->is_position(k)) along[2 * k] = 1;
  const VectorXd moved = mass * along;
  double centre = moved.dot(x.q) / moved.dot(along);
  for (int k = 0; k < body.element->n_vectors(); ++k) {
    const double about = body.element->is_position(k) ? centre : 0;
    EXPECT_NEAR(acceleration[2 * k], hot.expansion * (x.q[2 * k] - about), 1e-10 * hot.expansion);
  }
}

}  // namespace
}  // namespace flexmorph::fem
