#pragma once

#include "fem/shapes/strain.h"
#include "fem/term.h"

namespace flexmorph::fem {

/// Strains of one element at all points of its table, their rates and variations, and the virtual
/// work of stresses on them. Room for all of it is kept: one per thread serves any element.
class StrainField {
 public:
  /// The strains at q (n_strains x n_points).
  void set(const StrainMeasure& measure, const StrainTable& table, const LocalRows& q);
  const MatrixXd& strain() const { return strain_; }

  /// Their rates ė where the unknowns move at v; those of material flow alone: v = 0.
  void set_rate(const LocalRows& q, const LocalRows& v);
  const MatrixXd& rate() const { return rate_; }

  /// force += Σ ∂e/∂q · stress, stresses times the weights of their points (n_strains x n_points).
  void add_force(const MatrixXd& stress, LocalRows& force);

  /// ∂e/∂q, row n_points i + p of strain i at point p (after set()).
  const MatrixXd& variation();
  /// w.q ∂ė/∂q + w.v ∂ė/∂v likewise (after set_rate() and variation()).
  const MatrixXd& rate_variation(const Weights& w);
  /// tangent += scale Σ stress · ∂²e/∂q².
  void add_second(const MatrixXd& stress, double scale, LocalTangent& tangent);

 private:
  Eigen::Index n_points() const { return table_->weight.size(); }
  /// What mixing makes of strains of the measures (rows: strains), and the transposed.
  void mix(const std::vector<MatrixXd>& by, const MatrixXd& from, MatrixXd& to) const;
  const MatrixXd& unmixed(const MatrixXd& stress);
  void mix_rows(const std::vector<MatrixXd>& by, const MatrixXd& from, MatrixXd& to) const;
  /// z(p) from a table of the measures, or of their rates.
  void add_measures(const std::vector<MatrixXd>& of, Eigen::Index p, const LocalRows& q,
                    Measures& out) const;
  /// Row of ∂z·row/∂q: out = row Σ_i of_i(p, k).
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
