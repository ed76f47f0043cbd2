#pragma once

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

/// Tangent of one element; row and column dim k + c belong to shape function k, direction c.
using LocalTangent = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor,
                                   kMaxShapes * kMaxDim, kMaxShapes * kMaxDim>;

/// The seam of virtual work: one physical effect of one body.
///
/// A term keeps what it needs per element (invariants, mass matrices), refreshed by prepare() for
/// the elements that changed, so that evaluating costs the same for uniform and for designed
/// material.
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

  /// Energies of one element [J]; zero where a term has none.
  virtual double kinetic_energy(int, const Local&) const { return 0; }
  virtual double strain_energy(int, const Local&) const { return 0; }
  virtual double potential_energy(int, const Local&) const { return 0; }

  /// Power of the term when material flows through a mesh whose unknowns stand still: the term's
  /// force per area times ∂r/∂t at fixed unknowns and fixed material point, integrated [W].
  /// Only called for elements whose lines move.
  virtual double flow_power(int, const Local&) const { return 0; }
};

/// What a body is made of.
std::unique_ptr<Term> make_inertia(const PlaneSection& section);
std::unique_ptr<Term> make_membrane(const PlaneSection& section);
/// Weight of the body's own mass; gravity (dim) [m/s^2].
std::unique_ptr<Term> make_gravity(const PlaneSection& section, const VectorXd& gravity);
/// A mass [kg] at a material point, with its weight when gravity is not empty.
std::unique_ptr<Term> make_point_mass(double mass, const Vec2& material, const VectorXd& gravity);

/// Builds a term of the table by name ("inertia", "membrane").
/// @throws Error (input) naming the known terms.
std::unique_ptr<Term> make_term(const std::string& name, const PlaneSection& section);

}  // namespace flexmorph::fem
