#include <algorithm>
#include <array>
#include <memory>

#include "fem/terms.h"
#include "fem/terms/bending_kernels.h"
#include "fem/terms/density_term.h"
#include "fem/terms/sampling.h"

namespace flexmorph::fem {
namespace {

using Mat3 = Eigen::Matrix3d;

/// Returns D = c³/12 C [N m].
Mat3 stiffness_of(const PlaneSection& s) {
  return s.thickness * s.thickness * s.thickness / 12 * s.elasticity();
}

/// Energy density W = ½ κᵀ D κ in closed form.
class BendingDensity final : public LinearDensity {
 public:
  explicit BendingDensity(const Mat3& stiffness)
      : LinearDensity(plate_curvature(), stiffness), stiffness_(stiffness) {}
  double energy(const Measures& z, Measures* gradient, MeasureHessian* hessian) const override {
    using namespace bending;
    Vec<double> y[kVectors];
    for (int v = 0; v < kVectors; ++v)
      for (int c = 0; c < 3; ++c) y[v][c] = z(v, c);
    const Point<double> point(y, stiffness_, 1);
    if (gradient) {
      point.force(y);
      gradient->resize(kVectors, 3);
      for (int v = 0; v < kVectors; ++v)
        for (int c = 0; c < 3; ++c) (*gradient)(v, c) = y[v][c];
    }
    if (hessian) {
      Hessian<double> h;
      point.tangent(h);
      hessian->resize(3 * kVectors, 3 * kVectors);
      for (int v = 0; v < 3 * kVectors; ++v)
        for (int w = 0; w < 3 * kVectors; ++w)
          (*hessian)(v, w) = h.at[v / 3][w / 3][3 * (v % 3) + w % 3];
    }
    return point.energy();
  }

 private:
  Mat3 stiffness_;
};

/// Bending of a thin plate in space.
///
///   U = ½ ∫ κᵀ D κ dA,   κ = (r_mm·n, r_nn·n, 2 r_mn·n)/|n|³,   n = r_m × r_n       P (7)
///   D = c³/12 C [N m],   C plane stress in Voigt order 11, 22, 12
///
/// κ is a rational function of the unknowns and is therefore integrated at Gauss points. Neighbours
/// of equal size and material share tables of shape functions.
///
/// Source: P (7); fem/README.md, Bending.
class Bending final : public ElasticTerm, public BatchTerm {
 public:
  Bending(const PlaneSection& s, int n_points)
      : ElasticTerm("bending", parts_of(s, n_points)),
        section_(s),
        stiffness_(stiffness_of(s)),
        degree_(degree_of(n_points)) {}

  static int degree_of(int n_points) { return 2 * n_points - 2; }
  static std::vector<ElasticPart> parts_of(const PlaneSection& s, int n_points) {
    return {{std::make_shared<BendingDensity>(stiffness_of(s)),
             sample_points(degree_of(n_points), Tabulate::curvature)}};
  }

  /// Creates an unprepared term, because prepared data would be recomputed anyway.
  std::unique_ptr<Term> clone() const override { return make_bending(section_, degree_ / 2 + 1); }
  void prepare(const Element& element, const ScaleFactors& factors, bool all) override {
    if (element.dim() != 3) throw Error::input("term 'bending' needs a three-dimensional body");
    prepare_parts(element, factors);
    tables_.resize(static_cast<size_t>(element.n_elements()));
    int tabulated = -1;  // element of the last table
    for (int e = 0; e < element.n_elements(); ++e) {
      if ((!all && !element.moving(e)) || is_free(e)) continue;
      std::shared_ptr<Table> table = tabulate(element, e, factors);
      const bool same = tabulated >= 0 && tabulated == e - 1 &&
                        equal(*table, *tables_[static_cast<size_t>(e - 1)]);
      tables_[static_cast<size_t>(e)] = same ? tables_[static_cast<size_t>(e - 1)] : table;
      tabulated = e;
    }
    if (element.n_scalars() > 0) return;  // evaluated one by one, without batches
    batches_.resize((tables_.size() + kLanes - 1) / kLanes);
    for (size_t b = 0; b < batches_.size(); ++b) side_by_side(element, b, all);
  }

