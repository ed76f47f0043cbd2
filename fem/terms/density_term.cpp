#include "fem/terms/density_term.h"

#include "fem/terms/strain_field.h"
#include "fem/terms/strain_flow.h"

namespace flexmorph::fem {
namespace {

/// Returns the work space of the thread, which is too large for its stack.
StrainField& field() {
  static thread_local StrainField room;
  return room;
}

/// Returns ∫ s · ∂e/∂t dA at fixed unknowns, with stresses times the weights of their points.
double power_of_flow(StrainField& at, const MatrixXd& stress, const LocalRows& q) {
  at.set_rate(q, LocalRows::Zero(q.rows(), q.cols()));
  return stress.cwiseProduct(at.rate()).sum();
}

}  // namespace

void ElasticTerm::prepare_parts(const Element& element, const ScaleFactors& factors) {
  element_ = &element;
  factors_ = &factors;
  gradient_.prepare(element);
  free_.clear();
  if (element.n_scalars() == 0) return;
  free_.resize(parts_.size());
  for (size_t i = 0; i < parts_.size(); ++i) {
    const StrainSampling& sampling = *parts_[i].sampling;
    if (!sampling.is_pointwise())
      throw Error::input("term '" + name_ + "' does not support free material lines");
    free_[i].prepare(element, sampling.degree(), sampling.what(), factors);
  }
}

void ElasticTerm::add_eulerian_force(int e, const Local& x, EulerianForce& force) const {
  for (size_t i = 0; i < free_.size(); ++i)
    EulerianElastic(*parts_[i].density, free_[i].of(e)).add_force(x.q, force);
}

void ElasticTerm::add_eulerian_tangent(int e, const Local& x, const Weights& w,
                                       EulerianTangent& tangent) const {
  if (w.q == 0) return;
  for (size_t i = 0; i < free_.size(); ++i)
    EulerianElastic(*parts_[i].density, free_[i].of(e)).add_tangent(x.q, w.q, tangent);
}

void ElasticTerm::add_mean_force(int e, const LocalStep& x, LocalRows& force) const {
  gradient_.add_force(*this, e, x, force);
}

void ElasticTerm::add_mean_tangent(int e, const LocalStep& x, const Weights& w,
                                   LocalTangent& tangent) const {
  gradient_.add_tangent(*this, e, x, w, tangent);
}

Energies ElasticTerm::energies(int e, const Local& x) const {
  Energies out;
  if (!is_free(e)) {
    out.strain = energy_at(e, x);
    return out;
  }
  for (size_t i = 0; i < free_.size(); ++i)
    out.strain += EulerianElastic(*parts_[i].density, free_[i].of(e)).energy(x.q);
  return out;
}

double ElasticTerm::flow_power(int e, const Local& x) const {
  double out = 0;
  StrainTable table;
  for (const ElasticPart& part : parts_) {
    if (part.sampling->is_pointwise()) {
      ShapeTable t;
      const bool bends = part.sampling->what() == Tabulate::curvature;
      element_->tabulate(e, part.sampling->degree(),
                         bends ? Tabulate::curvature_rates : Tabulate::gradient_rates, *factors_,
                         ScaleFactorKind::stiffness, t);
      out += fem::flow_power(*part.density, t, x.q);
      continue;
    }
    part.sampling->tabulate({*element_, *factors_, element_->reference()}, e, table);
    StrainField& at = field();
    at.set(part.density->strain(), table, x.q);
    MatrixXd stress(at.strain().rows(), at.strain().cols());
    StrainVector s;
    for (Eigen::Index p = 0; p < stress.cols(); ++p) {
      part.density->of_strain(at.strain().col(p), &s, nullptr);
      stress.col(p) = table.weight[p] * s;
    }
    out += power_of_flow(at, stress, x.q);
  }
  return out;
}

namespace {

/// Computes in field() the strains of an element at the points at which cells are integrated.
StrainTable& strains_at_points(const StrainSampling& sampling, const StrainMeasure& measure,
                               const StrainSource& from, int e, const LocalRows& q) {
  static thread_local StrainTable table;
  if (!sampling.is_pointwise())
    throw Error::input(
        "assumed strains have no derivatives with respect to the scale factors of cells");
  sampling.tabulate(from, e, table);
  table.rate.clear();  // rates at fixed points contain no flow
  field().set(measure, table, q);
  return table;
}

}  // namespace

void ElasticTerm::add_scale_factor_gradient(int e, const Local& x, const LocalRows& psi,
                                            ScaleFactorGradient& out) const {
  const StrainSource from{*element_, *factors_, {}};
  StrainVector s;
  for (const ElasticPart& part : parts_) {
    strains_at_points(*part.sampling, part.density->strain(), from, e, x.q);
    StrainField& at = field();
    at.set_rate(x.q, psi);
    VectorXd values(at.strain().cols());
    for (Eigen::Index p = 0; p < values.size(); ++p) {
      part.density->of_strain(at.strain().col(p), &s, nullptr);
      values[p] = s.dot(at.rate().col(p));
    }
    element_->add_cell_integrals(e, part.sampling->degree(), values, factors_->grid, out.stiffness);
  }
}

void ElasticTerm::add_energy_gradient(int e, const Local& x, double weight,
                                      ScaleFactorGradient& out) const {
  const StrainSource from{*element_, *factors_, {}};
  for (const ElasticPart& part : parts_) {
    strains_at_points(*part.sampling, part.density->strain(), from, e, x.q);
    const MatrixXd& strain = field().strain();
    VectorXd values(strain.cols());
    for (Eigen::Index p = 0; p < values.size(); ++p)
      values[p] = weight * part.density->of_strain(strain.col(p), nullptr, nullptr);
    element_->add_cell_integrals(e, part.sampling->degree(), values, factors_->grid, out.stiffness);
  }
}

void ElasticTerm::add_line_energy(std::span<const ShapeTable> line, const Local& x,
                                  LineEnergy& out) const {
  for (const ElasticPart& part : parts_) {
    if (part.sampling->is_pointwise()) {
      fem::add_line_energy(*part.density, line, x.q, out.stiffness);
      continue;
    }
    MatrixXd strains = strains_on_line(part.density->strain(), line, x.q);
    part.sampling->along_line(strains);
    for (Eigen::Index g = 0; g < strains.rows(); ++g)
      out.stiffness[g] += part.density->of_strain(strains.row(g).transpose(), nullptr, nullptr);
  }
}

void StrainTables::prepare(const Element& element, const ScaleFactors& factors, bool all,
                           std::span<const std::shared_ptr<const StrainSampling>> samplings) {
  tables_.resize(samplings.size());
  const StrainSource from{element, factors, element.reference()};
  for (size_t i = 0; i < samplings.size(); ++i) {
    tables_[i].resize(static_cast<size_t>(element.n_elements()));
    for (int e = 0; e < element.n_elements(); ++e)
      if ((all || element.moving(e)) && element.free_sides(e).empty())
        samplings[i]->tabulate(from, e, tables_[i][static_cast<size_t>(e)]);
  }
}

namespace {

template <class Density>
std::vector<std::shared_ptr<const StrainSampling>> samplings_of(
    const std::vector<Sampled<Density>>& parts) {
  std::vector<std::shared_ptr<const StrainSampling>> out;
  for (const auto& part : parts) out.push_back(part.sampling);
  return out;
}

class Elastic final : public ElasticTerm {
 public:
  Elastic(std::string name, std::vector<ElasticPart> parts)
      : ElasticTerm(std::move(name), std::move(parts)) {}
  std::unique_ptr<Term> clone() const override { return make_elastic_term(name(), parts()); }

