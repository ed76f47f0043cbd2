#include "fem/load_term.h"
#include "fem/loads.h"
#include "fem/terms/eulerian_work.h"

namespace flexmorph::fem {
namespace {

/// Loads of fixed direction; their generalized force does not depend on the shape of the body.
class DeadLoad : public LoadTerm, public LinearMeanForce<DeadLoad>, public EulerianLineTerm {
 public:
  explicit DeadLoad(const LoadLaw& load) : LoadTerm(load) {}

  void add_force(int e, const Local&, LocalRows& force) const override {
    const VectorXd& share = share_[static_cast<size_t>(e)];
    if (share.size() > 0) force.noalias() -= factor() * share * load().transpose();
  }
  void add_tangent(int, const Local&, const Weights&, LocalTangent&) const override {}
  void add_eulerian_force(int e, const Local& x, EulerianForce& force) const override {
    LocalRows rows = LocalRows::Zero(x.q.rows(), x.q.cols());
    add_force(e, x, rows);
    force.head(rows.size()) += Eigen::Map<const VectorXd>(rows.data(), rows.size());
  }
  void add_eulerian_tangent(int, const Local&, const Weights&, EulerianTangent&) const override {}

  std::string name() const override { return "dead load"; }
  Energies energies(int e, const Local& x) const override {
    const VectorXd& share = share_[static_cast<size_t>(e)];
    if (share.size() == 0 || !has_potential()) return {};
    return {.potential = -factor() * share.dot(x.q * load())};
  }

 protected:
  void check(const Element& element, const std::string& what) const {
    if (load().size() != element.dim())
      throw Error::input(what + ": " + std::to_string(load().size()) +
                         " components are given, but the body has " +
                         std::to_string(element.dim()) + " dimensions");
  }
  /// Adds weight · N at a material point.
  void add_point(const Element& element, const Vec2& material, double weight) {
    const int e = element.locate(material, Tabulate::position_rates, table_);
    // Material flow through the point would do work that no energy balance contains.
    if (!element.free_sides(e).empty())
      check_fixed(element, e, material);
    else if (table_.N_t.size() > 0)
      throw Error::input("a load cannot act on an element whose material lines move");
    VectorXd& share = share_[static_cast<size_t>(e)];
    if (share.size() == 0) share.setZero(element.n_shapes());
    share += weight * table_.N.row(0).transpose();
  }

  std::vector<VectorXd> share_;  // ∫ N per element (n_shapes), or empty: not loaded
  ShapeTable table_;
};

class PointForce final : public DeadLoad {
 public:
  PointForce(const Vec2& material, const LoadLaw& force) : DeadLoad(force), material_(material) {}
  std::unique_ptr<Term> clone() const override { return std::make_unique<PointForce>(*this); }
  void prepare(const Element& element, const ScaleFactors&, bool all) override {
    if (!all) return;  // only elements whose lines do not move are loaded
    check(element, "point force");
    share_.assign(static_cast<size_t>(element.n_elements()), {});
    add_point(element, material_, 1);
  }

 private:
  Vec2 material_;
};

class EdgeLoad final : public DeadLoad {
 public:
  EdgeLoad(std::string edge, const LoadLaw& load) : DeadLoad(load), edge_(std::move(edge)) {}
  std::unique_ptr<Term> clone() const override { return std::make_unique<EdgeLoad>(*this); }
  void prepare(const Element& element, const ScaleFactors&, bool all) override {
    if (!all) return;  // only elements whose lines do not move are loaded
    check(element, "load of edge '" + edge_ + "'");
    share_.assign(static_cast<size_t>(element.n_elements()), {});
    const std::vector<NodeVectors> nodes = element.edge(edge_);
    if (nodes.size() == 1)
      throw Error::input("load of edge '" + edge_ +
                         "': the end of a beam is one node; use a point force for it, or a surface "
                         "load [N/m²] for the whole beam");
    const GaussRule& rule = gauss(2);  // exact for the cubic N
    for (size_t i = 0; i + 1 < nodes.size(); ++i) {
      const Vec2 from = nodes[i].material, along = nodes[i + 1].material - from;
      for (size_t g = 0; g < 2; ++g)
        add_point(element, from + rule.points[g] * along, rule.weights[g] * along.norm());
    }
  }

 private:
  std::string edge_;
};

class SurfaceLoad final : public DeadLoad, public FlowTerm {
 public:
  using DeadLoad::DeadLoad;
  std::unique_ptr<Term> clone() const override { return std::make_unique<SurfaceLoad>(*this); }
  void prepare(const Element& element, const ScaleFactors&, bool all) override {
    check(element, "surface load");
    if (element.n_scalars() > 0)
      throw Error::input("a surface load cannot act on a body with free material lines");
    share_.resize(static_cast<size_t>(element.n_elements()));
    rate_.resize(share_.size());
    for (int e = 0; e < element.n_elements(); ++e) {
      if (!all && !element.moving(e)) continue;
      element.tabulate(e, 3, Tabulate::position_rates, {}, ScaleFactorKind::none, table_);
      share_[static_cast<size_t>(e)] = table_.N.transpose() * table_.weight;
      rate_[static_cast<size_t>(e)] =
          table_.N_t.size() > 0 ? VectorXd(table_.N_t.transpose() * table_.weight) : VectorXd();
    }
  }
  double flow_power(int e, const Local& x) const override {
    const VectorXd& rate = rate_[static_cast<size_t>(e)];
    return rate.size() > 0 && has_potential() ? -factor() * rate.dot(x.q * load()) : 0;
  }

  void add_line_energy(std::span<const ShapeTable> line, const Local& x,
                       LineEnergy& out) const override {
    if (!has_potential()) return;
    for (size_t g = 0; g < line.size(); ++g)
      out.none[static_cast<Eigen::Index>(g)] -= factor() * (line[g].N * x.q * load())(0);
  }

 private:
  std::vector<VectorXd> rate_;  // ∫ Ṅ per element whose lines move
};

}  // namespace

std::unique_ptr<Term> make_point_force(const Vec2& material, const LoadLaw& force) {
  return std::make_unique<PointForce>(material, force);
}

std::unique_ptr<Term> make_edge_load(const std::string& edge, const LoadLaw& load) {
  return std::make_unique<EdgeLoad>(edge, load);
}

std::unique_ptr<Term> make_surface_load(const LoadLaw& load) {
  return std::make_unique<SurfaceLoad>(load);
}

}  // namespace flexmorph::fem
