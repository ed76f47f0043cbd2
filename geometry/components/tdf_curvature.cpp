#include <cassert>

#include "geometry/components/component_tdf.h"
#include "geometry/components/tdf.h"

namespace flexmorph {

using namespace component_tdf_kernels;

VectorXd UnionTdf::eroded_gradient() const {
  VectorXd out(phi_.size());
  for (Eigen::Index n = 0; n < out.size(); ++n)
    out[n] = heaviside(phi_[n] - settings_.erosion, settings_).slope;
  return out;
}

Eigen::SparseMatrix<double> UnionTdf::slopes() const {
  assert(evaluated_ && settings_.kind == TdfSettings::Kind::distance);
  constexpr int kParameters = Component::kParameters;
  Eigen::SparseMatrix<double> out(grid_.n_nodes(),
                                  kParameters * static_cast<Eigen::Index>(components_.size()));
  std::vector<double> chain;
  const double* visit = visits_.data();
  std::size_t r = 0;
  for (std::size_t c = 0; c < components_.size(); ++c) {
    const ComponentFrame frame(components_[c], settings_.min_half_thickness);
    int count = 0;
    for (; r < ends_[c]; visit += runs_[r].count, ++r)
      count = add_points(frame, runs_[r], visit, count);
    const auto n = static_cast<std::size_t>(count);
    chain.resize(kParameters * n);
    for (std::size_t k = 0; k < n; ++k) scratch_.seed[k] /= sum_[scratch_.node[k]];
    fill_chain<TdfSettings::Kind::distance>(frame, count, scratch_.x.data(), scratch_.y.data(),
                                            scratch_.seed.data(), chain.data());
    for (std::size_t p = 0; p < kParameters; ++p) {
      const auto column = static_cast<Eigen::Index>(kParameters * c + p);
      out.startVec(column);
      for (std::size_t k = 0; k < n; ++k)
        out.insertBack(scratch_.node[k], column) = chain[p * n + k];
    }
  }
  out.finalize();
  return out;
}

MatrixXd UnionTdf::curvature(const NodeGradients& f,
                             const Eigen::SparseMatrix<double>& slopes) const {
  assert(evaluated_ && settings_.kind == TdfSettings::Kind::distance);
  constexpr int kParameters = Component::kParameters;
  const double lambda = settings_.sharpness;
  VectorXd by_phi(grid_.n_nodes()), twice(grid_.n_nodes());
  for (Eigen::Index n = 0; n < by_phi.size(); ++n) {
    const Heaviside h = heaviside(phi_[n], settings_);
    const Heaviside e = heaviside(phi_[n] - settings_.erosion, settings_);
    by_phi[n] = f.df_dh[n] * h.slope + f.df_deroded[n] * e.slope;
    twice[n] = f.df_dh[n] * h.curvature + f.df_deroded[n] * e.curvature +
               f.d2f_deroded2[n] * e.slope * e.slope - lambda * by_phi[n];
  }
  MatrixXd out(slopes.transpose() * (twice.asDiagonal() * slopes));
  const double* visit = visits_.data();
  std::size_t r = 0;
  for (std::size_t c = 0; c < components_.size(); ++c) {
    const ComponentFrame frame(components_[c], settings_.min_half_thickness);
    Hessian7 own = Hessian7::Zero();
    int count = 0;
    for (; r < ends_[c]; visit += runs_[r].count, ++r)
      count = add_points(frame, runs_[r], visit, count);
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
      const int node = scratch_.node[k];
      if (by_phi[node] == 0) continue;
      const Expansion at = expansion<TdfSettings::Kind::distance>(
          components_[c], settings_.min_half_thickness, frame.sine(), frame.cosine(), scratch_.x[k],
          scratch_.y[k]);
      const Term term = smooth_term(lambda, at.value, cut_, highest_[node]);
      const double weight = by_phi[node] / sum_[node];
      own.noalias() += (weight * term.slope) * at.hessian;
      own.noalias() += (weight * lambda * term.curvature) * at.gradient * at.gradient.transpose();
    }
    const auto first = kParameters * static_cast<Eigen::Index>(c);
    out.block<kParameters, kParameters>(first, first) += own;
  }
  if (!out.allFinite()) throw Error::numerical("tdf: a second derivative is not finite");
  return out;
}

}  // namespace flexmorph
