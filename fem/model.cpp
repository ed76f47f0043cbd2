#include "fem/model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "fem/strain_term.h"

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

void Model::add_link(std::unique_ptr<Link> link) {
  links_.push_back(std::move(link));
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
  // The inertia of a body may be what a link acts by.
  for (const auto& link : links_) link->bind(views());
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
  n_constraints_ = 0;
  first_rows_ = {0};
  for (const auto& joint : joints_) {
    joint->bind(bodies);
    n_constraints_ += joint->size();
    first_rows_.push_back(n_constraints_);
  }
  for (const auto& link : links_) link->bind(bodies);
  ++pattern_version_;
  fresh_ = false;
  number_batches();
}

void Model::prepare(const State& x) {
  for (Body& b : bodies_)
    if (const int n = b.element->n_scalars(); n > 0)
      b.element->move_lines(x.q.segment(b.first_scalar(), n), x.v.segment(b.first_scalar(), n),
                            x.a.segment(b.first_scalar(), n));
  prepare(x.t);
}

void Model::prepare(double t) {
  for (Body& b : bodies_) {
    b.element->move_to(t);
    if (b.heat)
      for (const auto& term : b.terms)
        if (auto* hot = dynamic_cast<StrainTerm*>(term.get())) hot->heat_to(t);
    try {
      for (const auto& term : b.terms) term->prepare(*b.element, b.factors, !fresh_);
    } catch (const Error& error) {
      throw Error(error.kind(), "body '" + b.name + "': " + error.what());
    }
  }
  fresh_ = true;
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
  x.v = x.a = x.alpha = VectorXd::Zero(n_dofs_);
  x.lambda = VectorXd::Zero(n_constraints_);
  return x;
}