  void add_force(int e, const Local& x, LocalRows& force) const override {
    dispatch([&]<bool kMixed>() {
      bending::add_force<kMixed>(view(*tables_[static_cast<size_t>(e)]), value_indices_, stiffness_,
                                 x.q.data(), force.data());
    });
  }

  void add_tangent(int e, const Local& x, const Weights& w, LocalTangent& tangent) const override {
    if (w.q == 0) return;
    dispatch([&]<bool kMixed>() {
      bending::add_tangent<kMixed>(view(*tables_[static_cast<size_t>(e)]), value_indices_,
                                   w.q * stiffness_, x.q.data(), work<double>(), tangent.data());
    });
  }

  void add_forces(const Batch& x, Pack* force) const override {
    run_batch_kernel([&]<class V>() {
      of_batch<V>(x, [&]<bool kMixed>(const auto& table) {
        bending::add_force<kMixed>(table, value_indices_, stiffness_, packs_as<V>(x.q),
                                   packs_as<V>(force));
      });
    });
  }

  void add_tangents(const Batch& x, const Weights& w, Pack* tangent) const override {
    if (w.q == 0) return;
    run_batch_kernel([&]<class V>() {
      of_batch<V>(x, [&]<bool kMixed>(const auto& table) {
        bending::add_tangent<kMixed>(table, value_indices_, w.q * stiffness_, packs_as<V>(x.q),
                                     work<V>(), packs_as<V>(tangent));
      });
    });
  }

 private:
  using Table = bending::Table<double>;

  double energy_at(int e, const Local& x) const override {
    double out = 0;
    dispatch([&]<bool kMixed>() {
      out = bending::energy<kMixed>(view(*tables_[static_cast<size_t>(e)]), value_indices_,
                                    stiffness_, x.q.data());
    });
    return out;
  }

  /// Tables of eight elements: one for all, or a separate one for each, side by side.
  struct BatchTables {
    std::shared_ptr<const Table> shared;
    bending::Table<Pack> different;
  };

  /// Calls f<has mixed derivatives>().
  template <class F>
  void dispatch(const F& f) const {
    mixed_ ? f.template operator()<true>() : f.template operator()<false>();
  }

  template <class V, class F>
  void of_batch(const Batch& x, const F& f) const {
    const BatchTables& batch = batches_[static_cast<size_t>(x.first / kLanes)];
    const bending::Table<Pack>& own = batch.different;
    dispatch([&]<bool kMixed>() {
      if (batch.shared)
        f.template operator()<kMixed>(view(*batch.shared));
      else
        f.template operator()<kMixed>(bending::TableView<V>{own.n, packs_as<V>(own.m.data()),
                                                            packs_as<V>(own.across.data()),
                                                            packs_as<V>(own.weight.data())});
    });
  }

  /// Returns the work space of the thread, which is too large for its stack.
  template <class V>
  static bending::TangentWork<V>& work() {
    static thread_local bending::TangentWork<V> room;
    return room;
  }

  std::shared_ptr<Table> tabulate(const Element& element, int e, const ScaleFactors& factors) {
    products_.curvature = true;
    if (!element.tabulate_products(e, degree_, factors, ScaleFactorKind::stiffness, products_) ||
        products_.dd_m.size() == 0 || !number())
      throw Error::input(
          "term 'bending' needs shape functions that are products of cubic functions along m and "
          "n, and their second derivatives");
    const auto line = [](const MatrixXd& f, const MatrixXd& d, const MatrixXd& dd) {
      std::vector<double> out;
      for (Eigen::Index g = 0; g < f.rows(); ++g)
        for (const MatrixXd* order : {&f, &d, &dd})
          for (Eigen::Index i = 0; i < bending::kFunctions; ++i) out.push_back((*order)(g, i));
      return out;
    };
    const auto n = products_.weight.rows();
    auto out = std::make_shared<Table>();
    out->n = static_cast<int>(n);
    out->m = line(products_.f_m, products_.d_m, products_.dd_m);
    out->across = line(products_.f_n, products_.d_n, products_.dd_n);
    for (Eigen::Index g = 0; g < n; ++g)
      for (Eigen::Index h = 0; h < n; ++h) out->weight.push_back(products_.weight(g, h));
    return out;
  }

