#include "fem/solve/scaled_constraints.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace flexmorph::fem {

void ScaledConstraints::evaluate(Workspace& model, const State& x, Rows which) {
  const int n = model.n_dofs(), m = model.n_constraints();
  if (version_ != model.pattern_version()) {
    scales_ = model.scales();
    version_ = model.pattern_version();
  }
  if (which == Rows::all)
    model.all_constraints(x, c_);
  else
    model.constraints(x, c_);
  scaled_.clear();
  for (const auto& entry : c_.jacobian) {
    if (!std::isfinite(entry.value()) || !std::isfinite(c_.value[entry.row()]))
      throw Error::numerical(
          "joint '" +
          model.joints()[static_cast<size_t>(joint_of_row(model, entry.row()))]->name() +
          "' has numbers that are not finite at t = " + std::to_string(x.t) + " s");
    scaled_.emplace_back(entry.row(), entry.col(), entry.value() / scales_[entry.col()]);
  }
  jacobian_.resize(m, n);
  jacobian_.setFromTriplets(scaled_.begin(), scaled_.end());

  VectorXd& largest = row_scale_;
  largest.setZero(m);
  of_body_.setZero(m);
  // Only rows with entries of the body are visited, because chains have thousands of bodies.
  for (const Body& b : model.bodies()) {
    const auto over_entries = [&](const auto& act) {
      for (int column = b.first_dof; column < b.first_dof + b.n_dofs(); ++column)
        for (SparseMatrix::InnerIterator it(jacobian_, column); it; ++it) act(it);
    };
    over_entries([&](const auto& it) { of_body_[it.row()] += it.value() * it.value(); });
    over_entries([&](const auto& it) {
      largest[it.row()] = std::max(largest[it.row()], of_body_[it.row()]);
    });
    over_entries([&](const auto& it) { of_body_[it.row()] = 0; });
  }
  row_scale_ = (largest.array() > 0).select(largest.array().sqrt().inverse(), 1.0);
  for (int column = 0; column < n; ++column)
    for (SparseMatrix::InnerIterator it(jacobian_, column); it; ++it)
      it.valueRef() *= row_scale_[it.row()];
}

int joint_of_row(const Model& model, int row) {
  size_t joint = 0;
  while (model.first_row(joint + 1) <= row) ++joint;
  return static_cast<int>(joint);
}

std::string list_joints(const std::vector<std::string>& names) {
  constexpr size_t kMaxListed = 5;
  std::string out = names.size() == 1 ? "joint" : "joints";
  for (size_t i = 0; i < std::min(names.size(), kMaxListed); ++i)
    out += (i == 0 ? " '" : ", '") + names[i] + "'";
  if (names.size() > kMaxListed)
    out += " and " + std::to_string(names.size() - kMaxListed) + " more";
  return out;
}

VectorXd weights_of_joints(const Model& model, VectorXd weights) {
  const VectorXd all = weights;
  for (size_t i = 0; i < model.joints().size(); ++i)
    if (model.joints()[i]->belongs_to_body())
      weights.segment(model.first_row(i), model.joints()[i]->size()).setZero();
  return weights.isZero(0) ? all : weights;
}

std::vector<std::string> heaviest_joints(const Model& model, const VectorXd& weights,
                                         double least) {
  const VectorXd shown = weights_of_joints(model, weights);
  std::vector<double> of_joint;
  for (size_t i = 0; i < model.joints().size(); ++i) {
    const int size = model.joints()[i]->size();
    of_joint.push_back(
        size == 0 ? 0 : shown.segment(model.first_row(i), size).lpNorm<Eigen::Infinity>());
  }
  std::vector<size_t> order(of_joint.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return of_joint[a] > of_joint[b]; });
  std::vector<std::string> out;
  for (const size_t i : order)
    if (of_joint[i] > 0 && of_joint[i] >= least * of_joint[order[0]])
      out.push_back(model.joints()[i]->name());
  return out;
}

double model_size(const VectorXd& scales, const VectorXd& q) {
  const double size = q.size() == 0 ? 0 : scales.cwiseProduct(q).lpNorm<Eigen::Infinity>();
  return size > 0 ? size : 1;
}

double undeformed_size(const Model& model, const VectorXd& scales) {
  const VectorXd q = model.reference().q;
  double size = 0;
  for (Eigen::Index i = 0; i < q.size(); ++i)
    if (scales[i] == 1) size = std::max(size, std::abs(q[i]));
  // Rigid bodies alone all start at the origin, but their scales are lengths.
  return size > 0 ? size : model_size(scales, q);
}

}  // namespace flexmorph::fem
