// Shows that the reference beam is a valid reference: its statics, frequencies, kinematics,
// balances and limits agree with closed forms and published numbers, its motion agrees with a chain
// of small elements in the inertial frame that has no Coriolis, centrifugal or convective term, and
// its own discretization error is small.
#include "tests/support/reissner_beam.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>
#include <vector>

#include "tests/support/dense.h"
#include "tests/support/inertial_chain.h"

namespace flexmorph::reference {
namespace {

using Eigen::Matrix4d;

VectorXd zero(const ReissnerModel& model) { return VectorXd::Zero(model.size()); }

/// Returns the equilibrium in the frame of the hub (all rates zero at fixed sigma) under a tip
/// force along y.
VectorXd equilibrium(const ReissnerModel& model, double t = 0, double force = 0, int ramp = 1) {
  VectorXd q = zero(model);
  MatrixXd mass, damping, stiffness;
  for (int load = 1; load <= ramp; ++load) {
    for (int iteration = 0; iteration < 30; ++iteration) {
      VectorXd r = model.residual(t, q, zero(model), zero(model));
      r(model.beam().modes) -= force * load / ramp;
      model.linearize(t, q, mass, damping, stiffness);
      const VectorXd correction = testing::solve(stiffness, r);
      q -= correction;
      if (correction.norm() < 1e-13) break;
    }
  }
  return q;
}

/// Returns the squared natural frequencies at q without gyroscopic terms, in ascending order.
VectorXd squared_frequencies(const ReissnerModel& model, const VectorXd& q) {
  MatrixXd mass, damping, stiffness;
  model.linearize(0, q, mass, damping, stiffness);
  return testing::modes(stiffness, mass).values;
}

double bisect(double low, double high, const std::function<double(double)>& f) {
  const bool rising = f(high) > f(low);
  for (int i = 0; i < 200; ++i) {
    const double middle = (low + high) / 2;
    ((f(middle) > 0) == rising ? high : low) = middle;
  }
  return (low + high) / 2;
}

// The closed form solves x'' = -(omega / c)^2 x on the rotating bar with EA (x'(L) - 1) = m omega^2
// x(L): x = C sin(beta s).
TEST(ReissnerBeam, CentrifugalStretchIsTheClosedForm) {
  ReissnerBeam beam;
  beam.speed = 0;
  const ReissnerModel model(beam);
  const double length = beam.length, omega2 = beam.omega * beam.omega;
  const double ea = beam.axial_stiffness(), m = beam.tip_mass, rho_a = beam.line_density();
  const double b = std::sqrt(rho_a * omega2 / ea);
  const double c = 1 / (b * std::cos(b * length) - m * omega2 / ea * std::sin(b * length));
  const VectorXd q = equilibrium(model);
  EXPECT_NEAR(q(0), c * std::sin(b * length) - length, 1e-13);
  // The small-strain formula differs by a relative amount of the order of the strain, 2e-4.
  const double linear = omega2 / ea * (rho_a * std::pow(length, 3) / 3 + m * length * length);
  EXPECT_NEAR(q(0) / linear, 1, 4e-4);
  // The tension at the root is rho A omega^2 L^2 / 2 + m omega^2 L.
  const double tension = ea * (model.section(1e-6, 0, q).x() / (1e-6 * length) - 1);
  EXPECT_NEAR(tension / (rho_a * omega2 * length * length / 2 + m * omega2 * length), 1, 1e-3);
}

// The expected numbers are the elliptic-integral solution of the cantilever with a tip force, P L^2
// / EI = 1 and 10: K. Mattiasson (1981), Int. J. Numer. Meth. Eng. 17, 145-153. That beam is
// inextensible; therefore the section is slender.
TEST(ReissnerBeam, TipForceGivesTheElastica) {
  ReissnerBeam beam;
  beam.length = 1;
  beam.speed = beam.omega = 0;
  beam.width = 1e-3;
  beam.modes = 16;
  const ReissnerModel model(beam);
  const int n = beam.modes;
  const VectorXd one = equilibrium(model, 0, beam.bending_stiffness());
  EXPECT_NEAR(one(n), 0.30172, 1e-5);
  EXPECT_NEAR(one(0), -0.05643, 1e-5);
  EXPECT_NEAR(one(2 * n), 0.46135, 1e-5);
  const VectorXd ten = equilibrium(model, 0, 10 * beam.bending_stiffness(), 10);
  EXPECT_NEAR(ten(n), 0.81061, 1e-5);
  EXPECT_NEAR(ten(0), -0.55500, 1e-5);
  EXPECT_NEAR(ten(2 * n), 1.43029, 1e-5);
}

/// Returns the determinant whose roots are the frequencies of a Timoshenko cantilever with a tip
/// mass. A matrix exponential transfers the state (w / L, phi, M L / EI, Q L^2 / EI) from the clamp
/// to the tip.
double tip_determinant(const ReissnerBeam& b, double frequency) {
  const double l2 = b.length * b.length, scale = frequency * frequency * l2 / b.bending_stiffness();
  Matrix4d d = Matrix4d::Zero();
  d(0, 1) = 1;
  d(0, 3) = b.bending_stiffness() / (b.shear_stiffness() * l2);
  d(1, 2) = 1;
  d(2, 1) = -b.rotary_inertia() * scale;
  d(2, 3) = -1;
  d(3, 0) = -b.line_density() * l2 * scale;
  const Matrix4d carried = d.exp();
  const Eigen::RowVector4d shear = carried.row(3) - b.tip_mass * b.length * scale * carried.row(0);
  return carried(2, 2) * shear(3) - carried(2, 3) * shear(2);
}

TEST(ReissnerBeam, FrequenciesAtRestSolveTheFrequencyEquations) {
  ReissnerBeam beam;
  beam.speed = beam.omega = 0;
  beam.modes = 16;
  const ReissnerModel model(beam);
  const VectorXd found = squared_frequencies(model, zero(model)).cwiseSqrt();
  // Axial: z tan z = rho A L / m with z = omega L sqrt(rho / E).
  const double ratio = beam.line_density() * beam.length / beam.tip_mass;
  const double z = bisect(1e-3, 1.57, [=](double x) { return x * std::tan(x) - ratio; });
  const double axial = z / beam.length * std::sqrt(beam.youngs_modulus / beam.density);
  EXPECT_LT(((found.array() - axial).abs() / axial).minCoeff(), 1e-10);
  // The 73 Hz of fem/README.md, Starts, are the Rayleigh quotient of a linear mode, an upper bound.
  const double linear = std::sqrt(beam.axial_stiffness() / beam.length /
                                  (beam.tip_mass + beam.line_density() * beam.length / 3));
  EXPECT_NEAR(linear / (2 * std::numbers::pi), 73, 0.1);
  EXPECT_GT(linear, axial);
  EXPECT_LT(linear, 1.03 * axial);
  // Bending: the first three modes as Rayleigh quotients in 16 polynomials; the error falls like
  // exp(-n).
  int roots = 0;
  for (double f = 1; roots < 3; f += 5) {
    if (tip_determinant(beam, f) * tip_determinant(beam, f + 5) > 0) continue;
    const double root = bisect(f, f + 5, [&](double x) { return tip_determinant(beam, x); });
    EXPECT_LT(((found.array() - root).abs() / root).minCoeff(), 1e-8) << root;
    ++roots;
  }
  // Shear and rotary inertia lower the first frequency by about 2 % against the slender beam (mass
  // factor 33/140 of Rayleigh), which shifts the phase visibly within 1 s of vibration.
  const double slender =
      std::sqrt(3 * beam.bending_stiffness() / std::pow(beam.length, 3) /
                (beam.tip_mass + 33.0 / 140 * beam.line_density() * beam.length));
  EXPECT_NEAR(found(0) / slender, 0.98, 0.02);
}

// Rotating cantilever with omega sqrt(rho A L^4 / EI) = 2: the published frequency is 4.1373 for
// bending out of the plane of rotation (Wright et al. 1982, J. Appl. Mech. 49, 197-202), hence
// sqrt(4.1373^2 - 2^2) in that plane.
TEST(ReissnerBeam, RotationStiffensAsPublished) {
  ReissnerBeam beam;
  beam.length = 1;
  beam.speed = beam.tip_mass = 0;
  beam.width = 2e-3;  // slender: shear and stretch change the frequency by less than 1e-5
  const double unit = std::sqrt(beam.bending_stiffness() / beam.line_density());
  beam.omega = 2 * unit;
  const ReissnerModel model(beam);
  const double lowest = squared_frequencies(model, equilibrium(model))(0);
  EXPECT_NEAR(std::sqrt(lowest) / unit, std::sqrt(4.1373 * 4.1373 - 4), 1e-4);
}

/// A smooth state with all fields in motion.
struct Sample {
  VectorXd q, v, a;
  explicit Sample(int modes) : q(3 * modes), v(3 * modes), a(3 * modes) {
    for (int i = 0; i < 3 * modes; ++i) {
      const double decay = std::pow(0.5, i % modes);
      q(i) = 0.1 * decay * std::sin(1.0 + i);
      v(i) = 2 * decay * std::sin(2.0 + 3 * i);
      a(i) = 30 * decay * std::cos(1.0 + 2 * i);
    }
  }
};

// The expected inertia forces come from difference quotients of the path of each material point,
// which is followed through the moving mesh in the inertial frame.
TEST(ReissnerBeam, InertiaIsTheAccelerationOfMaterialPoints) {
  ReissnerBeam beam;
  beam.speed = 0.5;
  beam.youngs_modulus = 1e-12;  // the elastic forces are negligible
  beam.modes = 5;
  const ReissnerModel model(beam);
  const int n = beam.modes, cells = 200;
  const Sample at(n);
  const double t = 0.3, length = model.length(t);
  const auto path = [&](double s, double tau) {
    const VectorXd q = at.q + tau * at.v + tau * tau / 2 * at.a;
    const Vec3 r = model.section((s + beam.speed * tau) / model.length(t + tau), t + tau, q);
    const double c = std::cos(beam.omega * tau), d = std::sin(beam.omega * tau);
    return Vec3(c * r.x() - d * r.y(), d * r.x() + c * r.y(), r.z() + beam.omega * tau);
  };
  const auto acceleration = [&](double s) -> Vec3 {
    const double h =
        2e-3;  // fourth-order quotient: truncation h^4 f^(6) / 90, round-off 1e-16 / h^2
    return (-path(s, -2 * h) + 16 * path(s, -h) - 30 * path(s, 0) + 16 * path(s, h) -
            path(s, 2 * h)) /
           (12 * h * h);
  };
  VectorXd expected = zero(model);
  const auto add = [&](double sigma, const Vec3& inertia) {
    const Vec3 force = inertia.cwiseProduct(acceleration(sigma * length));
    for (int i = 0; i < 3 * n; ++i) {
      const Vec3 shape =
          model.section(sigma, t, VectorXd::Unit(3 * n, i)) - model.section(sigma, t, zero(model));
      expected(i) += shape.dot(force);
    }
  };
  for (int k = 0; k <= cells; ++k) {  // Simpson's rule
    const double w = (k == 0 || k == cells ? 1 : (k % 2 ? 4 : 2)) * length / (3.0 * cells);
    add(static_cast<double>(k) / cells,
        w * Vec3(beam.line_density(), beam.line_density(), beam.rotary_inertia()));
  }
  add(1, beam.tip_mass * Vec3(1, 1, 0));
  const VectorXd found = model.residual(t, at.q, at.v, at.a);
  for (int i = 0; i < 3; ++i) {
    const VectorXd want = expected.segment(i * n, n), got = found.segment(i * n, n);
    EXPECT_LT((got - want).norm() / want.norm(), 1e-7) << "field " << i;
  }
}

TEST(ReissnerBeam, TangentsAreDifferenceQuotients) {
  ReissnerBeam beam;
  beam.speed = 0.5;
  const ReissnerModel model(beam);
  const Sample at(beam.modes);
  MatrixXd tangent[3], quotient[3];
  model.linearize(0.2, at.q, tangent[0], tangent[1], tangent[2]);
  for (auto& m : quotient) m.resize(model.size(), model.size());
  const double h = 1e-5;
  for (int j = 0; j < model.size(); ++j) {
    const VectorXd d = h * VectorXd::Unit(model.size(), j);
    const auto difference = [&](const VectorXd& dq, const VectorXd& dv,
                                const VectorXd& da) -> VectorXd {
      return (model.residual(0.2, at.q + dq, at.v + dv, at.a + da) -
              model.residual(0.2, at.q - dq, at.v - dv, at.a - da)) /
             (2 * h);
    };
    quotient[0].col(j) = difference(zero(model), zero(model), d);
    quotient[1].col(j) = difference(zero(model), d, zero(model));
    quotient[2].col(j) = difference(d, zero(model), zero(model));
  }
  // The residual is linear in a and v, so that only the round-off of elastic forces of 1e5 N
  // divided by h remains; in q the remainder is of order h^2.
  EXPECT_LT((quotient[0] - tangent[0]).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LT((quotient[1] - tangent[1]).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LT((quotient[2] - tangent[2]).norm() / tangent[2].norm(), 1e-8);
}

/// Returns the root mean square difference of the deflections, relative to the largest deflection.
double chain_difference(const ReissnerBeam& beam, int elements) {
  Chain chain(beam, elements, 1);
  std::vector<double> times, deflection;
  while (chain.time() < 1 - chain.dt() / 2) {
    for (int k = 0; k < 100 && chain.time() < 1 - chain.dt() / 2; ++k) chain.step();
    times.push_back(chain.time());
    deflection.push_back(chain.tip().y());
  }
  const auto count = static_cast<Eigen::Index>(times.size());
  const TipHistory beam_motion = simulate(beam, VectorXd::Map(times.data(), count));
  const VectorXd difference = beam_motion.deflection - VectorXd::Map(deflection.data(), count);
  return difference.norm() / std::sqrt(static_cast<double>(count)) /
         beam_motion.deflection.cwiseAbs().maxCoeff();
}

TEST(ReissnerBeam, AgreesWithAChainInTheInertialFrame) {
  for (const double speed : {0.1, 0.5}) {
    ReissnerBeam beam;
    beam.speed = speed;
    const double coarse = chain_difference(beam, 16), fine = chain_difference(beam, 32);
    // The error is of second order in the element length (a factor of 4); the limit of 3 allows for
    // terms of higher order.
    EXPECT_LT(fine, 1e-3) << "v " << speed;
    EXPECT_GT(coarse, 3 * fine) << "v " << speed;
  }
}

ReissnerBeam plate(double speed) {
  ReissnerBeam beam;
  beam.speed = speed;
  return beam;
}

const VectorXd& milliseconds() {
  static const VectorXd times = VectorXd::LinSpaced(1001, 0, 1);
  return times;
}

// The energy and angular momentum supplied by hub and inflow equal the change of those of the beam.
// The momentum balance is an identity of the kinematics that the collocation satisfies up to its
// order. The energy balance holds only as far as test functions that vanish at the root resolve the
// motion; therefore it also measures the error in space. At h = 5e-4 Radau IIA dissipates at most
// (omega h)^6 / 7200 of the energy of the vibration (J) per step: 1e-7 of the total in 2000 steps.
TEST(ReissnerBeam, EnergyAndAngularMomentumBalance) {
  for (const double speed : {0.1, 0.5}) {
    const TipHistory m = simulate(plate(speed), milliseconds());
    const double energy = m.energy.maxCoeff(), momentum = m.angular_momentum.maxCoeff();
    EXPECT_LT((m.energy - m.supplied).cwiseAbs().maxCoeff() / energy, 1e-7) << "v " << speed;
    EXPECT_LT((m.angular_momentum - m.impulse).cwiseAbs().maxCoeff() / momentum, 1e-10);
    // The torque from all inertia forces is compared with the bending moment at the clamp, which
    // converges slowest because it is a pointwise value.
    const double torque = m.hub_torque.cwiseAbs().maxCoeff();
    EXPECT_LT((m.hub_torque - m.root_couple).cwiseAbs().maxCoeff() / torque, 1e-3) << "v " << speed;
  }
}

// In a very stiff plate, large steps let Radau IIA damp all vibration at once, so that the rigid
// extending body remains. The expected values are its hub torque 2 omega v (rho A L^2 / 2 + m L)
// and the deflection of a Timoshenko cantilever under the Coriolis forces 2 omega v rho A
// (distributed) and 2 omega v m (at the tip).
TEST(ReissnerBeam, StiffLimitIsTheRigidExtendingBody) {
  ReissnerBeam beam = plate(0.5);
  beam.youngs_modulus = 1e13;
  beam.step = 1e-2;
  const TipHistory motion = simulate(beam, VectorXd::Constant(1, 1.0));
  const double length = beam.length + beam.speed, coriolis = 2 * beam.omega * beam.speed;
  const double p = coriolis * beam.line_density(), tip = coriolis * beam.tip_mass;
  const double torque = p * length * length / 2 + tip * length;
  const double linear = p * std::pow(length, 4) / (8 * beam.bending_stiffness()) +
                        tip * std::pow(length, 3) / (3 * beam.bending_stiffness()) +
                        (p * length * length / 2 + tip * length) / beam.shear_stiffness();
  // Stiffening and the rates of a quasi-static motion have the relative size omega^2 / omega_1^2 =
  // 2e-5.
  EXPECT_NEAR(motion.hub_torque(0) / torque, 1, 1e-4);
  EXPECT_NEAR(motion.root_couple(0) / torque, 1, 1e-4);
  EXPECT_NEAR(-motion.deflection(0) / linear, 1, 1e-4);
}

// Expected deflections (linear, static, slender beam): 0.0380 m at L = 1, v = 0.5 and 1.2e-3 m at L
// = 0.6, v = 0.1. The start deflects the slow plate by up to two times its static value;
// centrifugal stiffening reduces the deflection of the long plate.
TEST(ReissnerBeam, DeflectionsHaveTheCoriolisScale) {
  const TipHistory slow = simulate(plate(0.1), milliseconds());
  const TipHistory fast = simulate(plate(0.5), milliseconds());
  EXPECT_LE(slow.deflection.maxCoeff(), 0);
  EXPECT_LE(fast.deflection.maxCoeff(), 0);
  EXPECT_GT(-slow.deflection.minCoeff(), 1.2e-3);
  EXPECT_LT(-slow.deflection.minCoeff(), 2.4e-3);
  EXPECT_NEAR(-fast.deflection(1000), 0.0380, 0.1 * 0.0380);

  // The frequency of the axial vibration is counted from upward passages of the mean within 0.2 s,
  // L = 0.5 to 0.52 m.
  const VectorXd stretch = (slow.axial - 0.1 * slow.time).head(201);
  std::vector<double> passages;
  for (int i = 0; i < 200; ++i) {
    const double a = stretch(i) - stretch.mean(), b = stretch(i + 1) - stretch.mean();
    if (a < 0 && b >= 0) passages.push_back(slow.time(i) + 1e-3 * a / (a - b));
  }
  const double frequency =
      static_cast<double>(passages.size() - 1) / (passages.back() - passages.front());
  EXPECT_NEAR(frequency, 70, 2);  // z tan z = rho A L / m at L = 0.51 m: 70.0 Hz
}

// The error of the default settings is measured against more modes and half the step. It is far
// below the 1e-4 of the largest deflection that a comparison to 0.6 % needs.
TEST(ReissnerBeam, DefaultModesAndStepAreEnough) {
  for (const double speed : {0.1, 0.5}) {
    ReissnerBeam fine = plate(speed);
    fine.modes = 18;
    fine.step /= 2;
    const VectorXd reference = simulate(fine, milliseconds()).deflection;
    const VectorXd error = simulate(plate(speed), milliseconds()).deflection - reference;
    EXPECT_LT(error.cwiseAbs().maxCoeff() / reference.cwiseAbs().maxCoeff(), 2e-5) << speed;
  }
}

// The tip deflection converges with the order 5 of Radau IIA where errors are far above round-off.
TEST(ReissnerBeam, StepConvergesWithOrderFive) {
  ReissnerBeam beam = plate(0.5);
  beam.youngs_modulus = 1e6;  // soft, and few modes: the steps resolve every frequency
  beam.modes = 3;
  const VectorXd times = VectorXd::LinSpaced(26, 0, 0.25);
  const auto deflection = [&](double step) {
    beam.step = step;
    return simulate(beam, times).deflection;
  };
  const VectorXd exact = deflection(2e-4);
  const double coarse = (deflection(2.5e-3) - exact).cwiseAbs().maxCoeff();
  const double order = std::log2(coarse / (deflection(1.25e-3) - exact).cwiseAbs().maxCoeff());
  EXPECT_NEAR(order, 5, 0.3);
}

TEST(ReissnerBeam, BadDataIsRefused) {
  ReissnerBeam beam;
  beam.thickness = -0.01;
  EXPECT_THROW(ReissnerModel{beam}, Error);
  EXPECT_THROW(simulate(plate(0.1), Vec2(0.2, 0.1)), Error);
}

}  // namespace
}  // namespace flexmorph::reference
