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

/// Returns the unknowns of one of the eight elements of a batch.
Local local_of(const Batch& x, int lane);

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

/// A term of virtual work: one physical effect of one body.
///
/// A term keeps what it needs per element (invariants, mass matrices), refreshed by prepare() for
/// the elements that changed, so that evaluating costs the same for uniform and for designed
/// material.
///
/// What a term can do besides these functions it says by deriving from the interfaces below, too
/// (BatchTerm, MeanForceTerm, ...). A body asks once, when the term is added (model/body_term.h).
///
/// Const functions are called for different elements by several threads at once: work space is on
/// the stack or per thread.
class Term {
 public:
  virtual ~Term() = default;
  /// Returns a copy that shares nothing that changes with this term; it is to be prepared before it
  /// is evaluated.
  virtual std::unique_ptr<Term> clone() const = 0;
  /// Returns what messages call the term.
  virtual std::string name() const { return "without a name"; }

  /// Refreshes what depends on mesh, material and time: of all elements, or only of those whose
  /// shape moves.
  virtual void prepare(const Element& element, const Factors& factors, bool all) = 0;

  /// Adds the generalized force that stands on the left of  M q̈ + F = Q  (n_shapes x dim).
  virtual void add_force(int e, const Local& x, LocalRows& force) const = 0;

  /// Adds w.q ∂f/∂q + w.v ∂f/∂v + w.a ∂f/∂a.
  virtual void add_tangent(int e, const Local& x, const Weights& w,
                           LocalTangent& tangent) const = 0;

  /// Returns the energies of one element [J]; zero where a term has none.
  virtual Energies energies(int, const Local&) const { return {}; }
  double kinetic_energy(int e, const Local& x) const { return energies(e, x).kinetic; }
  double strain_energy(int e, const Local& x) const { return energies(e, x).strain; }
  double potential_energy(int e, const Local& x) const { return energies(e, x).potential; }

  /// Returns the power of one element that the term turns into heat, which no energy keeps [W]; it
  /// is not negative.
  virtual double dissipation(int, const Local&) const { return 0; }

  /// Returns the linear momentum of one element [kg m/s], of dim entries; zero where the term has
  /// none.
  virtual Vec3 momentum(int, const Local&) const { return Vec3::Zero(); }
};

/// Adds the force of one of the eight elements of a batch, and its tangent, as BatchTerm does.
void add_force_of_lane(const Term& term, const Batch& x, int lane, Lanes* force);
void add_tangent_of_lane(const Term& term, const Batch& x, int lane, const Weights& w,
                         Lanes* tangent);

/// A term that evaluates eight elements side by side. Other terms are evaluated element by element.
class BatchTerm {
 public:
  virtual ~BatchTerm() = default;
  /// Adds the forces of Term::add_force(). @param force  (n_shapes dim), entries dim k + c
  virtual void add_forces(const Batch& x, Lanes* force) const = 0;
  /// Adds the tangents of Term::add_tangent(). @param tangent  (n_shapes dim)², by columns
  virtual void add_tangents(const Batch& x, const Weights& w, Lanes* tangent) const = 0;
};

/// A term with a mean force of a step that keeps the energy (a discrete gradient): F̄ · (end -
/// start) is the difference of the term's energy over the step, translations and rotations do no
/// work on F̄, and F̄ is the force at the mean state but for terms of second order in the step.
/// GramGradient serves a term whose energy is not quadratic.
class MeanForceTerm {
 public:
  virtual ~MeanForceTerm() = default;
  /// Adds the mean force of one element (n_shapes x dim).
  virtual void add_mean_force(int e, const LocalStep& x, LocalRows& force) const = 0;
  /// Adds the derivative of the mean force by an unknown that moves the mean state by w (so the end
  /// by 2 w.q, while the start stands).
  virtual void add_mean_tangent(int e, const LocalStep& x, const Weights& w,
                                LocalTangent& tangent) const = 0;
};

/// The mean force of a term T that is linear in (q, v, a): its force at the mean state.
template <class T>
class LinearMeanForce : public MeanForceTerm {
 public:
  void add_mean_force(int e, const LocalStep& x, LocalRows& force) const override {
    static_cast<const T&>(*this).add_force(e, x.mean, force);
  }
  void add_mean_tangent(int e, const LocalStep& x, const Weights& w,
                        LocalTangent& tangent) const override {
    static_cast<const T&>(*this).add_tangent(e, x.mean, w, tangent);
  }
};

/// A term that also gives forces on material lines that are unknowns, see Element::free_sides().
/// Lines are where the last Term::prepare() found them.
class FreeLineTerm {
 public:
  virtual ~FreeLineTerm() = default;
  /// Adds the forces on the shape unknowns and on the lines of one element.
  virtual void add_free_force(int e, const Local& x, FreeForce& force) const = 0;
  /// Adds their derivatives, weighted as in Term::add_tangent().
  virtual void add_free_tangent(int e, const Local& x, const Weights& w,
                                FreeTangent& tangent) const = 0;
};

/// A term whose force depends on the scale factors of a design.
class DesignedTerm {
 public:
  virtual ~DesignedTerm() = default;
  /// Adds ψ · ∂f/∂κ_c by the factors κ_c of all cells of the body, f the force of one element as
  /// Term::add_force() adds it. It is called only where the body has factors, for elements without
  /// free lines; lines are where the last Term::prepare() found them.
  /// @param psi  (n_shapes x dim)
  virtual void add_factor_slopes(int e, const Local& x, const LocalRows& psi,
                                 FactorSlopes& out) const = 0;
};

/// A term whose force is the gradient of its strain energy U by the unknowns, and nothing else.
class ElasticEnergy {
 public:
  virtual ~ElasticEnergy() = default;
  /// Adds weight ∂U/∂κ_c by the factors κ_c of all cells of the body.
  virtual void add_energy_slopes(int e, const Local& x, double weight, FactorSlopes& out) const = 0;
};

/// A term with power where material flows through the mesh. Terms without this interface have none.
class FlowTerm {
 public:
  virtual ~FlowTerm() = default;
  /// Returns the power of the term in one element whose unknowns stand still: the term's force per
  /// area times ∂r/∂t at fixed unknowns and fixed material point, integrated [W]. It is called only
  /// for elements whose lines move.
  virtual double flow_power(int e, const Local& x) const = 0;

  /// Adds the energies per area that cross an m-line through which material enters or leaves. With
  /// flow_power() they are the rate of the element's energy at fixed unknowns.
  /// @param line  tables of one point each (curvature_rates; gradient_rates in the plane): the
  ///              n >= 7 Gauss points along the line, in order, seen from the side of one element
  /// @param x     unknowns of that element
  /// @param out   (n) each
  virtual void add_line_energy(std::span<const ShapeTable> /*line*/, const Local& /*x*/,
                               LineEnergy& /*out*/) const {}
};

/// A term or a force element that can be scaled: its load is proportional to a factor, 1 until the
/// first call.
class ScaledLoad {
 public:
  virtual ~ScaledLoad() = default;
  /// Multiplies the load, or the temperature of a term of a hot body.
  virtual void scale_load(double factor) = 0;
};

}  // namespace flexmorph::fem
