#include "fem/model/model.h"

#include <algorithm>

namespace flexmorph::fem {

Model::Model(const Model& other)
    : redundant_rows_(other.redundant_rows_),
      left_out_rows_(other.left_out_rows_),
      n_dofs_(other.n_dofs_),
      n_constraints_(other.n_constraints_),
      pattern_version_(other.pattern_version_),
      content_version_(other.content_version_),
      scales_loads_(other.scales_loads_),
      scales_temperatures_(other.scales_temperatures_) {
  for (const Body& b : other.bodies_) {
    Body& body = bodies_.emplace_back(
        Body{b.name, b.element->clone(), b.section, {}, b.factors, b.heat, b.first_dof});
    for (const BodyTerm& term : b.terms) body.terms.push_back(term->clone());
  }
  for (const auto& joint : other.joints_) joints_.push_back(joint->clone());
  for (const ModelForceElement& force_element : other.force_elements_)
    force_elements_.emplace_back(force_element->clone());
  number_dofs();  // binds joints and force elements to the bodies of the copy
}

Body& Model::add_body(std::string name, std::unique_ptr<Element> element,
                      std::optional<PlaneSection> section,
                      std::vector<std::unique_ptr<Term>> terms) {
  Body body;
  body.name = std::move(name);
  body.element = std::move(element);
  body.section = section;
  for (std::unique_ptr<Term>& term : terms) body.terms.push_back(std::move(term));
  body.first_dof = n_dofs_;
  const Body* before = bodies_.data();
  bodies_.push_back(std::move(body));
  n_dofs_ += bodies_.back().n_dofs();
  ++pattern_version_;
  ++content_version_;
  // Joints and force elements may hold pointers into the list of bodies, which the insertion has
  // moved. A renumbering only after a reallocation avoids n of them for a model of n bodies.
  if (bodies_.data() != before) number_dofs();
  return bodies_.back();
}

void Model::add_joint(std::unique_ptr<Joint> joint) {
  joints_.push_back(std::move(joint));
  joints_.back()->bind(views());
  n_constraints_ += joints_.back()->size();
  first_rows_.push_back(n_constraints_);
  ++pattern_version_;
  ++content_version_;
}

void Model::add_force_element(std::unique_ptr<ForceElement> force_element) {
  const auto turned =
      std::count_if(force_elements_.begin(), force_elements_.end(),
                    [](const ModelForceElement& each) { return each.counts_turns(); });
  force_elements_.emplace_back(std::move(force_element));
  force_elements_.back()->bind(views());
  if (force_elements_.back().counts_turns())
    force_elements_.back().turning->set_turn_index(static_cast<int>(turned));
  ++pattern_version_;
  ++content_version_;
}

const Body& Model::body(const std::string& name) const {
  for (const Body& b : bodies_)
    if (b.name == name) return b;
  throw Error::input("there is no body '" + name + "'");
}

void Model::set_element(Body& body, std::unique_ptr<Element> element) {
  body.element = std::move(element);
  number_dofs();
}

void Model::set_factors(Body& body, ScaleFactors factors) {
  body.factors = std::move(factors);
  ++content_version_;
  // The force of a force element may depend on the inertia of a body, and thereby on its factors.
  for (const ModelForceElement& force_element : force_elements_) force_element->bind(views());
}

std::vector<BodyView> Model::views() const {
  std::vector<BodyView> out;
  for (const Body& b : bodies_) out.push_back({&b.name, b.element.get(), b.first_dof, &b.factors});
  return out;
}

void Model::number_dofs() {
  n_dofs_ = 0;
  for (Body& b : bodies_) {
    b.first_dof = n_dofs_;
    n_dofs_ += b.n_dofs();
  }
  const std::vector<BodyView> bodies = views();
  const std::vector<int> first_rows_before = first_rows_;
  n_constraints_ = 0;
  first_rows_ = {0};
  for (const auto& joint : joints_) {
    joint->bind(bodies);
    n_constraints_ += joint->size();
    first_rows_.push_back(n_constraints_);
  }
  renumber_redundant(first_rows_before);
  int n_turned = 0;
  for (const ModelForceElement& force_element : force_elements_) {
    force_element->bind(bodies);
    if (force_element.counts_turns()) force_element.turning->set_turn_index(n_turned++);
  }
  ++pattern_version_;
  ++content_version_;
}

void Model::leave_out(std::vector<int> redundant, std::vector<int> left_out) {
  redundant_rows_ = std::move(redundant);
  left_out_rows_ = std::move(left_out);
  ++pattern_version_;
  ++content_version_;
}

/// A change of a mesh may change the number of rows of a joint. Redundant joints connect rigid
/// bodies or edges and keep their rows, but the rows of later joints get other numbers.
void Model::renumber_redundant(const std::vector<int>& first_rows_before) {
  if (first_rows_before.size() != first_rows_.size()) return;  // a copy, or a first numbering
  for (std::vector<int>* rows : {&redundant_rows_, &left_out_rows_})
    for (int& row : *rows) {
      const auto next =
          std::upper_bound(first_rows_before.begin(), first_rows_before.end(), row) - 1;
      row += first_rows_[static_cast<size_t>(next - first_rows_before.begin())] - *next;
    }
}

bool Model::has_eulerian_lines() const {
  return std::any_of(bodies_.begin(), bodies_.end(),
                     [](const Body& b) { return b.element->n_scalars() > 0; });
}

State Model::reference() const {
  State x;
  x.q.resize(n_dofs_);
  for (const Body& b : bodies_) {
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> q =
        b.element->reference();
    x.q.segment(b.first_dof, q.size()) = Eigen::Map<const VectorXd>(q.data(), q.size());
    x.q.segment(b.first_scalar(), b.element->n_scalars()) = b.element->scalars();
  }
  x.v = x.a = VectorXd::Zero(n_dofs_);
  x.lambda = VectorXd::Zero(n_constraints_);
  return x;
}

VectorXd Model::scales() const {
  VectorXd out = VectorXd::Ones(n_dofs_);  // scalar unknowns keep 1
  for (const Body& b : bodies_)
    for (int k = 0; k < b.element->n_vectors(); ++k)
      out.segment(b.first_dof + b.element->dim() * k, b.element->dim())
          .setConstant(b.element->scale(k));
  return out;
}

void Model::scale_loads(double factor) {
  for (Body& b : bodies_)
    for (const BodyTerm& term : b.terms)
      if (term.scaled && (term.strain ? scales_temperatures_ : scales_loads_))
        term.scaled->scale_load(factor);
  if (!scales_loads_) return;
  for (const ModelForceElement& force_element : force_elements_)
    if (force_element.scaled) force_element.scaled->scale_load(factor);
}

void Model::choose_scaled(bool loads, bool temperatures) {
  scales_loads_ = loads;
  scales_temperatures_ = temperatures;
}

}  // namespace flexmorph::fem
