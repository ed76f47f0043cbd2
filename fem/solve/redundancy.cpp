#include "fem/solve/redundancy.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <set>

#include "fem/solve/assembly.h"

namespace flexmorph::fem {
namespace {

constexpr double kAgree = 1e-8;      // allowed violation of rows that are left out, in model sizes
constexpr double kDependent = 1e-7;  // relative to the first pivot, at an assembled position
constexpr double kDeteriorated = 0.2;  // smallest pivot of the kept rows relative to the best one

/// Returns the given rows of J without the columns that are zero in all of them.
MatrixXd dense_rows(const SparseMatrix& j, const std::vector<int>& rows) {
  std::vector<int> index(static_cast<size_t>(j.rows()), -1);
  for (size_t k = 0; k < rows.size(); ++k)
    index[static_cast<size_t>(rows[k])] = static_cast<int>(k);
  std::vector<VectorXd> columns;
  VectorXd each(static_cast<Eigen::Index>(rows.size()));
  for (int column = 0; column < j.cols(); ++column) {
    each.setZero();
    for (SparseMatrix::InnerIterator it(j, column); it; ++it)
      if (const int k = index[static_cast<size_t>(it.row())]; k >= 0) each[k] = it.value();
    if (!each.isZero(0)) columns.push_back(each);
  }
  MatrixXd out(each.size(), static_cast<Eigen::Index>(columns.size()));
  for (size_t k = 0; k < columns.size(); ++k) out.col(static_cast<Eigen::Index>(k)) = columns[k];
  return out;
}

/// Returns the size of the last of the pivots that `rank` rows need, relative to the first one.
double last_pivot(const Eigen::ColPivHouseholderQR<MatrixXd>& qr, Eigen::Index rank) {
  const auto diagonal = qr.matrixQR().diagonal().cwiseAbs();
  if (rank == 0) return 1;
  return diagonal.size() < rank ? 0 : diagonal[rank - 1] / diagonal[0];
}

std::vector<int> without(const std::vector<int>& all, const std::vector<int>& some) {
  std::vector<int> out;
  std::set_difference(all.begin(), all.end(), some.begin(), some.end(), std::back_inserter(out));
  return out;
}

/// Returns states near x at which the joints are assembled: a little later, and after small changes
/// of the positions.
std::vector<State> neighbours(Workspace& model, const State& x) {
  constexpr double kNear = 1e-3;  // in sizes of the model
  const VectorXd scales = model.scales();
  const double size = model_size(scales, x.q);
  const double speed = scales.cwiseProduct(x.v).lpNorm<Eigen::Infinity>();
  std::vector<double> delays = {1e-3, 1e-2};
  if (speed > 0) delays.insert(delays.begin(), kNear * size / speed);
  std::vector<State> out;
  for (size_t trial = 0; trial <= delays.size(); ++trial) {
    State y = x;
    if (trial > 0) {
      y.t += delays[trial - 1];
      y.q += delays[trial - 1] * x.v;
    }
    for (Eigen::Index i = 0; i < y.q.size(); ++i)  // multiples of the golden section
      y.q[i] += kNear * size / scales[i] *
                (std::fmod(0.6180339887498949 * static_cast<double>(i + 1), 1.0) - 0.37);
    try {
      assemble(model, y);
      out.push_back(std::move(y));
    } catch (const Error&) {
      continue;  // drives need not be defined there
    }
  }
  return out;
}

}  // namespace

void leave_out_redundant(Workspace& model, const State& x) {
  const Diagnosis here = diagnose(model, x);
  if (here.is_independent()) return;
  if (here.is_contradictory()) throw Error::input(describe(here));
  std::set<int> redundant;
  const auto add = [&](const Diagnosis& diagnosis) {
    for (const DependentGroup& group : diagnosis.groups)
      redundant.insert(group.rows.begin(), group.rows.end());
  };
  add(here);
  Workspace copy(model);
  for (const State& y : neighbours(copy, x)) {
    const Diagnosis there = diagnose(copy, y);
    if (there.rank > here.rank)
      throw Error::input(
          "the start is a singular position (a dead centre, or a position where branches meet): " +
          describe(here) + " at this position only; let the motion start at another position");
    if (there.rank == here.rank) add(there);
  }
  const std::vector<int> rows(redundant.begin(), redundant.end());
  ScaledConstraints all;
  all.evaluate(model, x, ScaledConstraints::Rows::all);
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(dense_rows(all.jacobian(), rows).transpose());
  const auto surplus = static_cast<size_t>(here.constraints - here.rank);
  std::vector<int> left_out;
  for (size_t k = rows.size() - surplus; k < rows.size(); ++k)
    left_out.push_back(
        rows[static_cast<size_t>(qr.colsPermutation().indices()[static_cast<Eigen::Index>(k)])]);
  std::sort(left_out.begin(), left_out.end());
  model.leave_out(rows, left_out);
}

void renew_left_out(Workspace& model, State& x) {
  const std::vector<int> rows = model.redundant_rows(), before = model.left_out_rows();
  if (before.empty()) return;
  ScaledConstraints all;
  all.evaluate(model, x, ScaledConstraints::Rows::all);
  const auto rank = static_cast<Eigen::Index>(rows.size() - before.size());
  using PivotedQr = Eigen::ColPivHouseholderQR<MatrixXd>;
  const PivotedQr best(dense_rows(all.jacobian(), rows).transpose()),
      now(dense_rows(all.jacobian(), without(rows, before)).transpose());
  if (last_pivot(now, rank) >= kDeteriorated * last_pivot(best, rank)) return;
  std::vector<int> left_out;
  for (auto k = rank; k < static_cast<Eigen::Index>(rows.size()); ++k)
    left_out.push_back(rows[static_cast<size_t>(best.colsPermutation().indices()[k])]);
  std::sort(left_out.begin(), left_out.end());
  model.leave_out(rows, left_out);
  for (const int row : left_out) x.lambda[row] = 0;
}

VectorXd least_multipliers(Workspace& model, const State& x) {
  VectorXd out = x.lambda;
  const std::vector<int>& rows = model.redundant_rows();
  if (rows.empty()) return out;
  ScaledConstraints all;
  all.evaluate(model, x, ScaledConstraints::Rows::all);
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(dense_rows(all.jacobian(), rows).transpose());
  const auto m = static_cast<Eigen::Index>(rows.size());
  const auto diagonal = qr.matrixQR().diagonal().cwiseAbs();
  Eigen::Index rank = 0;
  while (rank < diagonal.size() && diagonal[rank] > kDependent * diagonal[0]) ++rank;
  if (rank == m) return out;
  // Null vectors P [-R₁₁⁻¹ R₁₂; I] of the rows, as in diagnose().
  MatrixXd null(m, m - rank);
  null.topRows(rank) = -qr.matrixQR()
                            .topLeftCorner(rank, rank)
                            .triangularView<Eigen::Upper>()
                            .solve(MatrixXd(qr.matrixQR().block(0, rank, rank, m - rank)));
  null.bottomRows(m - rank).setIdentity();
  null = (qr.colsPermutation() * null).eval();
  VectorXd force(m);
  for (Eigen::Index k = 0; k < m; ++k) {
    const int row = rows[static_cast<size_t>(k)];
    force[k] = x.lambda[row] / all.row_scale()[row];
  }
  MatrixXd counted = null;
  VectorXd of_joints = force;
  for (Eigen::Index k = 0; k < m; ++k) {
    const int joint = joint_of_row(model, rows[static_cast<size_t>(k)]);
    if (!model.joints()[static_cast<size_t>(joint)]->belongs_to_body()) continue;
    counted.row(k).setZero();
    of_joints[k] = 0;
  }
  force -= null * counted.colPivHouseholderQr().solve(of_joints);
  for (Eigen::Index k = 0; k < m; ++k) {
    const int row = rows[static_cast<size_t>(k)];
    out[row] = force[k] * all.row_scale()[row];
  }
  return out;
}

std::vector<std::string> redundant_joints(const Model& model) {
  std::vector<std::string> out;
  for (const int row : model.redundant_rows()) {
    const Joint& joint = *model.joints()[static_cast<size_t>(joint_of_row(model, row))];
    if (joint.belongs_to_body() || (!out.empty() && out.back() == joint.name())) continue;
    out.push_back(joint.name());
  }
  return out;
}

LeftOutMiss left_out_miss(Workspace& model, const VectorXd& q, double t) {
  LeftOutMiss out;
  if (model.left_out_rows().empty()) return out;
  State x;
  x.t = t;
  x.q = q;
  x.v.setZero(q.size());
  ScaledConstraints all;
  all.evaluate(model, x, ScaledConstraints::Rows::all);
  const VectorXd misses = all.misses();
  for (const int row : model.left_out_rows()) {
    if (!(std::abs(misses[row]) > out.miss)) continue;
    out.miss = std::abs(misses[row]);
    out.joint = model.joints()[static_cast<size_t>(joint_of_row(model, row))]->name();
  }
  out.is_large = out.miss > kAgree * model_size(all.scales(), q);
  return out;
}

}  // namespace flexmorph::fem
