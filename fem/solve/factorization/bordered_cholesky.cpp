#include "fem/solve/factorization/bordered_cholesky.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "fem/solve/factorization/border.h"
#include "fem/solve/factorization/fill_order.h"
#include "fem/solve/factorization/multifrontal.h"
#include "fem/solve/factorization/substitution.h"

namespace flexmorph::fem {

namespace {

/// Reciprocal condition of S, rows scaled, below which UMFPACK is used.
constexpr double kMinReciprocalCondition = 1e-13;

size_t at(int k) { return static_cast<size_t>(k); }

/// Replaces (x, y) by (c x - s y, s x + c y), entry by entry.
template <class X, class Y>
void turn_pair(X&& x, Y&& y, double cosine, double sine) {
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const double old = x[k];
    x[k] = cosine * old - sine * y[k];
    y[k] = sine * old + cosine * y[k];
  }
}

}  // namespace

struct BorderedCholesky::Impl {
  struct BorderEntry {
    int row, column, value_index;  // position in D and index in the matrix
  };
  int n = 0;  // number of all unknowns
  Border border;
  std::vector<int> order, number;  // unknown of each position, A first; position of each unknown
  int n_inner = 0;
  std::vector<int> value_indices;  // index in the matrix of every value of the factor
  bool refused = false;  // true if the symmetric part was not accurate enough with this pattern
  VectorXd tried, image, back;
  std::vector<BorderEntry> border_entries;
  std::optional<Multifrontal> factor;  // empty: to be analysed
  MatrixXd updates, schur;             // -X Xᵀ of A; S as it is solved, rows scaled
  VectorXd row_scales;
  struct Turn {
    int x, y;  // positions of the entries of a vector
    double cosine, sine;
  };
  std::vector<Turn> turns;
  Eigen::PartialPivLU<MatrixXd> schur_factor;
  VectorXd permuted, block, tail, swapped;

  int n_border() const { return n - n_inner; }
  enum class Outcome { factored, too_unsymmetric, not_definite };
  Outcome factorize_inner(const SparseMatrix& a);
  bool factorize_values(const SparseMatrix& a, bool mean);
  std::vector<int> groups(const SparseMatrix& a) const;
  void number_unknowns(const SparseMatrix& a);
  void analyze_inner(const SparseMatrix& a);
  void forward();
  void backward();
  void solve_border(bool transposed);
  /// Replaces vectors from a position on by Q x (way = 1) or Qᵀ x (way = -1).
  void turn_vectors(int from, double way) {
    for (const Turn& t : turns) {
      if (t.x < from) continue;
      const double x = permuted[t.x], y = permuted[t.y], s = way * t.sine;
      permuted[t.x] = t.cosine * x - s * y;
      permuted[t.y] = s * x + t.cosine * y;
    }
  }
};

BorderedCholesky::BorderedCholesky() : impl_(std::make_unique<Impl>()) {}
BorderedCholesky::~BorderedCholesky() = default;

bool BorderedCholesky::analyze(const SparseMatrix& a) {
  Impl& s = *impl_;
  s.factor.reset();
  s.refused = false;
  s.n = static_cast<int>(a.rows());
  return s.border.analyze(a);
}

/// Groups unknowns whose columns have the same rows, as the unknowns of one node have; they are
/// ordered as one. Returns the first unknown of every group, and n.
std::vector<int> BorderedCholesky::Impl::groups(const SparseMatrix& a) const {
  const int *starts = a.outerIndexPtr(), *rows = a.innerIndexPtr();
  std::vector<int> out = {0};
  for (int k = 1; k < n; ++k)
    if (border.contains[at(k)] != border.contains[at(k - 1)] ||
        !std::equal(rows + starts[k - 1], rows + starts[k], rows + starts[k], rows + starts[k + 1]))
      out.push_back(k);
  out.push_back(n);
  return out;
}

void BorderedCholesky::Impl::number_unknowns(const SparseMatrix& a) {
  const std::vector<int> first = groups(a);
  const auto n_groups = first.size() - 1;
  std::vector<int> group_of(at(n)), graph_starts = {0}, graph, sides(n_groups);
  for (size_t g = 0; g < n_groups; ++g)
    std::fill(group_of.begin() + first[g], group_of.begin() + first[g + 1], static_cast<int>(g));
  for (size_t g = 0; g < n_groups; ++g) {
    sides[g] = border.contains[at(first[g])] != 0;
    bool itself = false;
    for (int p = a.outerIndexPtr()[first[g]]; p < a.outerIndexPtr()[first[g] + 1]; ++p) {
      const int other = group_of[at(a.innerIndexPtr()[p])];
      const bool known =
          static_cast<int>(graph.size()) > graph_starts.back() && graph.back() == other;
      if (!known) graph.push_back(other);
      itself |= other == static_cast<int>(g);
    }
    if (!itself)  // a constraint has no entry on the diagonal
      graph.insert(
          std::upper_bound(graph.begin() + graph_starts.back(), graph.end(), static_cast<int>(g)),
          static_cast<int>(g));
    graph_starts.push_back(static_cast<int>(graph.size()));
  }
  order.clear();
  for (const int g : fill_order(graph_starts, graph, sides))
    for (int k = first[at(g)]; k < first[at(g) + 1]; ++k) order.push_back(k);
  number.resize(at(n));
  for (int k = 0; k < n; ++k) number[at(order[at(k)])] = k;
  n_inner = static_cast<int>(std::count(border.contains.begin(), border.contains.end(), 0));
}

