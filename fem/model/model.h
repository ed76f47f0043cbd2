#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fem/dofs.h"
#include "fem/element.h"
#include "fem/heat.h"
#include "fem/joint.h"
#include "fem/model/body_term.h"
#include "fem/model/model_force_element.h"
#include "fem/section.h"

namespace flexmorph::fem {

/// One body: its elements, its section, and its terms, which are the physical effects that act on
/// it.
struct Body {
  std::string name;                       ///< Name of the body.
  std::unique_ptr<Element> element;       ///< Elements of the body.
  std::optional<PlaneSection> section{};  ///< Thickness and material; absent for a rigid body.
  std::vector<BodyTerm> terms;            ///< Terms of the body.
  ScaleFactors factors;                   ///< Scale factors of the design.
  std::optional<Heat> heat{};  ///< Temperature of the body; absent without thermal strain.
  int first_dof = 0;           ///< Number of the first unknown of the body in the model.

  /// Returns the number of unknowns of the body: the entries of its vector unknowns, then its
  /// scalar unknowns.
  int n_dofs() const { return element->dim() * element->n_vectors() + element->n_scalars(); }
  /// Returns the number of the first scalar unknown of the body in the model.
  int first_scalar() const { return first_dof + element->dim() * element->n_vectors(); }
};

/// Bodies, joints and force elements (links): the equations of motion
///
///   M(t) q̈ + F(q, q̇, t) + Φ_qᵀ λ = 0,   Φ(q, t) = 0                          P (23)
///
/// A model contains only what was added to it. It has value semantics: a copy shares no data that
/// can change with the original, and several threads may read a const model. A Workspace
/// (fem/model/workspace.h) evaluates forces, matrices and energies at a state; every thread has its
/// own.
class Model {
 public:
  Model() = default;
  /// Creates an independent copy, whose joints and force elements are bound to its own bodies.
  Model(const Model& other);
  Model(Model&&) = default;
  Model& operator=(const Model& other) { return *this = Model(other); }
  Model& operator=(Model&&) = default;
  ~Model() = default;

  /// Adds a body and returns it.
  Body& add_body(std::string name, std::unique_ptr<Element> element,
                 std::optional<PlaneSection> section, std::vector<std::unique_ptr<Term>> terms);
  /// Adds a joint between bodies that were added before.
  void add_joint(std::unique_ptr<Joint> joint);
  /// Adds a force element between bodies that were added before.
  void add_force_element(std::unique_ptr<ForceElement> force_element);

  /// Returns the bodies in the order in which they were added.
  std::vector<Body>& bodies() { return bodies_; }
  const std::vector<Body>& bodies() const { return bodies_; }
  /// Returns the body of that name.
  /// @throws Error (input) if there is none.
  const Body& body(const std::string& name) const;
  /// Returns the joints in the order in which they were added.
  const std::vector<std::unique_ptr<Joint>>& joints() const { return joints_; }
  /// Returns the first row of a joint in the constraints; first_row(joints().size()) is the number
  /// of constraints.
  int first_row(size_t joint) const { return first_rows_[joint]; }
  /// Sets the constraint rows that depend on each other (redundant joints), and those of them that
  /// are left out of Workspace::constraints() and of the matrices, so that the remaining rows are
  /// independent. The multipliers of left out rows must be 0. Both lists are empty at first.
  void leave_out(std::vector<int> redundant, std::vector<int> left_out);
  /// Returns all rows that depend on each other, ascending, see leave_out().
  const std::vector<int>& redundant_rows() const { return redundant_rows_; }
  /// Returns the rows that are left out, ascending, see leave_out().
  const std::vector<int>& left_out_rows() const { return left_out_rows_; }
  /// Returns the number of constraint rows that are not left out.
  int n_kept_constraints() const {
    return n_constraints_ - static_cast<int>(left_out_rows_.size());
  }
  /// Returns the force elements in the order in which they were added.
  const std::vector<ModelForceElement>& force_elements() const { return force_elements_; }

  /// Sets another mesh of a body; states of the old mesh no longer fit
  /// (dynamics/mesh_changes/mesh_map.h maps them).
  void set_element(Body& body, std::unique_ptr<Element> element);
  /// Sets the scale factors of the design of a body.
  void set_factors(Body& body, ScaleFactors factors);

  /// Returns true if coordinates of material lines are among the unknowns.
  bool has_eulerian_lines() const;

  /// Sets the factor of all loads and temperatures that choose_scaled() selects (ScaledLoad); 1
  /// until the first call.
  void scale_loads(double factor);
  /// Selects what scale_loads() scales: loads, temperatures of bodies, or both; both until the
  /// first call.
  void choose_scaled(bool loads, bool temperatures);

  /// Returns the number of unknowns.
  int n_dofs() const { return n_dofs_; }
  /// Returns the number of constraint rows.
  int n_constraints() const { return n_constraints_; }

  /// Returns the state of the undeformed model, every body in its own frame (n_dofs), with zero
  /// rates.
  State reference() const;
  /// Returns the displacement per unit change of each unknown: the element size for position
  /// gradients (n_dofs) [m^order].
  VectorXd scales() const;

  /// Returns a counter of the changes of bodies, meshes, joints and force elements, which change
  /// the pattern of the matrices. A solver that stored another value must analyse the pattern
  /// again.
  int pattern_version() const { return pattern_version_; }
  /// Returns a counter of the changes that pattern_version() counts and of the changes of scale
  /// factors.
  int content_version() const { return content_version_; }

 protected:
  /// Returns the data of all bodies for joints and force elements.
  std::vector<BodyView> views() const;

  std::vector<Body> bodies_;
  std::vector<std::unique_ptr<Joint>> joints_;
  std::vector<int> first_rows_ = {0};
  std::vector<ModelForceElement> force_elements_;
  std::vector<int> redundant_rows_, left_out_rows_;

 private:
  void number_dofs();
  void renumber_redundant(const std::vector<int>& first_rows_before);

  int n_dofs_ = 0, n_constraints_ = 0, pattern_version_ = 0, content_version_ = 0;
  bool scales_loads_ = true, scales_temperatures_ = true;
};

}  // namespace flexmorph::fem
