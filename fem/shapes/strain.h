#pragma once

#include <memory>
#include <span>
#include <vector>

#include "fem/element.h"

/// Densities: what a term made of strains brings. Everything else that the seam of virtual work
/// asks for follows in one place (terms/density_term.h).
namespace flexmorph::fem {

/// A derivative ∂^(m + n) r / ∂m^m ∂n^n of the position.
struct Measure {
  int m_order, n_order;
};
/// Six strains are the most there are; room for a vector register, or GCC 12 warns of loads that
/// never happen.
inline constexpr int kMaxMeasures = 5, kMaxStrains = 8;
using Measures = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor,
                               kMaxMeasures, kMaxDim>;  ///< a row per measure
using MeasureHessian =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxMeasures * kMaxDim,
                  kMaxMeasures * kMaxDim>;  ///< entry dim i + c of measure i, direction c
using StrainVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxStrains, 1>;
using StrainSquare =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxStrains, kMaxStrains>;
using StrainVariation = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxStrains,
                                      kMaxMeasures * kMaxDim>;  ///< columns as of MeasureHessian

/// Elastic energy per reference area as a function of derivatives of the position.
class EnergyDensity {
 public:
  virtual ~EnergyDensity() = default;
  virtual std::span<const Measure> measures() const = 0;
  /// W(z) [J/m²]; gradient and hessian by z where asked for.
  virtual double energy(const Measures& z, Measures* gradient, MeasureHessian* hessian) const = 0;
};

/// Strains of a point by derivatives of the position, e = e(z). They do not change when the body
/// moves as a rigid one.
class StrainMeasure {
 public:
  virtual ~StrainMeasure() = default;
  virtual int size() const = 0;  ///< strains of a point, <= kMaxStrains
  virtual std::span<const Measure> measures() const = 0;
  /// @param variation  ∂e/∂z where asked for (size x n_z)
  virtual void strain(const Measures& z, StrainVector& e, StrainVariation* variation) const = 0;
  /// out = ∂²e_i/∂z² (n_z x n_z).
  virtual void second_variation(int i, const Measures& z, MeasureHessian& out) const = 0;
};
/// (½(r_m·r_m - 1), ½(r_n·r_n - 1), r_m·r_n), the strain of Green and Lagrange [-], P (6).
const StrainMeasure& green_lagrange();
/// (r_mm·n, r_nn·n, 2 r_mn·n)/|n|³, n = r_m × r_n: the curvature of a plate in space [1/m], P (7).
const StrainMeasure& plate_curvature();

/// Elastic energy per reference area as a function of strains.
class StrainDensity : public EnergyDensity {
 public:
  /// @param strain  outlives the density
  explicit StrainDensity(const StrainMeasure& strain) : strain_(&strain) {}
  const StrainMeasure& strain() const { return *strain_; }
  /// W(e) [J/m²]; stress ∂W/∂e and its derivative by e where asked for.
  virtual double of_strain(const StrainVector& e, StrainVector* stress,
                           StrainSquare* stiffness) const = 0;

  std::span<const Measure> measures() const override { return strain_->measures(); }
  /// By the chain rule.
  double energy(const Measures& z, Measures* gradient, MeasureHessian* hessian) const override;

 private:
  const StrainMeasure* strain_;
};

/// W = ½ eᵀ D e.
class LinearDensity : public StrainDensity {
 public:
  /// @param stiffness  D, symmetric [J/m² per strain²]
  LinearDensity(const StrainMeasure& strain, const StrainSquare& stiffness)
      : StrainDensity(strain), stiffness_(stiffness) {}
  const StrainSquare& stiffness() const { return stiffness_; }
  double of_strain(const StrainVector& e, StrainVector* stress,
                   StrainSquare* stiffness) const override;

 private:
  StrainSquare stiffness_;
};

/// Power per reference area that strains dissipate while they change.
class DissipationDensity {
 public:
  virtual ~DissipationDensity() = default;
  virtual const StrainMeasure& strain() const = 0;
  /// The stress s(e, ė), of which s · ė >= 0 is the power [W/m²]; ∂s/∂e and ∂s/∂ė where asked for.
  virtual void stress(const StrainVector& e, const StrainVector& rate, StrainVector& stress,
                      StrainSquare* by_strain, StrainSquare* by_rate) const = 0;
};

/// Points of an element at which its density is taken, and the strains there: with e the strains
/// of the measures at all points, strain i of n of the density is mix[i] e_i; or, with n² matrices,
/// Σ_j mix[n i + j] e_j, empty ones being zero.
struct StrainTable {
  VectorXd weight;                      ///< reference area times the factor (n_points) [m²]
  std::vector<MatrixXd> measure;        ///< z_i = measure[i] q (n_points x n_shapes)
  std::vector<MatrixXd> rate;           ///< ∂measure/∂t at fixed material point; none: still
  std::vector<MatrixXd> mix, mix_rate;  ///< (n_points x n_points) and ∂mix/∂t; none: 1, still
};

/// What a table is made from.
struct StrainSource {
  const Element& element;
  const Factors& factors;
  MatrixXd reference;  ///< Element::reference()
};

/// How the strains of an element are sampled.
class StrainSampling {
 public:
  virtual ~StrainSampling() = default;
  /// Fills the table of an element, with rates where its lines move.
  virtual void tabulate(const StrainSource& from, int e, StrainTable& out) const = 0;
  /// Are strains those of the measures at points of degree() with the tables of what()? Free lines
  /// ask for that.
  virtual bool is_pointwise() const { return false; }
  virtual int degree() const { return 0; }
  virtual Tabulate what() const { return Tabulate::gradient; }
  /// Strains on an m-line out of those of its points (n x size of the strain).
  virtual void along_line(MatrixXd& /*strains*/) const {}
};

/// A density over the elements of a body. A term is made of one or more of them.
template <class Density>
struct Sampled {
  std::shared_ptr<const Density> density;
  std::shared_ptr<const StrainSampling> sampling;
};
using ElasticPart = Sampled<StrainDensity>;
using DissipativePart = Sampled<DissipationDensity>;

}  // namespace flexmorph::fem
