#pragma once

#include <numbers>

#include "geometry/base.h"

/// An independent model of the extending, rotating plate (P 4.2), used by tests only.
///
/// A shear-deformable, geometrically exact beam in the plane (Reissner 1972, ZAMP 23, 795-804)
/// slides out of a hub that rotates with constant omega. Material flows through the clamped root
/// with speed v, so that the free length is L(t) = L0 + v t, and a point mass is fixed to the free
/// end. The model shares nothing with the plate elements: it has other kinematics (cross-sections
/// stay plane), other strains (Reissner's instead of Green-Lagrange), polynomials over the whole
/// length, unknowns in the frame of the hub with explicit Coriolis, centrifugal and inflow terms,
/// and the Radau IIA method in time.
namespace flexmorph::reference {

/// The plate modelled as a beam; bending occurs in the plane of `width`. SI units, radians.
struct ReissnerBeam {
  double length = 0.5;                  ///< Free length L0 at t = 0 [m].
  double speed = 0.1;                   ///< Speed v of the material that leaves the hub [m/s].
  double omega = 2 * std::numbers::pi;  ///< Angular velocity of the hub [rad/s].
  double youngs_modulus = 1e8;          ///< Young's modulus [Pa].
  double poisson_ratio = 0.3;
  double density = 2700;    ///< Density [kg/m^3].
  double width = 0.1;       ///< Height of the cross-section in the plane of bending [m].
  double thickness = 0.01;  ///< Thickness [m].
  double tip_mass = 0.5;    ///< Mass at the tip [kg], without rotary inertia.
  int modes = 12;           ///< Number of polynomials per field.
  double step = 5e-4;       ///< Largest time step [s].

  double axial_stiffness() const;  ///< Returns E A [N].
  /// Returns E I [N m^2]: plane stress, free lateral contraction.
  double bending_stiffness() const;
  /// Returns k G A [N] with k = 10 (1 + nu) / (12 + 11 nu), Cowper (1966), J. Appl. Mech. 33,
  /// 335-340, which follows from the plane-stress elasticity solution (0.850 for nu = 0.3; 5/6 for
  /// nu = 0).
  double shear_stiffness() const;
  double line_density() const;    ///< Returns rho A [kg/m].
  double rotary_inertia() const;  ///< Returns rho I [kg m].
};

/// Momentum and energy of the free length and their flow through its boundary (inertial frame,
/// about the hub).
struct BeamBalance {
  double kinetic, strain;   ///< Energies [J], tip mass included.
  double angular_momentum;  ///< Angular momentum [kg m^2/s].
  double hub_torque;        ///< Moment of the hub on the beam, from all inertia forces [N m].
  double root_couple;       ///< Couple at the root from its strain, -E I kappa(0) [N m].
  double power;             ///< Work of the hub on the beam plus energy of the inflow [W].
  double momentum_inflow;   ///< Angular momentum that enters with the material per time [N m].
};

/// Equations of motion of the beam, discretized in space.
///
///   position   r = (s + u, w) in the frame of the hub,   s = X + v t in [0, L(t)]
///   strains    Gamma = R(phi)^T r' - e1,   kappa = phi'
///   forces     N = EA Gamma1,   Q = kGA Gamma2,   M = EI kappa
///   work       0 = int_0^L rho A dr . a + rho I dphi D2phi ds + m dr(L) . a(L)
///                + int_0^L N dGamma1 + Q dGamma2 + M dkappa ds
///
/// with a = D2r + 2 omega e_z x Dr - omega^2 r. The fields live on sigma = s / L in [0, 1]; a
/// material point X moves through sigma with c = v (1 - sigma) / L, hence
///
///   D  = d/dt + c d/dsigma
///   D2 = d2/dt2 + 2 c d2/dt dsigma + c^2 d2/dsigma2 - 2 v^2 (1 - sigma) / L^2 d/dsigma
///
/// omega is constant and adds nothing to D2phi. The root is clamped in value only: u = w = phi = 0
/// at s = 0, while axial, shear and bending strain are free there.
///
/// Unknowns q (3 n): n coefficients of u, then w, then phi, for psi_k = int_0^sigma P_k(2 z - 1) dz
/// (P_k Legendre). psi_0(1) = 1 and all others vanish at the tip: q(0) and q(n) are its
/// displacement.
class ReissnerModel {
 public:
  /// @throws Error (input) when a length, stiffness, density, number of modes or step is out of
  /// range.
  explicit ReissnerModel(const ReissnerBeam& beam);

  const ReissnerBeam& beam() const { return beam_; }
  int size() const { return 3 * beam_.modes; }
  double length(double t) const { return beam_.length + beam_.speed * t; }

  /// Returns the residual (3 n) of the virtual work for q and its time derivatives at fixed sigma.
  VectorXd residual(double t, const VectorXd& q, const VectorXd& v, const VectorXd& a) const;

  /// Computes the derivatives (3 n x 3 n each) of the residual by a, v and q.
  void linearize(double t, const VectorXd& q, MatrixXd& mass, MatrixXd& damping,
                 MatrixXd& stiffness) const;

  BeamBalance balance(double t, const VectorXd& q, const VectorXd& v, const VectorXd& a) const;

  /// Returns (x, y, phi) of the cross-section at sigma in [0, 1].
  Vec3 section(double sigma, double t, const VectorXd& q) const;

 private:
  struct Fields;  // the three fields and their material derivatives at the Gauss points
  Fields fields(double t, const VectorXd& q, const VectorXd& v, const VectorXd& a) const;

  ReissnerBeam beam_;
  VectorXd points_, weights_;    // Gauss-Legendre on [0, 1]
  MatrixXd psi_, dpsi_, ddpsi_;  // points x modes
  VectorXd dpsi_root_;           // psi_k'(0)
};

struct TipHistory {
  VectorXd time;
  /// The y of the tip in the frame of the hub [m]; negative: the tip lags behind the rotation.
  VectorXd deflection;
  VectorXd axial;   ///< The x of the tip in the frame of the hub [m].
  VectorXd energy;  ///< Kinetic and strain energy [J].
  /// Energy at t = 0 plus work of the hub and energy of the inflow since then [J].
  VectorXd supplied;
  VectorXd angular_momentum;  ///< Angular momentum [kg m^2/s].
  VectorXd hub_torque;        ///< Moment of the hub, from all inertia forces [N m].
  VectorXd root_couple;       ///< Couple at the root from the curvature there [N m].
  /// Angular momentum at t = 0 plus the contributions of hub and inflow [kg m^2/s].
  VectorXd impulse;
};

/// Computes the motion from the start `rigid` at t = 0 (straight, unstrained, every material point
/// moves with the velocity of the rigid extending body) to the last of the times, by the
/// three-stage Radau IIA method (order 5, stiffly accurate) with steps of equal size <= beam.step
/// between two times.
/// @param times  increasing, >= 0 [s]
/// @throws Error (input) for invalid data, (numerical) when Newton's method does not converge.
TipHistory simulate(const ReissnerBeam& beam, const VectorXd& times);

}  // namespace flexmorph::reference
