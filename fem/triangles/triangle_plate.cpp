#include "fem/triangles/triangle_plate.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "fem/solve/factorization/fill_order.h"
#include "fem/solve/factorization/supernodal_factor.h"
#include "fem/triangles/t6.h"

namespace flexmorph::fem {
namespace {

/// Lists of numbers, one list for every node; list k extends from starts[k] to starts[k + 1].
struct Lists {
  std::vector<int> starts, numbers;
  std::span<const int> of(int k) const {
    const auto at = static_cast<std::size_t>(k);
    return std::span<const int>(numbers).subspan(
        static_cast<std::size_t>(starts[at]),
        static_cast<std::size_t>(starts[at + 1] - starts[at]));
  }
};

/// Returns for every node the nodes that share a triangle or a spring with it, itself included,
/// ascending.
Lists neighbours(const PartMesh& mesh, const std::vector<char>& used,
                 const TrianglePlateSupports& supports) {
  const std::vector<signed char>& left_out = supports.left_out;
  const std::size_t n = mesh.points.size();
  std::vector<std::vector<int>> around(n);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!left_out.empty() && left_out[t] != 0) continue;
    for (const int a : mesh.triangles[t])
      for (const int b : mesh.triangles[t])
        if (used[static_cast<std::size_t>(a)] && used[static_cast<std::size_t>(b)])
          around[static_cast<std::size_t>(a)].push_back(b);
  }
  for (const NodeSpring& s : supports.springs) {
    around[static_cast<std::size_t>(s.a)].push_back(s.b);
    around[static_cast<std::size_t>(s.b)].push_back(s.a);
  }
  Lists out{{0}, {}};
  for (std::vector<int>& each : around) {
    std::sort(each.begin(), each.end());
    each.erase(std::unique(each.begin(), each.end()), each.end());
    out.numbers.insert(out.numbers.end(), each.begin(), each.end());
    out.starts.push_back(static_cast<int>(out.numbers.size()));
  }
  return out;
}

}  // namespace

struct TrianglePlate::Impl {
  const PartMesh& mesh;
  PlaneSection section;
  TrianglePlateSupports supports;
  std::vector<int> first_clamps;  // first clamp that each node is in front of
  std::vector<int> rows;          // unknown of each displacement, 2 node + c
  std::vector<int> active;        // number of unknowns in front of each clamp
  std::vector<int> starts, entries;
  std::optional<SupernodalFactor> factor;

  Impl(const PartMesh& m, const PlaneSection& s, TrianglePlateSupports all)
      : mesh(m), section(s), supports(std::move(all)) {}

  bool takes_part(std::size_t t) const {
    return supports.left_out.empty() || supports.left_out[t] == 0;
  }
  int n_clamps() const { return std::max(1, static_cast<int>(supports.clamps.size())); }
  void find_clamps();
  void number();
  void find_pattern(const Lists& graph, const std::vector<int>& order);
  void assemble();
  /// Adds a value to the entry of K of two unknowns; does nothing above the diagonal or if one is
  /// held.
  void add(std::span<double> values, int row, int column, double value) const;
};

void TrianglePlate::Impl::find_clamps() {
  for (const Vec2& p : mesh.points) {
    // The lines are in descending order of x; a node is in front of lines with a smaller x.
    const auto in_front = std::find_if(supports.clamps.begin(), supports.clamps.end(),
                                       [&](double x) { return p.x() > x + supports.small; });
    first_clamps.push_back(static_cast<int>(in_front - supports.clamps.begin()));
  }
}

void TrianglePlate::Impl::number() {
  const std::size_t n = mesh.points.size();
  std::vector<char> used(n, 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const int node : mesh.triangles[t])
      if (takes_part(t) && first_clamps[static_cast<std::size_t>(node)] < n_clamps())
        used[static_cast<std::size_t>(node)] = 1;
  std::vector<signed char> held(2 * n, 0);
  for (const HeldUnknown& h : supports.held)
    held[static_cast<std::size_t>(2 * h.node + h.component)] = 1;

  const Lists graph = neighbours(mesh, used, supports);
  std::vector<int> groups = first_clamps;
  for (std::size_t k = 0; k < n; ++k) groups[k] = std::min(groups[k], n_clamps());
  // Group numbers without nodes are allowed in CAMD.
  const std::vector<int> order = fill_order(graph.starts, graph.numbers, groups);
  rows.assign(2 * n, -1);
  active.assign(static_cast<std::size_t>(n_clamps()), 0);
  int next = 0;
  for (const int node : order) {
    const auto at = static_cast<std::size_t>(node);
    for (std::size_t c = 0; c < 2; ++c)
      if (used[at] && !held[2 * at + c]) rows[2 * at + c] = next++;
    for (int k = first_clamps[at]; k < n_clamps(); ++k) active[static_cast<std::size_t>(k)] = next;
  }
  if (next == 0) throw Error::input("triangles: all displacements are fixed");
  find_pattern(graph, order);
}

