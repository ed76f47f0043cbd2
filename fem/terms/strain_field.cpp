#include "fem/terms/strain_field.h"

namespace flexmorph::fem {
namespace {

/// Calls f(i, j, m) for every mixing matrix m, through which strain j contributes to strain i.
template <class F>
void for_parts(const std::vector<MatrixXd>& mix, Eigen::Index n_strains, const F& f) {
  const bool own = static_cast<Eigen::Index>(mix.size()) == n_strains;
  for (Eigen::Index i = 0; i < n_strains; ++i)
    for (Eigen::Index j = own ? i : 0; j < (own ? i + 1 : n_strains); ++j) {
      const MatrixXd& m = mix[static_cast<size_t>(own ? i : n_strains * i + j)];
      if (m.size() > 0) f(i, j, m);
    }
}

}  // namespace

void StrainField::mix(const std::vector<MatrixXd>& by, const MatrixXd& from, MatrixXd& to) const {
  to.setZero(from.rows(), from.cols());
  for_parts(by, from.rows(), [&](Eigen::Index i, Eigen::Index j, const MatrixXd& m) {
    to.row(i).noalias() += from.row(j) * m.transpose();
  });
}

void StrainField::mix_rows(const std::vector<MatrixXd>& by, const MatrixXd& from,
                           MatrixXd& to) const {
  to.setZero(from.rows(), from.cols());
  const Eigen::Index n = n_points();
  for_parts(by, from.rows() / n, [&](Eigen::Index i, Eigen::Index j, const MatrixXd& m) {
    to.middleRows(i * n, n).noalias() += m * from.middleRows(j * n, n);
  });
}

const MatrixXd& StrainField::unmixed(const MatrixXd& stress) {
  if (table_->mix.empty()) return stress;
  mixed_.setZero(stress.rows(), stress.cols());
  for_parts(table_->mix, stress.rows(), [&](Eigen::Index i, Eigen::Index j, const MatrixXd& m) {
    mixed_.row(j).noalias() += stress.row(i) * m;
  });
  return mixed_;
}

void StrainField::add_measures(const std::vector<MatrixXd>& of, Eigen::Index p, const LocalRows& q,
                               Measures& out) const {
  for (size_t i = 0; i < of.size(); ++i)
    out.row(static_cast<Eigen::Index>(i)).noalias() += of[i].row(p) * q;
}

template <class Row, class Out>
void StrainField::add_row(const std::vector<MatrixXd>& of, Eigen::Index p, double scale,
                          const Row& row, Out out) const {
  for (size_t i = 0; i < of.size(); ++i)
    for (Eigen::Index k = 0; k < n_shapes_; ++k)
      out.segment(dim_ * k, dim_) +=
          scale * of[i](p, k) * row.segment(dim_ * static_cast<Eigen::Index>(i), dim_);
}

void StrainField::set(const StrainMeasure& measure, const StrainTable& table, const LocalRows& q) {
  measure_ = &measure;
  table_ = &table;
  n_shapes_ = q.rows();
  dim_ = q.cols();
  const Eigen::Index n = n_points();
  z_.resize(static_cast<size_t>(n));
  by_measures_.resize(static_cast<size_t>(n));
  own_.resize(measure.size(), n);
  StrainVector e;
  for (Eigen::Index p = 0; p < n; ++p) {
    const auto at = static_cast<size_t>(p);
    z_[at].setZero(static_cast<Eigen::Index>(table.measure.size()), dim_);
    add_measures(table.measure, p, q, z_[at]);
    measure.strain(z_[at], e, &by_measures_[at]);
    own_.col(p) = e;
  }
  if (table.mix.empty())
    strain_ = own_;
  else
    mix(table.mix, own_, strain_);
}

void StrainField::set_rate(const LocalRows& q, const LocalRows& v) {
  const Eigen::Index n = n_points();
  z_rate_.resize(static_cast<size_t>(n));
  own_rate_.resize(measure_->size(), n);
  for (Eigen::Index p = 0; p < n; ++p) {
    const auto at = static_cast<size_t>(p);
    z_rate_[at].setZero(static_cast<Eigen::Index>(table_->measure.size()), dim_);
    add_measures(table_->measure, p, v, z_rate_[at]);
    add_measures(table_->rate, p, q, z_rate_[at]);
    own_rate_.col(p) =
        by_measures_[at] * Eigen::Map<const VectorXd>(z_rate_[at].data(), z_rate_[at].size());
  }
  if (table_->mix.empty())
    rate_ = own_rate_;
  else
    mix(table_->mix, own_rate_, rate_);
  if (table_->mix_rate.empty()) return;
  mix(table_->mix_rate, own_, mixed_);
  rate_ += mixed_;
}

void StrainField::add_force(const MatrixXd& stress, LocalRows& force) {
  const MatrixXd& s = unmixed(stress);
  Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, kMaxMeasures * kMaxDim> by_z;
  Eigen::Map<VectorXd> out(force.data(), force.size());
  for (Eigen::Index p = 0; p < n_points(); ++p) {
    by_z = s.col(p).transpose() * by_measures_[static_cast<size_t>(p)];
    add_row(table_->measure, p, 1, by_z, out.head(out.size()));
  }
}

const MatrixXd& StrainField::variation() {
  const Eigen::Index n = n_points(), n_strains = measure_->size();
  own_variation_.setZero(n_strains * n, n_shapes_ * dim_);
  for (Eigen::Index i = 0; i < n_strains; ++i)
    for (Eigen::Index p = 0; p < n; ++p)
      add_row(table_->measure, p, 1, by_measures_[static_cast<size_t>(p)].row(i),
              own_variation_.row(n * i + p));
  if (table_->mix.empty()) return own_variation_;
  mix_rows(table_->mix, own_variation_, variation_);
  return variation_;
}

const MatrixXd& StrainField::rate_variation(const Weights& w) {
  const Eigen::Index n = n_points(), n_strains = measure_->size();
  own_rate_variation_ = w.v * own_variation_;
  MeasureHessian second;
  Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, kMaxMeasures * kMaxDim> turned;
  for (Eigen::Index i = 0; i < n_strains && w.q != 0; ++i)
    for (Eigen::Index p = 0; p < n; ++p) {
      const auto at = static_cast<size_t>(p);
      measure_->second_variation(static_cast<int>(i), z_[at], second);
      turned =
          Eigen::Map<const VectorXd>(z_rate_[at].data(), z_rate_[at].size()).transpose() * second;
      add_row(table_->measure, p, w.q, turned, own_rate_variation_.row(n * i + p));
      add_row(table_->rate, p, w.q, by_measures_[at].row(i), own_rate_variation_.row(n * i + p));
    }
  if (table_->mix.empty()) return own_rate_variation_;
  mix_rows(table_->mix, own_rate_variation_, rate_variation_);
  for (size_t i = 0; i < table_->mix_rate.size(); ++i)
    rate_variation_.middleRows(static_cast<Eigen::Index>(i) * n, n).noalias() +=
        w.q * table_->mix_rate[i] * own_variation_.middleRows(static_cast<Eigen::Index>(i) * n, n);
  return rate_variation_;
}

void StrainField::add_second(const MatrixXd& stress, double scale, LocalTangent& tangent) {
  const MatrixXd& s = unmixed(stress);
  MeasureHessian sum, second;
  const auto n_z = static_cast<Eigen::Index>(table_->measure.size()) * dim_;
  for (Eigen::Index p = 0; p < n_points(); ++p) {
    sum.setZero(n_z, n_z);
    for (Eigen::Index i = 0; i < measure_->size(); ++i) {
      measure_->second_variation(static_cast<int>(i), z_[static_cast<size_t>(p)], second);
      sum += scale * s(i, p) * second;
    }
    by_unknowns_.setZero(n_z, n_shapes_ * dim_);
    for (size_t i = 0; i < table_->measure.size(); ++i)
      for (Eigen::Index k = 0; k < n_shapes_; ++k)
        for (Eigen::Index c = 0; c < dim_; ++c)
          by_unknowns_(dim_ * static_cast<Eigen::Index>(i) + c, dim_ * k + c) =
              table_->measure[i](p, k);
    tangent.noalias() += by_unknowns_.transpose() * (sum * by_unknowns_);
  }
}

}  // namespace flexmorph::fem
