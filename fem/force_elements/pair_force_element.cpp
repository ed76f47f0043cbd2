#include "fem/force_elements/pair_force_element.h"

#include <algorithm>

namespace flexmorph::fem {

void refuse_mean_force(const std::string& force_element) {
  throw Error::input(
      "force element '" + force_element +
      "' does not support integrator \"energy_momentum\"; use \"generalized_alpha\"");
}

PairForceElement::PairForceElement(std::string name, MarkerLocation a, MarkerLocation b,
                                   std::vector<Part> parts, bool varies)
    : name_(std::move(name)),
      pair_(std::move(a), std::move(b)),
      parts_(std::move(parts)),
      varies_(varies) {}

void PairForceElement::bind(std::span<const BodyView> bodies) {
  const auto works_on = [&](Part part) {
    return std::find(parts_.begin(), parts_.end(), part) != parts_.end();
  };
  pair_.bind(bodies, "force element '" + name_ + "'", works_on(MarkerPair::kAxisA),
             works_on(MarkerPair::kAxisB));
  columns_.clear();
  for (size_t k = 0; k < pair_.dofs().size(); ++k) {
    const auto moves = [&](Part part) {
      return pair_.depends(part, k) || pair_.depends(part + 1, k);
    };
    if (std::any_of(parts_.begin(), parts_.end(), moves)) columns_.push_back(k);
  }
}

void PairForceElement::add_to(const Values& s, VectorXd& out) const {
  for (const size_t k : columns_) out[pair_.dofs()[k]] += s.dot(pair_.column(k));
}

void PairForceElement::append(const MarkerPair::Square& by_y, const MarkerPair::Square& by_rate,
                              std::vector<Eigen::Triplet<double>>& out) const {
  for (const size_t l : columns_) {
    Values column = by_y * pair_.column(l);
    if (pair_.shifts()) column += by_rate * pair_.column_rate(l);
    for (const size_t k : columns_)
      out.emplace_back(pair_.dofs()[k], pair_.dofs()[l], pair_.column(k).dot(column));
  }
}

void PairForceElement::add_force(const State& x, VectorXd& out) const {
  pair_.evaluate(x.t, x.q, x.v);
  PairForce force;
  fill(x, pair_.y(), pair_.rate(), force);
  add_to(force.s, out);
}

void PairForceElement::add_pattern(std::vector<Eigen::Triplet<double>>& out) const {
  if (!varies_) return;
  for (const size_t l : columns_)
    for (const size_t k : columns_) out.emplace_back(pair_.dofs()[k], pair_.dofs()[l], 1.0);
}

void PairForceElement::add_tangent(const State& x, const Weights& w,
                                   std::vector<Eigen::Triplet<double>>& out) const {
  if (!varies_) return;
  pair_.evaluate(x.t, x.q, x.v);
  PairForce force;
  fill(x, pair_.y(), pair_.rate(), force);
  append(w.q * force.s_y + w.v * force.s_rate, w.q * force.s_rate, out);
}

double PairForceElement::power(const State& x) const {
  pair_.evaluate(x.t, x.q, x.v);
  PairForce force;
  fill(x, pair_.y(), pair_.rate(), force);
  return force.s.dot(pair_.y_t()) - (force.s - force.conservative).dot(pair_.rate());
}

}  // namespace flexmorph::fem
