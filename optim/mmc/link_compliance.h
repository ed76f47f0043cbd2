#pragma once

#include <memory>

#include "optim/mmc/compliance.h"

namespace flexmorph::mmc {

/// Compliance of the equivalent static loads of a link: a body that two pins hold and nothing
/// clamps (EslSets::pins), f(b) = Σ w_i F_i(b)ᵀ u_i(b) with balanced loads F_i, see LinkBalance.
///
///   inertia  F_i of F₀ = -M(b) a_i + f_i
///            df = -Σ w_i (2 u_iᵀ dM (a_i + R c_i) + u_iᵀ dK u_i)
///   frozen   the same with M(b₀), at every design:  df = -Σ w_i u_iᵀ dK u_i
///
/// f_i holds the joint forces at both pins. With support `pins` those at the first one and across
/// the line at the second one are replaced by reactions, which leaves the axial one at the second;
/// with `floating` all of them are as they were, and the link as a whole accelerates.
///
/// Displacements are those of LinkBalance: the line of the pins stays where it is (pins), or there
/// is no mean motion, linear or angular, by mass (floating).
///
/// Source: optim/README.md, Links between two pins.
class LinkCompliance final : public LoadResponse {
 public:
  /// @param mass0  factors of the design the motion was computed with; not read by `inertia`
  /// @throws Error (input) for loads without pins, with root columns or heat, for definition
  ///         `stiffness`, supports `moving_root` and `far_end`, and as Compliance.
  LinkCompliance(const fem::EslSets& loads, const fem::PlaneSection& section,
                 const ComplianceSettings& settings, const VectorXd& stiffness0,
                 const VectorXd& mass0);
  ~LinkCompliance() override;

  void evaluate(const VectorXd& stiffness, const VectorXd& mass, Value& value) override;
  /// Never compressed.
  void evaluate_each(const VectorXd& stiffness, const VectorXd& mass, Each& each) override;
  VectorXd individual(const VectorXd& stiffness, const VectorXd& mass) override;
  VectorXd displacement(const VectorXd& stiffness, const VectorXd& mass, int load) override;

  int n_loads() const override;
  int n_right_hand_sides() const override;
  int factorizations() const override;
  double condition() const override;
  Seconds seconds() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// What the settings ask for: Compliance, or LinkCompliance of a link between two pins. Arguments
/// and what is thrown are theirs.
std::unique_ptr<LoadResponse> make_compliance(const fem::EslSets& loads,
                                              const fem::PlaneSection& section,
                                              const ComplianceSettings& settings,
                                              const VectorXd& stiffness0, const VectorXd& mass0);

}  // namespace flexmorph::mmc
