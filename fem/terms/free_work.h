#pragma once

#include <span>

#include "fem/free_lines.h"
#include "fem/shapes/strain.h"
#include "fem/term.h"

/// Virtual work in elements whose material lines are unknowns, at quadrature points: the same for
/// every elastic energy and for everything that has mass.
namespace flexmorph::fem {

/// The shape functions that give a measure. @throws Error (numerical) where there are none.
const MatrixXd& table_of(const ShapeTable& t, const Measure& m);

/// Elastic energy U(q, p) = ∫ W dA of an element and its exact derivatives.
///
/// Forces on lines are ∂U/∂p with the limits of the integral, p = (m1, m2, n1, n2): the gradient of
/// the energy, not the virtual work at fixed material points P (9)-(11). Across an inner line they
/// differ by the jump of W, which bending has (r_mm jumps): a line that moves by δp turns a strip
/// of that width from the curvature of one side to that of the other. At a sleeve out of which
/// material comes the gradient is the configurational force M²/(2 EI), the virtual work twice as
/// much. Material that enters through a free root line brings no strain energy along, therefore:
/// the force on the line has strained it. Source: Bigoni, Dal Corso, Bosi, Misseroni
/// (2015); fem/README.md, Material flow.
class FreeElastic {
 public:
  /// @param table  with the material derivatives that the density asks for
  FreeElastic(const EnergyDensity& density, const FreeTable& table)
      : density_(density), table_(table) {}

  double energy(const LocalRows& q) const;
  void add_force(const LocalRows& q, FreeForce& force) const;
  void add_tangent(const LocalRows& q, double scale, FreeTangent& tangent) const;

 private:
  struct Point;
  void measure(Eigen::Index g, const LocalRows& q, Point& out) const;

  const EnergyDensity& density_;
  const FreeTable& table_;
};

/// @throws Error (input) unless the material point stays on the same fixed lines whatever the free
/// lines around it do, so that ∂r/∂p = 0 there.
void check_fixed(const Element& element, int e, const Vec2& material);

/// Tables of the elements of a body that have free lines.
class FreeTables {
 public:
  /// Tabulates them where the lines are. @throws Error (input) where the material is not uniform.
  void prepare(const Element& element, int degree, Tabulate what, const Factors& factors);
  bool has(int e) const { return !index_.empty() && index_[static_cast<size_t>(e)] >= 0; }
  const FreeTable& of(int e) const {
    return tables_[static_cast<size_t>(index_[static_cast<size_t>(e)])];
  }

 private:
  std::vector<int> index_;  // by element, -1: no free lines; empty: none at all
  std::vector<FreeTable> tables_;
};

/// Inertia and weight, by virtual displacements that stay with the material:
///
///   f_k = ∫ ρh N_k (r̈ - g) dA,   f_l = ∫ ρh ∂r/∂p_l · (r̈ - g) dA,   ∂r/∂p_l = Qᵀ N_p_l
///   r̈ = Qᵈᵈᵀ N + 2 Σ ṗ_l Qᵈᵀ N_l + Σ p̈_l Qᵀ N_l + ΣΣ ṗ_l ṗ_k Qᵀ N_lk                    P (5)
///
/// The tangent is exact: with the derivatives of the limits of integration, which P (20), (22) and
/// the appendix leave out.
class FreeInertia {
 public:
  /// @param area_density  factor on the weights of the table [kg/m²]
  /// @param gravity       (dim) [m/s²] or empty
  /// @param has_inertia   false: weight only
  FreeInertia(double area_density, VectorXd gravity, bool has_inertia)
      : density_(area_density), gravity_(std::move(gravity)), has_inertia_(has_inertia) {}
  void set_gravity(const VectorXd& gravity) { gravity_ = gravity; }

  double kinetic_energy(const FreeTable& table, const Local& x) const;
  double potential_energy(const FreeTable& table, const Local& x) const;
  Vec3 momentum(const FreeTable& table, const Local& x) const;
  void add_force(const FreeTable& table, const Local& x, FreeForce& force) const;
  void add_tangent(const FreeTable& table, const Local& x, const Weights& w,
                   FreeTangent& tangent) const;

 private:
  double density_;
  VectorXd gravity_;
  bool has_inertia_;
};

}  // namespace flexmorph::fem
