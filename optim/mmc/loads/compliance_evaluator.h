#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fem/esl_set.h"
#include "fem/solve/static_solver.h"
#include "optim/mmc/loads/static_loads.h"
#include "optim/mmc/problem/plate.h"

namespace flexmorph::mmc {

/// A load case of a static plate: nodal forces and a uniform temperature that act together.
struct LoadCase {
  std::string name;                     ///< Name of the load case, for messages.
  double weight = 1;                    ///< Weight w_l > 0 in the mean compliance [-].
  std::vector<fem::NodalForce> forces;  ///< Nodal forces [N].

  /// Thermal stretch a = α ΔT of the whole plate [-]; a free plate expands by the factor 1 + a.
  double thermal_stretch = 0;
};

/// The mean compliance of one plate under several loads, and its gradient with respect to the
/// stiffness and mass scale factors of every design cell:
///
///   f(b) = Σ w_l C_l,   C_l = F_l(b) . u_l(b),   K(b) u_l = F_l(b)
///
///   inertia    F_l = -M(b) a_l + f_l          df = Σ w_l (2 u_lᵀ dF_l - u_lᵀ dK u_l)
///   frozen     F_l = -M(b₀) a_l + f_l         df = -Σ w_l u_lᵀ dK u_l
///   stiffness  F_l = K(b₀) u_l of the motion  df = -Σ w_l u_lᵀ dK u_l
///   static     F_l given                      df = -Σ w_l u_lᵀ dK u_l
///              F_l + weight(b)                df = Σ w_l (2 u_lᵀ dF - u_lᵀ dK u_l)
///
/// Scale factors are given for each cell: stiffness (n_cells, 0..1), mass (n_cells, 0..1, 0 in the
/// void).
///
/// A link here is a body of a mechanism between two pins (EslSets::pins). Its loads are balanced:
/// F_l and u_l are those of LinkBalance. With support `pins`, reactions replace the joint forces in
/// f_l at the first pin, and perpendicular to the line of the pins at the second pin. With
/// `floating`, all joint forces stay unchanged, and the link as a whole accelerates.
///
/// Heated plates: C_l = u_lᵀ K u_l is twice the elastic energy of the elastic displacements u,
/// which are measured from the freely expanded plate with EslSet::thermal_stretch or
/// LoadCase::thermal_stretch = a. Supports that do not expand with the plate prescribe u, and the
/// thermal stress that they cause is included: root lines (EslSet::held_stretch; with support
/// `far_end` the clamp at the far end), the far edge (EslSet::held_end_stretch), supports of a
/// static plate. See RestrainedExpansion.
///
/// Source: P (33)-(35); optim/README.md, Responses and Links between two pins.
class ComplianceEvaluator {
 public:
  /// Creates the evaluator of the equivalent static loads of a motion.
  /// @param stiffness0, mass0  scale factors of the design that the motion was computed with; both
  ///        are not used by `inertia` loads, and stiffness0 is not used for links
  /// @throws Error (input) for `inertia` loads or a held far edge with support `far_end`, for no
  ///         loads, for loads that do not fit the grid; for links without pins or with root
  ///         columns, heat or definition `stiffness`; for pins with a support that is not one of
  ///         links.
  ComplianceEvaluator(const fem::EslSets& loads, const fem::PlaneSection& section,
                      const ComplianceSettings& settings, const VectorXd& stiffness0,
                      const VectorXd& mass0);
  /// Creates the evaluator of a static plate with equal supports for all loads. The loads are
  /// sorted by their values, so that results do not depend on the order in which they are given;
  /// see position(). A heated plate is
  /// held at its positions in the cold state: supports prescribe the thermal expansion that a rigid
  /// motion cannot compensate, so that supports that permit the expansion cause no stress.
  /// @param held      displacements that are held at zero
  /// @param gravity   acceleration of gravity for the plate's own weight in every load [m/s^2]
  /// @param compress  true to solve only as many right-hand sides in evaluate() as Σ w F Fᵀ has
  ///        directions, because f depends on this sum only (optim/README.md, Compression)
  /// @throws Error (input) for no loads, for loads that are zero or act only on held displacements,
  ///         for heat alone on a plate whose supports permit the expansion, for weights that are
  ///         not positive.
  ComplianceEvaluator(const Plate& plate, std::span<const fem::HeldUnknown> held,
                      std::span<const LoadCase> loads, bool compress,
                      const Vec2& gravity = Vec2::Zero());
  ~ComplianceEvaluator();
  ComplianceEvaluator(ComplianceEvaluator&&) noexcept;

