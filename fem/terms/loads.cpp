#include "fem/loads.h"

#include "fem/load_term.h"
#include "fem/terms/eulerian_work.h"

namespace flexmorph::fem {
namespace {

/// Weight of a body: f = -∫ ρh N dA gᵀ, potential V = -∫ ρh g·r dA.
class Gravity final : public LoadTerm,
                      public BatchTerm,
                      public LinearMeanForce<Gravity>,
                      public EulerianLineTerm,
                      public DesignedTerm,
                      public FlowTerm {
 public:
  Gravity(const PlaneSection& s, const LoadLaw& gravity)
      : LoadTerm(gravity),
        area_density_(s.density * s.thickness),
        of_free_(area_density_, load(), false) {}

  std::unique_ptr<Term> clone() const override { return std::make_unique<Gravity>(*this); }
  void prepare(const Element& element, const ScaleFactors& factors, bool all) override {
    if (!has_potential() && element.n_scalars() > 0)
      throw Error::input("gravity that varies cannot act on a body with free material lines");
    element_ = &element;
    factors_ = &factors;
    free_.prepare(element, 6, Tabulate::position, factors);
    mass_.resize(static_cast<size_t>(element.n_elements()));
    rate_.resize(mass_.size());
    ShapeTable table;
    for (int e = 0; e < element.n_elements(); ++e) {
      if ((!all && !element.moving(e)) || free_.has(e)) continue;
      element.tabulate(e, kDegree, Tabulate::position_rates, factors, ScaleFactorKind::mass, table);
      mass_[static_cast<size_t>(e)] = area_density_ * table.N.transpose() * table.weight;
      rate_[static_cast<size_t>(e)] =
          element.moving(e) ? VectorXd(area_density_ * table.N_t.transpose() * table.weight)
                            : VectorXd();
    }
  }
  void add_force(int e, const Local&, LocalRows& force) const override {
    force.noalias() -= factor() * mass_[static_cast<size_t>(e)] * load().transpose();
  }
  void add_tangent(int, const Local&, const Weights&, LocalTangent&) const override {}
  void add_forces(const Batch& x, Pack* force) const override {
    for (int k = 0; k < x.n_shapes; ++k) {
      Pack mass{};
      for (int lane = 0; lane < x.count; ++lane)
        mass[lane] = mass_[static_cast<size_t>(x.first + lane)][k];
      for (int c = 0; c < x.dim; ++c) force[x.dim * k + c] -= factor() * load()[c] * mass;
    }
  }
  void add_tangents(const Batch&, const Weights&, Pack*) const override {}

  void add_eulerian_force(int e, const Local& x, EulerianForce& force) const override {
    of_free_.add_force(free_.of(e), x, force);
  }
  void add_eulerian_tangent(int e, const Local& x, const Weights& w,
                            EulerianTangent& tangent) const override {
    of_free_.add_tangent(free_.of(e), x, w, tangent);
  }

  std::string name() const override { return "gravity"; }
  void add_scale_factor_gradient(int e, const Local&, const LocalRows& psi,
                                 ScaleFactorGradient& out) const override {
    const CellRange at = element_->cells(e, factors_->grid);
    if (psi.rows() == 4 && at.single()) {  // bilinear: a quarter of the weight at each corner
      out.mass[factors_->grid.cell(at.i0, at.j0)] -=
          0.25 * factor() * area_density_ * at.area * psi.colwise().sum().dot(load());
      return;
    }
    static thread_local ShapeTable t;
    element_->tabulate(e, kDegree, Tabulate::position, *factors_, ScaleFactorKind::mass, t);
    const VectorXd values = -factor() * area_density_ * t.N * (psi * load());
    element_->add_cell_integrals(e, kDegree, values, factors_->grid, out.mass);
  }
  Energies energies(int e, const Local& x) const override {
    if (!has_potential()) return {};
    if (free_.has(e)) return {.potential = of_free_.potential_energy(free_.of(e), x)};
    return {.potential = -factor() * mass_[static_cast<size_t>(e)].dot(x.q * load())};
  }
  double flow_power(int e, const Local& x) const override {
    if (!has_potential()) return 0;
    return -factor() * rate_[static_cast<size_t>(e)].dot(x.q * load());
  }
  void add_line_energy(std::span<const ShapeTable> line, const Local& x,
                       LineEnergy& out) const override {
    if (!has_potential()) return;
    for (size_t g = 0; g < line.size(); ++g)
      out.mass[static_cast<Eigen::Index>(g)] -=
          factor() * area_density_ * (line[g].N * x.q * load())(0);
  }
  void scale_load(double factor) override {
    LoadTerm::scale_load(factor);
    of_free_.set_gravity(factor * load());
  }

 private:
  static constexpr int kDegree = 3;  // polynomial degree of N
  const Element* element_ = nullptr;
  const ScaleFactors* factors_ = nullptr;
  double area_density_;
  EulerianInertia of_free_;
  EulerianTables free_;
  std::vector<VectorXd> mass_, rate_;  // ∫ρh N, ∫ρh Ṅ per element (n_shapes)
};

/// Mass at a material point: f = m N (r̈ - g)ᵀ with the material acceleration r̈ of the body.
class PointMass final : public LoadTerm,
                        public BatchTerm,
                        public LinearMeanForce<PointMass>,
                        public EulerianLineTerm,
                        public FlowTerm {
 public:
  PointMass(double mass, const Vec2& material, const LoadLaw& gravity)
      : LoadTerm(gravity), mass_(mass), material_(material) {}

  std::unique_ptr<Term> clone() const override { return std::make_unique<PointMass>(*this); }
  void prepare(const Element& element, const ScaleFactors&, bool) override {
    element_ = element.locate(material_, Tabulate::position_rates, table_);
    flows_ = table_.N_t.size() > 0;
    if (!element.free_sides(element_).empty()) check_fixed(element, element_, material_);
  }
  void add_force(int e, const Local& x, LocalRows& force) const override {
    if (e != element_) return;
    force.noalias() += mass_ * table_.N.transpose() * felt_acceleration(x);
  }
  void add_tangent(int e, const Local& x, const Weights& w, LocalTangent& tangent) const override {
    if (e != element_) return;
    Eigen::RowVectorXd row = w.a * table_.N;
    if (flows_) row += 2 * w.v * table_.N_t + w.q * table_.N_tt;
    const auto d = x.q.cols();
    for (Eigen::Index k = 0; k < row.size(); ++k)
      for (Eigen::Index l = 0; l < row.size(); ++l)
        for (Eigen::Index c = 0; c < d; ++c)
          tangent(d * k + c, d * l + c) += mass_ * table_.N(0, k) * row[l];
  }
  // Only one element carries the mass.
  void add_forces(const Batch& x, Pack* force) const override {
    if (is_in(x)) add_force_of_lane(*this, x, element_ - x.first, force);
  }
  void add_tangents(const Batch& x, const Weights& w, Pack* tangent) const override {
    if (is_in(x)) add_tangent_of_lane(*this, x, element_ - x.first, w, tangent);
  }
  std::string name() const override { return "point mass"; }
  void add_eulerian_force(int e, const Local& x, EulerianForce& force) const override {
    LocalRows rows = LocalRows::Zero(x.q.rows(), x.q.cols());
    add_force(e, x, rows);
    force.head(rows.size()) += Eigen::Map<const VectorXd>(rows.data(), rows.size());
  }
  void add_eulerian_tangent(int e, const Local& x, const Weights& w,
                            EulerianTangent& tangent) const override {
    LocalTangent rows = LocalTangent::Zero(x.q.size(), x.q.size());
    add_tangent(e, x, w, rows);
    tangent.topLeftCorner(x.q.size(), x.q.size()) += rows;
  }
  Energies energies(int e, const Local& x) const override {
    Energies out;
    if (e != element_) return out;
    Eigen::RowVectorXd velocity = table_.N * x.v;
    if (flows_) velocity += table_.N_t * x.q;
    out.kinetic = 0.5 * mass_ * velocity.squaredNorm();
    if (load().size() > 0 && has_potential())
      out.potential = -factor() * mass_ * (table_.N * x.q * load())(0);
    return out;
  }
  double flow_power(int e, const Local& x) const override {
    if (e != element_ || !flows_) return 0;
    // A varying weight has no potential that moves with the material.
    const Eigen::RowVectorXd a = has_potential() ? felt_acceleration(x) : acceleration(x);
    return mass_ * (table_.N_t * x.q * a.transpose())(0);
  }

 private:
  void add_load(int e, const Local&, LocalRows& force) const override {
    if (e == element_)
      force.noalias() -= factor() * mass_ * table_.N.transpose() * load().transpose();
  }

  bool is_in(const Batch& x) const { return element_ >= x.first && element_ < x.first + x.count; }

  Eigen::RowVectorXd acceleration(const Local& x) const {
    Eigen::RowVectorXd out = table_.N * x.a;
    if (flows_) out += 2 * table_.N_t * x.v + table_.N_tt * x.q;
    return out;
  }
  Eigen::RowVectorXd felt_acceleration(const Local& x) const {
    Eigen::RowVectorXd out = acceleration(x);
    if (load().size() > 0) out -= factor() * load().transpose();
    return out;
  }

  double mass_;
  Vec2 material_;
  int element_ = -1;
  bool flows_ = false;
  ShapeTable table_;
};

}  // namespace

std::unique_ptr<Term> make_gravity(const PlaneSection& section, const LoadLaw& gravity) {
  return std::make_unique<Gravity>(section, gravity);
}

std::unique_ptr<Term> make_point_mass(double mass, const Vec2& material, const LoadLaw& gravity) {
  return std::make_unique<PointMass>(mass, material, gravity);
}

}  // namespace flexmorph::fem
