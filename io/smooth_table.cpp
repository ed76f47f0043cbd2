#include "io/smooth_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unsupported/Eigen/Splines>

#include "geometry/base.h"
#include "io/files.h"

namespace flexmorph::io {
namespace {

using Spline = Eigen::Spline<double, 1, Eigen::Dynamic>;

constexpr size_t kOrder = 6;  // coefficients of a polynomial of degree 5

// Smallest distance of times as a fraction of the length of the table. Closer times coincide when
// they are scaled to [0, 1], or have so few different digits that derivatives are inaccurate.
constexpr double kMinSpacing = 1e-11;
// Largest error at the points as a fraction of the largest value. A larger error means that the
// spline lost its accuracy by round-off.
constexpr double kMaxMiss = 1e-6;

void check(std::span<const double> times, std::span<const double> values) {
  if (times.size() != values.size())
    throw Error::input("a table has as many times as values, not " + std::to_string(times.size()) +
                       " times and " + std::to_string(values.size()) + " values");
  if (times.size() < 4)
    throw Error::input("a table has at least 4 points, not " + std::to_string(times.size()));
  const auto row = [](size_t i) { return "row " + std::to_string(i + 1) + " of the table: "; };
  for (size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i]) || !std::isfinite(values[i]))
      throw Error::input(row(i) + "time and value are finite numbers");
    if (i > 0 && times[i] <= times[i - 1])
      throw Error::input(row(i) + "times increase, but " + to_text(times[i]) + " s follows " +
                         to_text(times[i - 1]) + " s");
  }
  const double length = times.back() - times.front();
  if (!std::isfinite(length))
    throw Error::input("the time span of the table is not a finite number");
  for (size_t i = 1; i < times.size(); ++i)
    if (times[i] - times[i - 1] < kMinSpacing * length)
      throw Error::input(
          "row " + std::to_string(i + 1) + " of the table: " + to_text(times[i]) + " s follows " +
          to_text(times[i - 1]) +
          " s; the distance between two times must be at least 1e-11 of the time span, here " +
          to_text(kMinSpacing * length, 3) + " s");
}

/// The B-splines that are not zero between the knots k and k + 1. Entry [p][r] is the B-spline of
/// degree p and index k - p + r.
using Basis = std::array<std::array<double, kOrder>, kOrder>;

/// Returns the values of the B-splines at u (de Boor 1978, chapter X).
Basis basis_at(double u, const double* knot, int degree) {
  Basis out{};
  out[0][0] = 1;
  for (int p = 1; p <= degree; ++p)
    for (int r = 0; r <= p; ++r) {
      const double *const first = knot - p + r, *const last = first + p;
      const auto& below = out[static_cast<size_t>(p - 1)];
      double& value = out[static_cast<size_t>(p)][static_cast<size_t>(r)];
      if (r > 0) value = (u - *first) / (*last - *first) * below[static_cast<size_t>(r - 1)];
      if (r < p) value += (last[1] - u) / (last[1] - first[1]) * below[static_cast<size_t>(r)];
    }
  return out;
}

[[noreturn]] void refuse_times() {
  throw Error::input(
      "no smooth function goes through the table: the distances between its times differ too much, "
      "or its values are too large");
}

/// Returns the coefficients of the spline with given knots that has the given values at u.
///
/// Row i of the banded equations contains the B-splines at u_i in the columns from i - degree to
/// i + degree. The elimination needs no pivoting, because the matrix is totally positive (de Boor
/// 1978, chapter XIII).
std::vector<double> interpolate(const Spline::KnotVectorType& u, std::span<const double> values,
                                int degree, const Spline::KnotVectorType& knots) {
  const Eigen::Index n = u.size();
  Eigen::Array<double, 2 * kOrder - 1, Eigen::Dynamic> band(2 * kOrder - 1, n);
  band.setZero();
  Eigen::Index span = degree;
  for (Eigen::Index i = 0; i < n; ++i) {
    while (span + 1 < n && u[i] >= knots[span + 1]) ++span;
    const Basis basis = basis_at(u[i], knots.data() + span, degree);
    // position in row i of the band; the column of the matrix is span - degree
    const Eigen::Index first = span - i;
    if (first < 0 || first > degree) refuse_times();
    for (int r = 0; r <= degree; ++r)
      band(first + r, i) = basis[static_cast<size_t>(degree)][static_cast<size_t>(r)];
  }
  std::vector<double> out(values.begin(), values.end());
  for (Eigen::Index k = 0; k < n; ++k)
    for (Eigen::Index i = k + 1; i <= std::min<Eigen::Index>(k + degree, n - 1); ++i) {
      const double factor = band(k - i + degree, i) / band(degree, k);
      if (factor == 0) continue;
      for (int r = 1; r <= degree; ++r) band(k - i + degree + r, i) -= factor * band(degree + r, k);
      out[static_cast<size_t>(i)] -= factor * out[static_cast<size_t>(k)];
    }
  for (Eigen::Index k = n - 1; k >= 0; --k) {
    double& here = out[static_cast<size_t>(k)];
    for (int r = 1; r <= degree && k + r < n; ++r)
      here -= band(degree + r, k) * out[static_cast<size_t>(k + r)];
    here /= band(degree, k);
    if (!std::isfinite(here)) refuse_times();
  }
  return out;
}