/// Builds the lower triangle of A and E in the order of elimination, and the list of entries of D.
void BorderedCholesky::Impl::analyze_inner(const SparseMatrix& a) {
  number_unknowns(a);
  std::vector<int> starts = {0}, rows;
  std::vector<std::pair<int, int>> column;  // rows and indices of entries
  value_indices.clear();
  border_entries.clear();
  for (int j = 0; j < n; ++j) {
    const int of = order[at(j)];
    column.clear();
    for (int p = a.outerIndexPtr()[of]; p < a.outerIndexPtr()[of + 1]; ++p) {
      const int i = number[at(a.innerIndexPtr()[p])];
      if (j >= n_inner && i >= n_inner) border_entries.push_back({i - n_inner, j - n_inner, p});
      if (j < n_inner && i >= j) column.emplace_back(i, p);
    }
    if (j >= n_inner) continue;
    std::sort(column.begin(), column.end());
    for (const auto& [row, value_index] : column) {
      rows.push_back(row);
      value_indices.push_back(value_index);
    }
    starts.push_back(static_cast<int>(rows.size()));
  }
  factor.emplace(std::move(starts), std::move(rows));
  int tallest = 0;
  for (int k = 0; k < factor->blocks().n_blocks(); ++k)
    tallest = std::max(tallest, factor->blocks().height(k));
  block.resize(tallest);
  permuted.resize(n);
  updates.resize(n_border(), n_border());
}

BorderedCholesky::Impl::Outcome BorderedCholesky::Impl::factorize_inner(const SparseMatrix& a) {
  const std::vector<char> before = border.contains;
  if (border.widen(a)) {
    if (!border.is_small_enough()) {  // the next matrix may be symmetric
      border.contains = before;
      return Outcome::too_unsymmetric;
    }
    factor.reset();
  }
  return factorize_values(a, false) ? Outcome::factored : Outcome::not_definite;
}

/// @param mean  true for the mean of both triangles, the symmetric part of the matrix
bool BorderedCholesky::Impl::factorize_values(const SparseMatrix& a, bool mean) {
  if (!factor) analyze_inner(a);
  const double* entries = a.valuePtr();
  const auto values = factor->values();
  for (size_t k = 0; k < values.size(); ++k)
    values[k] =
        mean ? 0.5 * (entries[value_indices[k]] + entries[border.mirrors[at(value_indices[k])]])
             : entries[value_indices[k]];
  return factor->factorize(&updates) < 0;
}

bool BorderedCholesky::factorize(const SparseMatrix& a, double miss) {
  using Outcome = Impl::Outcome;
  Impl& s = *impl_;
  Outcome outcome = s.factorize_inner(a);
  // Without inertia a plate on one pin turns about it: the neighbours of the pin hold it.
  if (outcome == Outcome::not_definite && s.border.add_second_layer(a)) {
    s.factor.reset();
    outcome = s.factorize_inner(a);
  }
  if (outcome == Outcome::factored) return renew_border(a, {});
  if (outcome == Outcome::not_definite || !(miss > 0) || s.refused) return false;
  s.refused = !s.factorize_values(a, true) || !renew_border(a, {}) || misses(a) > miss;
  return !s.refused;
}

/// Estimates the spectral radius of 1 - P⁻¹ a, P the solved matrix, by two power iterations.
double BorderedCholesky::misses(const SparseMatrix& a) {
  constexpr int kPasses = 2;
  Impl& s = *impl_;
  s.tried.resize(s.n);
  for (int k = 0; k < s.n; ++k)  // any vector that is not an eigenvector
    s.tried[k] = std::cos(static_cast<double>(k) * k);
  for (const int row : s.border.constraints) s.tried[row] = 0;
  double out = 0;
  for (int pass = 0; pass < kPasses; ++pass) {
    s.tried /= s.tried.lpNorm<Eigen::Infinity>();
    s.image.noalias() = a * s.tried;
    solve(s.image, s.back);
    s.tried -= s.back;
    for (const int row : s.border.constraints) s.tried[row] = 0;
    out = s.tried.lpNorm<Eigen::Infinity>();
    if (out == 0) break;
  }
  return out;
}

