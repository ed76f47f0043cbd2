#include "tests/support/reissner_beam.h"

#include <Eigen/Dense>
#include <cmath>
#include <string>

#include "tests/support/radau_iia.h"

namespace flexmorph::reference {
namespace {

using Eigen::ArrayXd;
using Eigen::Matrix3d;
using Points3 = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// Evaluates P_k(x) and its derivatives, k = 0 ... n - 1, by the three-term recursion.
void legendre(double x, int n, VectorXd& p, VectorXd& dp) {
  p.setZero(n);
  dp.setZero(n);
  p(0) = 1;
  if (n > 1) {
    p(1) = x;
    dp(1) = 1;
  }
  for (int k = 2; k < n; ++k) {
    p(k) = ((2 * k - 1) * x * p(k - 1) - (k - 1) * p(k - 2)) / k;
    dp(k) = dp(k - 2) + (2 * k - 1) * p(k - 1);
  }
}

/// Computes the Gauss-Legendre rule on [0, 1] (Golub & Welsch 1969: eigenvalues of the Jacobi
/// matrix).
void gauss_rule(int n, VectorXd& points, VectorXd& weights) {
  MatrixXd jacobi = MatrixXd::Zero(n, n);
  for (int k = 1; k < n; ++k) jacobi(k, k - 1) = jacobi(k - 1, k) = k / std::sqrt(4.0 * k * k - 1);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(jacobi);
  points = (eigen.eigenvalues().array() + 1) / 2;
  weights = eigen.eigenvectors().row(0).array().square();
}

/// Evaluates psi_k and two derivatives at sigma: psi_0 = sigma, psi_k = (P_{k+1} - P_{k-1}) / (2 (2
/// k + 1)).
void basis(double sigma, int n, VectorXd& psi, VectorXd& dpsi, VectorXd& ddpsi) {
  VectorXd p, dp;
  legendre(2 * sigma - 1, n + 1, p, dp);
  psi.resize(n);
  psi(0) = sigma;
  for (int k = 1; k < n; ++k) psi(k) = (p(k + 1) - p(k - 1)) / (2 * (2 * k + 1));
  dpsi = p.head(n);
  ddpsi = 2 * dp.head(n);
}

/// Strains and forces of one cross-section from x', y', phi and phi'.
struct Section {
  double cosine, sine, gamma1, gamma2, kappa, normal, shear, moment;

  Section(const ReissnerBeam& b, double dx, double dy, double phi, double dphi)
      : cosine(std::cos(phi)),
        sine(std::sin(phi)),
        gamma1(cosine * dx + sine * dy - 1),
        gamma2(-sine * dx + cosine * dy),
        kappa(dphi),
        normal(b.axial_stiffness() * gamma1),
        shear(b.shear_stiffness() * gamma2),
        moment(b.bending_stiffness() * kappa) {}

  /// Returns the coefficients of dx', dy' and dphi in N dGamma1 + Q dGamma2.
  Vec3 force() const {
    return {normal * cosine - shear * sine, normal * sine + shear * cosine,
            normal * gamma2 - shear * (1 + gamma1)};
  }

  /// Returns the derivative of `force` by (x', y', phi).
  Matrix3d tangent(const ReissnerBeam& b) const {
    const Vec3 d1(cosine, sine, gamma2), d2(-sine, cosine, -(1 + gamma1));
    Matrix3d k =
        b.axial_stiffness() * d1 * d1.transpose() + b.shear_stiffness() * d2 * d2.transpose();
    k(0, 2) += -normal * sine - shear * cosine;
    k(1, 2) += normal * cosine - shear * sine;
    k(2, 0) = k(0, 2);
    k(2, 1) = k(1, 2);
    k(2, 2) += -normal * (1 + gamma1) - shear * gamma2;
    return k;
  }

