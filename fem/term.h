#pragma once

#include "fem/element.h"
#include "fem/shapes/batch.h"

namespace flexmorph::fem {

/// Derivatives of (q, v, a) by the unknown of the solver: (1, 0, 0) in statics, (1, γ', β') in a
/// time step.
struct Weights {
  double q = 1, v = 0, a = 0;  ///< Weights of the derivatives by q, v and a.
};

/// Unknowns of one element with their rates and accelerations.
struct Local {
  LocalRows q, v, a;  ///< Values q, v and a (n_shapes x dim).
};

/// Returns the unknowns of one element of a batch.
/// @param lane  SIMD lane of the element
Local local_of(const Batch& x, int lane);

/// Unknowns of one element over a step of a mid-point scheme.
struct LocalStep {
  LocalRows start, end;  ///< Unknowns q at the start and at the end of the step.
  Local mean;            ///< Mean state: ½ (start + end), mean rate and mean acceleration.
};

/// Tangent matrix of one element; row and column dim k + c belong to shape function k, direction c.
using LocalTangent = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor,
                                   kMaxShapes * kMaxDim, kMaxShapes * kMaxDim>;

/// Largest number of generalized forces of an element with free lines.
inline constexpr int kMaxFree = kMaxShapes * kMaxDim + 4;
/// Generalized forces of an element with free lines: row dim k + c of shape function k, direction
/// c, then one row per line around the element (see Side).
using EulerianForce = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxFree, 1>;
/// Tangent matrix of an element with free lines; rows and columns are ordered as in EulerianForce.
using EulerianTangent =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kMaxFree, kMaxFree>;

/// Energies of a state, or of a term in one element [J].
struct Energies {
  /// Kinetic energy, strain energy and potential of loads [J].
  double kinetic = 0, strain = 0, potential = 0;
  /// Returns the sum of the three energies [J].
  double total() const { return kinetic + strain + potential; }
};

/// Energy per reference area of full material at points of a material line [J/m²], separated by the
/// scale factor of the design that multiplies it (one entry per point each).
struct LineEnergy {
  VectorXd stiffness;  ///< Strain energy, multiplied by the stiffness factor (n).
  VectorXd mass;       ///< Kinetic energy and weight, multiplied by the mass factor (n).
  VectorXd none;       ///< Potential of loads that do not depend on the design (n).

  /// Sets all entries to zeros for n points.
  void set_zero(Eigen::Index n) {
    for (VectorXd* x : {&stiffness, &mass, &none}) x->setZero(n);
  }
};

/// Interface of a term of virtual work: one physical effect of one body.
///
/// A term stores the data that it needs per element (invariants, mass matrices). prepare() updates
/// these data for the elements that changed; therefore an evaluation costs the same for uniform and
/// for designed material.
///
/// Further abilities of a term are the interfaces below, from which its class also derives
/// (BatchTerm, MeanForceTerm, ...). A body looks them up once, when the term is added
/// (model/body_term.h).
///
/// Const functions are called for different elements by several threads at the same time; therefore
/// work arrays are on the stack or per thread.
class Term {
 public:
  virtual ~Term() = default;
  /// Returns a copy that shares no data that can change with this term; call prepare() before it is
  /// evaluated.
  virtual std::unique_ptr<Term> clone() const = 0;
  /// Returns the name of the term, which messages use.
  virtual std::string name() const { return "without a name"; }

  /// Updates the data that depend on mesh, material and time.
  /// @param all  true for all elements, false for only the elements whose shape changes in time
  virtual void prepare(const Element& element, const ScaleFactors& factors, bool all) = 0;

  /// Adds the generalized force f (n_shapes x dim), a contribution to F in M q̈ + F = 0 (inertia
  /// terms also contain M q̈).
  virtual void add_force(int e, const Local& x, LocalRows& force) const = 0;

  /// Adds the tangent matrix w.q ∂f/∂q + w.v ∂f/∂v + w.a ∂f/∂a.
  virtual void add_tangent(int e, const Local& x, const Weights& w,
                           LocalTangent& tangent) const = 0;

  /// Returns the energies of one element [J]; zero where the term has none.
  virtual Energies energies(int, const Local&) const { return {}; }
  /// Returns the kinetic energy of one element [J].
  double kinetic_energy(int e, const Local& x) const { return energies(e, x).kinetic; }
  /// Returns the strain energy of one element [J].
  double strain_energy(int e, const Local& x) const { return energies(e, x).strain; }
  /// Returns the potential of the loads on one element [J].
  double potential_energy(int e, const Local& x) const { return energies(e, x).potential; }