  void prepare(const Element& element, const ScaleFactors& factors, bool all) override {
    prepare_parts(element, factors);
    tables_.prepare(element, factors, all, samplings_of(parts()));
  }

  void add_force(int e, const Local& x, LocalRows& force) const override {
    for (size_t i = 0; i < parts().size(); ++i) {
      const Stressed& at = stressed(i, e, x.q, false);
      field().add_force(at.stress, force);
    }
  }

  void add_tangent(int e, const Local& x, const Weights& w, LocalTangent& tangent) const override {
    if (w.q == 0) return;
    for (size_t i = 0; i < parts().size(); ++i) {
      Stressed& at = stressed(i, e, x.q, true);
      StrainField& strains = field();
      const MatrixXd& B = strains.variation();
      const Eigen::Index n = at.stress.cols();
      at.change.setZero(B.rows(), B.cols());
      for (Eigen::Index r = 0; r < at.stress.rows(); ++r)
        for (Eigen::Index c = 0; c < at.stress.rows(); ++c)
          for (Eigen::Index p = 0; p < n; ++p)
            if (const double d = at.stiffness[static_cast<size_t>(p)](r, c); d != 0)
              at.change.row(n * r + p) += w.q * d * B.row(n * c + p);
      tangent.noalias() += B.transpose() * at.change;
      strains.add_second(at.stress, w.q, tangent);
    }
  }

