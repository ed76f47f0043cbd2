#pragma once

#include "fem/batch.h"
#include "fem/element.h"
#include "fem/section.h"

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

  /// Energies of one element [J]; zero where a term has none.
  virtual double kinetic_energy(int, const Local&) const { return 0; }
  virtual double strain_energy(int, const Local&) const { return 0; }
  virtual double potential_energy(int, const Local&) const { return 0; }

  /// Linear momentum of one element [kg m/s], of dim entries; zero where the term has none.
  virtual Vec3 momentum(int, const Local&) const { return Vec3::Zero(); }

  /// Power of the term when material flows through a mesh whose unknowns stand still: the term's
  /// force per area times ∂r/∂t at fixed unknowns and fixed material point, integrated [W].
  /// Only called for elements whose lines move.
  virtual double flow_power(int, const Local&) const { return 0; }

  /// Is its energy that of strains, a function of q (and of free lines) alone that does not change
  /// when the body moves as a rigid one? Heat acts on such terms (thermal/heated.h).
  virtual bool is_elastic() const { return false; }
  /// Puts a term of a hot body (Body::heat) where its temperature is at time t.
  virtual void heat_to(double /*t*/) {}
  /// Rate of the term's energy at fixed unknowns and fixed lines, by the temperature [W].
  virtual double heat_power(int, const Local&) const { return 0; }

  /// Adds the energies per area that cross an m-line through which material enters or leaves. With
  /// flow_power() they are the rate of the element's energy at fixed unknowns.
  /// @param line  tables of one point each (curvature_rates; gradient_rates in the plane): the
  ///              n >= 7 Gauss points along the line, in order, seen from the side of one element
  /// @param x     unknowns of that element
  /// @param out   (n) each
  virtual void add_line_energy(std::span<const ShapeTable> /*line*/, const Local& /*x*/,
                               LineEnergy& /*out*/) const {}
};

/// What a body is made of.
std::unique_ptr<Term> make_inertia(const PlaneSection& section);
std::unique_ptr<Term> make_membrane(const PlaneSection& section);
/// The membrane with assumed strains: does not lock in thin bending (terms/membrane_invariant.h).
std::unique_ptr<Term> make_assumed_membrane(const PlaneSection& section);
/// Fully parameterized beam in the plane (elements/ancf_beam.h), section.thickness: its width
/// across the plane. General continuum mechanics, plane stress; and enhanced continuum mechanics,
/// which does not lock by Poisson's effect (terms/beam.cpp).
std::unique_ptr<Term> make_beam_gcm(const PlaneSection& section);
std::unique_ptr<Term> make_beam_ecm(const PlaneSection& section);
/// Bending of a thin plate in space, n x n Gauss points per element (5: force to 5e-4 at strong
/// deformation; 7: 4e-7). @throws Error (input) at prepare() for a body in the plane.
std::unique_ptr<Term> make_bending(const PlaneSection& section, int n_points = 5);
/// Weight of the body's own mass; gravity (dim) [m/s^2].
std::unique_ptr<Term> make_gravity(const PlaneSection& section, const VectorXd& gravity);
/// A mass [kg] at a material point, with its weight when gravity is not empty.
std::unique_ptr<Term> make_point_mass(double mass, const Vec2& material, const VectorXd& gravity);

/// Loads that keep their size and direction, per reference length and area; components as the body
/// has dimensions. All loads are scaled by Model::scale_loads().
/// @throws Error (input) at prepare() for other components, a point outside the body, an unknown
/// edge; point and edge loads also in elements whose lines move.
std::unique_ptr<Term> make_point_force(const Vec2& material, const VectorXd& force);  // [N]
std::unique_ptr<Term> make_edge_load(const std::string& edge, const VectorXd& load);  // [N/m]
std::unique_ptr<Term> make_surface_load(const VectorXd& load);                        // [N/m²]
/// Loads that follow the surface of a plate in space: a pressure [N/m²] along r_m × r_n, and a
/// moment per length [N] of an edge about the edge, positive where it bends with κ > 0.
/// @throws Error (input) at prepare() for a body in the plane or with material lines that move.
std::unique_ptr<Term> make_pressure(double pressure);
std::unique_ptr<Term> make_edge_moment(const std::string& edge, double moment);

/// Builds a term of the table by name ("inertia", "membrane", "membrane_assumed", "bending", "gcm",
/// "ecm").
/// @throws Error (input) naming the known terms.
std::unique_ptr<Term> make_term(const std::string& name, const PlaneSection& section);

}  // namespace flexmorph::fem
