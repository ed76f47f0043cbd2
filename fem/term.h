#pragma once

#include "fem/element.h"
#include "fem/shapes/batch.h"

namespace flexmorph::fem {

/// Derivatives of (q, v, a) by the unknown of the solver: (1, 0, 0) in statics, (1, γ', β') in a
/// time step.
struct Weights {
  double q = 1, v = 0, a = 0;
};

/// Unknowns of one element and their rates.
struct Local {
  LocalRows q, v, a;
};

/// Unknowns of one element over a step of a mid-point scheme.
struct LocalStep {
  LocalRows start, end;  ///< q at both ends
  Local mean;            ///< ½ (start + end), the mean rate and the mean acceleration
};

/// Tangent of one element; row and column dim k + c belong to shape function k, direction c.
using LocalTangent = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor,
                                   kMaxShapes * kMaxDim, kMaxShapes * kMaxDim>;

/// Generalized forces of an element with free lines: row dim k + c of shape function k, direction
/// c, then one row per line around it (see Side); and their tangent.
inline constexpr int kMaxFree = kMaxShapes * kMaxDim + 4;
using FreeForce = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxFree, 1>;
using FreeTangent =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kMaxFree, kMaxFree>;

/// Energies of a state, or of a term in one element [J].
struct Energies {
  double kinetic = 0, strain = 0, potential = 0;
  double total() const { return kinetic + strain + potential; }
};

/// Energy per reference area of full material at points of a material line [J/m²], sorted by the
/// factor of the design that multiplies it (one entry per point each).
struct LineEnergy {
  VectorXd stiffness;  ///< of strains
  VectorXd mass;       ///< of motion and weight
  VectorXd none;       ///< of loads that do not see the design

  void set_zero(Eigen::Index n) {
    for (VectorXd* x : {&stiffness, &mass, &none}) x->setZero(n);
  }
};

/// The seam of virtual work: one physical effect of one body.
///
/// A term keeps what it needs per element (invariants, mass matrices), refreshed by prepare() for
/// the elements that changed, so that evaluating costs the same for uniform and for designed
/// material.
///
/// Const functions are called for different elements by several threads at once: work space is on
/// the stack or per thread.
class Term {
 public:
  virtual ~Term() = default;
  /// A copy that shares nothing that changes with this one; to be prepared before it is evaluated.
  virtual std::unique_ptr<Term> clone() const = 0;

  /// Refreshes what depends on mesh, material and time: of all elements, or only of those whose
  /// shape moves.
  virtual void prepare(const Element& element, const Factors& factors, bool all) = 0;

  /// Adds the generalized force that stands on the left of  M q̈ + F = Q  (n_shapes x dim).
  virtual void add_force(int e, const Local& x, LocalRows& force) const = 0;

  /// Adds w.q ∂f/∂q + w.v ∂f/∂v + w.a ∂f/∂a.
  virtual void add_tangent(int e, const Local& x, const Weights& w,
                           LocalTangent& tangent) const = 0;

  /// The same for eight elements side by side; by the functions above, element by element, unless
  /// a term knows better.
  /// @param force    (n_shapes dim), entries dim k + c
  virtual void add_forces(const Batch& x, Lanes* force) const;
  /// @param tangent  (n_shapes dim)², by columns
  virtual void add_tangents(const Batch& x, const Weights& w, Lanes* tangent) const;

  /// Adds the mean force of a step that keeps the energy (a discrete gradient): F̄ · (end - start)
  /// is the difference of the term's energy over the step, translations and rotations do no work on
  /// F̄, and F̄ is the force at the mean state but for terms of second order in the step. A term that
  /// is linear in (q, v, a) gives its force at the mean state; GramGradient serves a term whose
  /// energy is not quadratic.
  /// @throws Error (input) when the term has none.
  virtual void add_mean_force(int e, const LocalStep& x, LocalRows& force) const;

  /// Adds the derivative of the mean force by an unknown that moves the mean state by w (so the end
  /// by 2 w.q, while the start stands).
  virtual void add_mean_tangent(int e, const LocalStep& x, const Weights& w,
                                LocalTangent& tangent) const;

  /// Said by messages.
  virtual std::string name() const { return "without a name"; }

  /// Multiplies the load of a term that is one (1 until the first call): its force is proportional
  /// to the factor. Nothing in terms that are no loads.
  virtual void scale_load(double /*factor*/) {}

  /// The same where lines around the element are unknowns, see Element::free_sides(): forces on
  /// them too. Lines are where the last prepare() found them.
  /// @throws Error (input) when the term does not know free lines.
  virtual void add_free_force(int e, const Local& x, FreeForce& force) const;
  virtual void add_free_tangent(int e, const Local& x, const Weights& w,
                                FreeTangent& tangent) const;

  /// Adds ψ · ∂f/∂κ_c by the factors κ_c of all cells of the body, f the force of one element as
  /// add_force() adds it. Nothing where a term does not see factors. Only called where there are
  /// some, for elements without free lines; lines are where the last prepare() found them.
  /// @param psi  (n_shapes x dim)
  virtual void add_factor_slopes(int /*e*/, const Local& /*x*/, const LocalRows& /*psi*/,
                                 FactorSlopes& /*out*/) const {}
  /// Adds weight ∂U/∂κ_c, U the strain energy of one element.
  virtual void add_energy_slopes(int /*e*/, const Local& /*x*/, double /*weight*/,
                                 FactorSlopes& /*out*/) const {}
  /// Is its force the gradient of its strain energy by the unknowns, and nothing else?
  virtual bool is_elastic() const { return false; }

  /// Energies of one element [J]; zero where a term has none.
  virtual Energies energies(int, const Local&) const { return {}; }
  double kinetic_energy(int e, const Local& x) const { return energies(e, x).kinetic; }
  double strain_energy(int e, const Local& x) const { return energies(e, x).strain; }
  double potential_energy(int e, const Local& x) const { return energies(e, x).potential; }

  /// Power of one element that the term turns into heat, which nobody keeps [W]; not negative.
  virtual double dissipation(int, const Local&) const { return 0; }

  /// Linear momentum of one element [kg m/s], of dim entries; zero where the term has none.
  virtual Vec3 momentum(int, const Local&) const { return Vec3::Zero(); }

  /// Power of the term when material flows through a mesh whose unknowns stand still: the term's
  /// force per area times ∂r/∂t at fixed unknowns and fixed material point, integrated [W].
  /// Only called for elements whose lines move.
  virtual double flow_power(int, const Local&) const { return 0; }

  /// Adds the energies per area that cross an m-line through which material enters or leaves. With
  /// flow_power() they are the rate of the element's energy at fixed unknowns.
  /// @param line  tables of one point each (curvature_rates; gradient_rates in the plane): the
  ///              n >= 7 Gauss points along the line, in order, seen from the side of one element
  /// @param x     unknowns of that element
  /// @param out   (n) each
  virtual void add_line_energy(std::span<const ShapeTable> /*line*/, const Local& /*x*/,
                               LineEnergy& /*out*/) const {}
};

}  // namespace flexmorph::fem