 private:
  /// Stresses at all points, times weights.
  struct Stressed {
    double energy = 0;
    MatrixXd stress, change;  // stresses, and their change in the tangent
    std::vector<StrainSquare> stiffness;
  };

  /// Evaluates the stresses of an element and a density; the strains remain in field(). The result
  /// belongs to the thread.
  Stressed& stressed(size_t part, int e, const LocalRows& q, bool derive) const {
    static thread_local Stressed out;
    const StrainDensity& density = *parts()[part].density;
    const StrainTable& table = tables_.of(part, e);
    field().set(density.strain(), table, q);
    const MatrixXd& strain = field().strain();
    out.energy = 0;
    out.stress.resize(strain.rows(), strain.cols());
    out.stiffness.resize(static_cast<size_t>(strain.cols()));
    StrainVector s;
    for (Eigen::Index p = 0; p < strain.cols(); ++p) {
      StrainSquare* by_strain = derive ? &out.stiffness[static_cast<size_t>(p)] : nullptr;
      out.energy += table.weight[p] * density.of_strain(strain.col(p), &s, by_strain);
      out.stress.col(p) = table.weight[p] * s;
      if (derive) *by_strain *= table.weight[p];
    }
    return out;
  }

  double energy_at(int e, const Local& x) const override {
    double out = 0;
    for (size_t i = 0; i < parts().size(); ++i) out += stressed(i, e, x.q, false).energy;
    return out;
  }

