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
#include "fem/model/model_link.h"
#include "fem/section.h"

namespace flexmorph::fem {

/// One body: its elements, what it is made of, and the physical effects it takes part in.
struct Body {
  std::string name;
  std::unique_ptr<Element> element;
  std::optional<PlaneSection> section{};  ///< absent: a rigid body
  std::vector<BodyTerm> terms;
  Factors factors;
  std::optional<Heat> heat{};  ///< absent: cold
  int first_dof = 0;

  /// Vector unknowns, entry by entry, then scalar ones.
  int n_dofs() const { return element->dim() * element->n_vectors() + element->n_scalars(); }
  int first_scalar() const { return first_dof + element->dim() * element->n_vectors(); }
};

/// Bodies, joints and links: the equations of motion
///
///   M(t) q̈ + F(q, q̇, t) + Φ_qᵀ λ = 0,   Φ(q, t) = 0                          P (23)
///
/// A model holds what was added to it and nothing else. It is a value: a copy shares nothing that
/// changes with the original, and a const one may be read by several threads. What it comes to at a
/// state is found by a Workspace (fem/model/workspace.h), one per thread.
class Model {
 public:
  Model() = default;
  Model(const Model& other);
  Model(Model&&) = default;
  Model& operator=(const Model& other) { return *this = Model(other); }
  Model& operator=(Model&&) = default;
  ~Model() = default;

  Body& add_body(std::string name, std::unique_ptr<Element> element,
                 std::optional<PlaneSection> section, std::vector<std::unique_ptr<Term>> terms);
  void add_joint(std::unique_ptr<Joint> joint);
  void add_link(std::unique_ptr<Link> link);

  std::vector<Body>& bodies() { return bodies_; }
  const std::vector<Body>& bodies() const { return bodies_; }
  const Body& body(const std::string& name) const;
  const std::vector<std::unique_ptr<Joint>>& joints() const { return joints_; }
  /// First row of joint i in the constraints; first_row(joints().size()) is their number.
  int first_row(size_t joint) const { return first_rows_[joint]; }
  const std::vector<ModelLink>& links() const { return links_; }

  /// Gives a body another mesh; states of the old one no longer fit
  /// (dynamics/mesh_changes/mesh_map.h carries over).
  void set_element(Body& body, std::unique_ptr<Element> element);
  void set_factors(Body& body, Factors factors);

  /// Are material lines among the unknowns?
  bool has_free_lines() const;

  /// Multiplies all loads (ScaledLoad) by a factor; 1 until the first call.
  void scale_loads(double factor);
  /// What scale_loads() multiplies, loads and the temperature of hot bodies: both until the first
  /// call.
  void choose_scaled(bool loads, bool temperatures);

  int n_dofs() const { return n_dofs_; }
  int n_constraints() const { return n_constraints_; }

  /// All unknowns of the undeformed model in its own frames (n_dofs), rates zero.
  State reference() const;
  /// Displacement per unit of each unknown's change: element size for slopes (n_dofs) [m^order].
  VectorXd scales() const;

  /// Counts changes of bodies, meshes, joints and links, with which the pattern of the matrices
  /// changes: a solver that saw another number must analyse again.
  int pattern_version() const { return pattern_version_; }
  /// Counts these and changes of factors.
  int content_version() const { return content_version_; }

 protected:
  std::vector<BodyView> views() const;

  std::vector<Body> bodies_;
  std::vector<std::unique_ptr<Joint>> joints_;
  std::vector<int> first_rows_ = {0};
  std::vector<ModelLink> links_;

 private:
  void number_dofs();

  int n_dofs_ = 0, n_constraints_ = 0, pattern_version_ = 0, content_version_ = 0;
  bool scales_loads_ = true, scales_temperatures_ = true;
};

}  // namespace flexmorph::fem
