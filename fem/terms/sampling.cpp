#include "fem/terms/sampling.h"

#include <cmath>

#include "fem/eulerian_lines.h"
#include "fem/terms/membrane_invariant.h"
#include "fem/terms/strain_flow.h"

namespace flexmorph::fem {
namespace {

Tabulate with_rates(Tabulate what) {
  return what == Tabulate::gradient ? Tabulate::gradient_rates : Tabulate::curvature_rates;
}

class Points final : public StrainSampling {
 public:
  Points(int degree, Tabulate what) : degree_(degree), what_(what) {}
  bool is_pointwise() const override { return true; }
  int degree() const override { return degree_; }
  Tabulate what() const override { return what_; }
  void tabulate(const StrainSource& from, int e, StrainTable& out) const override {
    const bool moves = from.element.moving(e);
    ShapeTable t;
    from.element.tabulate(e, degree_, moves ? with_rates(what_) : what_, from.factors,
                          ScaleFactorKind::stiffness, t);
    out = {t.weight, {t.N_m, t.N_n}, {}, {}, {}};
    if (moves) out.rate = {t.N_mt, t.N_nt};
    if (what_ == Tabulate::gradient) return;
    for (MatrixXd* second : {&t.N_mm, &t.N_nn, &t.N_mn}) out.measure.push_back(std::move(*second));
    if (!moves) return;
    for (MatrixXd* second : {&t.N_mmt, &t.N_nnt, &t.N_mnt}) out.rate.push_back(std::move(*second));
  }

 private:
  int degree_;
  Tabulate what_;
};

/// Returns x ⊗ y; consecutive points are along n.
MatrixXd both_ways(const MatrixXd& x, const MatrixXd& y) {
  MatrixXd out(x.rows() * y.rows(), x.cols() * y.cols());
  for (Eigen::Index i = 0; i < x.rows(); ++i)
    for (Eigen::Index j = 0; j < x.cols(); ++j)
      out.block(i * y.rows(), j * y.cols(), y.rows(), y.cols()) = x(i, j) * y;
  return out;
}

class Assumed final : public StrainSampling {
 public:
  void tabulate(const StrainSource& from, int e, StrainTable& out) const override {
    Points(kDegree, Tabulate::gradient).tabulate(from, e, out);
    const auto n = static_cast<int>(std::lround(std::sqrt(static_cast<double>(out.weight.size()))));
    const MatrixXd one = MatrixXd::Identity(n, n), A = parabola_through_samples(n);
    out.mix = {both_ways(A, one), both_ways(one, A), both_ways(A, A)};
    if (out.rate.empty()) return;
    EulerianTable sides;  // only used for the positions of the lines
    from.element.tabulate_eulerian(e, 0, Tabulate::gradient, sides);
    const MatrixXd K_m = ParabolaFlow(n, sides.side[kM1], sides.side[kM2]).K,
                   K_n = ParabolaFlow(n, sides.side[kN1], sides.side[kN2]).K;
    out.mix_rate = {both_ways(K_m, one), both_ways(one, K_n),
                    both_ways(K_m, A) + both_ways(A, K_n)};
  }
  // The samples along m are on m-lines, so that only strains that are interpolated along n differ.
  void along_line(MatrixXd& strains) const override {
    strains.rightCols(2) =
        (parabola_through_samples(static_cast<int>(strains.rows())) * strains.rightCols(2)).eval();
  }

 private:
  static constexpr int kDegree = 12;
};

class Sections final : public StrainSampling {
 public:
  Sections(BeamStrains strains, bool on_axis) : strains_(strains), on_axis_(on_axis) {}
  void tabulate(const StrainSource& from, int e, StrainTable& out) const override {
    BeamStrainPoints at = beam_strain_points(from.element, e, from.factors, from.reference);
    const Eigen::Index n = at.n_points(), n_sections = at.sample(0) - n, n_rows = at.d_1.rows();
    out = {VectorXd::Zero(n_rows), {std::move(at.d_1), std::move(at.d_2)}, {}, {}, {}};
    if (on_axis_)
      for (Eigen::Index s = 0; s < n_sections; ++s)
        out.weight[at.on_axis(s)] = at.area[static_cast<size_t>(s)];
    else
      out.weight.head(n) = at.weight;
    if (strains_ == BeamStrains::assumed) {
      mix(at, n_sections, out);
      return;
    }
    // Only points with weight are kept.
    const Eigen::Index first = on_axis_ ? n : 0, count = on_axis_ ? n_sections : n;
    out.weight = out.weight.segment(first, count).eval();
    for (MatrixXd& measure : out.measure) measure = measure.middleRows(first, count).eval();
  }

 private:
  /// Sets the mixing matrices of ε̄(x, y) = ε(x, y) - ε(x, 0) + ε̄(x), with ε̄(x) computed from the
  /// samples.
  void mix(const BeamStrainPoints& at, Eigen::Index n_sections, StrainTable& out) const {
    const Eigen::Index n = at.n_points(), n_rows = out.weight.size();
    out.mix.assign(9, MatrixXd());
    for (Eigen::Index i = 0; i < 3; ++i)
      for (Eigen::Index j = 0; j < 3; ++j) {
        MatrixXd part = MatrixXd::Zero(n_rows, n_rows);
        for (Eigen::Index row = on_axis_ ? n : 0; row < (on_axis_ ? n + n_sections : n); ++row) {
          const Eigen::Index s = on_axis_ ? row - n : at.section[static_cast<size_t>(row)];
          if (i == j) {
            part(row, row) += 1;
            part(row, at.on_axis(s)) -= 1;
          }
          for (Eigen::Index k = 0; k < BeamStrainPoints::kSamples; ++k)
            part(row, at.sample(k)) = at.assumed[static_cast<size_t>(s)](i, 3 * k + j);
        }
        if (!part.isZero(0)) out.mix[static_cast<size_t>(3 * i + j)] = std::move(part);
      }
  }
  BeamStrains strains_;
  bool on_axis_;
};

}  // namespace

std::shared_ptr<const StrainSampling> sample_points(int degree, Tabulate what) {
  return std::make_shared<Points>(degree, what);
}
std::shared_ptr<const StrainSampling> sample_assumed() { return std::make_shared<Assumed>(); }
std::shared_ptr<const StrainSampling> sample_sections(BeamStrains strains, bool on_axis) {
  return std::make_shared<Sections>(strains, on_axis);
}

}  // namespace flexmorph::fem
