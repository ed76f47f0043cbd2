#include "io/smooth_table.h"

#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/Splines>

#include "geometry/base.h"
#include "io/files.h"

namespace flexmorph::io {
namespace {

using Spline = Eigen::Spline<double, 1, Eigen::Dynamic>;

constexpr size_t kOrder = 6;  // coefficients of a polynomial of degree 5

// Of the length of the table: closer times fall together when they are scaled to [0, 1], or have so
// few digits left between them that no derivative is worth its name.
constexpr double kClosest = 1e-11;

void check(std::span<const double> times, std::span<const double> values) {
  if (times.size() != values.size())
    throw Error::input("a table has as many times as values: " + std::to_string(times.size()) +
                       " and " + std::to_string(values.size()));
  if (times.size() < 4)
    throw Error::input("a table has at least 4 points, not " + std::to_string(times.size()));
  for (size_t i = 0; i < times.size(); ++i) {
    const std::string row = "row " + std::to_string(i + 1) + " of the table: ";
    if (!std::isfinite(times[i]) || !std::isfinite(values[i]))
      throw Error::input(row + "time and value are finite numbers");
    if (i > 0 && times[i] <= times[i - 1])
      throw Error::input(row + "times increase, but " + to_text(times[i]) + " s follows " +
                         to_text(times[i - 1]) + " s");
  }
  const double length = times.back() - times.front();
  if (!std::isfinite(length)) throw Error::input("the times of the table span more than a number");
  for (size_t i = 1; i < times.size(); ++i)
    if (times[i] - times[i - 1] < kClosest * length)
      throw Error::input("row " + std::to_string(i + 1) + " of the table: " + to_text(times[i]) +
                         " s follows " + to_text(times[i - 1]) +
                         " s; between two rows lies at least 1e-11 of the whole, here " +
                         to_text(kClosest * length, 3) + " s");
}

/// Coefficients of the spline with these knots that takes the values at u.
VectorXd interpolate(const Spline::KnotVectorType& u, std::span<const double> values, int degree,
                     const Spline::KnotVectorType& knots) {
  const Eigen::Index n = u.size();
  std::vector<Eigen::Triplet<double>> entries;
  VectorXd right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    right[i] = values[static_cast<size_t>(i)];
    // At the last knot all basis functions but the last vanish; no need to divide by empty spans.
    if (i == n - 1) {
      entries.emplace_back(i, i, 1.0);
      continue;
    }
    const Eigen::Index span = Spline::Span(u[i], degree, knots);
    const auto basis = Spline::BasisFunctions(u[i], degree, knots);
    for (Eigen::Index k = 0; k <= degree; ++k) entries.emplace_back(i, span - degree + k, basis[k]);
  }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseLU<Eigen::SparseMatrix<double>> solver(matrix);
  VectorXd out = solver.solve(right);
  if (solver.info() != Eigen::Success || !out.allFinite())
    throw Error::input("no smooth function goes through the table: its times are too uneven");
  return out;
}

}  // namespace

SmoothTable::SmoothTable(std::span<const double> times, std::span<const double> values) {
  check(times, values);
  const auto n = static_cast<Eigen::Index>(times.size());
  const int degree = static_cast<int>(std::min<Eigen::Index>(kOrder - 1, n - 1));
  const double start = times.front(), length = times.back() - start;
  Spline::KnotVectorType u(n), knots;
  for (Eigen::Index i = 0; i < n; ++i) u[i] = (times[static_cast<size_t>(i)] - start) / length;
  u[n - 1] = 1;
  Eigen::KnotAveraging(u, degree, knots);
  const VectorXd controls = interpolate(u, values, degree, knots);
  const Spline spline(knots, controls.transpose());

  // Between two knots the spline is a polynomial, here in powers of t - t_k.
  for (Eigen::Index k = degree; k + degree + 1 < knots.size(); ++k) {
    if (knots[k + 1] <= knots[k]) continue;
    const auto derivatives = spline.derivatives(knots[k], degree);
    breaks_.push_back(start + length * knots[k]);
    double scale = 1;
    for (size_t j = 0; j < kOrder; ++j) {
      const bool there = static_cast<int>(j) <= degree;
      coefficients_.push_back(there ? derivatives(0, static_cast<Eigen::Index>(j)) * scale : 0);
      scale /= length * static_cast<double>(j + 1);
    }
  }
  breaks_.push_back(times.back());
  if (!std::all_of(coefficients_.begin(), coefficients_.end(),
                   [](double c) { return std::isfinite(c); }))
    throw Error::input("no smooth function goes through the table: its values are too large for " +
                       std::string("the distances of its times"));
}

Jet SmoothTable::operator()(double t) const {
  if (!(t >= first() && t <= last()))
    throw Error::input("the table covers " + to_text(first()) + " to " + to_text(last()) +
                       " s; asked for t = " + to_text(t) + " s");
  const auto next = std::upper_bound(breaks_.begin() + 1, breaks_.end() - 1, t);
  const auto interval = static_cast<size_t>(next - breaks_.begin()) - 1;
  const double* c = &coefficients_[kOrder * interval];
  const double x = t - breaks_[interval];
  return {c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5])))),
          c[1] + x * (2 * c[2] + x * (3 * c[3] + x * (4 * c[4] + x * 5 * c[5]))),
          2 * c[2] + x * (6 * c[3] + x * (12 * c[4] + x * 20 * c[5]))};
}

}  // namespace flexmorph::io