  /// Finds the unknown that belongs to each product; false where the shape functions are not those
  /// of h12 or h16.
  bool number() {
    value_indices_.fill(-1);
    const size_t n_shapes = products_.function_m.size();
    mixed_ = n_shapes == value_indices_.size();
    for (size_t k = 0; k < n_shapes; ++k) {
      const int i = products_.function_m[k], j = products_.function_n[k];
      if (!mixed_ && i % 2 == 1 && j % 2 == 1) return false;
      value_indices_[static_cast<size_t>(bending::kFunctions * j + i)] = static_cast<int>(k);
    }
    return products_.weight.rows() <= bending::kMaxLine && (mixed_ || n_shapes == 12);
  }

  static bool equal(const Table& x, const Table& y) {
    const auto close = [](const std::vector<double>& a, const std::vector<double>& b) {
      const auto map = [](const std::vector<double>& v) {
        return Eigen::Map<const VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
      };
      return a.size() == b.size() && map(a).isApprox(map(b), 1e-13);
    };
    return close(x.weight, y.weight) && close(x.m, y.m) && close(x.across, y.across);
  }

  void side_by_side(const Element& element, size_t b, bool all) {
    const int first = static_cast<int>(b) * kLanes,
              last = std::min(first + kLanes, element.n_elements());
    bool changes = all;
    for (int e = first; e < last; ++e) changes |= element.moving(e);
    if (!changes) return;
    BatchTables& out = batches_[b];
    const auto begin = tables_.begin() + first, end = tables_.begin() + last;
    const bool alike = std::all_of(begin, end, [&](const auto& t) { return t == *begin; });
    out.shared = alike ? *begin : nullptr;
    if (alike) return;
    out.different.n = (*begin)->n;
    const auto spread = [&](std::vector<double> Table::*from, std::vector<Pack>& to) {
      to.resize(((**begin).*from).size());
      for (int lane = 0; lane < kLanes; ++lane) {
        const Table& t = *begin[std::min(lane, last - first - 1)];
        for (size_t k = 0; k < to.size(); ++k) to[k][lane] = (t.*from)[k];
      }
    };
    spread(&Table::m, out.different.m);
    spread(&Table::across, out.different.across);
    spread(&Table::weight, out.different.weight);
  }

  PlaneSection section_;
  Mat3 stiffness_;  // D [N m]
  int degree_;
  bending::EntryIndices value_indices_{};
  bool mixed_ = false;
  std::vector<std::shared_ptr<const Table>> tables_;
  std::vector<BatchTables> batches_;
  ProductTable products_;
};

}  // namespace

std::unique_ptr<Term> make_bending(const PlaneSection& section, int n_points) {
  return std::make_unique<Bending>(section, n_points);
}

const TermRow& bending_row() {
  static const auto points = [](const TermData& data) {
    return static_cast<int>(number_of(bending_row(), "bending_points", data));
  };
  static const TermRow kRow{
      .name = "bending",
      .sentence = "Elastic forces from the bending of a thin plate.",
      .role = "bending",
      .domains = {TermDomain::space},
      .required_in = {TermDomain::space},
      .keys = {{.name = "bending_points",
                .noun = "a number of Gauss points in each direction",
                .unit = "-",
                .low = 3,
                .high = 16,
                .whole = true,
                .fallback = 9,
                .sentence =
                    "Number of Gauss points per element and direction for the term `bending`."}},
      .columns = {},
      .elastic = [](const TermData& data) { return Bending::parts_of(data.section, points(data)); },
      .make = [](const TermData& data) { return make_bending(data.section, points(data)); }};
  return kRow;
}

}  // namespace flexmorph::fem
