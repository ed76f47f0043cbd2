#pragma once

#include "fem/shapes/strain.h"
#include "fem/term.h"

namespace flexmorph::fem {

/// Strains of one element at all points of its table, their rates and variations, and the virtual
/// work of stresses on them. The work space is kept, so that one object per thread serves any
/// element.
class StrainField {
 public:
  /// Computes the strains at q (n_strains x n_points).
  void set(const StrainMeasure& measure, const StrainTable& table, const LocalRows& q);
  /// Returns the strains of the last set() (n_strains x n_points).
  const MatrixXd& strain() const { return strain_; }

  /// Computes the rates ė of the strains for the rates v of the unknowns; v = 0 gives the rates due
  /// to material flow alone.
  void set_rate(const LocalRows& q, const LocalRows& v);
  /// Returns the rates of the last set_rate() (n_strains x n_points).
  const MatrixXd& rate() const { return rate_; }

  /// Adds Σ ∂e/∂q · stress to the force, with stresses times the weights of their points (n_strains
  /// x n_points).
  void add_force(const MatrixXd& stress, LocalRows& force);

  /// Computes and returns ∂e/∂q, row n_points i + p for strain i at point p; call it after set().
  const MatrixXd& variation();
  /// Computes and returns w.q ∂ė/∂q + w.v ∂ė/∂v, rows as in variation(); call it after set_rate()
  /// and variation().
  const MatrixXd& rate_variation(const Weights& w);
  /// Adds scale Σ stress · ∂²e/∂q² to the tangent.
  void add_second(const MatrixXd& stress, double scale, LocalTangent& tangent);

 private:
  Eigen::Index n_points() const { return table_->weight.size(); }
  /// Applies the mixing matrices to the strains of the measures (rows: strains).
  void mix(const std::vector<MatrixXd>& by, const MatrixXd& from, MatrixXd& to) const;
  /// Applies the transposed mixing matrices to stresses.
  const MatrixXd& unmixed(const MatrixXd& stress);
  /// Applies the mixing matrices to variations (rows: strains and points).
  void mix_rows(const std::vector<MatrixXd>& by, const MatrixXd& from, MatrixXd& to) const;
  /// Adds the measures z(p) from a table of the measures, or of their rates.
  void add_measures(const std::vector<MatrixXd>& of, Eigen::Index p, const LocalRows& q,
                    Measures& out) const;
  /// Adds a row of ∂z·row/∂q: out += scale row Σ_i of_i(p, k).
  template <class Row, class Out>
  void add_row(const std::vector<MatrixXd>& of, Eigen::Index p, double scale, const Row& row,
               Out out) const;

  const StrainMeasure* measure_ = nullptr;
  const StrainTable* table_ = nullptr;
  Eigen::Index n_shapes_ = 0, dim_ = 0;
  std::vector<Measures> z_, z_rate_;
  std::vector<StrainVariation> by_measures_;  // ∂e/∂z
  MatrixXd own_, own_rate_;                   // strains of the measures, before mixing
  MatrixXd strain_, rate_, stress_, mixed_;
  MatrixXd own_variation_, variation_, own_rate_variation_, rate_variation_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxMeasures * kMaxDim,
                kMaxShapes * kMaxDim>
      by_unknowns_;  // ∂z/∂q of a point
};

}  // namespace flexmorph::fem