const std::vector<char>& BorderedCholesky::border() const { return impl_->border.contains; }

bool BorderedCholesky::renew_border(const SparseMatrix& a, std::span<const TurnedVectors> turns) {
  Impl& s = *impl_;
  s.schur = s.updates.selfadjointView<Eigen::Lower>();
  s.turns.clear();
  for (const TurnedVectors& t : turns)
    for (int k = t.first; k < t.last; k += 2) {
      if (s.border.contains[at(k)] != s.border.contains[at(k + 1)]) return false;
      s.turns.push_back({s.number[at(k)], s.number[at(k + 1)], t.cosine, t.sine});
      if (!s.border.contains[at(k)]) continue;
      const int x = s.number[at(k)] - s.n_inner, y = s.number[at(k + 1)] - s.n_inner;
      turn_pair(s.schur.row(x), s.schur.row(y), t.cosine, t.sine);
      turn_pair(s.schur.col(x), s.schur.col(y), t.cosine, t.sine);
    }
  if (s.n_border() == 0) return true;
  for (const Impl::BorderEntry& e : s.border_entries)
    s.schur(e.row, e.column) += a.valuePtr()[e.value_index];
  s.row_scales = s.schur.cwiseAbs().rowwise().maxCoeff().cwiseInverse();
  if (!s.row_scales.allFinite()) return false;
  s.schur = s.row_scales.asDiagonal() * s.schur;
  s.schur_factor.compute(s.schur);
  return s.schur_factor.rcond() > kMinReciprocalCondition;
}

void BorderedCholesky::Impl::forward() {
  const Supernodes& b = factor->blocks();
  for (int s = 0; s < b.n_blocks(); ++s) {
    const int first = b.first[at(s)], width = b.width(s), height = b.height(s);
    const int* below = b.below(s);
    std::copy_n(permuted.data() + first, width, block.data());
    std::fill(block.data() + width, block.data() + height, 0.0);
    forward_block(factor->block(s), width, height, block.data());
    std::copy_n(block.data(), width, permuted.data() + first);
    for (int i = width; i < height; ++i) permuted[below[i - width]] += block[i];
  }
}

void BorderedCholesky::Impl::backward() {
  const Supernodes& b = factor->blocks();
  for (int s = b.n_blocks(); s-- > 0;) {
    const int first = b.first[at(s)], width = b.width(s), height = b.height(s);
    const int* below = b.below(s);
    std::copy_n(permuted.data() + first, width, block.data());
    for (int i = width; i < height; ++i) block[i] = permuted[below[i - width]];
    backward_block(factor->block(s), width, height, block.data());
    std::copy_n(block.data(), width, permuted.data() + first);
  }
}

/// Computes tail = S⁻¹ tail, or S⁻ᵀ tail, from the factors P W S = L U, W the scales of the rows.
void BorderedCholesky::Impl::solve_border(bool transposed) {
  const auto& lu = schur_factor.matrixLU();
  const auto lower = lu.triangularView<Eigen::UnitLower>();
  const auto upper = lu.triangularView<Eigen::Upper>();
  if (transposed) {
    upper.transpose().solveInPlace(tail);
    lower.transpose().solveInPlace(tail);
    swapped.noalias() = schur_factor.permutationP().transpose() * tail;
    tail = row_scales.cwiseProduct(swapped);
    return;
  }
  tail.array() *= row_scales.array();
  swapped.noalias() = schur_factor.permutationP() * tail;
  lower.solveInPlace(swapped);
  upper.solveInPlace(swapped);
  tail.swap(swapped);
}

void BorderedCholesky::solve(const VectorXd& b, VectorXd& x, bool transposed) {
  //   L y = b_A,   S x_D = b_D - X y,   Lᵀ x_A = y - Xᵀ x_D, y and x_A before their rotation
  Impl& s = *impl_;
  const int n = s.n, m = s.n_border();
  for (int k = 0; k < n; ++k) s.permuted[k] = b[s.order[at(k)]];
  s.turn_vectors(0, -1);
  s.forward();
  if (m > 0) {
    s.turn_vectors(s.n_inner, 1);
    s.tail = s.permuted.tail(m);
    s.solve_border(transposed);
    s.permuted.tail(m) = s.tail;
    s.turn_vectors(s.n_inner, -1);
  }
  s.backward();
  s.turn_vectors(0, 1);
  x.resize(n);
  for (int k = 0; k < n; ++k) x[s.order[at(k)]] = s.permuted[k];
}

void BorderedCholesky::archive(Archive& memory) {
  Impl& s = *impl_;
  std::vector<char> border = s.border.contains;
  memory(border, s.border.layers, s.refused);
  if (memory.is_restoring() && border.size() == s.border.contains.size())
    s.border.contains = std::move(border);
}

}  // namespace flexmorph::fem
