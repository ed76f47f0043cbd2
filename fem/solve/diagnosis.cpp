#include "fem/solve/diagnosis.h"

#include <Eigen/SparseQR>
#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/text.h"

namespace flexmorph::fem {
namespace {

constexpr double kNewPart = 1e-9;  // independent fraction of a unit row below which it is dependent
constexpr double kZeroEntry = 1e-7;   // relative to the largest entry, 1, of a null vector
constexpr double kConsistent = 1e-8;  // relative to the terms that add up to zero
// Relative to the size of the model, per second and per second squared: rates and accelerations
// that are zero except for round-off have no scale of their own, in particular those of a static
// model.
constexpr double kRoundOff = 1e-10;
constexpr double kShift = 1e-14;     // shift of the Gram matrix of ConstraintWatch
constexpr double kSurelyNew = 1e-4;  // above it the Gram matrix is accurate enough
constexpr double kSeparatingEntry =
    0.1;  // smallest entry alone in its column that proves a row independent

std::string number(double value) { return formatted("%.3g", value); }

using Entry = std::pair<int, double>;
/// A null vector of the rows: (row, entry), rows ascending, largest entry 1.
using NullVector = std::vector<Entry>;

/// Returns Jᵀ without the unknowns that no row acts on, with at least as many rows as columns.
SparseMatrix compressed_transpose(const SparseMatrix& j) {
  std::vector<Eigen::Triplet<double>> entries;
  int used = 0;
  for (int column = 0; column < j.cols(); ++column) {
    bool any = false;
    for (SparseMatrix::InnerIterator it(j, column); it; ++it) {
      if (it.value() == 0) continue;
      entries.emplace_back(used, static_cast<int>(it.row()), it.value());
      any = true;
    }
    used += any;
  }
  SparseMatrix out(std::max<Eigen::Index>(used, j.rows()), j.rows());
  out.setFromTriplets(entries.begin(), entries.end());
  out.makeCompressed();
  return out;
}

NullVector normalized(const VectorXd& z) {
  Eigen::Index at = 0;
  z.cwiseAbs().maxCoeff(&at);
  NullVector out;
  for (Eigen::Index i = 0; i < z.size(); ++i)
    if (std::abs(z[i]) > kZeroEntry * std::abs(z[at]))
      out.emplace_back(static_cast<int>(i), z[i] / z[at]);
  return out;
}

/// Returns true if all rows are certainly independent. Pivots of the Gram matrix J Jᵀ of unit rows
/// are squares of the fraction that each row adds to the rows before it. Their round-off, 1e-16
/// times a number that grows with the length of a chain, is far below the bound. The cost is nearly
/// linear for chains, where QR needs seconds.
bool surely_independent(const SparseMatrix& j) {
  const SparseMatrix gram = j * j.transpose();
  const Eigen::SimplicialLDLT<SparseMatrix> factor(gram);
  return factor.info() == Eigen::Success && factor.vectorD().minCoeff() > kSurelyNew * kSurelyNew;
}

/// Returns the given rows of a matrix.
SparseMatrix rows_of(const SparseMatrix& j, const std::vector<int>& rows) {
  SparseMatrix pick(static_cast<Eigen::Index>(rows.size()), j.rows());
  for (size_t k = 0; k < rows.size(); ++k) pick.insert(static_cast<Eigen::Index>(k), rows[k]) = 1;
  return pick * j;
}

/// Finds independent rows (ascending) and a null vector for every other row.
///
/// With Jᵀ P = Q [R₁₁ R₁₂; 0 0], the null vectors are the columns of P [-R₁₁⁻¹ R₁₂; I]. Each of
/// them is the unique representation of a dependent row by the independent ones.
void factor_rows(const SparseMatrix& all, std::vector<int>& independent,
                 std::vector<NullVector>& null_vectors) {
  const std::vector<int> rows = entangled_rows(all);
  const SparseMatrix j = rows_of(all, rows);
  const auto m = static_cast<Eigen::Index>(rows.size());
  std::vector<char> depends(static_cast<size_t>(all.rows()), 0);
  if (m > 0 && !surely_independent(j)) {
    const SparseMatrix transpose = compressed_transpose(j);
    Eigen::SparseQR<SparseMatrix, Eigen::COLAMDOrdering<int>> qr;
    qr.setPivotThreshold(kNewPart);
    qr.compute(transpose);
    if (qr.info() != Eigen::Success)
      throw Error::numerical("diagnosis of constraints: the QR factorization failed");
    const auto& order = qr.colsPermutation().indices();
    const Eigen::Index rank = qr.rank();
    for (Eigen::Index k = rank; k < m; ++k)
      depends[static_cast<size_t>(rows[static_cast<size_t>(order[k])])] = 1;
    const Eigen::SparseMatrix<double, Eigen::RowMajor> sorted = qr.matrixR();
    const SparseMatrix r = sorted;
    const SparseMatrix r11 = r.topLeftCorner(rank, rank);
    MatrixXd span = MatrixXd(r.block(0, rank, rank, m - rank));
    r11.triangularView<Eigen::Upper>().solveInPlace(span);
    VectorXd z(all.rows());
    const auto entry = [&](Eigen::Index k) -> double& {
      return z[rows[static_cast<size_t>(order[k])]];
    };
    for (Eigen::Index k = 0; k < m - rank; ++k) {
      z.setZero();
      for (Eigen::Index i = 0; i < rank; ++i) entry(i) = -span(i, k);
      entry(rank + k) = 1;
      null_vectors.push_back(normalized(z));
    }
  }
  for (int row = 0; row < all.rows(); ++row)
    if (depends[static_cast<size_t>(row)] == 0) independent.push_back(row);
}

std::vector<int> joints_of(const NullVector& z, const std::vector<int>& joint_of) {
  std::vector<int> out;
  for (const auto& [row, entry] : z)
    if (const int joint = joint_of[static_cast<size_t>(row)]; out.empty() || out.back() != joint)
      out.push_back(joint);
  return out;
}

/// Returns a - c b with the c that cancels the entry of `row`; both vectors have this entry.
NullVector without(const NullVector& a, const NullVector& b, int row, int m) {
  const auto entry = [row](const NullVector& z) {
    return std::find_if(z.begin(), z.end(), [row](const Entry& e) { return e.first == row; })
        ->second;
  };
  const double c = entry(a) / entry(b);
  VectorXd sum = VectorXd::Zero(m);
  for (const auto& [i, value] : a) sum[i] += value;
  for (const auto& [i, value] : b) sum[i] -= c * value;
  sum[row] = 0;
  // Entries that cancel leave round-off.
  const double largest = std::max(1.0, std::abs(c));
  return normalized((sum.array().abs() > kZeroEntry * largest).select(sum, 0.0));
}

/// Subtracts null vectors from each other as long as one of them then involves fewer joints.
void shorten(std::vector<NullVector>& all, const std::vector<int>& joint_of) {
  constexpr size_t kMaxListed = 60;  // longer lists are of no use to a reader
  if (all.size() > kMaxListed) return;
  const int m = static_cast<int>(joint_of.size());
  for (bool shorter = true; shorter;) {
    shorter = false;
    for (NullVector& a : all)
      for (const NullVector& b : all) {
        const auto of_a = joints_of(a, joint_of), of_b = joints_of(b, joint_of);
        if (&a == &b || of_a.size() < 2 || of_a == of_b) continue;
        std::vector<int> common;
        for (const auto& [row, entry] : a)
          if (std::any_of(b.begin(), b.end(), [r = row](const Entry& e) { return e.first == r; }))
            common.push_back(row);
        for (const int row : common) {
          NullVector sum = without(a, b, row, m);
          if (joints_of(sum, joint_of).size() >= of_a.size()) continue;
          a = std::move(sum);
          shorter = true;
          break;
        }
      }
  }
}

/// Returns |Σ z f| where it exceeds round-off and the allowance, otherwise 0.
double miss_of(const NullVector& z, const VectorXd& row_scale, const VectorXd& f,
               double allowance) {
  double sum = 0, size = 0;
  for (const auto& [row, entry] : z) {
    const double part = entry * row_scale[row] * f[row];
    sum += part;
    size += std::abs(part);
  }
  return std::abs(sum) > kConsistent * size + allowance ? std::abs(sum) : 0;
}

std::string describe(const DependentGroup& g) {
  const bool one = g.joints.size() == 1;
  // Of joints that contradict each other, the last one has most likely been added by mistake.
  std::vector<std::string> joints = g.joints;
  if (g.contradictory) std::rotate(joints.begin(), joints.end() - 1, joints.end());
  std::string out = list_joints(joints);
  if (!g.contradictory) {
    out += one ? " constrains " : " constrain ";
    out += g.surplus == 1 ? "one degree of freedom"
                          : std::to_string(g.surplus) + " degrees of freedom";
    return out + (one ? " a second time" : " more than once");
  }
  out += one ? " contradicts itself: its error is " : " contradict each other: their error is ";
  if (g.miss > 0) return out + number(g.miss) + " m";
  if (g.rate_miss > 0) return out + number(g.rate_miss) + " m/s in velocity";
  return out + number(g.acceleration_miss) + " m/s² in acceleration";
}

}  // namespace

bool Diagnosis::is_contradictory() const {
  return std::any_of(groups.begin(), groups.end(), [](const auto& g) { return g.contradictory; });
}

bool Diagnosis::misses_positions() const {
  return std::any_of(groups.begin(), groups.end(), [](const auto& g) { return g.miss > 0; });
}

std::vector<int> entangled_rows(const SparseMatrix& j) {
  using RowMajor = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  const RowMajor by_row = j;
  const auto counts = [](double entry) { return entry != 0; };
  // Number of rows with an entry in each column.
  std::vector<int> left(static_cast<size_t>(j.cols()), 0);
  // Sum of the numbers of the rows with an entry in each column.
  std::vector<long long> sum(static_cast<size_t>(j.cols()), 0);
  for (int row = 0; row < by_row.outerSize(); ++row)
    for (RowMajor::InnerIterator e(by_row, row); e; ++e)
      if (counts(e.value())) {
        ++left[static_cast<size_t>(e.col())];
        sum[static_cast<size_t>(e.col())] += row;
      }
  std::vector<char> free(static_cast<size_t>(j.rows()), 0);
  std::vector<int> alone;
  for (int column = 0; column < j.cols(); ++column)
    if (left[static_cast<size_t>(column)] == 1) alone.push_back(column);
  while (!alone.empty()) {
    const int column = alone.back();
    alone.pop_back();
    if (left[static_cast<size_t>(column)] != 1) continue;
    const auto row = static_cast<int>(sum[static_cast<size_t>(column)]);
    if (std::abs(j.coeff(row, column)) < kSeparatingEntry) continue;
    free[static_cast<size_t>(row)] = 1;
    for (RowMajor::InnerIterator e(by_row, row); e; ++e) {
      if (!counts(e.value())) continue;
      const auto c = static_cast<size_t>(e.col());
      sum[c] -= row;
      if (--left[c] == 1) alone.push_back(static_cast<int>(c));
    }
  }
  std::vector<int> out;
  for (int row = 0; row < j.rows(); ++row)
    if (free[static_cast<size_t>(row)] == 0) out.push_back(row);
  return out;
}

Diagnosis diagnose(Workspace& model, const State& x) {
  Diagnosis out;
  out.unknowns = model.n_dofs();
  out.constraints = model.n_constraints();
  if (out.constraints == 0) return out;
  ScaledConstraints rows;
  rows.evaluate(model, x, ScaledConstraints::Rows::all);
  std::vector<NullVector> null_vectors;
  factor_rows(rows.jacobian(), out.independent, null_vectors);
  out.rank = static_cast<int>(out.independent.size());

  std::vector<int> joint_of;
  for (size_t i = 0; i < model.joints().size(); ++i)
    joint_of.insert(joint_of.end(), static_cast<size_t>(model.joints()[i]->size()),
                    static_cast<int>(i));
  shorten(null_vectors, joint_of);
  const auto shown = [&](const NullVector& z) {
    std::vector<int> all = joints_of(z, joint_of), out = all;
    std::erase_if(out,
                  [&](int i) { return model.joints()[static_cast<size_t>(i)]->belongs_to_body(); });
    return out.empty() ? all : out;
  };

  const double size = model_size(rows.scales(), x.q);
  const double speed = rows.scales().cwiseProduct(x.v).lpNorm<Eigen::Infinity>();
  std::map<std::vector<int>, DependentGroup> groups;
  for (const NullVector& z : null_vectors) {
    DependentGroup& g = groups[shown(z)];
    ++g.surplus;
    for (const auto& [row, entry] : z) g.rows.push_back(row);
    const Constraints& c = rows.unscaled();
    g.miss = std::max(g.miss, miss_of(z, rows.row_scale(), c.value, 1e-10 * size));
    g.rate_miss = std::max(
        g.rate_miss, miss_of(z, rows.row_scale(), c.rate, kConsistent * speed + kRoundOff * size));
    g.acceleration_miss = std::max(g.acceleration_miss,
                                   miss_of(z, rows.row_scale(), c.acceleration,
                                           kConsistent * speed * speed / size + kRoundOff * size));
    g.contradictory = g.miss > 0 || g.rate_miss > 0 || g.acceleration_miss > 0;
  }
  for (auto& [joints, g] : groups) {
    for (const int joint : joints)
      g.joints.push_back(model.joints()[static_cast<size_t>(joint)]->name());
    std::sort(g.rows.begin(), g.rows.end());
    g.rows.erase(std::unique(g.rows.begin(), g.rows.end()), g.rows.end());
    out.groups.push_back(std::move(g));
  }
  return out;
}

int degrees_of_freedom(Workspace& model, const State& x) {
  return diagnose(model, x).degrees_of_freedom();
}

std::string describe(const Diagnosis& diagnosis) {
  constexpr size_t kMaxListed = 10;
  std::vector<const DependentGroup*> groups;
  // contradictions first, because they must be changed first
  for (const bool contradictory : {true, false})
    for (const DependentGroup& g : diagnosis.groups)
      if (g.contradictory == contradictory) groups.push_back(&g);
  std::string out;
  for (size_t i = 0; i < std::min(groups.size(), kMaxListed); ++i) {
    if (i > 0) out += "\n";
    out += describe(*groups[i]);
  }
  if (groups.size() > kMaxListed)
    out +=
        "\n" + std::to_string(groups.size() - kMaxListed) + " more groups of joints are not listed";
  return out;
}

Conditioning ConstraintWatch::look(const State& x) {
  Conditioning out{x.t, 1, {}};
  const int m = model_.n_constraints();
  if (m == 0) return out;
  rows_.evaluate(model_, x);
  gram_ = rows_.jacobian() * rows_.jacobian().transpose();
  for (const int row : model_.left_out_rows()) gram_.coeffRef(row, row) = 1;
  if (version_ != model_.pattern_version()) {
    factor_.setShift(kShift);
    factor_.analyzePattern(gram_);
    version_ = model_.pattern_version();
  }
  factor_.factorize(gram_);
  if (factor_.info() != Eigen::Success)
    throw Error::numerical("check of constraints: the factorization failed at t = " + number(x.t) +
                           " s");
  // A deterministic start vector with components in all rows: multiples of the golden section.
  z_.resize(m);
  for (int i = 0; i < m; ++i) z_[i] = std::fmod(0.6180339887498949 * (i + 1), 1.0) - 0.37;
  z_.normalize();
  previous_ = z_;
  double largest = 0, smallest_inverse = 0;
  for (int k = 0; k < 12; ++k) {
    z_ = gram_ * z_;
    largest = std::max(largest, z_.norm());
    z_.normalize();
  }
  z_ = previous_;
  for (int k = 0; k < 12; ++k) {
    z_ = factor_.solve(z_).eval();
    const double norm = z_.norm();
    z_ /= norm;
    const bool settled = norm < smallest_inverse * (1 + 1e-3);
    smallest_inverse = std::max(smallest_inverse, norm);
    if (settled) break;
  }
  out.condition = std::sqrt(largest * smallest_inverse);
  out.joints = heaviest_joints(model_, z_, 0.1);
  return out;
}

double constraint_condition(Workspace& model, const State& x) {
  return ConstraintWatch(model).look(x).condition;
}

std::string describe(const Conditioning& c) {
  return "constraints are nearly dependent at t = " + number(c.t) + " s: the condition number is " +
         number(c.condition) + ", mainly caused by " + list_joints(c.joints);
}

}  // namespace flexmorph::fem
