#include "fem/shapes/strain.h"

#include <Eigen/Geometry>
#include <cmath>

namespace flexmorph::fem {
namespace {

using Mat3 = Eigen::Matrix3d;

class GreenLagrange final : public StrainMeasure {
 public:
  int size() const override { return 3; }
  std::span<const Measure> measures() const override {
    static constexpr Measure kList[] = {{1, 0}, {0, 1}};
    return kList;
  }
  void strain(const Measures& z, StrainVector& e, StrainVariation* variation) const override {
    const auto r_m = z.row(0), r_n = z.row(1);
    const Eigen::Index d = z.cols();
    e.resize(3);
    e << 0.5 * (r_m.squaredNorm() - 1), 0.5 * (r_n.squaredNorm() - 1), r_m.dot(r_n);
    if (!variation) return;
    variation->setZero(3, 2 * d);
    variation->row(0).head(d) = r_m;
    variation->row(1).tail(d) = r_n;
    variation->row(2) << r_n, r_m;
  }
  void second_variation(int i, const Measures& z, MeasureHessian& out) const override {
    const Eigen::Index d = z.cols();
    out.setZero(2 * d, 2 * d);
    if (i < 2) {
      out.diagonal().segment(i * d, d).setOnes();
    } else {
      out.topRightCorner(d, d).setIdentity();
      out.bottomLeftCorner(d, d).setIdentity();
    }
  }
};

/// Returns [x]× with [x]× y = x × y.
Mat3 crossing(const Vec3& x) {
  Mat3 out;
  out << 0, -x[2], x[1], x[2], 0, -x[0], -x[1], x[0], 0;
  return out;
}

/// With a = (r_mm, r_nn, 2 r_mn), ν = n/|n|³ and n = r_m × r_n:
///
///   κ_i = a_i · ν(n),   δν = J δn,   J = |n|⁻³ (1 - 3 n̂ n̂ᵀ),   δn = G (δr_m, δr_n)
///   ∂(J a)/∂n = |n|⁻⁵ (-3 (a nᵀ + n aᵀ + (a·n) 1) + 15 (a·n) n̂ n̂ᵀ)
class PlateCurvature final : public StrainMeasure {
 public:
  int size() const override { return 3; }
  std::span<const Measure> measures() const override {
    static constexpr Measure kList[] = {{1, 0}, {0, 1}, {2, 0}, {0, 2}, {1, 1}};
    return kList;
  }
  void strain(const Measures& z, StrainVector& e, StrainVariation* variation) const override {
    const Point at(z);
    e.resize(3);
    if (variation) variation->setZero(3, 15);
    for (int i = 0; i < 3; ++i) {
      e[i] = at.a(i).dot(at.nu);
      if (!variation) continue;
      variation->block<1, 6>(i, 0) = (at.J * at.a(i)).transpose() * at.G;
      variation->block<1, 3>(i, 6 + 3 * i) = kFactor[i] * at.nu.transpose();
    }
  }
  void second_variation(int i, const Measures& z, MeasureHessian& out) const override {
    const Point at(z);
    const Vec3 a = at.a(i), along = at.J * a;
    const double length = at.n.norm(), a_n = a.dot(at.n);
    const Mat3 Q = (-3 * (a * at.n.transpose() + at.n * a.transpose() + a_n * Mat3::Identity()) +
                    15 * a_n / (length * length) * at.n * at.n.transpose()) /
                   std::pow(length, 5);
    out.setZero(15, 15);
    out.block<6, 6>(0, 0) = at.G.transpose() * Q * at.G;
    // Second derivative of the cross product: along · (δr_m × Δr_n + Δr_m × δr_n).
    out.block<3, 3>(0, 3) -= crossing(along);
    out.block<3, 3>(3, 0) += crossing(along);
    out.block<6, 3>(0, 6 + 3 * i) = kFactor[i] * at.G.transpose() * at.J;
    out.block<3, 6>(6 + 3 * i, 0) = out.block<6, 3>(0, 6 + 3 * i).transpose();
  }

 private:
  static constexpr double kFactor[] = {1, 1, 2};  // factors of a_i
  struct Point {
    explicit Point(const Measures& measures) : z(measures) {
      const Vec3 r_m = z.row(0).transpose(), r_n = z.row(1).transpose();
      n = r_m.cross(r_n);
      const double length = n.norm();
      nu = n / std::pow(length, 3);
      J = (Mat3::Identity() - 3 / (length * length) * n * n.transpose()) / std::pow(length, 3);
      G << -crossing(r_n), crossing(r_m);
    }
    Vec3 a(int i) const { return kFactor[i] * z.row(2 + i).transpose(); }

    const Measures& z;
    Vec3 n, nu;
    Mat3 J;
    Eigen::Matrix<double, 3, 6> G;
  };
};

}  // namespace

const StrainMeasure& green_lagrange() {
  static const GreenLagrange kMeasure;
  return kMeasure;
}

const StrainMeasure& plate_curvature() {
  static const PlateCurvature kMeasure;
  return kMeasure;
}

double StrainDensity::energy(const Measures& z, Measures* gradient, MeasureHessian* hessian) const {
  StrainVector e, stress;
  StrainVariation variation;
  StrainSquare stiffness;
  const bool derive = gradient || hessian;
  strain_->strain(z, e, derive ? &variation : nullptr);
  const double out = of_strain(e, derive ? &stress : nullptr, hessian ? &stiffness : nullptr);
  if (gradient) {
    const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxMeasures * kMaxDim, 1> flat =
        variation.transpose() * stress;
    *gradient = Eigen::Map<const Measures>(flat.data(), z.rows(), z.cols());
  }
  if (hessian) {
    *hessian = variation.transpose() * stiffness * variation;
    MeasureHessian second;
    for (int i = 0; i < strain_->size(); ++i) {
      strain_->second_variation(i, z, second);
      *hessian += stress[i] * second;
    }
  }
  return out;
}

double LinearDensity::of_strain(const StrainVector& e, StrainVector* stress,
                                StrainSquare* stiffness) const {
  const StrainVector s = stiffness_ * e;
  if (stress) *stress = s;
  if (stiffness) *stiffness = stiffness_;
  return 0.5 * e.dot(s);
}

}  // namespace flexmorph::fem
