#include "fem/shapes/gram_gradient.h"

namespace flexmorph::fem {

void GramGradient::correction(const Term& term, int e, const LocalStep& x, Correction& out) const {
  const auto vectors = element_->vectors(e);
  const auto n = x.start.rows();
  out.relative.setZero(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const int vector = vectors[static_cast<size_t>(k)];
    out.relative(k, k) += element_->scale(vector);
    if (element_->is_position(vector)) out.relative(k, 0) -= element_->scale(vector);
  }
  const LocalRows d = x.end - x.start;
  out.middle.noalias() = out.relative * x.mean.q;
  const LocalRows moved = out.relative * d;
  out.change.noalias() = out.middle * moved.transpose();  // Q₁Q₁ᵀ - Q₀Q₀ᵀ = Q̄Dᵀ + DQ̄ᵀ
  out.change += out.change.transpose().eval();
  out.norm = out.change.squaredNorm();
  out.force.setZero(n, x.start.cols());
  term.add_force(e, x.mean, out.force);

  constexpr double kRigid = 1e-7;
  const Square gram = out.middle * out.middle.transpose();
  if (out.norm <= kRigid * kRigid * gram.squaredNorm()) {
    out.norm = out.error = 0;
    return;
  }
  const double start = term.strain_energy(e, {x.start, x.mean.v, x.mean.a}),
               end = term.strain_energy(e, {x.end, x.mean.v, x.mean.a});
  out.error = end - start - out.force.cwiseProduct(d).sum();
}

void GramGradient::add_force(const Term& term, int e, const LocalStep& x, LocalRows& force) const {
  Correction c;
  correction(term, e, x, c);
  force += c.force;
  if (c.norm == 0) return;
  const LocalRows direction = c.change * c.middle;
  force.noalias() += c.factor() * c.relative.transpose() * direction;
}

/// With α = 2R/|A|², the end of the step moving by 2 w.q and the mean state by w.q:
///   d(α Lᵀ A L q̄) = w.q α Lᵀ A L dq + 2 w.q α Lᵀ (L dq Q₁ᵀ + Q₁ (L dq)ᵀ) Q̄ + Lᵀ A Q̄ dα
///   dα = 2 dR/|A|² - 2 α A:dA/|A|²,  A:dA = 4 w.q (Lᵀ A Q₁)·dq
///   dR = (2 w.q (f(q₁) - f(q̄)) - w.q K(q̄)ᵀ d)·dq
void GramGradient::add_tangent(const Term& term, int e, const LocalStep& x, const Weights& w,
                               LocalTangent& tangent) const {
  term.add_tangent(e, x.mean, w, tangent);
  if (w.q == 0) return;
  Correction c;
  correction(term, e, x, c);
  if (c.norm == 0) return;
  const auto n = x.start.rows(), dim = x.start.cols();
  LocalRows end_force = LocalRows::Zero(n, dim);
  term.add_force(e, {x.end, x.mean.v, x.mean.a}, end_force);
  LocalTangent stiffness = LocalTangent::Zero(n * dim, n * dim);
  term.add_tangent(e, x.mean, {1, 0, 0}, stiffness);
  const LocalRows d = x.end - x.start, end = c.relative * x.end;
  const LocalRows turned = c.change * end, direction = c.change * c.middle;
  const LocalRows along_end = c.relative.transpose() * turned,
                  along_middle = c.relative.transpose() * direction;
  LocalRows d_factor(n, dim);
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxShapes * kMaxDim, 1>>
      moved(d.data(), d.size());
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxShapes * kMaxDim, 1>>(d_factor.data(),
                                                                                   d_factor.size())
      .noalias() = stiffness.transpose() * moved;
  const double factor = c.factor();
  d_factor =
      (2 * w.q / c.norm) * (2 * (end_force - c.force) - d_factor - 4 * factor * along_end).eval();

  const Square pulled = c.relative.transpose() * c.change * c.relative,
               metric = c.relative.transpose() * c.relative;
  const LocalRows pulled_end = c.relative.transpose() * end,
                  pulled_middle = c.relative.transpose() * c.middle;
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxDim, kMaxDim> product =
      end.transpose() * c.middle;
  for (Eigen::Index k = 0; k < n; ++k)
    for (Eigen::Index b = 0; b < dim; ++b)
      for (Eigen::Index l = 0; l < n; ++l)
        for (Eigen::Index a = 0; a < dim; ++a)
          tangent(dim * k + b, dim * l + a) +=
              w.q * factor *
                  ((a == b ? pulled(k, l) : 0.0) +
                   2 * (metric(k, l) * product(a, b) + pulled_end(k, a) * pulled_middle(l, b))) +
              along_middle(k, b) * d_factor(l, a);
}

}  // namespace flexmorph::fem