  StrainTables tables_;
};

class Dissipative final : public StrainTerm,
                          public LinearMeanForce<Dissipative>,
                          public DesignedTerm,
                          public DissipativeTerm,
                          public FlowTerm {
 public:
  Dissipative(std::string name, std::vector<DissipativePart> parts)
      : name_(std::move(name)), parts_(std::move(parts)) {}
  std::unique_ptr<Term> clone() const override { return make_dissipative_term(name_, parts_); }
  std::string name() const override { return name_; }

  void prepare(const Element& element, const ScaleFactors& factors, bool all) override {
    if (element.n_scalars() > 0)
      throw Error::input("term '" + name_ + "' does not support free material lines");
    element_ = &element;
    factors_ = &factors;
    tables_.prepare(element, factors, all, samplings_of(parts_));
  }

  void add_force(int e, const Local& x, LocalRows& force) const override {
    for (size_t i = 0; i < parts_.size(); ++i) {
      const Stressed& at = stressed(i, e, x, false);
      field().add_force(at.stress, force);
    }
  }

  void add_tangent(int e, const Local& x, const Weights& w, LocalTangent& tangent) const override {
    if (w.q == 0 && w.v == 0) return;
    for (size_t i = 0; i < parts_.size(); ++i) {
      Stressed& at = stressed(i, e, x, true);
      StrainField& strains = field();
      const MatrixXd &B = strains.variation(), &R = strains.rate_variation(w);
      const Eigen::Index n = at.stress.cols();
      at.change.setZero(B.rows(), B.cols());
      for (Eigen::Index r = 0; r < at.stress.rows(); ++r)
        for (Eigen::Index c = 0; c < at.stress.rows(); ++c)
          for (Eigen::Index p = 0; p < n; ++p) {
            const auto at_p = static_cast<size_t>(p);
            if (const double d = at.by_strain[at_p](r, c); d != 0)
              at.change.row(n * r + p) += w.q * d * B.row(n * c + p);
            if (const double d = at.by_rate[at_p](r, c); d != 0)
              at.change.row(n * r + p) += d * R.row(n * c + p);
          }
      tangent.noalias() += B.transpose() * at.change;
      if (w.q != 0) strains.add_second(at.stress, w.q, tangent);
    }
  }

  void add_scale_factor_gradient(int e, const Local& x, const LocalRows& psi,
                                 ScaleFactorGradient& out) const override {
    const StrainSource from{*element_, *factors_, {}};
    StrainVector s;
    for (const DissipativePart& part : parts_) {
      if (!part.sampling->is_pointwise())
        throw Error::input(
            "assumed strains have no derivatives with respect to the scale factors of cells");
      StrainTable table;
      part.sampling->tabulate(from, e, table);
      StrainField& at = field();
      at.set(part.density->strain(), table, x.q);
      at.set_rate(x.q, x.v);
      MatrixXd stress(at.strain().rows(), at.strain().cols());
      for (Eigen::Index p = 0; p < stress.cols(); ++p) {
        part.density->stress(at.strain().col(p), at.rate().col(p), s, nullptr, nullptr);
        stress.col(p) = s;
      }
      table.rate.clear();
      at.set_rate(x.q, psi);
      const VectorXd values = stress.cwiseProduct(at.rate()).colwise().sum().transpose();
      element_->add_cell_integrals(e, part.sampling->degree(), values, factors_->grid,
                                   out.stiffness);
    }
  }

  double dissipation(int e, const Local& x) const override {
    double out = 0;
    for (size_t i = 0; i < parts_.size(); ++i) out += stressed(i, e, x, false).power;
    return out;
  }

  double flow_power(int e, const Local& x) const override {
    double out = 0;
    for (size_t i = 0; i < parts_.size(); ++i) {
      const Stressed& at = stressed(i, e, x, false);
      out += power_of_flow(field(), at.stress, x.q);
    }
    return out;
  }

 private:
  /// Stresses at all points, times weights.
  struct Stressed {
    double power = 0;
    MatrixXd stress, change;  // stresses, and their change in the tangent
    std::vector<StrainSquare> by_strain, by_rate;
  };

  /// Evaluates the stresses of an element and a density; strains and rates remain in field(). The
  /// result belongs to the thread.
  Stressed& stressed(size_t part, int e, const Local& x, bool derive) const {
    static thread_local Stressed out;
    const DissipationDensity& density = *parts_[part].density;
    const StrainTable& table = tables_.of(part, e);
    StrainField& strains = field();
    strains.set(density.strain(), table, x.q);
    strains.set_rate(x.q, x.v);
    const MatrixXd &strain = strains.strain(), &rate = strains.rate();
    out.power = 0;
    out.stress.resize(strain.rows(), strain.cols());
    out.by_strain.resize(static_cast<size_t>(strain.cols()));
    out.by_rate.resize(static_cast<size_t>(strain.cols()));
    StrainVector s;
    for (Eigen::Index p = 0; p < strain.cols(); ++p) {
      StrainSquare &by_strain = out.by_strain[static_cast<size_t>(p)],
                   &by_rate = out.by_rate[static_cast<size_t>(p)];
      density.stress(strain.col(p), rate.col(p), s, derive ? &by_strain : nullptr,
                     derive ? &by_rate : nullptr);
      out.stress.col(p) = table.weight[p] * s;
      out.power += out.stress.col(p).dot(rate.col(p));
      if (!derive) continue;
      by_strain *= table.weight[p];
      by_rate *= table.weight[p];
    }
    return out;
  }

  std::string name_;
  std::vector<DissipativePart> parts_;
  const Element* element_ = nullptr;
  const ScaleFactors* factors_ = nullptr;
  StrainTables tables_;
};

}  // namespace

std::unique_ptr<StrainTerm> make_elastic_term(std::string name, std::vector<ElasticPart> parts) {
  return std::make_unique<Elastic>(std::move(name), std::move(parts));
}

std::unique_ptr<StrainTerm> make_dissipative_term(std::string name,
                                                  std::vector<DissipativePart> parts) {
  return std::make_unique<Dissipative>(std::move(name), std::move(parts));
}

}  // namespace flexmorph::fem
