#pragma once

#include <span>

#include "fem/eulerian_lines.h"
#include "fem/shapes/strain.h"
#include "fem/term.h"

/// Virtual work at quadrature points of elements whose material lines are unknowns, for every
/// elastic energy and for all terms with mass.
namespace flexmorph::fem {

/// Returns the derivatives of the shape functions that belong to a measure.
/// @throws Error (numerical) where there are none.
const MatrixXd& table_of(const ShapeTable& t, const Measure& m);

/// Elastic energy U(q, p) = ∫ W dA of an element with free lines and its exact derivatives.
///
/// Forces on lines are ∂U/∂p with the limits of the integral, p = (m1, m2, n1, n2). They are the
/// gradient of the energy, not the virtual work at fixed material points P (9)-(11). Across an
/// inner line the two differ by the jump of W, which exists in bending (r_mm jumps): a line that
/// moves by δp changes the curvature of a strip of width δp from the value on one side to the value
/// on the other side. At a sleeve out of which material slides, the gradient is the configurational
/// force M²/(2 EI), and the virtual work is twice as large. Therefore material that enters through
/// a free root line carries no strain energy with it, because the force on the line has strained
/// it. Source: Bigoni, Dal Corso, Bosi, Misseroni (2015); fem/README.md, Material flow.
class EulerianElastic {
 public:
  /// Creates the energy of one element.
  /// @param table  with the material derivatives that the density needs
  EulerianElastic(const EnergyDensity& density, const EulerianTable& table)
      : density_(density), table_(table) {}

  /// Returns the energy U [J].
  double energy(const LocalRows& q) const;
  /// Adds the forces ∂U/∂q and ∂U/∂p.
  void add_force(const LocalRows& q, EulerianForce& force) const;
  /// Adds the second derivatives of U by q and p, times scale.
  void add_tangent(const LocalRows& q, double scale, EulerianTangent& tangent) const;

 private:
  struct Point;
  void measure(Eigen::Index g, const LocalRows& q, Point& out) const;

  const EnergyDensity& density_;
  const EulerianTable& table_;
};

/// Checks that a material point stays on the same fixed lines, however the free lines around it
/// move, so that ∂r/∂p = 0 there.
/// @throws Error (input) if it does not.
void check_fixed(const Element& element, int e, const Vec2& material);

/// Tables of the elements of a body that have free lines.
class EulerianTables {
 public:
  /// Tabulates the elements at the present positions of the lines.
  /// @throws Error (input) where the material is not uniform.
  void prepare(const Element& element, int degree, Tabulate what, const ScaleFactors& factors);
  /// Returns true if an element has free lines.
  bool has(int e) const { return !index_.empty() && index_[static_cast<size_t>(e)] >= 0; }
  /// Returns the table of an element with free lines.
  const EulerianTable& of(int e) const {
    return tables_[static_cast<size_t>(index_[static_cast<size_t>(e)])];
  }

 private:
  std::vector<int> index_;  // by element, -1: no free lines; empty: no element has free lines
  std::vector<EulerianTable> tables_;
};

/// Inertia and weight of an element with free lines, by virtual displacements of fixed material
/// points:
///
///   f_k = ∫ ρh N_k (r̈ - g) dA,   f_l = ∫ ρh ∂r/∂p_l · (r̈ - g) dA,   ∂r/∂p_l = Qᵀ N_p_l
///   r̈ = Qᵈᵈᵀ N + 2 Σ ṗ_l Qᵈᵀ N_l + Σ p̈_l Qᵀ N_l + ΣΣ ṗ_l ṗ_k Qᵀ N_lk                    P (5)
///
/// The tangent is exact: it contains the derivatives of the limits of integration, which P (20),
/// (22) and the appendix leave out.
class EulerianInertia {
 public:
  /// Creates the inertia and weight of a body.
  /// @param area_density  factor on the weights of the table [kg/m²]
  /// @param gravity  (dim) [m/s²] or empty
  /// @param has_inertia  false: weight only
  EulerianInertia(double area_density, VectorXd gravity, bool has_inertia)
      : density_(area_density), gravity_(std::move(gravity)), has_inertia_(has_inertia) {}
  /// Replaces the gravity (dim) [m/s²].
  void set_gravity(const VectorXd& gravity) { gravity_ = gravity; }

  /// Returns the kinetic energy [J]; 0 without inertia.
  double kinetic_energy(const EulerianTable& table, const Local& x) const;
  /// Returns the potential energy of the weight [J].
  double potential_energy(const EulerianTable& table, const Local& x) const;
  /// Returns the linear momentum [kg m/s]; 0 without inertia.
  Vec3 momentum(const EulerianTable& table, const Local& x) const;
  /// Adds the forces f_k on the shape unknowns and f_l on the lines.
  void add_force(const EulerianTable& table, const Local& x, EulerianForce& force) const;
  /// Adds the derivatives of the forces, weighted for q, v and a.
  void add_tangent(const EulerianTable& table, const Local& x, const Weights& w,
                   EulerianTangent& tangent) const;

 private:
  double density_;
  VectorXd gravity_;
  bool has_inertia_;
};

}  // namespace flexmorph::fem
