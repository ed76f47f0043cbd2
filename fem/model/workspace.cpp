#include "fem/model/workspace.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "fem/load_term.h"
#include "fem/model/workspace_wrench.h"
#include "fem/strain_term.h"

namespace flexmorph::fem {

bool Workspace::are_lines_at(const State& x) const {
  size_t k = 0;
  for (const Body& b : bodies_)
    for (int i = 0; i < b.element->n_scalars(); ++i, k += 3) {
      const Eigen::Index at = b.first_scalar() + i;
      if (k + 2 >= lines_.size() || lines_[k] != x.q[at] || lines_[k + 1] != x.v[at] ||
          lines_[k + 2] != x.a[at])
        return false;
    }
  return true;
}

void Workspace::keep_lines(const State& x) {
  lines_.clear();
  for (const Body& b : bodies_)
    for (int i = 0; i < b.element->n_scalars(); ++i)
      for (const VectorXd* of_x : {&x.q, &x.v, &x.a})
        lines_.push_back((*of_x)[b.first_scalar() + i]);
}

void Workspace::prepare(const State& x) {
  if (prepared_version_ == content_version() && prepared_t_ == x.t && are_lines_at(x)) return;
  for (Body& b : bodies_)
    if (const int n = b.element->n_scalars(); n > 0)
      b.element->move_lines(x.q.segment(b.first_scalar(), n), x.v.segment(b.first_scalar(), n),
                            x.a.segment(b.first_scalar(), n));
  keep_lines(x);
  prepare_bodies(x.t);
}

void Workspace::restore_cache(const CacheCheckpoint& whole) {
  size_t at = 0;
  for (Body& b : bodies_) {
    const int n = b.element->n_scalars();
    if (n == 0 || whole.lines.empty()) continue;
    // One column per line, with the rows q, v, a.
    const Eigen::Map<const Eigen::Matrix<double, 3, Eigen::Dynamic>> line(whole.lines.data() + at,
                                                                          3, n);
    b.element->move_lines(line.row(0), line.row(1), line.row(2));
    at += 3 * static_cast<size_t>(n);
  }
  lines_ = whole.lines;
  prepared_version_ = -1;
  prepare_bodies(whole.t);
}

void Workspace::prepare(double t) {
  if (prepared_version_ != content_version() || prepared_t_ != t) prepare_bodies(t);
}

void Workspace::move_lines(double t) {
  prepared_t_ = std::numeric_limits<double>::quiet_NaN();
  for (Body& b : bodies_) b.element->move_to(t);
}

void Workspace::prepare_bodies(double t) {
  // The time stays invalid if an exception is thrown.
  prepared_t_ = std::numeric_limits<double>::quiet_NaN();
  const bool all = prepared_version_ != content_version();
  if (all) checkpoint_ = {t, lines_};
  if (numbered_version_ != pattern_version()) number_batches();
  for (Body& b : bodies_) {
    b.element->move_to(t);
    for (const BodyTerm& term : b.terms) {
      if (term.heated) term.heated->heat_to(t);
      if (term.load) term.load->load_to(t);
    }
    try {
      for (const BodyTerm& term : b.terms) {
        if (all && b.element->n_scalars() > 0) term.with_eulerian_lines();
        term->prepare(*b.element, b.factors, all);
      }
    } catch (const Error& error) {
      throw Error(error.kind(), "body '" + b.name + "': " + error.what());
    }
  }
  prepared_version_ = content_version();
  prepared_t_ = t;
}

void Workspace::gather(const Body& body, int e, const State& x, Local& local) {
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

void Workspace::gather(const Body& body, int e, const State& mean, const VectorXd& q0,
                       const VectorXd& q1, LocalStep& step) {
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

void Workspace::constraints(const State& x, Constraints& out) {
  all_constraints(x, out);
  if (left_out_rows_.empty()) return;
  for (const int row : left_out_rows_) out.value[row] = out.rate[row] = out.acceleration[row] = 0;
  for (auto& entry : out.jacobian)
    if (std::binary_search(left_out_rows_.begin(), left_out_rows_.end(), entry.row()))
      entry = {entry.row(), entry.col(), 0.0};
}

void Workspace::all_constraints(const State& x, Constraints& out) {
  out.value.resize(n_constraints());
  out.rate.resize(n_constraints());
  out.acceleration.resize(n_constraints());
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

void Workspace::add_constraint_force(const Constraints& c, const VectorXd& lambda, VectorXd& out) {
  for (const auto& entry : c.jacobian) out[entry.col()] += entry.value() * lambda[entry.row()];
}

VectorXd Workspace::joint_force(size_t joint, const State& x) {
  VectorXd out = VectorXd::Zero(n_dofs());
  joints_[joint]->evaluate(x.t, x.q, x.v, rows_);
  for (const auto& entry : rows_.jacobian)
    out[entry.col()] -= entry.value() * x.lambda[first_rows_[joint] + entry.row()];
  return out;
}

LocationMotion Workspace::location_motion(const MarkerLocation& location, const State& x) const {
  Marker marker(location);
  marker.bind(views(), "place", false);
  const MarkerMotion m = marker.evaluate(x.t, x.q, x.v);
  Eigen::Vector4d acceleration = m.convective;
  for (size_t k = 0; k < marker.dofs().size(); ++k)
    acceleration += x.a[marker.dofs()[k]] * marker.block().col(static_cast<Eigen::Index>(k));
  return {m.y.head<2>(), m.rate.head<2>(), acceleration.head<2>(), m.y.tail<2>()};
}

Wrench wrench_on(const Body& body, const VectorXd& force, const Vec3& about, const State& x) {
  const Element& element = *body.element;
  Wrench out;
  for (int k = 0; k < element.n_vectors(); ++k) {
    const int at = body.first_dof + element.dim() * k;
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

Wrench Workspace::joint_wrench(size_t joint, const std::string& name, const Vec3& about,
                               const State& x) {
  return wrench_on(body(name), joint_force(joint, x), about, x);
}

void Workspace::add_energies(const State& x, const Body& body, Energies& out) {
  Local local;
  for (int e = 0; e < body.element->n_elements(); ++e) {
    gather(body, e, x, local);
    for (const BodyTerm& term : body.terms) {
      const Energies of_term = term->energies(e, local);
      out.kinetic += of_term.kinetic;
      out.strain += of_term.strain;
      out.potential += of_term.potential;
    }
  }
}

Energies Workspace::energies(const State& x) {
  prepare(x);
  Energies out;
  for (const Body& b : bodies_) add_energies(x, b, out);
  for (const ModelForceElement& force_element : force_elements_) {
    const Energies of_link = force_element->energies(x);
    out.strain += of_link.strain;
    out.potential += of_link.potential;
  }
  return out;
}

Energies Workspace::energies(const State& x, const Body& body) {
  prepare(x);
  Energies out;
  add_energies(x, body, out);
  return out;
}

Vec3 Workspace::momentum(const State& x) {
  prepare(x);
  Vec3 out = Vec3::Zero();
  Local local;
  for (const Body& b : bodies_)
    for (int e = 0; e < b.element->n_elements(); ++e) {
      gather(b, e, x, local);
      for (const BodyTerm& term : b.terms) out += term->momentum(e, local);
    }
  return out;
}

void Workspace::follow_turns(State& x) const {
  const auto counts = [](const ModelForceElement& force_element) {
    return force_element.counts_turns();
  };
  VectorXd turned(std::count_if(force_elements_.begin(), force_elements_.end(), counts));
  Eigen::Index k = 0;
  for (const ModelForceElement& force_element : force_elements_)
    if (counts(force_element)) turned[k++] = force_element.turning->turned(x);
  x.turned = std::move(turned);
}

double Workspace::force_element_power(const State& x) {
  double out = 0;
  for (const ModelForceElement& force_element : force_elements_) out += force_element->power(x);
  return out;
}

template <class Wanted, class Amount>
double Workspace::summed(const State& x, Wanted wanted, Amount amount) {
  prepare(x);
  double out = 0;
  Local local;
  for (const Body& b : bodies_)
    for (const BodyTerm& term : b.terms) {
      if (!wanted(term)) continue;
      for (int e = 0; e < b.element->n_elements(); ++e) {
        gather(b, e, x, local);
        out += amount(term, e, local);
      }
    }
  return out;
}

double Workspace::heat_power(const State& x) {
  return summed(
      x, [](const BodyTerm& term) { return term.heated != nullptr; },
      [](const BodyTerm& term, int e, const Local& local) {
        return term.heated->heat_power(e, local);
      });
}

double Workspace::dissipation(const State& x) {
  return summed(
      x, [](const BodyTerm& term) { return term.dissipative != nullptr; },
      [](const BodyTerm& term, int e, const Local& local) {
        return term.dissipative->dissipation(e, local);
      });
}

double Workspace::load_power(const State& x) {
  return summed(
      x, [](const BodyTerm& term) { return term.load && !term.load->has_potential(); },
      [](const BodyTerm& term, int e, const Local& local) { return term.load->power(e, local); });
}

double Workspace::strain_energy(const State& x) {
  return summed(
      x, [](const BodyTerm& term) { return term.elastic != nullptr; },
      [](const BodyTerm& term, int e, const Local& local) {
        return term->strain_energy(e, local);
      });
}

double Workspace::flow_power(const State& x) {
  prepare(x);
  double out = 0;
  Local local;
  for (const Body& b : bodies_)
    for (int e = 0; e < b.element->n_elements(); ++e) {
      // Free lines are unknowns; therefore their motion causes no power at fixed unknowns.
      if (!b.element->moving(e) || !b.element->free_sides(e).empty()) continue;
      gather(b, e, x, local);
      for (const BodyTerm& term : b.terms)
        if (term.flow) out += term.flow->flow_power(e, local);
    }
  return out;
}

namespace {

/// Returns r_m × r_n in the plane (negative for an inverted element), |r_m × r_n| in space.
double area_ratio(const VectorXd& r_m, const VectorXd& r_n) {
  if (r_m.size() == 2) return r_m[0] * r_n[1] - r_m[1] * r_n[0];
  return r_m.head<3>().cross(r_n.head<3>()).norm();
}

}  // namespace

double Workspace::smallest_area_ratio(const State& x) {
  prepare(x);
  double smallest = std::numeric_limits<double>::infinity();
  Local local;
  ShapeTable table;
  for (const Body& b : bodies_) {
    if (!b.element->has_shapes()) continue;
    for (int e = 0; e < b.element->n_elements(); ++e) {
      gather(b, e, x, local);
      b.element->tabulate(e, 4, Tabulate::gradient, {}, ScaleFactorKind::none, table);
      if (table.N_m.size() == 0) continue;
      const MatrixXd r_m = table.N_m * local.q, r_n = table.N_n * local.q;
      for (Eigen::Index p = 0; p < r_m.rows(); ++p)
        smallest = std::min(smallest, area_ratio(r_m.row(p), r_n.row(p)));
    }
  }
  return smallest;
}

}  // namespace flexmorph::fem
