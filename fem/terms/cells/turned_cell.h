#pragma once

#include <cmath>

#include "fem/shapes/batch.h"

/// A cell with small strains in a corotational frame. This energy prevents nearly empty cells from
/// turning inside out. (The energy of St. Venant and Kirchhoff is soft in compression: an element
/// passes through itself at a small pressure, which occurs in void cells early.)
///
///   U = ½ dᵀ K d,   d = Rᵀ p - P,   R(θ) of the polar decomposition of the mean gradient F:
///   θ = atan2(F₂₁ - F₁₂, F₁₁ + F₂₂)
///
/// p, P: the three vectors of a plane bilinear cell (fem/terms/gram.h), deformed and undeformed; K:
/// the stiffness of small strains for these vectors. U does not change under translations and
/// rotations. Therefore the sum of the forces and their moment are always zero, whatever rigid
/// motion the body performs. K times an infinitesimal rotation of P is zero, so that the linear
/// limit is K.
///
/// Source: polar decomposition in the plane, e.g. Moita, Crisfield (1996), Int. J. Numer. Meth.
/// Engng 39, 3775-3792; energy interpolation between void and material: Wang et al. (2014), Comput.
/// Methods Appl. Mech. Engng 276, 453-472.
namespace flexmorph::fem::turned_cell {

/// Number of vectors of a cell and number of their components.
inline constexpr int kVectors = 3, kSize = 2 * kVectors;

/// Returns the square root of a number.
inline double root_of(double x) { return std::sqrt(x); }
/// Returns the square roots of a pack of SIMD lanes.
template <int kWidth>
inline PackOf<kWidth> root_of(PackOf<kWidth> x) {
  for (int k = 0; k < kLanes; ++k) x[k] = std::sqrt(x[k]);
  return x;
}

/// Rotates the vectors x by the angle with cosine c and sine s.
template <class V>
inline void turn(const V& c, const V& s, const V* x, V* out) {
  for (int k = 0; k < kSize; k += 2) {
    out[k] = c * x[k] - s * x[k + 1];
    out[k + 1] = s * x[k] + c * x[k + 1];
  }
}

/// Quantities that the force and the tangent of a cell share.
template <class V>
struct State {
  V c, s;                ///< Cosine and sine of θ.
  V y[kSize], f[kSize];  ///< Rᵀ p and K d.
  V moment;              ///< ∂U/∂θ at fixed p.
  V slope[kSize];        ///< Gradient ∂θ/∂p.
  /// Gradients of C = F₁₁ + F₂₂ and of S = F₂₁ - F₁₂, which are linear in p.
  V dc[kSize], ds[kSize];
  V C, S, square;  ///< C, S and C² + S².
  V energy;        ///< Energy U.
};

/// Returns the state of a cell with the vectors p.
/// @param stiffness  K (kSize x kSize)
/// @param reference  P (kSize): (½ a, 0), (0, ½ b), (0, 0)
template <class V>
inline State<V> state_of(const V* stiffness, const V* p, const V* reference) {
  State<V> t;
  const V zero{}, m = 1.0 / reference[0], n = 1.0 / reference[3];
  for (int k = 0; k < kSize; ++k) t.dc[k] = t.ds[k] = zero;
  t.dc[0] = m;
  t.dc[3] = n;
  t.ds[1] = m;
  t.ds[2] = -n;
  t.C = p[0] * m + p[3] * n;
  t.S = p[1] * m - p[2] * n;
  t.square = t.C * t.C + t.S * t.S;
  const V size = root_of(t.square);
  t.c = t.C / size;
  t.s = t.S / size;
  turn<V>(t.c, -t.s, p, t.y);
  V d[kSize];
  for (int k = 0; k < kSize; ++k) d[k] = t.y[k] - reference[k];
  t.energy = zero;
  for (int k = 0; k < kSize; ++k) {
    t.f[k] = zero;
    for (int l = 0; l < kSize; ++l) t.f[k] += stiffness[k * kSize + l] * d[l];
    t.energy += 0.5 * t.f[k] * d[k];
  }
  t.moment = zero;  // ∂y/∂θ = -J y
  for (int k = 0; k < kSize; k += 2) t.moment += t.f[k] * t.y[k + 1] - t.f[k + 1] * t.y[k];
  for (int k = 0; k < kSize; ++k) t.slope[k] = (t.C * t.ds[k] - t.S * t.dc[k]) / t.square;
  return t;
}

/// Adds weight ∂U/∂p (kSize).
template <class V>
inline void add_force(const State<V>& t, const V& weight, V* force) {
  V turned[kSize];
  turn<V>(t.c, t.s, t.f, turned);
  for (int k = 0; k < kSize; ++k) force[k] += weight * (turned[k] + t.moment * t.slope[k]);
}

/// Adds weight ∂²U/∂p² (2 x 2 blocks k <= l, in the order of gram::stiffness_of()).
///
///   R K Rᵀ + h ⊗ τ + τ ⊗ h + m' τ ⊗ τ + m ∂²θ,   τ = ∂θ,  h = R (J f - K J y),
///   m = -f · J y,   m' = Jy · K Jy - f · y
template <class V>
inline void add_stiffness(const V* stiffness, const State<V>& t, const V& weight, V* out) {
  V jy[kSize], kjy[kSize], bent[kSize], h[kSize];
  for (int k = 0; k < kSize; k += 2) {
    jy[k] = -t.y[k + 1];
    jy[k + 1] = t.y[k];
  }
  V twice{};
  for (int k = 0; k < kSize; ++k) {
    kjy[k] = V{};
    for (int l = 0; l < kSize; ++l) kjy[k] += stiffness[k * kSize + l] * jy[l];
    twice += jy[k] * kjy[k] - t.f[k] * t.y[k];
  }
  for (int k = 0; k < kSize; k += 2) {
    bent[k] = -t.f[k + 1] - kjy[k];
    bent[k + 1] = t.f[k] - kjy[k + 1];
  }
  turn<V>(t.c, t.s, bent, h);
  // Second derivatives of the angle of (C, S) with respect to C and S.
  const V fourth = t.square * t.square, both = 2.0 * t.C * t.S / fourth,
          mixed = (t.S * t.S - t.C * t.C) / fourth;
  for (int k = 0; k < kVectors; ++k)
    for (int l = k; l < kVectors; ++l) {
      const V* block = stiffness + 2 * k * kSize + 2 * l;
      const V xx = block[0], xy = block[1], yx = block[kSize], yy = block[kSize + 1];
      // One block of R K Rᵀ.
      const V left[4] = {t.c * xx - t.s * yx, t.c * xy - t.s * yy, t.s * xx + t.c * yx,
                         t.s * xy + t.c * yy};
      const V turned[4] = {left[0] * t.c - left[1] * t.s, left[0] * t.s + left[1] * t.c,
                           left[2] * t.c - left[3] * t.s, left[2] * t.s + left[3] * t.c};
      for (int x = 0; x < 2; ++x)
        for (int c = 0; c < 2; ++c) {
          const int i = 2 * k + x, j = 2 * l + c;
          const V second = both * (t.dc[i] * t.dc[j] - t.ds[i] * t.ds[j]) +
                           mixed * (t.dc[i] * t.ds[j] + t.ds[i] * t.dc[j]);
          out[(k * kVectors + l) * 4 + x * 2 + c] +=
              weight * (turned[x * 2 + c] + h[i] * t.slope[j] + t.slope[i] * h[j] +
                        twice * t.slope[i] * t.slope[j] + t.moment * second);
        }
    }
}

}  // namespace flexmorph::fem::turned_cell
