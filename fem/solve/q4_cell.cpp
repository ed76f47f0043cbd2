#include "fem/solve/q4_cell.h"

#include <cmath>
#include <cstddef>

namespace flexmorph::fem {

Eigen::Matrix<double, 8, 8> q4_stiffness(const PlaneSection& s, double dx, double dy) {
  const Eigen::Matrix3d D = s.thickness * s.elasticity();
  const double gauss = 1 / std::sqrt(3.0), weight = dx * dy / 4;
  Eigen::Matrix<double, 8, 8> K = Eigen::Matrix<double, 8, 8>::Zero();
  for (double xi : {-gauss, gauss}) {
    for (double eta : {-gauss, gauss}) {
      Eigen::Matrix<double, 3, 8> B = Eigen::Matrix<double, 3, 8>::Zero();
      for (std::size_t a = 0; a < 4; ++a) {
        const double xi_a = 2 * kCornerI[a] - 1, eta_a = 2 * kCornerJ[a] - 1;
        const double N_x = xi_a * (1 + eta_a * eta) / 4 * (2 / dx);
        const double N_y = eta_a * (1 + xi_a * xi) / 4 * (2 / dy);
        const auto k = static_cast<Eigen::Index>(2 * a);
        B.col(k) << N_x, 0, N_y;
        B.col(k + 1) << 0, N_y, N_x;
      }
      K += weight * B.transpose() * D * B;
    }
  }
  return K;
}

Eigen::Matrix4d q4_mass(const PlaneSection& s, double dx, double dy) {
  Eigen::Matrix4d m;
  m << 4, 2, 1, 2,  //
      2, 4, 2, 1,   //
      1, 2, 4, 2,   //
      2, 1, 2, 4;
  return s.density * s.thickness * dx * dy / 36 * m;
}

Q4Energy::Q4Energy(const PlaneSection& s, double dx, double dy) {
  const Eigen::Matrix3d D = s.thickness * s.elasticity();
  const double normal = D(0, 0), shear = D(2, 2);
  s_u_ = normal * dy / (4 * dx);
  d_v_ = normal * dx / (4 * dy);
  coupling_ = D(0, 1) / 2;
  d_u_ = 1 / dy;
  s_v_ = 1 / dx;
  shear_ = shear * dx * dy / 4;
  h_u_ = (normal * dy * dy + shear * dx * dx) / (12 * dx * dy);
  h_v_ = (normal * dx * dx + shear * dy * dy) / (12 * dx * dy);
}

void Q4Energy::weighted(const Corners& c, const double* w_, Eigen::Index n, double* energy_) const {
  const Q4Energy k = *this;
  const double* __restrict u0 = c.u[0], * __restrict u1 = c.u[1], * __restrict u2 = c.u[2], * __restrict u3 = c.u[3], * __restrict v0 = c.v[0], * __restrict v1 = c.v[1], * __restrict v2 = c.v[2], * __restrict v3 = c.v[3], * __restrict w = w_;
  double* __restrict energy = energy_;
  for (Eigen::Index l = 0; l < n; ++l) {
    const double u_bottom = u1[l] - u0[l], u_top = u2[l] - u3[l], u_left = u3[l] - u0[l];
    const double v_bottom = v1[l] - v0[l], v_top = v2[l] - v3[l], v_left = v3[l] - v0[l];
    const double s_u = u_bottom + u_top, h_u = u_top - u_bottom, d_u = 2 * u_left + h_u;
    const double s_v = v_bottom + v_top, h_v = v_top - v_bottom, d_v = 2 * v_left + h_v;
    const double gamma = k.d_u_ * d_u + k.s_v_ * s_v;
    energy[l] = w[l] * (k.s_u_ * s_u * s_u + k.d_v_ * d_v * d_v + k.coupling_ * s_u * d_v +
                        k.shear_ * gamma * gamma + k.h_u_ * h_u * h_u + k.h_v_ * h_v * h_v);
  }
}

void Q4MassProduct::multiply(const Corners& z, const Corners& a, Eigen::Index n,
                             double* product_) const {
  const double* __restrict z0 = z[0], * __restrict z1 = z[1], * __restrict z2 = z[2], * __restrict z3 = z[3], * __restrict a0 = a[0], * __restrict a1 = a[1], * __restrict a2 = a[2], * __restrict a3 = a[3];
  double* __restrict product = product_;
  const double mass = mass_;
  for (Eigen::Index l = 0; l < n; ++l) {
    const double z_left = z0[l] + z3[l], z_right = z1[l] + z2[l];
    const double a_left = a0[l] + a3[l], a_right = a1[l] + a2[l];
    const double dz_left = z3[l] - z0[l], dz_right = z2[l] - z1[l];
    const double da_left = a3[l] - a0[l], da_right = a2[l] - a1[l];
    // Eigenvalues of M: 9 for the mean, 3 for the two gradients, 1 for the hourglass shape.
    product[l] = mass * (9 * (z_left + z_right) * (a_left + a_right) +
                         3 * (z_right - z_left) * (a_right - a_left) +
                         3 * (dz_left + dz_right) * (da_left + da_right) +
                         (dz_right - dz_left) * (da_right - da_left));
  }
}

}  // namespace flexmorph::fem
