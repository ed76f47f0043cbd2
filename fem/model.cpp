#include "fem/model.h"

#include <algorithm>
#include <limits>

namespace flexmorph::fem {

Body& Model::add_body(std::string name, std::unique_ptr<Element> element,
                      const PlaneSection& section, std::vector<std::unique_ptr<Term>> terms) {
  Body body;
  body.name = std::move(name);
  body.element = std::move(element);
  body.section = section;
  body.terms = std::move(terms);
  bodies_.push_back(std::move(body));
  number_dofs();
  return bodies_.back();
}

void Model::add_joint(std::unique_ptr<Joint> joint) {
  joints_.push_back(std::move(joint));
  number_dofs();
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

void Model::set_factors(Body& body, Factors factors) {
  body.factors = std::move(factors);
  fresh_ = false;
}

void Model::number_dofs() {
  n_dofs_ = 0;
  std::vector<BodyView> views;
  for (Body& b : bodies_) {
    b.first_dof = n_dofs_;
    n_dofs_ += b.n_dofs();
    views.push_back({&b.name, b.element.get(), b.first_dof});
  }
  n_constraints_ = 0;
  for (const auto& joint : joints_) {
    joint->bind(views);
    n_constraints_ += joint->size();
  }
  ++pattern_version_;
  fresh_ = false;
}

void Model::prepare(double t) {
  for (Body& b : bodies_) {
    b.element->move_to(t);
    for (const auto& term : b.terms) term->prepare(*b.element, b.factors, !fresh_);
  }
  fresh_ = true;
}

State Model::reference() const {
  State x;
  x.q.resize(n_dofs_);
  for (const Body& b : bodies_) {
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> q =
        b.element->reference();
    x.q.segment(b.first_dof, b.n_dofs()) = Eigen::Map<const VectorXd>(q.data(), q.size());
  }
  x.v = x.a = x.alpha = VectorXd::Zero(n_dofs_);
  x.lambda = VectorXd::Zero(n_constraints_);
  return x;
}

VectorXd Model::scales() const {
  VectorXd out(n_dofs_);
  for (const Body& b : bodies_)
    for (int k = 0; k < b.element->n_vectors(); ++k)
      out.segment(b.first_dof + b.element->dim() * k, b.element->dim())
          .setConstant(b.element->scale(k));
  return out;
}

void Model::gather(const Body& body, int e, const State& x, Local& local) const {
  const int dim = body.element->dim();
  const auto vectors = body.element->vectors(e);
  const auto n = static_cast<Eigen::Index>(vectors.size());
  local.q.resize(n, dim);
  local.v.resize(n, dim);
  local.a.resize(n, dim);
  for (Eigen::Index k = 0; k < n; ++k) {
    const int at = body.first_dof + dim * vectors[static_cast<size_t>(k)];
    local.q.row(k) = x.q.segment(at, dim);
    local.v.row(k) = x.v.segment(at, dim);
    local.a.row(k) = x.a.segment(at, dim);
  }
}

void Model::force(const State& x, VectorXd& out) const {
  out.setZero(n_dofs_);
  Local local;
  LocalRows f;
  for (const Body& b : bodies_) {
    const int dim = b.element->dim();
    for (int e = 0; e < b.element->n_elements(); ++e) {
      gather(b, e, x, local);
      f.setZero(local.q.rows(), dim);
      for (const auto& term : b.terms) term->add_force(e, local, f);
      const auto vectors = b.element->vectors(e);
      for (Eigen::Index k = 0; k < f.rows(); ++k)
        out.segment(b.first_dof + dim * vectors[static_cast<size_t>(k)], dim) += f.row(k);
    }
  }
}

void Model::constraints(const State& x, Constraints& out) const {
  out.value.resize(n_constraints_);
  out.rate.resize(n_constraints_);
  out.acceleration.resize(n_constraints_);
  out.jacobian.clear();
  ConstraintRows rows;
  int first = 0;
  for (const auto& joint : joints_) {
    joint->evaluate(x.t, x.q, x.v, rows);
    out.value.segment(first, joint->size()) = rows.value;
    out.rate.segment(first, joint->size()) = rows.rate;
    out.acceleration.segment(first, joint->size()) = rows.acceleration;
    for (const auto& entry : rows.jacobian)
      out.jacobian.emplace_back(first + entry.row(), entry.col(), entry.value());
    first += joint->size();
  }
}

void Model::add_constraint_force(const Constraints& c, const VectorXd& lambda,
                                 VectorXd& out) const {
  for (const auto& entry : c.jacobian) out[entry.col()] += entry.value() * lambda[entry.row()];
}

void Model::joint_stiffness(const State& x, std::vector<Eigen::Triplet<double>>& out) const {
  out.clear();
  int first = 0;
  for (const auto& joint : joints_) {
    joint->add_stiffness(x.t, x.q, x.lambda.segment(first, joint->size()), out);
    first += joint->size();
  }
}

void Model::build_pattern() const {
  const int n = n_dofs_ + n_constraints_;
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<std::vector<int>> dofs;  // per element
  for (const Body& b : bodies_)
    for (int e = 0; e < b.element->n_elements(); ++e) {
      std::vector<int>& list = dofs.emplace_back();
      for (const int k : b.element->vectors(e))
        for (int c = 0; c < b.element->dim(); ++c)
          list.push_back(b.first_dof + b.element->dim() * k + c);
      for (const int row : list)
        for (const int column : list) entries.emplace_back(row, column, 1.0);
    }
  Constraints c;
  const State at = reference();
  constraints(at, c);
  std::vector<Eigen::Triplet<double>> stiffness;
  joint_stiffness(at, stiffness);
  entries.insert(entries.end(), stiffness.begin(), stiffness.end());
  for (const auto& entry : c.jacobian) {
    entries.emplace_back(n_dofs_ + entry.row(), entry.col(), 1.0);
    entries.emplace_back(entry.col(), n_dofs_ + entry.row(), 1.0);
  }
  pattern_.resize(n, n);
  pattern_.setFromTriplets(entries.begin(), entries.end());
  pattern_.makeCompressed();

  const auto place = [&](int row, int column) {
    const int* first = pattern_.innerIndexPtr() + pattern_.outerIndexPtr()[column];
    const int* last = pattern_.innerIndexPtr() + pattern_.outerIndexPtr()[column + 1];
    return static_cast<int>(std::lower_bound(first, last, row) - pattern_.innerIndexPtr());
  };
  places_.clear();
  for (const std::vector<int>& list : dofs) {
    std::vector<int>& at = places_.emplace_back();
    at.reserve(list.size() * list.size());
    for (const int row : list)
      for (const int column : list) at.push_back(place(row, column));
  }
  joint_places_.clear();
  for (const auto& entry : c.jacobian) {
    joint_places_.push_back(place(n_dofs_ + entry.row(), entry.col()));
    joint_places_.push_back(place(entry.col(), n_dofs_ + entry.row()));
  }
  stiffness_places_.clear();
  for (const auto& entry : stiffness) stiffness_places_.push_back(place(entry.row(), entry.col()));
  built_version_ = pattern_version_;
}

void Model::kkt(const State& x, const Constraints& c, const Weights& w, double scale,
                SparseMatrix& out) const {
  if (built_version_ != pattern_version_) build_pattern();
  if (out.rows() != pattern_.rows() || out.nonZeros() != pattern_.nonZeros()) out = pattern_;
  double* values = out.valuePtr();
  std::fill(values, values + out.nonZeros(), 0.0);
  Local local;
  LocalTangent tangent;
  size_t index = 0;
  for (const Body& b : bodies_)
    for (int e = 0; e < b.element->n_elements(); ++e, ++index) {
      gather(b, e, x, local);
      tangent.setZero(local.q.size(), local.q.size());
      for (const auto& term : b.terms) term->add_tangent(e, local, w, tangent);
      const std::vector<int>& at = places_[index];
      const double* entry = tangent.data();
      for (const int place : at) values[place] += scale * *entry++;
    }
  if (w.q != 0 && !stiffness_places_.empty()) {
    std::vector<Eigen::Triplet<double>> stiffness;
    joint_stiffness(x, stiffness);
    for (size_t k = 0; k < stiffness.size(); ++k)
      values[stiffness_places_[k]] += scale * w.q * stiffness[k].value();
  }
  for (size_t k = 0; k < c.jacobian.size(); ++k) {
    values[joint_places_[2 * k]] += c.jacobian[k].value();
    values[joint_places_[2 * k + 1]] += c.jacobian[k].value();
  }
}

Energies Model::energies(const State& x) const {
  Energies out;
  Local local;
  for (const Body& b : bodies_)
    for (int e = 0; e < b.element->n_elements(); ++e) {
      gather(b, e, x, local);
      for (const auto& term : b.terms) {
        out.kinetic += term->kinetic_energy(e, local);
        out.strain += term->strain_energy(e, local);
        out.potential += term->potential_energy(e, local);
      }
    }
  return out;
}

double Model::flow_power(const State& x) const {
  double out = 0;
  Local local;
  for (const Body& b : bodies_)
    for (int e = 0; e < b.element->n_elements(); ++e) {
      if (!b.element->moving(e)) continue;
      gather(b, e, x, local);
      for (const auto& term : b.terms) out += term->flow_power(e, local);
    }
  return out;
}

double Model::smallest_area_ratio(const State& x) const {
  double smallest = std::numeric_limits<double>::infinity();
  Local local;
  ShapeTable table;
  for (const Body& b : bodies_) {
    if (b.element->dim() != 2) continue;
    for (int e = 0; e < b.element->n_elements(); ++e) {
      gather(b, e, x, local);
      b.element->tabulate(e, 4, Tabulate::gradient, {}, FactorKind::none, table);
      if (table.N_m.size() == 0) continue;  // a rigid body has no gradients
      const MatrixXd r_m = table.N_m * local.q, r_n = table.N_n * local.q;
      const auto area =
          r_m.col(0).array() * r_n.col(1).array() - r_m.col(1).array() * r_n.col(0).array();
      smallest = std::min(smallest, area.minCoeff());
    }
  }
  return smallest;
}

}  // namespace flexmorph::fem
