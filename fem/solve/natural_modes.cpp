#include "fem/solve/natural_modes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "fem/solve/diagnosis.h"

namespace flexmorph::fem {
namespace {

constexpr double kRoundOff = 1e-13;  // of the largest K_ii / M_ii
constexpr double kGrowth = 1e-3;     // damping ratio, with a negative sign, of a mode that grows

/// Returns the first n rows and columns of a matrix.
SparseMatrix first_block(const SparseMatrix& a, int n) { return a.topLeftCorner(n, n); }

double largest_entry(const SparseMatrix& a) {
  double out = 0;
  for (int k = 0; k < a.outerSize(); ++k)
    for (SparseMatrix::InnerIterator it(a, k); it; ++it) out = std::max(out, std::abs(it.value()));
  return out;
}

bool is_symmetric(const SparseMatrix& a) {
  const SparseMatrix transposed = a.transpose();
  return largest_entry(a - transposed) <= 1e-10 * largest_entry(a);
}

/// Returns the matrix Ω of natural_modes() (n x n).
SparseMatrix rotation_rates(const Model& model, std::span<const Turning> turning) {
  std::vector<Eigen::Triplet<double>> entries;
  for (size_t b = 0; b < turning.size(); ++b) {
    const Body& body = model.bodies()[b];
    for (int k = 0; k < body.element->n_vectors() && turning[b].rate != 0; ++k) {
      const int at = body.first_dof + body.element->dim() * k;
      entries.emplace_back(at, at + 1, -turning[b].rate);
      entries.emplace_back(at + 1, at, turning[b].rate);
    }
  }
  SparseMatrix out(model.n_dofs(), model.n_dofs());
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

/// Returns the independent rows of the scaled constraints.
SparseMatrix independent_rows(Workspace& model, const State& x) {
  ScaledConstraints rows;
  rows.evaluate(model, x);
  const Diagnosis diagnosis = diagnose(model, x);
  if (diagnosis.is_independent()) return rows.jacobian();
  const Eigen::SparseMatrix<double, Eigen::RowMajor> all = rows.jacobian();
  std::vector<Eigen::Triplet<double>> entries;
  int row = 0;
  for (const int each : diagnosis.independent) {
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(all, each); it; ++it)
      entries.emplace_back(row, static_cast<int>(it.col()), it.value());
    ++row;
  }
  SparseMatrix out(row, all.cols());
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

/// Returns the matrices of small motions in displacements S δq.
SmallMotion small_motion(Workspace& model, const State& x, std::span<const Turning> turning,
                         const VectorXd& scales) {
  const int n = model.n_dofs();
  Constraints c;
  model.constraints(x, c);
  SparseMatrix stiffness, damping, mass;
  model.kkt(x, c, {1, 0, 0}, 1, stiffness);
  model.kkt(x, c, {0, 1, 0}, 1, damping);
  model.kkt(x, c, {0, 0, 1}, 1, mass);
  const bool turns = std::any_of(turning.begin(), turning.end(), [](const Turning& t) {
    return t.rate != 0 || t.acceleration != 0;
  });
  if (turns) add_turning_tangent(model, x, c, turning, stiffness);
  const auto scaled = [&](const SparseMatrix& all) {
    const VectorXd inverse = scales.cwiseInverse();
    SparseMatrix out = inverse.asDiagonal() * first_block(all, n) * inverse.asDiagonal();
    out.prune(0.0);
    return out;
  };
  SmallMotion out;
  out.stiffness = scaled(stiffness);
  out.damping = scaled(damping);
  out.mass = scaled(mass);
  // Both vectors of a node that Ω exchanges have the same scale.
  if (turns) out.damping += 2 * out.mass * rotation_rates(model, turning);
  out.constraints = independent_rows(model, x);
  const double size = std::sqrt(largest_entry(out.stiffness) * largest_entry(out.mass));
  out.is_symmetric = largest_entry(out.damping) <= 1e-12 * size && is_symmetric(out.stiffness);
  return out;
}

/// Returns the largest K_ii / M_ii [1/s²].
double largest_ratio(const SmallMotion& motion) {
  const VectorXd k = motion.stiffness.diagonal(), m = motion.mass.diagonal();
  const double least = 1e-12 * m.maxCoeff();
  double out = 0;
  for (Eigen::Index i = 0; i < k.size(); ++i)
    if (m[i] > least) out = std::max(out, std::abs(k[i]) / m[i]);
  return out;
}

/// Returns real, independent shapes of rigid modes. In quadratic problems a rigid mode has up to
/// two eigenvalues 0 with equal shapes.
std::vector<Eigenpair> independent_shapes(const std::vector<Eigenpair>& rigid) {
  constexpr double kIndependent = 1e-2;  // part of a vector that the others do not contain
  std::vector<VectorXd> basis;
  for (const Eigenpair& each : rigid)
    for (const VectorXd& part : {VectorXd(each.shape.real()), VectorXd(each.shape.imag())}) {
      if (!(part.norm() > kIndependent * each.shape.norm())) continue;
      VectorXd rest = part.normalized();
      for (int pass = 0; pass < 2; ++pass)
        for (const VectorXd& known : basis) rest -= known.dot(rest) * known;
      if (rest.norm() > kIndependent) basis.push_back(rest.normalized());
    }
  std::vector<Eigenpair> out;
  for (const VectorXd& each : basis) out.push_back({0, each.cast<std::complex<double>>()});
  return out;
}

/// Finds the pairs with a shift near the lowest frequency that is not zero. The first shift is the
/// largest stiffness per mass, divided by a number that is larger than any other mode needs.
std::vector<Eigenpair> lowest_pairs(const SmallMotion& motion, int count) {
  constexpr double kFirst = 1e-9, kNear = 30, kFarther = 1e4, kBeside = 1.5;
  constexpr int kPasses = 8;
  if (count == 0) return {};
  std::optional<std::vector<Eigenpair>> rigid;
  if (!motion.is_symmetric && is_symmetric(motion.stiffness)) {
    // Rigid modes do not depend on C, and the shapes of double eigenvalues 0 are inaccurate.
    SmallMotion undamped = motion;
    undamped.damping.setZero();
    undamped.is_symmetric = true;
    rigid = lowest_pairs(undamped, count);
    std::erase_if(*rigid, [](const Eigenpair& each) { return each.value != 0.0; });
  }
  const double ratio = largest_ratio(motion);
  double shift = ratio > 0 ? std::sqrt(kFirst * ratio) : 1;
  // A quadratic problem has up to two eigenvalues for every rigid mode.
  const int more = motion.is_symmetric ? 0 : rigid ? static_cast<int>(rigid->size()) : count;
  for (int pass = 0; pass < kPasses; ++pass) {
    const std::vector<Eigenpair> found = eigenpairs(motion, shift, count + more);
    if (found.empty()) {  // all eigenvalues are far above the shift
      shift *= kFarther;
      continue;
    }
    const double zero =
        std::sqrt((motion.is_symmetric ? 1e-6 : 1e-8) * shift * shift + kRoundOff * ratio);
    const auto first = std::find_if(found.begin(), found.end(), [&](const Eigenpair& each) {
      return std::abs(each.value) > zero;
    });
    const double lowest = first == found.end() ? 0 : std::abs(first->value);
    if (lowest != 0 && !(lowest < kNear * shift && shift < kNear * lowest)) {
      shift = kBeside * lowest;  // at a mode that grows the matrix would be singular
      continue;
    }
    std::vector<Eigenpair> out = rigid ? *rigid : independent_shapes({found.begin(), first});
    out.insert(out.end(), first, found.end());
    if (out.size() > static_cast<size_t>(count)) out.resize(static_cast<size_t>(count));
    return out;
  }
  throw Error::numerical(
      "natural frequencies: the lowest frequency cannot be separated from round-off");
}

NaturalMode mode_of(const Model& model, const SparseMatrix& mass, const VectorXd& scales,
                    const Eigenpair& pair) {
  NaturalMode out;
  out.eigenvalue = pair.value;
  Eigen::Index largest = 0;
  pair.shape.cwiseAbs().maxCoeff(&largest);
  const VectorXcd displacement = pair.shape / pair.shape[largest];
  const VectorXcd momentum = mass.cast<std::complex<double>>() * displacement;
  double all = 0;
  for (const Body& body : model.bodies()) {
    const double energy = displacement.segment(body.first_dof, body.n_dofs())
                              .dot(momentum.segment(body.first_dof, body.n_dofs()))
                              .real();
    out.kinetic_share.push_back(energy);
    all += energy;
  }
  for (double& each : out.kinetic_share) each = all > 0 ? each / all : 0;
  out.shape = displacement.cwiseQuotient(scales.cast<std::complex<double>>());
  return out;
}

}  // namespace

double NaturalMode::frequency() const {
  return std::abs(eigenvalue.imag()) / (2 * std::numbers::pi);
}

double NaturalMode::damping_ratio() const {
  return is_rigid() ? 0 : 0.0 - eigenvalue.real() / std::abs(eigenvalue);
}

bool NaturalMode::grows() const { return eigenvalue.real() > kGrowth * std::abs(eigenvalue); }

int NaturalModes::n_rigid() const {
  return static_cast<int>(
      std::count_if(modes.begin(), modes.end(), [](const NaturalMode& m) { return m.is_rigid(); }));
}

NaturalModes natural_modes(Workspace& model, const State& x, std::span<const Turning> turning,
                           int count) {
  model.prepare(x);
  const VectorXd scales = model.scales();
  const SmallMotion motion = small_motion(model, x, turning, scales);
  if (!(motion.mass.diagonal().maxCoeff() > 0))
    throw Error::input(
        "natural frequencies need inertia: give the bodies a density and the term \"inertia\"");
  NaturalModes out;
  out.degrees_of_freedom = motion.degrees_of_freedom();
  out.is_complex = !motion.is_symmetric;
  for (const Eigenpair& pair : lowest_pairs(motion, std::min(count, out.degrees_of_freedom)))
    out.modes.push_back(mode_of(model, motion.mass, scales, pair));
  return out;
}

}  // namespace flexmorph::fem
