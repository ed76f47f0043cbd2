#pragma once

#include <memory>
#include <span>
#include <vector>

#include "fem/element.h"

/// Densities: functions of the strains at a point, from which a term is built. The forces and
/// matrices that the interface Term needs follow from them in one file (terms/density_term.h).
namespace flexmorph::fem {

/// A derivative ∂^(m + n) r / ∂m^m ∂n^n of the position.
struct Measure {
  int m_order, n_order;  ///< Orders of the derivatives by m and by n.
};
/// Largest numbers of measures and of strains at a point. There are at most six strains; eight fill
/// a vector register, and with six GCC 12 warns of loads that never happen.
inline constexpr int kMaxMeasures = 5, kMaxStrains = 8;
/// Values of the measures at a point, one row per measure.
using Measures =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kMaxMeasures, kMaxDim>;
/// Second derivatives by the measures; entry dim i + c belongs to measure i, direction c.
using MeasureHessian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0,
                                     kMaxMeasures * kMaxDim, kMaxMeasures * kMaxDim>;
/// Vector of the strains at a point.
using StrainVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxStrains, 1>;
/// Matrix of derivatives of stresses by strains.
using StrainSquare =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxStrains, kMaxStrains>;
/// Derivatives of the strains by the measures; the columns are ordered as in MeasureHessian.
using StrainVariation =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxStrains, kMaxMeasures * kMaxDim>;

/// Interface of an elastic energy per reference area as a function of derivatives of the position.
class EnergyDensity {
 public:
  virtual ~EnergyDensity() = default;
  /// Returns the derivatives of the position that the density depends on.
  virtual std::span<const Measure> measures() const = 0;
  /// Returns W(z) [J/m²]; fills the gradient and the hessian by z unless they are null.
  virtual double energy(const Measures& z, Measures* gradient, MeasureHessian* hessian) const = 0;
};

/// Interface of strains at a point as functions of derivatives of the position, e = e(z). They do
/// not change in a rigid motion of the body.
class StrainMeasure {
 public:
  virtual ~StrainMeasure() = default;
  /// Returns the number of strains at a point, <= kMaxStrains.
  virtual int size() const = 0;
  /// Returns the derivatives of the position that the strains depend on.
  virtual std::span<const Measure> measures() const = 0;
  /// Evaluates the strains e(z).
  /// @param variation  ∂e/∂z (size x n_z), or null
  virtual void strain(const Measures& z, StrainVector& e, StrainVariation* variation) const = 0;
  /// Evaluates the second derivatives ∂²e_i/∂z² (n_z x n_z).
  virtual void second_variation(int i, const Measures& z, MeasureHessian& out) const = 0;
};
/// Returns the Green-Lagrange strain (½(r_m·r_m - 1), ½(r_n·r_n - 1), r_m·r_n) [-], P (6).
const StrainMeasure& green_lagrange();
/// Returns the curvature of a plate in space (r_mm·n, r_nn·n, 2 r_mn·n)/|n|³ with n = r_m × r_n
/// [1/m], P (7).
const StrainMeasure& plate_curvature();

/// Interface of an elastic energy per reference area as a function of strains.
class StrainDensity : public EnergyDensity {
 public:
  /// Creates a density of the given strains.
  /// @param strain  must exist as long as the density
  explicit StrainDensity(const StrainMeasure& strain) : strain_(&strain) {}
  /// Returns the strains that the density depends on.
  const StrainMeasure& strain() const { return *strain_; }
  /// Returns W(e) [J/m²]; fills the stress ∂W/∂e and its derivative by e unless they are null.
  virtual double of_strain(const StrainVector& e, StrainVector* stress,
                           StrainSquare* stiffness) const = 0;

  std::span<const Measure> measures() const override { return strain_->measures(); }
  /// Evaluates W(e(z)) by the chain rule.
  double energy(const Measures& z, Measures* gradient, MeasureHessian* hessian) const override;

 private:
  const StrainMeasure* strain_;
};

/// The quadratic energy density W = ½ eᵀ D e.
class LinearDensity : public StrainDensity {
 public:
  /// Creates the density with the stiffness D.
  /// @param stiffness  D, symmetric [J/m² per strain²]
  LinearDensity(const StrainMeasure& strain, const StrainSquare& stiffness)
      : StrainDensity(strain), stiffness_(stiffness) {}
  /// Returns the stiffness D [J/m² per strain²].
  const StrainSquare& stiffness() const { return stiffness_; }
  double of_strain(const StrainVector& e, StrainVector* stress,
                   StrainSquare* stiffness) const override;

 private:
  StrainSquare stiffness_;
};

/// Interface of the power per reference area that is dissipated by strain rates.
class DissipationDensity {
 public:
  virtual ~DissipationDensity() = default;
  /// Returns the strains that the density depends on.
  virtual const StrainMeasure& strain() const = 0;
  /// Evaluates the stress s(e, ė), with the power s · ė >= 0 [W/m²], and its derivatives ∂s/∂e and
  /// ∂s/∂ė unless they are null.
  virtual void stress(const StrainVector& e, const StrainVector& rate, StrainVector& stress,
                      StrainSquare* by_strain, StrainSquare* by_rate) const = 0;
};

/// Points of an element at which the density is evaluated, and the strains there. With e_i the i-th
/// strain of the measures at all points and n the number of strains, strain i of the density is
/// mix[i] e_i with n matrices or, with n² matrices, Σ_j mix[n i + j] e_j, in which empty matrices
/// are zero.
struct StrainTable {
  VectorXd weight;                ///< Reference area times the scale factor (n_points) [m²].
  std::vector<MatrixXd> measure;  ///< Matrices of z_i = measure[i] q (n_points x n_shapes).

  /// Rates ∂measure/∂t at a fixed material point; empty if no line moves.
  std::vector<MatrixXd> rate;
  /// Matrices (n_points x n_points) and their rates ∂mix/∂t. Empty: identity, and zero rates.
  std::vector<MatrixXd> mix, mix_rate;
};

/// The data from which a strain table is filled.
struct StrainSource {
  const Element& element;       ///< Elements of the body.
  const ScaleFactors& factors;  ///< Scale factors of the design.
  MatrixXd reference;           ///< Reference values, see Element::reference().
};

/// Interface of the sampling of the strains of an element: the points, and the interpolation
/// between them.
class StrainSampling {
 public:
  virtual ~StrainSampling() = default;
  /// Fills the table of element e, with rates where its lines move.
  virtual void tabulate(const StrainSource& from, int e, StrainTable& out) const = 0;
  /// Returns true if the strains are the strains of the measures at points of degree() with the
  /// tables of what(); free lines require it.
  virtual bool is_pointwise() const { return false; }
  /// Returns the polynomial degree of the quadrature of a pointwise sampling.
  virtual int degree() const { return 0; }
  /// Returns the tables that a pointwise sampling needs.
  virtual Tabulate what() const { return Tabulate::gradient; }
  /// Replaces the strains at points of an m-line by the sampled strains (n x size of the strain).
  virtual void along_line(MatrixXd& /*strains*/) const {}
};

/// A density with its sampling over the elements of a body; a term consists of one or more of them.
template <class Density>
struct Sampled {
  std::shared_ptr<const Density> density;          ///< Density at a point.
  std::shared_ptr<const StrainSampling> sampling;  ///< Sampling of the strains in an element.
};
/// Elastic density with its sampling.
using ElasticPart = Sampled<StrainDensity>;
/// Dissipation density with its sampling.
using DissipativePart = Sampled<DissipationDensity>;

}  // namespace flexmorph::fem
