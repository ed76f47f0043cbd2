#pragma once

#include <Eigen/SparseCore>

#include "geometry/base.h"

namespace flexmorph::mmc {

/// What a design problem asks of the statics of one plate under many loads: compliances
/// C_l = F_l . u_l with K(b) u_l = F_l, and their derivatives by the factors of every design cell.
/// Of a hot plate C_l is u_lᵀ K u_l of the elastic displacements, twice the elastic energy: heat
/// counts as far as supports hold its growth back (HeldExpansion).
///
/// Factors are per cell: stiffness (n_cells, 0..1), mass (n_cells, 0..1, 0 in the void).
class LoadResponse {
 public:
  virtual ~LoadResponse() = default;

  /// The weighted sum f = Σ w_l C_l.
  struct Value {
    double f = 0;
    VectorXd d_stiffness, d_mass;  ///< (n_cells)
    /// The part of d_stiffness that heat adds where supports hold its growth back (n_cells), or
    /// empty: its sign is that of an energy, while the rest has the other one.
    VectorXd d_held;
  };
  /// One factorization, one block solve, one energy pass.
  /// @throws Error (numerical) when K cannot be factored or f is not finite.
  virtual void evaluate(const VectorXd& stiffness, const VectorXd& mass, Value& value) = 0;

  /// f alone, which may take less than half of the work.
  /// @throws Error (numerical) as evaluate().
  virtual double sum(const VectorXd& stiffness, const VectorXd& mass) {
    Value value;
    evaluate(stiffness, mass, value);
    return value.f;
  }

  /// Every load by itself, without weights: what a worst case needs.
  struct Each {
    VectorXd f;                    ///< C_l (n_loads)
    MatrixXd d_stiffness, d_mass;  ///< (n_loads x n_cells); d_mass is empty for fixed loads
  };
  /// The same solves as evaluate(), uncompressed, with one row of energies per load.
  /// @throws Error (numerical) as evaluate().
  virtual void evaluate_each(const VectorXd& stiffness, const VectorXd& mass, Each& each) = 0;

  /// Are there second derivatives?
  virtual bool has_curvature() const { return false; }
  /// Second derivatives along directions of the stiffness factors.
  /// The first one along direction i is -u · K_i u, K_i = Σ_c D_ci K_c, and from K u_i = -K_i u
  ///
  ///   C_ij = 2 (L⁻¹ K_i u) · (L⁻¹ K_j u),   K = L Lᵀ
  ///
  /// @param directions  D (n_cells x n)
  /// @param weights  of every load (n_loads); empty: of the weighted sum
  /// @return Σ w_l C_l,ij (n x n)
  /// @throws Error (input) where there are none.
  virtual MatrixXd curvature(const VectorXd& /*stiffness*/,
                             const Eigen::SparseMatrix<double>& /*directions*/,
                             const VectorXd& /*weights*/) {
    throw Error::input("these loads have no second derivatives");
  }

  /// C_l of every load at the given factors (n_loads).
  virtual VectorXd individual(const VectorXd& stiffness, const VectorXd& mass) = 0;

  /// Displacements of one load, node by node (2 n_nodes), at the given factors: of a hot plate all
  /// of it, thermal growth included, so that it is zero where held.
  virtual VectorXd displacement(const VectorXd& stiffness, const VectorXd& mass, int load) = 0;

  virtual int n_loads() const = 0;
  virtual int n_right_hand_sides() const = 0;  ///< after compression
  virtual int factorizations() const = 0;      ///< since construction
  /// Estimated condition of K of the last factorization, see fem::condition_estimate().
  virtual double condition() const = 0;
  struct Seconds {  ///< CPU seconds of the last evaluation
    double factor = 0, solve = 0, sensitivity = 0;
  };
  virtual Seconds seconds() const = 0;
};

}  // namespace flexmorph::mmc
