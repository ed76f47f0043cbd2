#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fem/dofs.h"
#include "fem/element.h"
#include "fem/joint.h"
#include "fem/term.h"

namespace flexmorph::fem {

/// One body: its elements, what it is made of, and the physical effects it takes part in.
struct Body {
  std::string name;
  std::unique_ptr<Element> element;
  PlaneSection section;
  std::vector<std::unique_ptr<Term>> terms;
  Factors factors;
  int first_dof = 0;

  int n_dofs() const { return element->dim() * element->n_vectors(); }
};

/// Energies of a state [J].
struct Energies {
  double kinetic = 0, strain = 0, potential = 0;
  double total() const { return kinetic + strain + potential; }
};

/// All constraint rows of a model at one state.
struct Constraints {
  VectorXd value, rate, acceleration;            ///< (m); see ConstraintRows
  std::vector<Eigen::Triplet<double>> jacobian;  ///< Φ_q
};

/// Bodies and joints: the equations of motion
///
///   M(t) q̈ + F(q, q̇, t) + Φ_qᵀ λ = 0,   Φ(q, t) = 0                          P (23)
///
/// A model holds what was added to it and nothing else. Its matrices keep their sparsity pattern
/// until a mesh changes.
class Model {
 public:
  /// Adds a body; its terms are prepared by the next prepare().
  Body& add_body(std::string name, std::unique_ptr<Element> element, const PlaneSection& section,
                 std::vector<std::unique_ptr<Term>> terms);
  void add_joint(std::unique_ptr<Joint> joint);

  std::vector<Body>& bodies() { return bodies_; }
  const std::vector<Body>& bodies() const { return bodies_; }
  const Body& body(const std::string& name) const;

  /// Gives a body another mesh; states of the old one no longer fit (dynamics/remesh carries over).
  void set_element(Body& body, std::unique_ptr<Element> element);
  void set_factors(Body& body, Factors factors);

  /// Puts material lines where they are at time t and refreshes what depends on them.
  void prepare(double t);

  int n_dofs() const { return n_dofs_; }
  int n_constraints() const { return n_constraints_; }

  /// All unknowns of the undeformed model in its own frames (n_dofs), rates zero.
  State reference() const;
  /// Displacement per unit of each unknown's change: element size for slopes (n_dofs) [m^order].
  VectorXd scales() const;

  /// M q̈ + F(q, q̇) without constraint forces (n_dofs); prepare(x.t) first.
  void force(const State& x, VectorXd& out) const;
  void constraints(const State& x, Constraints& out) const;
  /// out += Φ_qᵀ λ.
  void add_constraint_force(const Constraints& c, const VectorXd& lambda, VectorXd& out) const;

  /// [ scale · (w.q (F + Φ_qᵀ λ)_q + w.v F_v + w.a M)   Φ_qᵀ ]
  /// [ Φ_q                                              0    ]   in a fixed pattern, which changes
  /// with pattern_version() only.
  void kkt(const State& x, const Constraints& c, const Weights& w, double scale,
           SparseMatrix& out) const;
  /// Counts changes of the pattern: a solver that saw another number must analyse again.
  int pattern_version() const { return pattern_version_; }

  Energies energies(const State& x) const;
  /// Power of all terms at fixed unknowns, see Term::flow_power() [W].
  double flow_power(const State& x) const;
  /// Smallest area ratio |r_m x r_n| over all elements (sampled at 3 x 3 points): a collapse of the
  /// St. Venant-Kirchhoff material shows here before Newton fails.
  double smallest_area_ratio(const State& x) const;

 private:
  void number_dofs();
  void build_pattern() const;
  void joint_stiffness(const State& x, std::vector<Eigen::Triplet<double>>& out) const;
  void gather(const Body& body, int e, const State& x, Local& local) const;

  std::vector<Body> bodies_;
  std::vector<std::unique_ptr<Joint>> joints_;
  int n_dofs_ = 0, n_constraints_ = 0, pattern_version_ = 0;
  bool fresh_ = false;  // terms are prepared for this mesh and these factors
  // Pattern of the KKT matrix and where element entries go; rebuilt after a change of the mesh.
  mutable int built_version_ = -1;
  mutable SparseMatrix pattern_;
  mutable std::vector<std::vector<int>> places_;  // per element of all bodies: n_local² positions
  mutable std::vector<int> joint_places_;         // two per jacobian entry: (row, dof), (dof, row)
  mutable std::vector<int> stiffness_places_;     // of the joints' (Φ_qᵀ λ)_q
};

}  // namespace flexmorph::fem
