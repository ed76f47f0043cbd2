#include "fem/terms/sampling.h"

#include <cmath>

#include "fem/free_lines.h"
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
                          FactorKind::stiffness, t);
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

/// x ⊗ y: points are numbered along m first.
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
    FreeTable sides;  // only for where the lines are
    from.element.tabulate_free(e, 0, Tabulate::gradient, sides);
    const MatrixXd K_m = ParabolaFlow(n, sides.side[kM1], sides.side[kM2]).K,
                   K_n = ParabolaFlow(n, sides.side[kN1], sides.side[kN2]).K;
    out.mix_rate = {both_ways(K_m, one), both_ways(one, K_n),
                    both_ways(K_m, A) + both_ways(A, K_n)};
  }
  // An m-line holds samples along m: only what is interpolated along n differs.
  void along_line(MatrixXd& strains) const override {
    strains.rightCols(2) =
        (parabola_through_samples(static_cast<int>(strains.rows())) * strains.rightCols(2)).eval();
  }

 private:
  static constexpr int kDegree = 12;
};

class Sections final : public StrainSampling {
 public:
  explicit Sections(bool on_axis) : on_axis_(on_axis) {}
  void tabulate(const StrainSource& from, int e, StrainTable& out) const override {
    const auto numbers = from.element.vectors(e);
    MatrixXd X(numbers.size(), from.reference.cols());
    for (size_t k = 0; k < numbers.size(); ++k)
      X.row(static_cast<Eigen::Index>(k)) = from.reference.row(numbers[k]);
    ShapeTable t, axis;
    from.element.tabulate(e, 8, Tabulate::gradient, from.factors, FactorKind::stiffness, t);
    const Eigen::Index n = t.weight.size(), n_shapes = t.N.cols();
    out = {
        VectorXd::Zero(n), {MatrixXd::Zero(n, n_shapes), MatrixXd::Zero(n, n_shapes)}, {}, {}, {}};
    // Points with the same x follow each other; they are a section.
    for (Eigen::Index first = 0, last = 0; first < n; first = last) {
      const double x = t.material[static_cast<size_t>(first)].x();
      while (last < n && t.material[static_cast<size_t>(last)].x() == x) ++last;
      const Vec2 e2 = ((t.N.row(last - 1) - t.N.row(first)) * X).transpose().normalized(),
                 e1(e2.y(), -e2.x());
      if (on_axis_) {
        from.element.locate({x, 0}, Tabulate::gradient, axis);
        out.weight[first] = t.weight.segment(first, last - first).sum();
        turn(axis, 0, e1, e2, first, out);
        continue;
      }
      for (Eigen::Index p = first; p < last; ++p) {
        out.weight[p] = t.weight[p];
        turn(t, p, e1, e2, p, out);
      }
    }
  }

 private:
  static void turn(const ShapeTable& t, Eigen::Index from, const Vec2& e1, const Vec2& e2,
                   Eigen::Index to, StrainTable& out) {
    out.measure[0].row(to) = e1.x() * t.N_m.row(from) + e1.y() * t.N_n.row(from);
    out.measure[1].row(to) = e2.x() * t.N_m.row(from) + e2.y() * t.N_n.row(from);
  }
  bool on_axis_;
};

}  // namespace

std::shared_ptr<const StrainSampling> sample_points(int degree, Tabulate what) {
  return std::make_shared<Points>(degree, what);
}
std::shared_ptr<const StrainSampling> sample_assumed() { return std::make_shared<Assumed>(); }
std::shared_ptr<const StrainSampling> sample_sections(bool on_axis) {
  return std::make_shared<Sections>(on_axis);
}

}  // namespace flexmorph::fem
