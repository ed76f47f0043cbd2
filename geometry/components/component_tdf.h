#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <unsupported/Eigen/AutoDiff>

#include "geometry/components/component_frame.h"
#include "geometry/components/tdf.h"
#include "geometry/vector_level.h"

/// The topology description function (TDF) of one component at many points: the inner loops of
/// UnionTdf. The header is internal to geometry/components/tdf.cpp and tdf_curvature.cpp, whose
/// loops use SIMD instructions.
namespace flexmorph::component_tdf_kernels {

/// Returns s = (u⁶ + v⁶)^(1/6), at least 1e-50, so that the center needs no special case.
///
/// The larger square is factored out: w = 1 + r³ lies in [1, 2], and s² = larger w (w^(-1/6))⁴. The
/// inverse root starts from a parabola (error 1.1e-3). Three Newton steps give full precision:
///
///   t <- t (7 - w t⁶) / 6
///
/// Unlike pow and cbrt the function has no branches, therefore loops over it can use SIMD
/// instructions.
template <class T>
T superellipse_radius(const T& u, const T& v) {
  using std::sqrt;
  const T u2 = u * u, v2 = v * v;
  const T larger = std::max(std::max(u2, v2), T(1e-100));
  const T r = std::min(u2, v2) / larger;
  const T z = r * r * r, w = 1 + z;
  T t = 1 - z * (0.15337 - 0.04444 * z);
  for (int step = 0; step < 3; ++step) {
    const T t3 = t * t * t;
    t = t * (7 - w * t3 * t3) * (1.0 / 6);
  }
  const T t2 = t * t;
  return sqrt(T(larger * w)) * t2;
}

/// Returns the fifth power of a number.
template <class T>
T fifth_power(const T& t) {
  return t * t * t * t * t;
}

/// Returns the sixth power of a number.
template <class T>
T sixth_power(const T& t) {
  const T t3 = t * t * t;
  return t3 * t3;
}

/// The first-order distance P = (1 - s) R of a superellipse of constant g, with the intermediate
/// values that its derivatives need, as a function of u = x/L and v = y/g:
///
///   R = w/|∇s| + (1 - w)(1 + k) g,   ∇s = (A/L, B/g),   A = (u/s)⁵,   B = (v/s)⁵,
///   w = s² (3 - 2 s), k = s (1 - s)⁴ inside; w = 1, k = 0 on the outline and outside.
///
/// On the outline and outside P is the first-order distance. |∇s| depends only on the direction
/// from the center; the weight w keeps the gradient bounded there, and k rounds off the cone at the
/// center. P is twice continuously differentiable except at the center, where its gradient is 0.
template <class T>
struct FirstOrderDistance {
  /// Intermediate values of the formula: a = u/s, b = v/s, per_slope = 1/|∇s|, dw = w', dk = k'.
  T s, a, b, A, B, per_slope, w, dw, k, dk, R, P;

