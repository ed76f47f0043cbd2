#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "geometry/component_frame.h"
#include "geometry/tdf.h"

/// The TDF of one component at many points: the loops that UnionTdf is made of. Internal to
/// geometry/tdf.cpp, which is compiled for vector registers.
namespace flexmorph::component_tdf_kernels {

/// s = (u⁶ + v⁶)^(1/6), at least 1e-50: the center needs no case of its own.
///
/// With the larger square taken out, w = 1 + r³ lies in [1, 2], and s² = larger w (w^(-1/6))⁴.
/// The inverse root starts from a parabola (right to 1.1e-3) and takes three Newton steps
/// t <- t (7 - w t⁶) / 6 to full precision. Unlike pow and cbrt it has no branches, so that loops
/// over it run in vector registers.
inline double superellipse_radius(double u, double v) {
  const double u2 = u * u, v2 = v * v;
  const double larger = std::max(std::max(u2, v2), 1e-100);
  const double r = std::min(u2, v2) / larger;
  const double z = r * r * r, w = 1 + z;
  double t = 1 - z * (0.15337 - 0.04444 * z);
  for (int step = 0; step < 3; ++step) {
    const double t3 = t * t * t;
    t *= (7 - w * t3 * t3) * (1.0 / 6);
  }
  const double t2 = t * t;
  return std::sqrt(larger * w) * t2;
}

inline double fifth_power(double t) { return t * t * t * t * t; }

inline double sixth_power(double t) {
  const double t3 = t * t * t;
  return t3 * t3;
}

/// P = (1 - s) R of a superellipse of constant g, from u = x/L, v = y/g, and what its derivatives
/// need:   R = w/|∇s| + (1 - w) g,   ∇s = (A/L, B/g),   A = (u/s)⁵,   B = (v/s)⁵,
/// w = min(s, 1)². On the outline and outside this is the first-order distance; |∇s| depends on
/// the direction from the center only, so that w keeps the slope bounded there.
struct FirstOrderDistance {
  double s, a, b, A, B, per_slope, w, R, P;