VectorXd Model::scales() const {
  VectorXd out = VectorXd::Ones(n_dofs_);  // of scalar unknowns
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

void Model::gather(const Body& body, int e, const State& mean, const VectorXd& q0,
                   const VectorXd& q1, LocalStep& step) const {
  gather(body, e, mean, step.mean);
  const int dim = body.element->dim();
  const auto vectors = body.element->vectors(e);
  step.start.resize(step.mean.q.rows(), dim);
  step.end.resize(step.mean.q.rows(), dim);
  for (Eigen::Index k = 0; k < step.start.rows(); ++k) {
    const int at = body.first_dof + dim * vectors[static_cast<size_t>(k)];
    step.start.row(k) = q0.segment(at, dim);
    step.end.row(k) = q1.segment(at, dim);
  }
}

void Model::constraints(const State& x, Constraints& out) const {
  out.value.resize(n_constraints_);
  out.rate.resize(n_constraints_);
  out.acceleration.resize(n_constraints_);
  out.jacobian.clear();
  int first = 0;
  for (const auto& joint : joints_) {
    joint->evaluate(x.t, x.q, x.v, rows_);
    out.value.segment(first, joint->size()) = rows_.value;
    out.rate.segment(first, joint->size()) = rows_.rate;
    out.acceleration.segment(first, joint->size()) = rows_.acceleration;
    for (const auto& entry : rows_.jacobian)
      out.jacobian.emplace_back(first + entry.row(), entry.col(), entry.value());
    first += joint->size();
  }
}

void Model::add_constraint_force(const Constraints& c, const VectorXd& lambda,
                                 VectorXd& out) const {
  for (const auto& entry : c.jacobian) out[entry.col()] += entry.value() * lambda[entry.row()];
}

void Model::scale_loads(double factor) {
  for (Body& b : bodies_)
    for (const auto& term : b.terms) {
      const bool strained = dynamic_cast<const StrainTerm*>(term.get()) != nullptr;
      if (strained ? scales_temperatures_ : scales_loads_) term->scale_load(factor);
    }
  if (!scales_loads_) return;
  for (const auto& link : links_) link->scale_load(factor);
}

void Model::choose_scaled(bool loads, bool temperatures) {
  scales_loads_ = loads;
  scales_temperatures_ = temperatures;
}

VectorXd Model::joint_force(size_t joint, const State& x) const {
  VectorXd out = VectorXd::Zero(n_dofs_);
  joints_[joint]->evaluate(x.t, x.q, x.v, rows_);
  for (const auto& entry : rows_.jacobian)
    out[entry.col()] -= entry.value() * x.lambda[first_rows_[joint] + entry.row()];
  return out;
}

PlaceMotion Model::place_motion(const MarkerPlace& place, const State& x) const {
  Marker marker(place);
  marker.bind(views(), "place", false);
  const MarkerMotion m = marker.evaluate(x.t, x.q, x.v);
  Eigen::Vector4d acceleration = m.convective;
  for (size_t k = 0; k < marker.dofs().size(); ++k)
    acceleration += x.a[marker.dofs()[k]] * marker.block().col(static_cast<Eigen::Index>(k));
  return {m.y.head<2>(), m.rate.head<2>(), acceleration.head<2>(), m.y.tail<2>()};
}

Wrench Model::joint_wrench(size_t joint, const std::string& name, const Vec3& about,
                           const State& x) const {
  const Body& b = body(name);
  const Element& element = *b.element;
  const VectorXd force = joint_force(joint, x);
  Wrench out;
  for (int k = 0; k < element.n_vectors(); ++k) {
    const int at = b.first_dof + element.dim() * k;
    Vec3 f = Vec3::Zero(), arm = Vec3::Zero();
    for (int c = 0; c < element.dim(); ++c) {
      f[c] = force[at + c];
      arm[c] = x.q[at + c];
    }
    if (element.is_position(k)) {
      out.force += f;
      arm -= about;
    }
    out.moment += arm.cross(f);
  }
  return out;
}

Energies Model::energies(const State& x) const {
  Energies out;
  Local local;
  for (const Body& b : bodies_)
    for (int e = 0; e < b.element->n_elements(); ++e) {
      gather(b, e, x, local);
      for (const auto& term : b.terms) {
        const Energies of_term = term->energies(e, local);
        out.kinetic += of_term.kinetic;
        out.strain += of_term.strain;
        out.potential += of_term.potential;
      }
    }
  for (const auto& link : links_) {
    out.strain += link->strain_energy(x);
    out.potential += link->potential_energy(x);
  }
  return out;
}

Vec3 Model::momentum(const State& x) const {
  Vec3 out = Vec3::Zero();
  Local local;
  for (const Body& b : bodies_)
    for (int e = 0; e < b.element->n_elements(); ++e) {
      gather(b, e, x, local);
      for (const auto& term : b.terms) out += term->momentum(e, local);
    }
  return out;
}

double Model::link_power(const State& x) const {
  double out = 0;
  for (const auto& link : links_) out += link->power(x);
  return out;
}

double Model::heat_power(const State& x) const {
  double out = 0;
  Local local;
  for (const Body& b : bodies_) {
    if (!b.heat) continue;
    for (int e = 0; e < b.element->n_elements(); ++e) {
      gather(b, e, x, local);
      for (const auto& term : b.terms)
        if (const auto* hot = dynamic_cast<const StrainTerm*>(term.get()))
          out += hot->heat_power(e, local);
    }
  }
  return out;
}

double Model::dissipation(const State& x) const {
  double out = 0;
  Local local;
  for (const Body& b : bodies_)
    for (int e = 0; e < b.element->n_elements(); ++e) {
      gather(b, e, x, local);
      for (const auto& term : b.terms) out += term->dissipation(e, local);
    }
  return out;
}

double Model::flow_power(const State& x) const {
  double out = 0;
  Local local;
  for (const Body& b : bodies_)
    for (int e = 0; e < b.element->n_elements(); ++e) {
      // Free lines are unknowns: what their motion does is no power at fixed unknowns.
      if (!b.element->moving(e) || !b.element->free_sides(e).empty()) continue;
      gather(b, e, x, local);
      for (const auto& term : b.terms) out += term->flow_power(e, local);
    }
  return out;
}

namespace {

/// r_m × r_n in the plane (negative where turned inside out), |r_m × r_n| in space.
double area_ratio(const VectorXd& r_m, const VectorXd& r_n) {
  if (r_m.size() == 2) return r_m[0] * r_n[1] - r_m[1] * r_n[0];
  return r_m.head<3>().cross(r_n.head<3>()).norm();
}

}  // namespace

double Model::smallest_area_ratio(const State& x) const {
  double smallest = std::numeric_limits<double>::infinity();
  Local local;
  ShapeTable table;
  for (const Body& b : bodies_) {
    for (int e = 0; e < b.element->n_elements(); ++e) {
      gather(b, e, x, local);
      b.element->tabulate(e, 4, Tabulate::gradient, {}, FactorKind::none, table);
      if (table.N_m.size() == 0) continue;  // a rigid body has no gradients
      const MatrixXd r_m = table.N_m * local.q, r_n = table.N_n * local.q;
      for (Eigen::Index p = 0; p < r_m.rows(); ++p)
        smallest = std::min(smallest, area_ratio(r_m.row(p), r_n.row(p)));
    }
  }
  return smallest;
}

}  // namespace flexmorph::fem