  /// Evaluates the formula at (u, v) for given 1/L, 1/g [1/m] and g [m].
  FirstOrderDistance(const T& u, const T& v, const T& per_L, const T& per_g, const T& g)
      : s(superellipse_radius(u, v)) {
    using std::sqrt;
    const T per_s = 1 / s;
    a = u * per_s;
    b = v * per_s;
    A = fifth_power(a);
    B = fifth_power(b);
    const T along = A * per_L, across = B * per_g;
    // The lower bound acts only at the center, where a = b = 0.
    const T squared = along * along + across * across, floor = 1e-6 * per_L * per_L;
    per_slope = 1 / sqrt(std::max(squared, floor));
    const T inside = std::min(s, T(1));
    w = inside * inside * (3 - 2 * inside);
    dw = 6 * inside * (1 - inside);
    const T depth = 1 - inside, cube = depth * depth * depth;
    k = inside * depth * cube;
    dk = cube * (1 - 5 * inside);
    R = w * per_slope + (1 - w) * (1 + k) * g;
    P = (1 - s) * R;
  }
};

/// Returns P/(1 + (P/g)⁸)^(1/8) inside, so that no point is farther from the outline than the
/// half-thickness g; returns P outside.
inline double capped(double P, double g) {
  const double r = std::max(P, 0.0) / g, r2 = r * r, r4 = r2 * r2;
  return P / std::sqrt(std::sqrt(std::sqrt(1 + r4 * r4)));
}

/// Returns φ of the kind `distance` at a point (x, y) of the component's frame [m].
inline double distance_tdf(const ComponentFrame& frame, double x, double y) {
  const double g = frame.half_thickness(x), per_g = 1 / g;
  const FirstOrderDistance<double> f(x * frame.per_length(), y * per_g, frame.per_length(), per_g,
                                     g);
  return capped(f.P, g);
}

/// Returns φ = 1 - (x/L)⁶ - (y/g)⁶ of the kind `paper` at a point (x, y) of the component's frame.
inline double paper_tdf(const ComponentFrame& frame, double x, double y) {
  return 1 - sixth_power(x * frame.per_length()) - sixth_power(y / frame.half_thickness(x));
}

/// φ of one component and its partial derivatives. Derivatives by L, c1, c2, c3 include the change
/// of g with them.
template <class T>
struct Partials {
  T phi;            ///< Value of φ.
  T x, y;           ///< Derivatives by the local coordinates.
  T L, c1, c2, c3;  ///< Derivatives by L, c1, c2, c3 at fixed local coordinates.
};

/// Partial derivatives of φ(u, v, g, L) with u = x/L and v = y/g(x):
///
///   dφ = φ_u du + φ_v dv + φ_g dg + φ_L dL,   du = dx/L - u dL/L,   dv = (dy - v dg)/g.
template <class T>
struct ByShape {
  T u, v, g, L;  ///< Derivatives by u, v, g and L.
};
/// Returns φ with its derivatives by the local coordinates and the parameters, by the chain rule.
template <class T>
Partials<T> chain(const T& per_L, const BasicProfile<T>& profile, const T& u, const T& v,
                  const T& phi, const ByShape<T>& d) {
  const T by_g = d.g - d.v * v / profile.g;
  return {phi,
          d.u * per_L + by_g * profile.dg_dx,
          d.v / profile.g,
          d.L - d.u * u * per_L + by_g * profile.dg_dp[0],
          by_g * profile.dg_dp[1],
          by_g * profile.dg_dp[2],
          by_g * profile.dg_dp[3]};
}

/// Returns φ of the kind `distance` and its derivatives: φ = P q^(-1/8), q = 1 + (P/g)⁸ inside and
/// 1 outside.
///
///   φ_P = q^(-9/8),  φ_g = (P/g)⁹ φ_P.
///
/// With D = |∇s|, s_u = A, s_v = B and A_u = 5 a⁴ b⁶/s,  B_v = 5 b⁴ a⁶/s,  A_v = B_u = -5 a⁵ b⁵/s:
///
///   P_u = A P_s - (1 - s) w D_u/D²,   P_v = B P_s - (1 - s) w D_v/D²,
///   P_s = -R + (1 - s) (w' (1/D - (1 + k) g) + (1 - w) k' g).
template <class T>
Partials<T> distance_partials(const HalfThickness<T>& shape, const T& x, const T& y) {
  using std::sqrt;
  const BasicProfile<T> profile = shape.profile(x);
  const T& g = profile.g;
  const T& per_L = shape.per_length();
  const T per_g = 1 / g;
  const T u = x * per_L, v = y * per_g;
  const FirstOrderDistance<T> f(u, v, per_L, per_g, g);
  const T a2 = f.a * f.a, b2 = f.b * f.b, a4 = a2 * a2, b4 = b2 * b2, five = 5 / f.s;
  const T A_u = five * a4 * b4 * b2, B_v = five * b4 * a4 * a2, cross = -five * f.A * f.B;
  const T wA = f.A * per_L * per_L, wB = f.B * per_g * per_g, depth = 1 - f.s;
  const T cube = f.w * f.per_slope * f.per_slope * f.per_slope;
  const T by_s = depth * (f.dw * (f.per_slope - (1 + f.k) * g) + (1 - f.w) * f.dk * g) - f.R;
  const T P_u = f.A * by_s - depth * cube * (wA * A_u + wB * cross);
  const T P_v = f.B * by_s - depth * cube * (wA * cross + wB * B_v);
  const T P_L = depth * cube * wA * f.A * per_L;
  const T P_g = depth * (cube * wB * f.B * per_g + (1 - f.w) * (1 + f.k));

  const T r = (f.P > 0 ? f.P : T(0)) * per_g, r2 = r * r, r4 = r2 * r2, q = 1 + r4 * r4;
  const T root = 1 / sqrt(T(sqrt(T(sqrt(q))))), by_P = root / q;
  return chain<T>(per_L, profile, u, v, f.P * root,
                  {P_u * by_P, P_v * by_P, P_g * by_P + r4 * r4 * r * by_P, P_L * by_P});
}

/// Returns φ = 1 - u⁶ - v⁶ of the kind `paper` and its derivatives.
template <class T>
Partials<T> paper_partials(const HalfThickness<T>& shape, const T& x, const T& y) {
  const BasicProfile<T> profile = shape.profile(x);
  const T u = x * shape.per_length(), v = y / profile.g;
  return chain<T>(shape.per_length(), profile, u, v, 1 - sixth_power(u) - sixth_power(v),
                  {-6 * fifth_power(u), -6 * fifth_power(v), T(0), T(0)});
}

/// Returns φ of a kind and its derivatives at a point (x, y) of the component's frame.
template <TdfSettings::Kind kind, class T>
Partials<T> partials(const HalfThickness<T>& shape, const T& x, const T& y) {
  return kind == TdfSettings::Kind::paper ? paper_partials<T>(shape, x, y)
                                          : distance_partials<T>(shape, x, y);
}

/// Fills `phi` with φ at `count` points (x, y) of the component's frame.
template <TdfSettings::Kind kind>
void tdf_at_points(const ComponentFrame& frame, int count, const double* x, const double* y,
                   double* phi) {
  run_kernel([=, &frame]<int>() {
    const ComponentFrame f = frame;
#pragma omp simd
    for (int k = 0; k < count; ++k)
      phi[k] = kind == TdfSettings::Kind::paper ? paper_tdf(f, x[k], y[k])
                                                : distance_tdf(f, x[k], y[k]);
  });
}

/// Adds up Σ_k seed_k dφ(x_k, y_k)/dp for the seven parameters p and writes the sums to `out` (7).
template <TdfSettings::Kind kind>
void sum_chain(const ComponentFrame& frame, int count, const double* px, const double* py,
               const double* seed, double* out) {
  run_kernel([=, &frame]<int>() {
    const HalfThickness<double> shape = frame.shape();
    double by_x = 0, by_y = 0, by_angle = 0, by_L = 0, by_c1 = 0, by_c2 = 0, by_c3 = 0;
#pragma omp simd reduction(+ : by_x, by_y, by_angle, by_L, by_c1, by_c2, by_c3)
    for (int k = 0; k < count; ++k) {
      const double x = px[k], y = py[k], f = seed[k];
      const Partials<double> d = partials<kind>(shape, x, y);
      by_x += f * d.x;
      by_y += f * d.y;
      by_angle += f * (d.x * y - d.y * x);
      by_L += f * d.L;
      by_c1 += f * d.c1;
      by_c2 += f * d.c2;
      by_c3 += f * d.c3;
    }
    out[0] = frame.sine() * by_y - frame.cosine() * by_x;
    out[1] = -frame.sine() * by_x - frame.cosine() * by_y;
    out[2] = by_L;
    out[3] = by_angle;
    out[4] = by_c1;
    out[5] = by_c2;
    out[6] = by_c3;
  });
}

/// Computes weight_k dφ(x_k, y_k)/dp for the seven parameters p, one column of `out` each (count x
/// 7).
template <TdfSettings::Kind kind>
void fill_chain(const ComponentFrame& frame, int count, const double* px, const double* py,
                const double* weight, double* out) {
  run_kernel([=, &frame]<int>() {
    const HalfThickness<double> shape = frame.shape();
    const double sine = frame.sine(), cosine = frame.cosine();
    const std::ptrdiff_t n = count;
#pragma omp simd
    for (std::ptrdiff_t k = 0; k < n; ++k) {
      const double x = px[k], y = py[k], f = weight[k];
      const Partials<double> d = partials<kind>(shape, x, y);
      out[k] = f * (sine * d.y - cosine * d.x);
      out[n + k] = f * (-sine * d.x - cosine * d.y);
      out[2 * n + k] = f * d.L;
      out[3 * n + k] = f * (d.x * y - d.y * x);
      out[4 * n + k] = f * d.c1;
      out[5 * n + k] = f * d.c2;
      out[6 * n + k] = f * d.c3;
    }
  });
}

/// Derivatives by the seven parameters of a component.
using Gradient7 = Eigen::Matrix<double, 7, 1>;
/// Second derivatives by the seven parameters of a component.
using Hessian7 = Eigen::Matrix<double, 7, 7>;

/// φ, its gradient and its Hessian by the seven parameters at a point (x, y) of the component's
/// frame.
struct Expansion {
  double value;        ///< Value of φ.
  Gradient7 gradient;  ///< First derivatives by the parameters.
  Hessian7 hessian;    ///< Second derivatives by the parameters.
};
/// Returns the expansion of φ at a point (x, y) of the component's frame. Automatic differentiation
/// of the first derivatives gives the Hessian by q = (x, y, L, c1, c2, c3). The chain rule then
/// adds the dependence of x and y on the position (X, Y) and the angle of the component:
///
///   x_X = -cos, x_Y = -sin, x_θ = y,   y_X = sin, y_Y = -cos, y_θ = -x   (X, Y its center)
template <TdfSettings::Kind kind>
Expansion expansion(const Component& c, double minimum, double sine, double cosine, double x,
                    double y) {
  constexpr int kLocal = 6;
  using Vector = Eigen::Matrix<double, kLocal, 1>;
  using Dual = Eigen::AutoDiffScalar<Vector>;
  const auto seeded = [](double value, int number) { return Dual(value, kLocal, number); };
  const HalfThickness<Dual> shape(seeded(c.half_length, 2), seeded(c.c1, 3), seeded(c.c2, 4),
                                  seeded(c.c3, 5), minimum);
  const Partials<Dual> d = partials<kind>(shape, seeded(x, 0), seeded(y, 1));
  const Dual* each[kLocal] = {&d.x, &d.y, &d.L, &d.c1, &d.c2, &d.c3};
  Vector by_local;
  Eigen::Matrix<double, kLocal, kLocal> twice;
  for (int k = 0; k < kLocal; ++k) {
    by_local[k] = each[k]->value();
    twice.row(k) = each[k]->derivatives();
  }
  Eigen::Matrix<double, kLocal, 7> turn;
  turn.setZero();
  turn.row(0) << -cosine, -sine, 0, y, 0, 0, 0;
  turn.row(1) << sine, -cosine, 0, -x, 0, 0, 0;
  turn(2, 2) = turn(3, 4) = turn(4, 5) = turn(5, 6) = 1;
  Expansion out{d.phi.value(), turn.transpose() * by_local, turn.transpose() * twice * turn};
  const double by_x = by_local[0], by_y = by_local[1];
  out.hessian(3, 3) -= by_x * x + by_y * y;
  out.hessian(0, 3) += by_x * sine + by_y * cosine;
  out.hessian(3, 0) += by_x * sine + by_y * cosine;
  out.hessian(1, 3) += by_y * sine - by_x * cosine;
  out.hessian(3, 1) += by_y * sine - by_x * cosine;
  return out;
}

/// The term S(z) exp(λ (φ - highest)) of UnionTdf, z = λ (φ - cut), and its derivatives by z.
struct Term {
  double value, slope, curvature;  ///< Value, first and second derivative by z.
};
/// Returns the term of a component at a node where its TDF is φ and the highest one is `highest`.
inline Term smooth_term(double lambda, double phi, double cut, double highest) {
  constexpr double kWidth = 2;
  const double z = lambda * (phi - cut);
  if (z <= 0) return {0, 0, 0};
  const double e = std::exp(lambda * (phi - highest));
  if (z >= kWidth) return {e, e, e};
  const double s = z / kWidth, rest = 1 - s;
  const double S = s * s * s * (10 - s * (15 - 6 * s)), by_z = 30 * s * s * rest * rest / kWidth;
  const double twice = 60 * s * rest * (1 - 2 * s) / (kWidth * kWidth);
  return {S * e, (S + by_z) * e, (S + 2 * by_z + twice) * e};
}

/// Returns a rectangle of the component's frame that contains every point with φ > cut (cut < 0).
///
/// distance: such a point has s < 1 + |cut| |∇s|. In the direction with u/s = a, v/s = b the point
/// is at x = a s L, y = b s g, therefore |x| < a L + |cut| a √(A² + (B L/g)²) and
/// y| < b g + |cut| b √((A g/L)² + B²). The rectangle takes the largest values over all directions;
/// the bound of x uses the smallest g at and beyond the thinner tip, the bound of y the largest g.
///
/// paper: (x/L)⁶ and (y/g)⁶ are below 1 + |cut|.
inline Box reach(const ComponentFrame& frame, TdfSettings::Kind kind, double cut) {
  const double L = frame.half_length(), beyond = 1 + HalfThickness<double>::kBeyond;
  const double top = frame.shape().range(-beyond, beyond).second;
  constexpr double kRoundOff = 1 + 1e-9;
  if (kind == TdfSettings::Kind::paper) {
    const double grown = std::sqrt(std::cbrt(1 - cut)) * kRoundOff;
    return {{-L * grown, -top * grown}, {L * grown, top * grown}};
  }
  const double thin =
      std::min(frame.shape().range(-beyond, -1).first, frame.shape().range(1, beyond).first);
  double along = 0, across = 0;
  constexpr int kDirections = 64;
  for (int k = 0; k <= kDirections; ++k) {
    const double a6 = static_cast<double>(k) / kDirections;
    const double a = std::sqrt(std::cbrt(a6)), b = std::sqrt(std::cbrt(1 - a6));
    const double A = fifth_power(a), B = fifth_power(b);
    along = std::max(along, a * (L - cut * std::hypot(A, B * L / thin)));
    across = std::max(across, b * (top - cut * std::hypot(A * top / L, B)));
  }
  constexpr double kBetween = 1.01;  // margin for directions between two samples
  return {{-along * kBetween, -across * kBetween}, {along * kBetween, across * kBetween}};
}

}  // namespace flexmorph::component_tdf_kernels
