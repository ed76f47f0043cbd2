#include "fem/dynamics/integrators/acceleration_solver.h"

#include <algorithm>
#include <cmath>

#include "fem/solve/condition.h"

namespace flexmorph::fem {
namespace {

/// Number of unknowns up to which KLU, which keeps its pivots, is faster than DirectSolver.
constexpr int kDenseUnknowns = 400;
/// Scaled mass (largest 1) below which a motion that the constraints allow counts as a motion
/// without mass. Masses of elements and bodies are far above this limit; round-off of zero masses
/// is below it.
constexpr double kNoMass = 1e-12;

/// Returns the index of an entry in the values of a compressed matrix.
int value_index(const SparseMatrix& a, int row, int column) {
  const int* first = a.innerIndexPtr() + a.outerIndexPtr()[column];
  const int* last = a.innerIndexPtr() + a.outerIndexPtr()[column + 1];
  return static_cast<int>(std::lower_bound(first, last, row) - a.innerIndexPtr());
}

/// Returns true if material lines of any element move.
bool any_moves(const Model& model) {
  for (const Body& b : model.bodies())
    for (int e = 0; e < b.element->n_elements(); ++e)
      if (b.element->moving(e)) return true;
  return false;
}

}  // namespace

void AccelerationSolver::number(const State& x, const Constraints& c) {
  const int n = model_.n_dofs(), m = model_.n_constraints();
  model_.kkt(x, c, {0, 0, 1}, 1, kkt_);
  // Unknowns without mass are scaled like displacements of the largest mass.
  const VectorXd mass = VectorXd(kkt_.diagonal()).head(n), sizes = model_.scales();
  const double largest = n > 0 ? mass.cwiseQuotient(sizes.cwiseAbs2()).maxCoeff() : 0.0;
  scale_.setOnes(n + m);
  for (int i = 0; i < n; ++i)
    scale_[i] = 1 / (mass[i] > 0 ? std::sqrt(mass[i]) : std::sqrt(largest) * sizes[i]);
  if (!(largest > 0) && n > 0) scale_.setOnes();
  scale_.tail(m).setZero();
  for (const auto& entry : c.jacobian)
    scale_[n + entry.row()] += std::pow(entry.value() * scale_[entry.col()], 2);
  for (int i = n; i < n + m; ++i) scale_[i] = scale_[i] > 0 ? 1 / std::sqrt(scale_[i]) : 1;

  weights_.resize(kkt_.nonZeros());
  for (int column = 0, k = 0; column < kkt_.cols(); ++column)
    for (SparseMatrix::InnerIterator it(kkt_, column); it; ++it)
      weights_[k++] = scale_[it.row()] * scale_[column];
  value_indices_.clear();
  for (const auto& entry : c.jacobian) {
    value_indices_.push_back(value_index(kkt_, n + entry.row(), entry.col()));
    value_indices_.push_back(value_index(kkt_, entry.col(), n + entry.row()));
  }
  kkt_.coeffs() *= weights_.array();
  mass_moves_ = any_moves(model_);
  is_small_ = n + m <= kDenseUnknowns;
  is_factored_ = false;
  factored_.setZero(static_cast<Eigen::Index>(c.jacobian.size()));
  right_.resize(n + m);
  require_mass();
  if (is_small_)
    small_.analyze(kkt_);
  else
    large_.analyze(kkt_);
  version_ = model_.pattern_version();
}

/// Inverse iteration for the smallest mass on the null space of Φ_q. M is shifted by less than any
/// mass of the model, so that directions without mass dominate the iteration.
/// @throws Error (input) naming the bodies if a motion without mass exists.
void AccelerationSolver::require_mass() const {
  const int n = model_.n_dofs();
  if (n == model_.n_kept_constraints()) return;
  SparseMatrix shifted = kkt_;
  for (int i = 0; i < n; ++i) shifted.coeffRef(i, i) += 0.01 * kNoMass;
  shifted.makeCompressed();
  DirectSolver solver;
  solver.analyze(shifted);
  solver.factorize(shifted);
  VectorXd z(kkt_.rows()), right = VectorXd::Zero(kkt_.rows());
  for (int i = 0; i < n; ++i) right[i] = std::fmod(0.6180339887498949 * (i + 1), 1.0) - 0.37;
  for (int k = 0; k < 4; ++k) {
    solver.solve(shifted, right, z);
    if (!z.allFinite()) throw Error::numerical("minimal_coordinates: the mass matrix is singular");
    z.tail(z.size() - n).setZero();
    z.normalize();
    right.head(n) = z.head(n);
  }
  if ((kkt_ * z).dot(z) > kNoMass) return;
  const double most = z.lpNorm<Eigen::Infinity>();
  std::string bodies;
  for (const Body& b : model_.bodies())
    if (b.n_dofs() > 0 && z.segment(b.first_dof, b.n_dofs()).lpNorm<Eigen::Infinity>() > 0.1 * most)
      bodies += (bodies.empty() ? "'" : ", '") + b.name + "'";
  throw Error::input(
      "minimal_coordinates: accelerations do not exist, because degrees of freedom without mass "
      "are not fixed; they belong to " +
      bodies + ". Give the body a mass, fix it, or use another integrator.");
}

void AccelerationSolver::factorize(const State& x, const Constraints& c) {
  bool changed = false;
  if (version_ != model_.pattern_version()) {
    number(x, c);
  } else if (mass_moves_) {
    model_.kkt(x, c, {0, 0, 1}, 1, kkt_);
    kkt_.coeffs() *= weights_.array();
    changed = true;
  }
  for (size_t k = 0; k < c.jacobian.size(); ++k)
    changed = changed || c.jacobian[k].value() != factored_[static_cast<Eigen::Index>(k)];
  if (is_factored_ && !changed) return;
  double* values = kkt_.valuePtr();
  for (const int at : value_indices_) values[at] = 0;
  for (size_t k = 0; k < c.jacobian.size(); ++k) {
    factored_[static_cast<Eigen::Index>(k)] = c.jacobian[k].value();
    for (const int at : {value_indices_[2 * k], value_indices_[2 * k + 1]})
      values[at] += weights_[at] * c.jacobian[k].value();
  }
  is_factored_ = false;
  if (is_small_)
    small_.factorize(kkt_);
  else
    large_.factorize(kkt_);
  is_factored_ = true;
  ++factorizations_;
}

void AccelerationSolver::archive(Archive& memory) {
  memory(factorizations_, mass_moves_, is_factored_, is_small_, kkt_, scale_, weights_,
         value_indices_, factored_);
  right_.resize(scale_.size());
  if (!memory.up_to_date(version_, model_.pattern_version())) return;
  if (is_small_)
    small_.archive(memory, kkt_);
  else
    large_.archive(memory, kkt_);
}

std::optional<double> AccelerationSolver::condition() const {
  if (factorizations_ == 0) return {};
  return condition_estimate(kkt_);
}

void AccelerationSolver::solve(const VectorXd& force, const VectorXd& constraint, VectorXd& a,
                               VectorXd& lambda) {
  const Eigen::Index n = model_.n_dofs(), m = model_.n_constraints();
  right_ << force, constraint;
  right_.array() *= scale_.array();
  if (is_small_) {
    solution_ = right_;
    small_.solve(solution_);
    right_.noalias() -= kkt_ * solution_;  // one refinement, because kept pivots are not optimal
    small_.solve(right_);
    solution_ += right_;
  } else {
    large_.solve(kkt_, right_, solution_);
  }
  solution_.array() *= scale_.array();
  if (!solution_.allFinite()) throw Error::numerical("the accelerations are not finite");
  a = solution_.head(n);
  lambda = solution_.tail(m);
}

}  // namespace flexmorph::fem
