#include "fem/terms/element_invariants.h"

#include <cmath>
#include <utility>

#include "fem/terms/gram.h"

namespace flexmorph::fem {
namespace {

bool equal(const MatrixXd& x, const MatrixXd& y) {
  return x.rows() == y.rows() && x.cols() == y.cols() && x.isApprox(y, 1e-13);
}

template <int kKinds>
void number_as(bool coupled, PairNumbers& pairs, std::vector<int>& function_m,
               std::vector<int>& function_n) {
  using N = gram::Numbering<kKinds>;
  pairs.i.assign(N::tables.i.begin(), N::tables.i.end());
  pairs.j.assign(N::tables.j.begin(), N::tables.j.end());
  pairs.starts.assign(N::tables.start.begin(), N::tables.start.end());
  if (coupled) pairs.starts = {0, N::n_pairs};
  function_m.resize(N::n);
  function_n.resize(N::n);
  for (int c = 0; c < 4; ++c)
    for (int kind = c == 0 ? 1 : 0; kind < kKinds; ++kind) {
      const auto at = static_cast<size_t>(N::vector(kind, c));
      function_m[at] = 2 * gram::slope_m(kind) + c % 2;
      function_n[at] = 2 * gram::slope_n(kind) + c / 2;
    }
}

}  // namespace

void ElementInvariants::number(int kinds, bool coupled) {
  kinds_ = kinds;
  coupled_ = coupled;
  if (kinds == 1)
    number_as<1>(coupled, pairs_, function_m_, function_n_);
  else if (kinds == 3)
    number_as<3>(coupled, pairs_, function_m_, function_n_);
  else if (kinds == 4)
    number_as<4>(coupled, pairs_, function_m_, function_n_);
  else
    throw Error::input("term 'membrane' needs 1, 3 or 4 vectors at each of four nodes");
  value_indices_ = invariant_indices(pairs_, function_m_, function_n_);
}

void ElementInvariants::begin(const Element& element, const ScaleFactors& factors, bool all) {
  tabulated_ = -1;
  scaled_from_ = nullptr;
  moments_.follow(element, factors, factors.stiffness, kDegree + 1, all);
}

ElementInvariants::Packed ElementInvariants::of(const Element& element, int e,
                                                const ScaleFactors& factors) {
  std::swap(previous_, table_);
  // The number of points is that of an integration with scale factors in the weights, twice the
  // usual degree.
  const bool weighed = weigh(e, weights_);
  const int degree = weighed ? 2 * kDegree : kinds_ == 1 ? kCellDegree : kDegree;
  const ScaleFactorKind kind = weighed ? ScaleFactorKind::none : ScaleFactorKind::stiffness;
  if (!element.tabulate_products(e, degree, factors, kind, table_))
    throw Error::input("term 'membrane' needs shape functions that are products along m and n");
  if (weighed) table_.weight = weights_;
  const bool same = tabulated_ >= 0 && tabulated_ == e - 1 &&
                    equal(previous_.weight, table_.weight) && equal(previous_.f_m, table_.f_m) &&
                    equal(previous_.f_n, table_.f_n);
  tabulated_ = e;
  if (!same) last_ = scaled();
  return last_;
}

/// Returns W of table_. Cells of one shape, each of one material, differ by a factor, so that W is
/// computed only once for them.
ElementInvariants::Packed ElementInvariants::scaled() {
  const bool cell = kinds_ == 1 && coupled_;
  if (cell && scaled_from_) {
    const ProductTable &a = scaled_from_table_, &b = table_;
    const double factor = b.weight.sum() / a.weight.sum();
    if (b.weight.rows() == a.weight.rows() && b.weight.cols() == a.weight.cols() &&
        std::isfinite(factor) && equal(factor * a.weight, b.weight) && equal(a.f_m, b.f_m) &&
        equal(a.f_n, b.f_n) && equal(a.d_m, b.d_m) && equal(a.d_n, b.d_n)) {
      auto out = std::make_shared<std::vector<double>>(*scaled_from_);
      for (double& x : *out) x *= factor;
      return out;
    }
  }
  const auto out = std::make_shared<std::vector<double>>(of_table(table_));
  if (cell) {
    scaled_from_ = out;
    scaled_from_table_ = table_;
  }
  return out;
}

std::vector<double> ElementInvariants::of_table(const ProductTable& table) const {
  const ProductTable classes = even_and_odd(table, function_m_, function_n_);
  return strains_ == Strains::displacement
             ? membrane_invariant(classes, value_indices_, elasticity_)
             : assumed_membrane_invariant(classes, pairs_, elasticity_);
}

ElementInvariants::Packed ElementInvariants::squares() {
  if (squares_of_ == last_) return squares_;
  squares_of_ = last_;
  return squares_ = std::make_shared<std::vector<double>>(full_squares(pairs_, *last_));
}

}  // namespace flexmorph::fem
