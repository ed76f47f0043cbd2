#include "fem/joints/pair_joint.h"

namespace flexmorph::fem {

unsigned PairJoint::bits(std::initializer_list<Part> parts) {
  unsigned out = 0;
  for (const Part part : parts) out |= 3U << part;
  return out;
}

PairJoint::PairJoint(std::string name, MarkerLocation a, MarkerLocation b, Shape shape)
    : name_(std::move(name)),
      pair_(std::move(a), std::move(b)),
      shape_(std::move(shape)),
      rows_(shape_.reads.size()) {}

void PairJoint::bind(std::span<const BodyView> bodies) {
  unsigned all = 0;
  for (const unsigned reads : shape_.reads) all |= reads;
  pair_.bind(bodies, "joint '" + name_ + "'", (all & bits({Part::kAxisA})) != 0,
             (all & bits({Part::kAxisB})) != 0);
  const size_t n = pair_.dofs().size();

  const auto reads = [&](unsigned entries, size_t k) {
    for (int i = 0; i < 8; ++i)
      if ((entries >> i & 1U) != 0 && pair_.depends(i, k)) return true;
    return false;
  };
  entries_.clear();
  for (int row = 0; row < size(); ++row)
    for (size_t k = 0; k < n; ++k)
      if (reads(shape_.reads[static_cast<size_t>(row)], k)) entries_.push_back({row, k});

  coupled_.clear();
  const auto coupled = [&](size_t k, size_t l) {
    for (const auto& [one, other] : shape_.couples)
      if ((reads(bits({one}), k) && reads(bits({other}), l)) ||
          (reads(bits({other}), k) && reads(bits({one}), l)))
        return true;
    return false;
  };
  for (size_t k = 0; k < n; ++k)
    for (size_t l = 0; l < n; ++l)
      if (coupled(k, l)) coupled_.emplace_back(k, l);
}

void PairJoint::evaluate(double t, const VectorXd& q, const VectorXd& v,
                         ConstraintRows& rows) const {
  pair_.evaluate(t, q, v);
  fill(t, pair_.y(), rows_);
  rows.value.resize(size());
  rows.rate.resize(size());
  rows.acceleration.resize(size());
  rows.jacobian.clear();
  const Values& rate = pair_.rate();
  for (int i = 0; i < size(); ++i) {
    const PairRow& row = rows_[static_cast<size_t>(i)];
    rows.value[i] = row.f;
    rows.rate[i] = row.f_t + row.f_y.dot(pair_.y_t());
    rows.acceleration[i] = -(rate.dot(row.f_yy * rate) + 2 * row.f_yt.dot(rate) + row.f_tt +
                             row.f_y.dot(pair_.convective()));
  }
  for (const Entry& entry : entries_)
    rows.jacobian.emplace_back(
        entry.row, pair_.dofs()[entry.column],
        rows_[static_cast<size_t>(entry.row)].f_y.dot(pair_.column(entry.column)));
}

void PairJoint::add_stiffness(double t, const VectorXd& q, const VectorXd& lambda,
                              std::vector<Eigen::Triplet<double>>& out) const {
  if (coupled_.empty()) return;
  pair_.evaluate(t, q, q);  // the rates are not used
  fill(t, pair_.y(), rows_);
  MarkerPair::Square hessian = MarkerPair::Square::Zero();
  for (int i = 0; i < size(); ++i) hessian += lambda[i] * rows_[static_cast<size_t>(i)].f_yy;
  for (const auto& [k, l] : coupled_)
    out.emplace_back(pair_.dofs()[k], pair_.dofs()[l],
                     pair_.column(k).dot(hessian * pair_.column(l)));
}

}  // namespace flexmorph::fem