  /// The weighted sum f of the compliances with its derivatives.
  struct Value {
    double f = 0;  ///< Weighted sum f of the compliances [J].

    /// Derivatives of f by the scale factors (n_cells) [J]; 0 in cells that no load moves.
    VectorXd d_stiffness, d_mass;
    /// Contribution of the restrained thermal expansion to d_stiffness (n_cells) [J], or empty. It
    /// is positive like an energy, while the other contribution is negative.
    VectorXd d_held;
  };
  /// Computes f and its derivatives by one factorization, one block solve and one pass over the
  /// energies of the cells.
  /// @param stiffness, mass  scale factors (n_cells)
  /// @throws Error (numerical) when K cannot be factored or f is not finite.
  void evaluate(const VectorXd& stiffness, const VectorXd& mass, Value& value);

  /// Returns f without derivatives [J]. Where a clamp holds the plate, forward substitutions
  /// suffice, because F_l . K_l⁻¹ F_l = |L_l⁻¹ F_l|² with a leading block L_l of L.
  /// @throws Error (numerical) as evaluate().
  double sum(const VectorXd& stiffness, const VectorXd& mass);

  /// The compliances of all loads, without weights, as worst-case problems need them.
  struct Each {
    VectorXd f;  ///< Compliances C_l (n_loads) [J].

    /// Derivatives of C_l by the scale factors (n_loads x n_cells) [J]; d_mass is empty for fixed
    /// loads.
    MatrixXd d_stiffness, d_mass;
  };
  /// Computes the compliance of every load and its derivatives. The loads are solved as in
  /// evaluate(), but without compression.
  /// @throws Error (numerical) as evaluate().
  void evaluate_each(const VectorXd& stiffness, const VectorXd& mass, Each& each);

  /// Returns true if second derivatives are available: for cold static plates without weight.
  bool has_curvature() const;
  /// Returns second derivatives along directions of the stiffness factors, Σ w_l C_l,ij (n x n)
  /// [J]. The first derivative along direction i is -u · K_i u, K_i = Σ_c D_ci K_c, and K u_i =
  /// -K_i u leads to
  ///
  ///   C_ij = 2 (L⁻¹ K_i u) · (L⁻¹ K_j u),   K = L Lᵀ
  ///
  /// @param directions  D (n_cells x n)
  /// @param weights  weights of the loads (n_loads); empty for those of the weighted sum f
  /// @throws Error (input) where has_curvature() is false.
  MatrixXd curvature(const VectorXd& stiffness, const Eigen::SparseMatrix<double>& directions,
                     const VectorXd& weights);

  /// Returns the compliance C_l of every load at the given scale factors (n_loads) [J].
  VectorXd individual(const VectorXd& stiffness, const VectorXd& mass);

  /// Returns the nodal displacements of one load at the given scale factors (2 n_nodes) [m]. For a
  /// heated plate they include the thermal expansion, so that they are zero at supports. With a
  /// clamp only nodes in front of the clamp move, and the expansion starts at the clamp at Y = 0.
  /// @throws Error (input) for a load that does not exist.
  VectorXd displacement(const VectorXd& stiffness, const VectorXd& mass, int load);

  /// Returns the number of loads.
  int n_loads() const;
  /// Returns the index by which this class counts the load that was given as number `load`. Loads
  /// of a motion keep their order.
  int position(int load) const;
  /// Returns the number of right-hand sides that evaluate() solves, after compression.
  int n_right_hand_sides() const;
  /// Returns the number of factorizations since construction, or with continue_from() since the
  /// beginning of the run that is continued.
  int factorizations() const;
  /// The factorizations of a run, with which a later run continues to count.
  struct Work {
    std::uint64_t factorizations = 0;  ///< Number of factorizations.
    std::uint64_t factored = 0;        ///< Checksum of the design of the last one; 0: none.
  };
  /// Returns the factorizations so far.
  Work work() const;
  /// Continues to count from an earlier run, as if this object had made its factorizations.
  void continue_from(const Work& work);
  /// Returns the estimated condition of K of the last factorization, see fem::condition_estimate().
  double condition() const;
  /// CPU seconds of one evaluation.
  struct Seconds {
    /// CPU seconds of the factorization, of the solution and of the derivatives.
    double factor = 0, solve = 0, sensitivity = 0;
  };
  /// Returns the CPU seconds of the last evaluation.
  Seconds seconds() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::mmc