/// Returns the j-th derivatives of the spline at its knot k, j = 0 .. degree. The coefficients of a
/// derivative are differences of the coefficients of the next lower derivative (de Boor 1978,
/// chapter X).
std::array<double, kOrder> derivatives_at(const double* knot, const double* control, int degree) {
  const Basis basis = basis_at(*knot, knot, degree);
  std::array<double, kOrder> c{}, out{};
  for (int r = 0; r <= degree; ++r) c[static_cast<size_t>(r)] = control[r - degree];
  for (int j = 0; j <= degree; ++j) {
    const int p = degree - j;  // degree of the derivative; its coefficients are c[j] .. c[degree]
    for (int r = 0; r <= p; ++r)
      out[static_cast<size_t>(j)] +=
          c[static_cast<size_t>(j + r)] * basis[static_cast<size_t>(p)][static_cast<size_t>(r)];
    for (int i = degree; i > j; --i) {
      const double* const first = knot - degree + i;
      const double difference = c[static_cast<size_t>(i)] - c[static_cast<size_t>(i - 1)];
      c[static_cast<size_t>(i)] = p * difference / (first[p] - *first);
    }
  }
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
  const std::vector<double> controls = interpolate(u, values, degree, knots);

  // Between two knots the spline is stored as a polynomial in powers of t - t_k.
  breaks_.reserve(times.size() + 1);
  coefficients_.reserve(kOrder * times.size());
  for (Eigen::Index k = degree; k + degree + 1 < knots.size(); ++k) {
    if (knots[k + 1] <= knots[k]) continue;
    const auto derivatives = derivatives_at(knots.data() + k, controls.data() + k, degree);
    breaks_.push_back(start + length * knots[k]);
    double scale = 1;
    for (size_t j = 0; j < kOrder; ++j) {
      coefficients_.push_back(derivatives[j] * scale);
      scale /= length * static_cast<double>(j + 1);
    }
  }
  breaks_.push_back(times.back());
  if (!std::all_of(coefficients_.begin(), coefficients_.end(),
                   [](double c) { return std::isfinite(c); }))
    throw Error::input("no smooth function goes through the table: its values are too large for " +
                       std::string("the distances between its times"));
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  for (size_t i = 0; i < times.size(); ++i)
    if (!(std::abs((*this)(times[i]).value - values[i]) <= kMaxMiss * largest)) refuse_times();
}

Jet SmoothTable::operator()(double t) const {
  if (!(t >= first() && t <= last()))
    throw Error::input("the table covers " + to_text(first()) + " to " + to_text(last()) +
                       " s, but its value at t = " + to_text(t) + " s is needed");
  const auto next = std::upper_bound(breaks_.begin() + 1, breaks_.end() - 1, t);
  const auto interval = static_cast<size_t>(next - breaks_.begin()) - 1;
  const double* c = &coefficients_[kOrder * interval];
  const double x = t - breaks_[interval];
  return {c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5])))),
          c[1] + x * (2 * c[2] + x * (3 * c[3] + x * (4 * c[4] + x * 5 * c[5]))),
          2 * c[2] + x * (6 * c[3] + x * (12 * c[4] + x * 20 * c[5]))};
}

}  // namespace flexmorph::io