  /// Returns the strain energy per length [J/m].
  double energy() const { return (normal * gamma1 + shear * gamma2 + moment * kappa) / 2; }
};

double area(const ReissnerBeam& b) { return b.width * b.thickness; }
double second_moment(const ReissnerBeam& b) { return b.thickness * std::pow(b.width, 3) / 12; }

}  // namespace

double ReissnerBeam::axial_stiffness() const { return youngs_modulus * area(*this); }
double ReissnerBeam::bending_stiffness() const { return youngs_modulus * second_moment(*this); }
double ReissnerBeam::shear_stiffness() const {
  const double nu = poisson_ratio, k = 10 * (1 + nu) / (12 + 11 * nu);
  return k * youngs_modulus / (2 * (1 + nu)) * area(*this);
}
double ReissnerBeam::line_density() const { return density * area(*this); }
double ReissnerBeam::rotary_inertia() const { return density * second_moment(*this); }

/// Fields of the beam; the columns are u, w, phi, and the rows are the Gauss points.
struct ReissnerModel::Fields {
  double length;
  Points3 value, slope, rate, second;  // field, d/ds, D, D2
};

ReissnerModel::ReissnerModel(const ReissnerBeam& beam) : beam_(beam) {
  if (!(beam.length > 0 && beam.youngs_modulus > 0 && beam.density > 0 && beam.width > 0 &&
        beam.thickness > 0 && beam.tip_mass >= 0 && beam.modes >= 2 && beam.step > 0))
    throw Error::input(
        "reissner beam: lengths, stiffness, density and step are positive, modes >= 2");
  // The inertia terms have the highest degree 2 n - 2 + 4; the other points integrate the sines and
  // cosines.
  gauss_rule(beam.modes + 8, points_, weights_);
  psi_.resize(points_.size(), beam.modes);
  dpsi_ = ddpsi_ = psi_;
  VectorXd psi, dpsi, ddpsi;
  for (Eigen::Index g = 0; g < points_.size(); ++g) {
    basis(points_(g), beam.modes, psi, dpsi, ddpsi);
    psi_.row(g) = psi;
    dpsi_.row(g) = dpsi;
    ddpsi_.row(g) = ddpsi;
  }
  basis(0, beam.modes, psi, dpsi_root_, ddpsi);
}

ReissnerModel::Fields ReissnerModel::fields(double t, const VectorXd& q, const VectorXd& v,
                                            const VectorXd& a) const {
  const int n = beam_.modes;
  const Eigen::Map<const MatrixXd> Q(q.data(), n, 3), V(v.data(), n, 3), A(a.data(), n, 3);
  const double length = this->length(t);
  const ArrayXd c = beam_.speed * (1 - points_.array()) / length;
  const Points3 q_s = dpsi_ * Q, q_ss = ddpsi_ * Q, v_s = dpsi_ * V;

  Fields f;
  f.length = length;
  f.value = psi_ * Q;
  f.slope = q_s / length;
  f.rate = psi_ * V;
  f.rate.array() += q_s.array().colwise() * c;
  f.second = psi_ * A;
  f.second.array() += v_s.array().colwise() * (2 * c) + q_ss.array().colwise() * c.square() -
                      q_s.array().colwise() * (2 * beam_.speed / length * c);
  return f;
}

VectorXd ReissnerModel::residual(double t, const VectorXd& q, const VectorXd& v,
                                 const VectorXd& a) const {
  const int n = beam_.modes;
  const double omega = beam_.omega, speed = beam_.speed;
  const Fields f = fields(t, q, v, a);
  Points3 on_value(points_.size(), 3), on_slope(points_.size(), 3);
  for (Eigen::Index g = 0; g < points_.size(); ++g) {
    const Section section(beam_, 1 + f.slope(g, 0), f.slope(g, 1), f.value(g, 2), f.slope(g, 2));
    const Vec3 force = section.force();
    const double x = f.length * points_(g) + f.value(g, 0), y = f.value(g, 1);
    const double ax = f.second(g, 0) - 2 * omega * f.rate(g, 1) - omega * omega * x;
    const double ay = f.second(g, 1) + 2 * omega * (speed + f.rate(g, 0)) - omega * omega * y;
    const double wl = weights_(g) * f.length;
    on_value.row(g) << wl * beam_.line_density() * ax, wl * beam_.line_density() * ay,
        wl * (beam_.rotary_inertia() * f.second(g, 2) + force(2));
    on_slope.row(g) << weights_(g) * force(0), weights_(g) * force(1), weights_(g) * section.moment;
  }
  VectorXd r(size());
  Eigen::Map<MatrixXd>(r.data(), n, 3) = psi_.transpose() * on_value + dpsi_.transpose() * on_slope;
  // Only psi_0 moves the tip, and c = 0 there.
  r(0) += beam_.tip_mass * (a(0) - 2 * omega * v(n) - omega * omega * (f.length + q(0)));
  r(n) += beam_.tip_mass * (a(n) + 2 * omega * (speed + v(0)) - omega * omega * q(n));
  return r;
}

void ReissnerModel::linearize(double t, const VectorXd& q, MatrixXd& mass, MatrixXd& damping,
                              MatrixXd& stiffness) const {
  const int n = beam_.modes;
  const double omega = beam_.omega, length = this->length(t);
  const Eigen::Map<const MatrixXd> Q(q.data(), n, 3);
  const Points3 value = psi_ * Q, slope = dpsi_ * Q / length;
  mass = damping = stiffness = MatrixXd::Zero(3 * n, 3 * n);
  const auto block = [n](MatrixXd& m, int i, int j) { return m.block(i * n, j * n, n, n); };
  for (Eigen::Index g = 0; g < points_.size(); ++g) {
    const Section section(beam_, 1 + slope(g, 0), slope(g, 1), value(g, 2), slope(g, 2));
    const Matrix3d k = section.tangent(beam_);
    const double wl = weights_(g) * length, c = beam_.speed * (1 - points_(g)) / length;
    const auto p = psi_.row(g), dp = dpsi_.row(g), ddp = ddpsi_.row(g);
    const Vec3 inertia(beam_.line_density(), beam_.line_density(), beam_.rotary_inertia());
    for (int i = 0; i < 3; ++i) {
      const VectorXd left = wl * inertia(i) * p.transpose();
      block(mass, i, i) += left * p;
      block(damping, i, i) += left * (2 * c * dp);
      block(stiffness, i, i) += left * (c * c * ddp - 2 * beam_.speed / length * c * dp);
    }
    const VectorXd coriolis = 2 * omega * wl * beam_.line_density() * p.transpose();
    block(damping, 0, 1) -= coriolis * p;
    block(damping, 1, 0) += coriolis * p;
    block(stiffness, 0, 1) -= coriolis * (c * dp);
    block(stiffness, 1, 0) += coriolis * (c * dp);
    for (int i = 0; i < 2; ++i) {
      block(stiffness, i, i) -= omega / 2 * coriolis * p;
      for (int j = 0; j < 2; ++j)
        block(stiffness, i, j) += weights_(g) / length * k(i, j) * dp.transpose() * dp;
      block(stiffness, i, 2) += weights_(g) * k(i, 2) * dp.transpose() * p;
      block(stiffness, 2, i) += weights_(g) * k(2, i) * p.transpose() * dp;
    }
    block(stiffness, 2, 2) += wl * k(2, 2) * p.transpose() * p + weights_(g) / length *
                                                                     beam_.bending_stiffness() *
                                                                     dp.transpose() * dp;
  }
  for (const int i : {0, n}) {
    mass(i, i) += beam_.tip_mass;
    stiffness(i, i) -= beam_.tip_mass * omega * omega;
  }
  damping(0, n) -= 2 * omega * beam_.tip_mass;
  damping(n, 0) += 2 * omega * beam_.tip_mass;
}

BeamBalance ReissnerModel::balance(double t, const VectorXd& q, const VectorXd& v,
                                   const VectorXd& a) const {
  const int n = beam_.modes;
  const double omega = beam_.omega, speed = beam_.speed;
  const double rho_a = beam_.line_density(), rho_i = beam_.rotary_inertia();
  const Fields f = fields(t, q, v, a);
  BeamBalance b{};
  Vec2 hub_force = Vec2::Zero();
  const auto add_mass = [&](double m, Vec2 r, Vec2 rate, Vec2 second) {
    rate += Vec2(speed, 0);
    const Vec2 velocity = rate + omega * Vec2(-r.y(), r.x());
    const Vec2 force = m * (second + 2 * omega * Vec2(-rate.y(), rate.x()) - omega * omega * r);
    b.kinetic += m * velocity.squaredNorm() / 2;
    b.angular_momentum += m * (r.x() * velocity.y() - r.y() * velocity.x());
    b.hub_torque += r.x() * force.y() - r.y() * force.x();
    hub_force += force;
  };
  for (Eigen::Index g = 0; g < points_.size(); ++g) {
    const Section section(beam_, 1 + f.slope(g, 0), f.slope(g, 1), f.value(g, 2), f.slope(g, 2));
    const double wl = weights_(g) * f.length, spin = omega + f.rate(g, 2);
    add_mass(wl * rho_a, {f.length * points_(g) + f.value(g, 0), f.value(g, 1)},
             {f.rate(g, 0), f.rate(g, 1)}, {f.second(g, 0), f.second(g, 1)});
    b.kinetic += wl * rho_i * spin * spin / 2;
    b.angular_momentum += wl * rho_i * spin;
    b.hub_torque += wl * rho_i * f.second(g, 2);
    b.strain += wl * section.energy();
  }
  add_mass(beam_.tip_mass, {f.length + q(0), q(n)}, {v(0), v(n)}, {a(0), a(n)});

  // The root: the point of the hub is fixed in the frame of the hub, and material passes it with
  // the velocity v r' and the angular velocity omega + v kappa.
  const Vec3 root = dpsi_root_.transpose() * Eigen::Map<const MatrixXd>(q.data(), n, 3) / f.length;
  const Section section(beam_, 1 + root(0), root(1), 0, root(2));
  const Vec2 velocity = speed * Vec2(1 + root(0), root(1));
  const double spin = omega + speed * root(2);
  b.root_couple = -section.moment;
  b.power =
      hub_force.dot(velocity) + b.hub_torque * spin +
      speed * (rho_a * velocity.squaredNorm() / 2 + rho_i * spin * spin / 2 + section.energy());
  b.momentum_inflow = speed * rho_i * spin;
  return b;
}

Vec3 ReissnerModel::section(double sigma, double t, const VectorXd& q) const {
  VectorXd psi, dpsi, ddpsi;
  basis(sigma, beam_.modes, psi, dpsi, ddpsi);
  const Vec3 uwphi = psi.transpose() * Eigen::Map<const MatrixXd>(q.data(), beam_.modes, 3);
  return uwphi + Vec3(sigma * length(t), 0, 0);
}

TipHistory simulate(const ReissnerBeam& beam, const VectorXd& times) {
  const ReissnerModel model(beam);
  RadauIIA motion(model, 0);
  const Eigen::Index count = times.size();
  TipHistory out;
  out.time = times;
  for (VectorXd* row : {&out.deflection, &out.axial, &out.energy, &out.supplied,
                        &out.angular_momentum, &out.impulse, &out.hub_torque, &out.root_couple})
    row->resize(count);
  double t = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    if (!(times(i) >= t)) throw Error::input("reissner beam: times increase from 0");
    const int steps = static_cast<int>(std::ceil((times(i) - t) / beam.step * (1 - 1e-9)));
    for (int k = 0; k < steps; ++k) motion.step((times(i) - t) / steps);
    t = times(i);
    const Vec3 tip = model.section(1, t, motion.q());
    const BeamBalance b = motion.balance();
    out.axial(i) = tip.x();
    out.deflection(i) = tip.y();
    out.energy(i) = b.kinetic + b.strain;
    out.supplied(i) = motion.supplied();
    out.angular_momentum(i) = b.angular_momentum;
    out.impulse(i) = motion.impulse();
    out.hub_torque(i) = b.hub_torque;
    out.root_couple(i) = b.root_couple;
  }
  return out;
}

}  // namespace flexmorph::reference
