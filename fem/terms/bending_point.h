#pragma once

#include <Eigen/Core>
#include <cmath>

#include "fem/shapes/batch.h"

/// Bending energy of a thin plate at one point of one element (V = double) or of eight elements
/// side by side (V = PackOf<...>).
namespace flexmorph::fem::bending {

/// A vector in space.
template <class V>
struct Vec {
  V x[3];  ///< Cartesian components.
  /// Returns a component of the vector.
  V& operator[](int c) { return x[c]; }
  /// Returns a component of the vector.
  const V& operator[](int c) const { return x[c]; }
};

/// Returns the scalar product of two vectors.
template <class V>
inline V dot(const Vec<V>& a, const Vec<V>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
/// Returns the vector product of two vectors.
template <class V>
inline Vec<V> cross(const Vec<V>& a, const Vec<V>& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}
/// Returns a vector multiplied by a number.
template <class V>
inline Vec<V> scaled(const V& s, const Vec<V>& a) {
  return {{s * a[0], s * a[1], s * a[2]}};
}

/// Returns the square root of a number.
inline double root(double x) { return std::sqrt(x); }
/// Returns the square roots of a pack of SIMD lanes.
template <int kWidth>
inline PackOf<kWidth> root(PackOf<kWidth> x) {
  for (int k = 0; k < kLanes; ++k) x[k] = std::sqrt(x[k]);
  return x;
}

/// Number of vectors at a point: r_m, r_n, r_mm, r_nn, r_mn.
inline constexpr int kVectors = 5;

/// Second derivatives of the energy: block (v, w) of the vectors, 3 x 3 by rows.
template <class V>
struct Hessian {
  V at[kVectors][kVectors][9];  ///< Entries of all blocks.
};

/// Energy density u = ½ κᵀ D κ at one point and its derivatives by y = (r_m, r_n, r_mm, r_nn,
/// r_mn).
///
///   n = r_m × r_n,   ν = n/|n|³,   a = (r_mm, r_nn, 2 r_mn),   κ_i = a_i · ν,   μ = D κ
///
///   δν = J δn,   J = |n|⁻³ (1 - 3 n̂ n̂ᵀ),   δn = [δr_m] r_n + r_m [δr_n]  (cross products)
///   δu = Σ μ_i (δa_i · ν) + p · δn,   p = J A,   A = Σ μ_i a_i
///   δ²u = δκᵀ D Δκ + Σ μ_i (δa_i · J Δn + Δa_i · J δn) + p · δ²n + δnᵀ Q Δn
///   Q = ∂p/∂n = |n|⁻⁵ (-3 (A nᵀ + n Aᵀ + (A·n) 1) + 15 (A·n) n̂ n̂ᵀ)
///
/// All are multiplied by a weight. Where n = 0 they are not finite.
template <class V>
class Point {
 public:
  /// Evaluates the energy density at the vectors y for a bending stiffness D, multiplied by a
  /// weight. It is always inlined, so that changes of the surrounding code do not change its
  /// rounding.
  [[gnu::always_inline]] Point(const Vec<V>* y, const Eigen::Matrix3d& stiffness, const V& weight)
      : r_m_(y[0]), r_n_(y[1]) {
    n_ = cross(r_m_, r_n_);
    square_inverse_ = 1.0 / dot(n_, n_);
    cube_inverse_ = square_inverse_ * root(square_inverse_);
    nu_ = scaled(cube_inverse_, n_);
    a_[0] = y[2];
    a_[1] = y[3];
    a_[2] = scaled(V{} + 2.0, y[4]);
    for (int i = 0; i < 3; ++i) kappa_[i] = dot(a_[i], nu_);
    for (int i = 0; i < 3; ++i) {
      moment_[i] = V{};
      for (int j = 0; j < 3; ++j) {
        D_[i][j] = stiffness(i, j) * weight;
        moment_[i] += D_[i][j] * kappa_[j];
      }
    }
    for (int c = 0; c < 3; ++c)
      A_[c] = moment_[0] * a_[0][c] + moment_[1] * a_[1][c] + moment_[2] * a_[2][c];
    p_ = times_J(A_);
  }

  /// Returns the energy density times the weight.
  V energy() const { return 0.5 * dot(kappa_, moment_); }

  /// Computes the first derivatives ∂u/∂y (5).
  void force(Vec<V>* out) const {
    out[0] = cross(r_n_, p_);
    out[1] = cross(p_, r_m_);
    for (int i = 0; i < 3; ++i) out[2 + i] = scaled(factor(i) * moment_[i], nu_);
  }

  /// Computes the second derivatives ∂²u/∂y², which are symmetric.
  void tangent(Hessian<V>& out) const {
    // ∂κ_i/∂r_m and ∂κ_i/∂r_n, and D times them.
    Vec<V> by_m[3], by_n[3], D_by_m[3], D_by_n[3];
    for (int i = 0; i < 3; ++i) {
      const Vec<V> ja = times_J(a_[i]);
      by_m[i] = cross(r_n_, ja);
      by_n[i] = cross(ja, r_m_);
    }
    for (int i = 0; i < 3; ++i)
      for (int c = 0; c < 3; ++c) {
        D_by_m[i][c] = D_[i][0] * by_m[0][c] + D_[i][1] * by_m[1][c] + D_[i][2] * by_m[2][c];
        D_by_n[i][c] = D_[i][0] * by_n[0][c] + D_[i][1] * by_n[1][c] + D_[i][2] * by_n[2][c];
      }
    of_derivatives(by_m, by_n, D_by_m, D_by_n, out);
    of_curvatures(D_by_m, D_by_n, out);
  }

 private:
  static constexpr double factor(int i) { return i == 2 ? 2.0 : 1.0; }  // a_i by y_(2+i)

  /// Returns J x = |n|⁻³ (x - 3 n (n·x)/|n|²).
  Vec<V> times_J(const Vec<V>& x) const {
    const V along = 3.0 * square_inverse_ * dot(n_, x);
    return scaled(cube_inverse_,
                  Vec<V>{{x[0] - along * n_[0], x[1] - along * n_[1], x[2] - along * n_[2]}});
  }

  /// Computes the blocks of r_m and r_n: δκᵀ D Δκ + δnᵀ Q Δn + p · δ²n.
  void of_derivatives(const Vec<V>* by_m, const Vec<V>* by_n, const Vec<V>* D_by_m,
                      const Vec<V>* D_by_n, Hessian<V>& out) const {
    Vec<V> Q[3], m_Q[3], n_Q[3];  // Q, and [r_n] Q and [r_m] Q, by rows
    const V l5 = square_inverse_ * cube_inverse_, along = dot(A_, n_),
            normal = 15.0 * square_inverse_ * along;
    for (int b = 0; b < 3; ++b) {
      for (int c = 0; c < 3; ++c)
        Q[b][c] = l5 * (normal * n_[b] * n_[c] - 3.0 * (A_[b] * n_[c] + n_[b] * A_[c]));
      Q[b][b] -= 3.0 * l5 * along;
    }
    for (int c = 0; c < 3; ++c) {  // Q is symmetric: its rows are its columns
      const Vec<V> m = cross(r_n_, Q[c]), n = cross(r_m_, Q[c]);
      for (int b = 0; b < 3; ++b) {
        m_Q[b][c] = m[b];
        n_Q[b][c] = n[b];
      }
    }
    for (int b = 0; b < 3; ++b) {
      const Vec<V> mm = cross(r_n_, m_Q[b]), mn = cross(m_Q[b], r_m_), nn = cross(r_m_, n_Q[b]);
      for (int c = 0; c < 3; ++c) {
        V m_m = mm[c], m_n = mn[c], n_n = nn[c];
        for (int i = 0; i < 3; ++i) {
          m_m += by_m[i][b] * D_by_m[i][c];
          m_n += by_m[i][b] * D_by_n[i][c];
          n_n += by_n[i][b] * D_by_n[i][c];
        }
        out.at[0][0][3 * b + c] = m_m;
        out.at[0][1][3 * b + c] = m_n;
        out.at[1][1][3 * b + c] = n_n;
      }
    }
    V* mixed = out.at[0][1];  // - [p]
    mixed[1] += p_[2];
    mixed[2] -= p_[1];
    mixed[3] -= p_[2];
    mixed[5] += p_[0];
    mixed[6] += p_[1];
    mixed[7] -= p_[0];
    transpose(out.at[0][1], out.at[1][0]);
  }

  /// Computes the blocks that involve the second derivatives r_mm, r_nn and r_mn.
  void of_curvatures(const Vec<V>* D_by_m, const Vec<V>* D_by_n, Hessian<V>& out) const {
    V m_J[9], n_J[9];  // (∂n/∂r_m)ᵀ J = [r_n] J, (∂n/∂r_n)ᵀ J = -[r_m] J
    for (int c = 0; c < 3; ++c) {
      const V along = 3.0 * square_inverse_ * n_[c];
      Vec<V> column;
      for (int b = 0; b < 3; ++b)
        column[b] = cube_inverse_ * ((b == c ? 1.0 : 0.0) - along * n_[b]);
      const Vec<V> m = cross(r_n_, column), n = cross(column, r_m_);
      for (int b = 0; b < 3; ++b) {
        m_J[3 * b + c] = m[b];
        n_J[3 * b + c] = n[b];
      }
    }
    for (int i = 0; i < 3; ++i) {
      for (int b = 0; b < 3; ++b)
        for (int c = 0; c < 3; ++c) {
          out.at[0][2 + i][3 * b + c] =
              factor(i) * (D_by_m[i][b] * nu_[c] + moment_[i] * m_J[3 * b + c]);
          out.at[1][2 + i][3 * b + c] =
              factor(i) * (D_by_n[i][b] * nu_[c] + moment_[i] * n_J[3 * b + c]);
        }
      transpose(out.at[0][2 + i], out.at[2 + i][0]);
      transpose(out.at[1][2 + i], out.at[2 + i][1]);
      for (int k = 0; k < 3; ++k)
        for (int b = 0; b < 3; ++b)
          for (int c = 0; c < 3; ++c)
            out.at[2 + i][2 + k][3 * b + c] = factor(i) * factor(k) * D_[i][k] * nu_[b] * nu_[c];
    }
  }

  static void transpose(const V* from, V* to) {
    for (int b = 0; b < 3; ++b)
      for (int c = 0; c < 3; ++c) to[3 * c + b] = from[3 * b + c];
  }

  Vec<V> r_m_, r_n_, n_, nu_, kappa_, moment_, A_, p_;
  Vec<V> a_[3];
  V D_[3][3];
  V square_inverse_, cube_inverse_;  // |n|⁻², |n|⁻³
};

}  // namespace flexmorph::fem::bending