/// Finds the lower triangle by columns, in the order of the unknowns.
void TrianglePlate::Impl::find_pattern(const Lists& graph, const std::vector<int>& order) {
  starts = {0};
  for (const int node : order)
    for (std::size_t c = 0; c < 2; ++c) {
      const int column = rows[2 * static_cast<std::size_t>(node) + c];
      if (column < 0) continue;
      const std::size_t first = entries.size();
      for (const int other : graph.of(node))
        for (std::size_t d = 0; d < 2; ++d) {
          const int row = rows[2 * static_cast<std::size_t>(other) + d];
          if (row >= column) entries.push_back(row);
        }
      std::sort(entries.begin() + static_cast<std::ptrdiff_t>(first), entries.end());
      starts.push_back(static_cast<int>(entries.size()));
    }
  factor.emplace(starts, entries);
}

void TrianglePlate::Impl::assemble() {
  std::span<double> values = factor->values();
  std::fill(values.begin(), values.end(), 0.0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!takes_part(t)) continue;
    const Eigen::Matrix<double, 12, 12> k = T6(mesh.corners(t)).stiffness(section);
    std::array<int, 12> unknowns{};
    for (std::size_t a = 0; a < 12; ++a)
      unknowns[a] = rows[2 * static_cast<std::size_t>(mesh.triangles[t][a / 2]) + a % 2];
    for (std::size_t a = 0; a < 12; ++a)
      for (std::size_t b = 0; b < 12; ++b)
        add(values, unknowns[a], unknowns[b], k(static_cast<int>(a), static_cast<int>(b)));
  }
  for (const NodeSpring& s : supports.springs) {
    const int a = rows[2 * static_cast<std::size_t>(s.a) + static_cast<std::size_t>(s.component)],
              b = rows[2 * static_cast<std::size_t>(s.b) + static_cast<std::size_t>(s.component)];
    add(values, a, a, s.stiffness);
    add(values, b, b, s.stiffness);
    add(values, std::max(a, b), std::min(a, b), -s.stiffness);
  }
}

void TrianglePlate::Impl::add(std::span<double> values, int row, int column, double value) const {
  if (column < 0 || row < column) return;
  const int *begin = entries.data() + starts[static_cast<std::size_t>(column)],
            *end = entries.data() + starts[static_cast<std::size_t>(column) + 1];
  const auto at = static_cast<std::size_t>(std::lower_bound(begin, end, row) - entries.data());
  values[at] += value;
}

TrianglePlate::TrianglePlate(const PartMesh& mesh, const PlaneSection& section,
                             TrianglePlateSupports supports)
    : impl_(std::make_unique<Impl>(mesh, section, std::move(supports))) {
  impl_->find_clamps();
  impl_->number();
}
TrianglePlate::~TrianglePlate() = default;
TrianglePlate::TrianglePlate(TrianglePlate&&) noexcept = default;

const PartMesh& TrianglePlate::mesh() const { return impl_->mesh; }
const PlaneSection& TrianglePlate::section() const { return impl_->section; }
int TrianglePlate::n_unknowns() const { return static_cast<int>(impl_->starts.size()) - 1; }
int TrianglePlate::row(int node, int component) const {
  return impl_->rows[static_cast<std::size_t>(2 * node + component)];
}
bool TrianglePlate::takes_part(std::size_t triangle) const { return impl_->takes_part(triangle); }
int TrianglePlate::first_clamp(int node) const {
  return impl_->first_clamps[static_cast<std::size_t>(node)];
}
/// At least one node of a triangle in front of a clamp is in front of it; no clamp crosses a
/// triangle.
int TrianglePlate::first_clamp(std::size_t triangle) const {
  int out = n_clamps();
  for (const int node : impl_->mesh.triangles[triangle]) out = std::min(out, first_clamp(node));
  return out;
}
int TrianglePlate::n_clamps() const { return impl_->n_clamps(); }

void TrianglePlate::factorize() {
  impl_->assemble();
  const int column = impl_->factor->factorize();
  if (column < 0) return;
  const auto at = std::find(impl_->rows.begin(), impl_->rows.end(), column);
  const Vec2& p = impl_->mesh.point(static_cast<int>((at - impl_->rows.begin()) / 2));
  throw Error::numerical("triangles: the part is not sufficiently supported at (" +
                         std::to_string(p.x()) + ", " + std::to_string(p.y()) +
                         ") m: its stiffness is not positive definite");
}

void TrianglePlate::solve(MatrixXd& loads, std::span<const int> clamps) const {
  std::vector<int> active;
  for (const int k : clamps) active.push_back(impl_->active[static_cast<std::size_t>(k)]);
  for (std::size_t l = 0; l < active.size(); ++l)
    loads.row(static_cast<Eigen::Index>(l)).tail(loads.cols() - active[l]).setZero();
  impl_->factor->forward(loads, active);
  impl_->factor->backward(loads, active);
}

}  // namespace flexmorph::fem