  FirstOrderDistance(double u, double v, double per_L, double per_g, double g)
      : s(superellipse_radius(u, v)) {
    const double per_s = 1 / s;
    a = u * per_s;
    b = v * per_s;
    A = fifth_power(a);
    B = fifth_power(b);
    const double along = A * per_L, across = B * per_g;
    // The floor acts at the very center only, where a = b = 0.
    per_slope = 1 / std::sqrt(std::max(along * along + across * across, 1e-6 * per_L * per_L));
    const double inside = std::min(s, 1.0);
    w = inside * inside;
    R = w * per_slope + (1 - w) * g;
    P = (1 - s) * R;
  }
};

/// Inside, P/(1 + (P/g)⁸)^(1/8): no point is further from the outline than the half-thickness.
inline double capped(double P, double g) {
  const double r = std::max(P, 0.0) / g, r2 = r * r, r4 = r2 * r2;
  return P / std::sqrt(std::sqrt(std::sqrt(1 + r4 * r4)));
}

inline double distance_tdf(const ComponentFrame& frame, double x, double y) {
  const double g = frame.half_thickness(x), per_g = 1 / g;
  const FirstOrderDistance f(x * frame.per_length(), y * per_g, frame.per_length(), per_g, g);
  return capped(f.P, g);
}

inline double paper_tdf(const ComponentFrame& frame, double x, double y) {
  return 1 - sixth_power(x * frame.per_length()) - sixth_power(y / frame.half_thickness(x));
}

/// φ of one component and its partial derivatives; those by g are already times dg.
struct Partials {
  double phi;
  double x, y;           // by the local coordinates
  double L, c1, c2, c3;  // at fixed local coordinates
};

/// φ(u, v, g, L) with u = x/L, v = y/g(x):  dφ = φ_u du + φ_v dv + φ_g dg + φ_L dL,
/// du = dx/L - u dL/L,  dv = (dy - v dg)/g.
struct ByShape {
  double u, v, g, L;
};
inline Partials chain(const ComponentFrame& frame, const Profile& profile, double u, double v,
                      double phi, const ByShape& d) {
  const double by_g = d.g - d.v * v / profile.g;
  const double per_L = frame.per_length();
  return {phi,
          d.u * per_L + by_g * profile.dg_dx,
          d.v / profile.g,
          d.L - d.u * u * per_L + by_g * profile.dg_dp[0],
          by_g * profile.dg_dp[1],
          by_g * profile.dg_dp[2],
          by_g * profile.dg_dp[3]};
}

/// φ = P q^(-1/8), q = 1 + (P/g)⁸ inside and 1 outside:  φ_P = q^(-9/8),  φ_g = (P/g)⁹ φ_P.
/// With D = |∇s|, s_u = A, s_v = B and
/// A_u = 5 a⁴ b⁶/s,  B_v = 5 b⁴ a⁶/s,  A_v = B_u = -5 a⁵ b⁵/s:
/// P_u = -A R + (1 - s) (w_u (1/D - g) - w D_u/D²),  P_v likewise.
inline Partials distance_partials(const ComponentFrame& frame, double x, double y) {
  const Profile profile = frame.profile(x);
  const double g = profile.g, per_L = frame.per_length(), per_g = 1 / g;
  const double u = x * per_L, v = y * per_g;
  const FirstOrderDistance f(u, v, per_L, per_g, g);
  const double a2 = f.a * f.a, b2 = f.b * f.b, a4 = a2 * a2, b4 = b2 * b2, five = 5 / f.s;
  const double A_u = five * a4 * b4 * b2, B_v = five * b4 * a4 * a2, cross = -five * f.A * f.B;
  const double wA = f.A * per_L * per_L, wB = f.B * per_g * per_g, depth = 1 - f.s;
  const double cube = f.w * f.per_slope * f.per_slope * f.per_slope;
  const double by_w = depth * (f.s < 1 ? 2 * f.s : 0.0) * (f.per_slope - g);
  const double P_u = f.A * (by_w - f.R) - depth * cube * (wA * A_u + wB * cross);
  const double P_v = f.B * (by_w - f.R) - depth * cube * (wA * cross + wB * B_v);
  const double P_L = depth * cube * wA * f.A * per_L;
  const double P_g = depth * (cube * wB * f.B * per_g + 1 - f.w);

  const double r = std::max(f.P, 0.0) * per_g, r2 = r * r, r4 = r2 * r2, q = 1 + r4 * r4;
  const double root = 1 / std::sqrt(std::sqrt(std::sqrt(q))), by_P = root / q;
  return chain(frame, profile, u, v, f.P * root,
               {P_u * by_P, P_v * by_P, P_g * by_P + r4 * r4 * r * by_P, P_L * by_P});
}

/// φ = 1 - u⁶ - v⁶.
inline Partials paper_partials(const ComponentFrame& frame, double x, double y) {
  const Profile profile = frame.profile(x);
  const double u = x * frame.per_length(), v = y / profile.g;
  return chain(frame, profile, u, v, 1 - sixth_power(u) - sixth_power(v),
               {-6 * fifth_power(u), -6 * fifth_power(v), 0.0, 0.0});
}

template <TdfSettings::Kind kind>
Partials partials(const ComponentFrame& frame, double x, double y) {
  return kind == TdfSettings::Kind::paper ? paper_partials(frame, x, y)
                                          : distance_partials(frame, x, y);
}

inline void tdf_at_points(const ComponentFrame& frame, TdfSettings::Kind kind, int count,
                          const double* x, const double* y, double* phi) {
  if (kind == TdfSettings::Kind::paper) {
#pragma omp simd
    for (int k = 0; k < count; ++k) phi[k] = paper_tdf(frame, x[k], y[k]);
  } else {
#pragma omp simd
    for (int k = 0; k < count; ++k) phi[k] = distance_tdf(frame, x[k], y[k]);
  }
}

/// Σ_k seed_k dφ(x_k, y_k)/dp for the seven parameters p.
template <TdfSettings::Kind kind>
void sum_chain(const ComponentFrame& frame, int count, const double* px, const double* py,
               const double* seed, double* out) {
  double by_x = 0, by_y = 0, by_angle = 0, by_L = 0, by_c1 = 0, by_c2 = 0, by_c3 = 0;
#pragma omp simd reduction(+ : by_x, by_y, by_angle, by_L, by_c1, by_c2, by_c3)
  for (int k = 0; k < count; ++k) {
    const double x = px[k], y = py[k], f = seed[k];
    const Partials d = partials<kind>(frame, x, y);
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
}

/// weight_k dφ(x_k, y_k)/dp for the seven parameters p, one column of `out` each (count x 7).
template <TdfSettings::Kind kind>
void fill_chain(const ComponentFrame& frame, int count, const double* px, const double* py,
                const double* weight, double* out) {
  const double sine = frame.sine(), cosine = frame.cosine();
  const std::ptrdiff_t n = count;
#pragma omp simd
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    const double x = px[k], y = py[k], f = weight[k];
    const Partials d = partials<kind>(frame, x, y);
    out[k] = f * (sine * d.y - cosine * d.x);
    out[n + k] = f * (-sine * d.x - cosine * d.y);
    out[2 * n + k] = f * d.L;
    out[3 * n + k] = f * (d.x * y - d.y * x);
    out[4 * n + k] = f * d.c1;
    out[5 * n + k] = f * d.c2;
    out[6 * n + k] = f * d.c3;
  }
}

/// Rectangle of the component's frame that holds every point with φ > cut (cut < 0).
///
/// distance: s < 1 + |cut| |∇s| there. In the direction with u/s = a, v/s = b the point is at
/// x = a s L, y = b s g, so that |x| < a L + |cut| a √(A² + (B L/g)²) and
/// |y| < b g + |cut| b √((A g/L)² + B²): largest over all directions, x with the thinner tip's g
/// (beyond a tip g is the end value), y with the largest g.
/// paper: (x/L)⁶ and (y/g)⁶ are below 1 + |cut|.
inline Box reach(const ComponentFrame& frame, TdfSettings::Kind kind, double cut) {
  const double L = frame.half_length(), top = frame.largest_half_thickness();
  constexpr double kRoundOff = 1 + 1e-9;
  if (kind == TdfSettings::Kind::paper) {
    const double grown = std::sqrt(std::cbrt(1 - cut)) * kRoundOff;
    return {{-L * grown, -top * grown}, {L * grown, top * grown}};
  }
  const double thin = std::min(frame.half_thickness(-L), frame.half_thickness(L));
  double along = 0, across = 0;
  constexpr int kDirections = 64;
  for (int k = 0; k <= kDirections; ++k) {
    const double a6 = static_cast<double>(k) / kDirections;
    const double a = std::sqrt(std::cbrt(a6)), b = std::sqrt(std::cbrt(1 - a6));
    const double A = fifth_power(a), B = fifth_power(b);
    along = std::max(along, a * (L - cut * std::hypot(A, B * L / thin)));
    across = std::max(across, b * (top - cut * std::hypot(A * top / L, B)));
  }
  constexpr double kBetween = 1.01;  // between two sampled directions
  return {{-along * kBetween, -across * kBetween}, {along * kBetween, across * kBetween}};
}

}  // namespace flexmorph::component_tdf_kernels