  /// Returns the linear momentum of one element [kg m/s] (dim entries, the others are zero); zero
  /// where the term has none.
  virtual Vec3 momentum(int, const Local&) const { return Vec3::Zero(); }
};

/// Adds the force of one element of a batch in the layout of BatchTerm::add_forces().
/// @param lane  SIMD lane of the element
void add_force_of_lane(const Term& term, const Batch& x, int lane, Pack* force);
/// Adds the tangent matrix of one element of a batch in the layout of BatchTerm::add_tangents().
/// @param lane  SIMD lane of the element
void add_tangent_of_lane(const Term& term, const Batch& x, int lane, const Weights& w,
                         Pack* tangent);

/// Interface of a term that evaluates eight elements at once, one per SIMD lane. Other terms are
/// evaluated element by element.
class BatchTerm {
 public:
  virtual ~BatchTerm() = default;
  /// Adds the forces of Term::add_force().
  /// @param force  (n_shapes dim), entries dim k + c
  virtual void add_forces(const Batch& x, Pack* force) const = 0;
  /// Adds the tangent matrices of Term::add_tangent().
  /// @param tangent  (n_shapes dim)², by columns
  virtual void add_tangents(const Batch& x, const Weights& w, Pack* tangent) const = 0;
};

/// Interface of a term with an energy-conserving mean force over a time step (a discrete gradient).
/// F̄ · (end - start) is the difference of the energy of the term over the step. Translations and
/// rotations do no work on F̄, and F̄ differs from the force at the mean state by terms of second
/// order in the step. GramGradient provides the mean force of a term whose energy is not quadratic.
class MeanForceTerm {
 public:
  virtual ~MeanForceTerm() = default;
  /// Adds the mean force of one element (n_shapes x dim).
  virtual void add_mean_force(int e, const LocalStep& x, LocalRows& force) const = 0;
  /// Adds the derivative of the mean force by an unknown that moves the mean state by w (therefore
  /// the end of the step by 2 w.q, while the start is fixed).
  virtual void add_mean_tangent(int e, const LocalStep& x, const Weights& w,
                                LocalTangent& tangent) const = 0;
};

/// The mean force of a term T that is linear in (q, v, a), which is its force at the mean state.
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

/// Interface of a term that also has forces on free material lines, see Element::free_sides(). The
/// lines are at their positions of the last Term::prepare().
class EulerianLineTerm {
 public:
  virtual ~EulerianLineTerm() = default;
  /// Adds the forces on the shape unknowns and on the lines of one element.
  virtual void add_eulerian_force(int e, const Local& x, EulerianForce& force) const = 0;
  /// Adds the derivatives of the forces of add_eulerian_force(), weighted as in
  /// Term::add_tangent().
  virtual void add_eulerian_tangent(int e, const Local& x, const Weights& w,
                                    EulerianTangent& tangent) const = 0;
};

/// Interface of a term whose force depends on the scale factors of a design.
class DesignedTerm {
 public:
  virtual ~DesignedTerm() = default;
  /// Adds the gradient of ψ · f with respect to the scale factors κ_c of all cells of the body,
  /// with f the force of one element from Term::add_force(). It is called only where the body has
  /// scale factors, for elements without free lines. The lines are at their positions of the last
  /// Term::prepare().
  /// @param psi  (n_shapes x dim)
  virtual void add_scale_factor_gradient(int e, const Local& x, const LocalRows& psi,
                                         ScaleFactorGradient& out) const = 0;
};

/// Interface of a term that dissipates energy. Terms without this interface dissipate none.
class DissipativeTerm {
 public:
  virtual ~DissipativeTerm() = default;
  /// Returns the power that the term dissipates in one element, which no energy contains [W]; it is
  /// not negative.
  virtual double dissipation(int e, const Local& x) const = 0;
};

/// Interface of a term whose force is exactly the gradient of its strain energy U with respect to
/// the unknowns.
class ElasticEnergy {
 public:
  virtual ~ElasticEnergy() = default;
  /// Adds weight ∂U/∂κ_c for the scale factors κ_c of all cells of the body.
  virtual void add_energy_gradient(int e, const Local& x, double weight,
                                   ScaleFactorGradient& out) const = 0;
};

/// Interface of a term with power where material flows through the mesh. Terms without this
/// interface have no such power.
class FlowTerm {
 public:
  virtual ~FlowTerm() = default;
  /// Returns the power of the term in one element at fixed unknowns [W]: the force of the term per
  /// area times ∂r/∂t at fixed unknowns and fixed material point, integrated over the element. It
  /// is called only for elements whose lines move.
  virtual double flow_power(int e, const Local& x) const = 0;

  /// Adds the energies per area on an m-line through which material enters or leaves. Together with
  /// flow_power() they give the rate of the energy of the element at fixed unknowns.
  /// @param line  tables of one point each (curvature_rates; gradient_rates in the plane) at the n
  /// >= 7 Gauss points along the line, in order, of the element on one side of the line
  /// @param x     unknowns of that element
  /// @param out   (n) each
  virtual void add_line_energy([[maybe_unused]] std::span<const ShapeTable> line,
                               [[maybe_unused]] const Local& x,
                               [[maybe_unused]] LineEnergy& out) const {}
};

/// Interface of a term or a force element with a load factor, which is 1 until the first call.
class ScaledLoad {
 public:
  virtual ~ScaledLoad() = default;
  /// Sets the factor that multiplies the load, or the temperature for a term of a body with a
  /// temperature.
  virtual void scale_load(double factor) = 0;
};

}  // namespace flexmorph::fem
