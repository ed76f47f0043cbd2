#pragma once

#include <functional>

#include "fem/force_element.h"
#include "fem/heat.h"

namespace flexmorph::fem {

/// The thermal inertia force Q_tk of a heated body in the plane, T (22), rotated with the body:
///
///   Q_tk = M ë_dΘ,   ë_dΘ = α T̈ R(θ) (e_o - A_r X_cm),
///   θ = atan2(∫ρ Y × r dV, ∫ρ Y · r dV),   Y = X - X_cm
///
/// It gives every material point the acceleration that it has in the free heated body, so that this
/// motion requires no strain. θ is the rotation closest to the body in the mass norm (Procrustes).
/// For this θ, R B and q, B = M (e_o - A_r X_cm), satisfy Σ q_k × R B_k = 0 exactly, and Σ B_k = 0
/// over the positions. Therefore Q_tk changes neither linear nor angular momentum. In the
/// directions of the reference, as in T, it would change the angular momentum of a rotating body.
///
/// The tangent -α T̈ u uᵀ/|(c, s)|, u = R B rotated by 90 degrees, couples all unknowns of the body
/// and is left out: relative to M/(β h²) it is β h² α T̈, of the order 1e-6.
///
/// Where T̈ = 0 always (accelerates() of thermal/temperature.h) the force is zero and need not be
/// added.
///
/// The mass is that of the body as it is designed. No load factor scales the force.
class ThermalForce final : public ForceElement, public MeanForceElement {
 public:
  /// Creates the force of one body.
  /// @param area_density  density times width or thickness [kg/m²]
  /// @throws Error (input) for a heat without temperature; at bind() for a body in space, a rigid
  ///     one, or one with material lines that move; at add_force() (numerical) where θ is not
  ///     defined.
  ThermalForce(std::string name, std::string body, Heat heat, double area_density);

  std::unique_ptr<ForceElement> clone() const override {
    return std::make_unique<ThermalForce>(*this);
  }
  /// Returns the rotation θ of the body [rad], in (-π, π].
  double rotation(const VectorXd& q) const;

  std::string name() const override { return name_; }
  void bind(std::span<const BodyView> bodies) override;
  void add_force(const State& x, VectorXd& out) const override;
  void add_pattern(std::vector<Eigen::Triplet<double>>&) const override {}
  void add_tangent(const State&, const Weights&,
                   std::vector<Eigen::Triplet<double>>&) const override {}
  /// Adds Q_tk at the mean state and time, which conserves the momenta in a mid-point step.
  void add_mean_force(const State& mean, const VectorXd& q0, const VectorXd& q1,
                      VectorXd& out) const override;
  void add_mean_tangent(const State&, const VectorXd&, const VectorXd&, const Weights&,
                        std::vector<Eigen::Triplet<double>>&) const override {}
  /// Returns the power Q_tk · q̇ [W].
  double power(const State& x) const override;

 private:
  /// Returns α T̈ (cos θ, sin θ); zero where T̈ = 0.
  Vec2 direction(double t, const VectorXd& q) const;
  /// Returns (∫ρ Y · r, ∫ρ Y × r) [kg m²].
  Vec2 fit(const VectorXd& q) const;

  std::string name_, body_;
  Heat heat_;
  double area_density_;
  const Element* element_ = nullptr;
  int first_dof_ = 0;
  MatrixXd B_;  // M (e_o - A_r X_cm) (n x 2)
};

}  // namespace flexmorph::fem
