// Prints the cost of one element evaluation: force, and force with tangent, of every term of the
// table that acts on elements, in ns per element on one core, together with the counted operations
// and the rate of a dense product. It also prints three methods for the in-plane force of a spatial
// h12 element: the full tensors as P (11) prints them, their nonzero entries, and 7 x 7 Gauss
// points. All three must agree to 1e-12, otherwise the program fails.
//
//   element_speed
#include <Eigen/SparseCore>
#include <algorithm>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "fem/elements/ancf_plate.h"
#include "fem/terms.h"
#include "fem/terms/gram.h"
#include "tests/benchmark/cpu.h"
#include "tests/support/models.h"

namespace {

using namespace flexmorph;
using namespace flexmorph::fem;
using testing::ShapeSet;

const PlaneSection kSection{0.01, 1e5, 0.3, 7810};

/// Returns the CPU time [ns] of one call: the least of many batches of at least 0.1 ms, because
/// other processes use the machine, too.
template <class F>
double nanoseconds(const F& f) {
  const auto batch = [&](int n) {
    const double start = cpu_seconds();
    for (int k = 0; k < n; ++k) {
      f();
      asm volatile("" ::: "memory");
    }
    return (cpu_seconds() - start) / n;
  };
  int n = 1;
  while (batch(n) * n < 1e-4) n *= 2;
  double best = batch(n);
  const double start = cpu_seconds();
  for (int k = 0; k < 2000 && (k < 3 || cpu_seconds() - start < 0.4); ++k)
    best = std::min(best, batch(n));
  return 1e9 * best;
}

/// Returns the best rate of a dense product [operations per ns].
double dgemm_rate() {
  double best = 0;
  for (const int n : {160, 240, 320, 500}) {
    const MatrixXd a = MatrixXd::Random(n, n), b = MatrixXd::Random(n, n);
    MatrixXd c(n, n);
    const double rate = 2.0 * n * n * n / nanoseconds([&] { c.noalias() = a * b; });
    std::printf("dense product, n = %d: %.1f operations per ns\n", n, rate);
    best = std::max(best, rate);
  }
  return best;
}

struct Operations {
  double force = 0, both = 0;
};

/// Returns the additions and multiplications of the kernels of gram.h, counted by their loops.
template <int kKinds>
Operations gram_operations(int d, bool classes) {
  using N = gram::Numbering<kKinds>;
  double multiply = 0, rows = 0;
  for (std::size_t c = 0; c < 4; ++c) {
    const double m = N::tables.start[c + 1] - N::tables.start[c];
    multiply += 2 * m * (classes ? m : N::n_pairs);
    for (std::size_t a = 0; a < 4; ++a)  // pairs of class c, vectors l of class a, partners i
      rows += m * (N::first[a + 1] - N::first[a]) *
              (classes ? N::first[(a ^ c) + 1] - N::first[a ^ c] : N::n) * 2 * d;
  }
  const double n = N::n, to_vectors = 12.0 * kKinds * d;
  const double nodes = kKinds * (kKinds + 1) / 2.0 * d * d * (64 + 24) + 0.0;
  Operations out;
  out.force = to_vectors + N::n_pairs * 2 * d + multiply + 2 * n * n * d + to_vectors;
  out.both = out.force + rows + n * n * (n + 1) / 2 * 2 * d * d + nodes;
  return out;
}

/// Returns the operations of bending_kernels.h with n x n points. A point takes 96 operations
/// (shared by force and energy), 30 (force) and 1127 (second derivatives).
Operations bending_operations(int n, bool mixed) {
  const double products = mixed ? 16 : 12, points = n * n,
               shared = 2 * 9 * products * n + 2 * 60 * points + 96 * points;
  Operations out;
  out.force = 2 * shared - 96 * points + 30 * points;
  out.both = out.force + shared + 1127 * points + 6 * points * 2 * (100 + 240);
  const double of[2] = {4, mixed ? 4.0 : 2.0};  // functions along m for function j along n
  for (int j = 0; j < 4; ++j)
    for (int l = 0; l < 4; ++l) out.both += n * (l >= j ? 6 : 3) * of[l % 2] * (15 + 6 * of[j % 2]);
  return out;
}

/// 8 x 8 elements with random unknowns about the reference configuration of the plate.
struct Plate {
  AncfPlate element;
  ScaleFactors factors;
  std::vector<Pack> q, zero, force, tangent;
  int n_local;

  Plate(ShapeSet shapes, int dim, bool designed)
      : element(dim, shapes, testing::uniform_lines(0, 0.3, 8), testing::uniform_lines(0, 0.3, 8)),
        n_local(element.n_shapes() * dim) {
    if (designed) {
      factors.grid = {0, 0, 0.3, 0.3, 64, 64};
      factors.mass = factors.stiffness =
          VectorXd::Random(factors.grid.n_cells()).array() * 0.45 + 0.55;
    }
    const auto size = static_cast<std::size_t>(n_local);
    q.resize(8 * size);
    zero.assign(8 * size, Pack{});
    force.resize(size);
    tangent.resize(size * size);
    const MatrixXd shape = testing::random_shape(element, 0.1, 1);
    for (int e = 0; e < 64; ++e) {
      const LocalRows rows = testing::rows_of_element(element, shape, e);
      for (std::size_t k = 0; k < size; ++k)
        q[static_cast<std::size_t>(e / kLanes) * size + k][e % kLanes] = rows.data()[k];
    }
  }
  Batch batch(int b) const {
    const auto at = static_cast<std::size_t>(b * n_local);
    return {8 * b,         kLanes,           element.n_shapes(), element.dim(),
            q.data() + at, zero.data() + at, zero.data() + at};
  }
};

void term_rows(double rate) {
  std::printf("\n%-10s %-4s dim %-8s %9s %6s %9s %14s %9s %6s\n", "term", "", "material",
              "force ns", "ops", "of dgemm", "with tangent ns", "ops", "of dgemm");
  for (const std::string name : {"membrane", "inertia", "bending"})
    for (const ShapeSet shapes : {ShapeSet::h12, ShapeSet::h16})
      for (const int dim : {2, 3})
        for (const bool designed : {false, true}) {
          if (name == "bending" && dim == 2) continue;
          Plate p(shapes, dim, designed);
          const BodyTerm term = make_term(name, kSection);
          term->prepare(p.element, p.factors, true);
          const auto forces = [&] {
            for (int b = 0; b < 8; ++b) term.add_forces(p.batch(b), p.force.data());
          };
          const double force = nanoseconds(forces) / 64,
                       both = nanoseconds([&] {
                                for (int b = 0; b < 8; ++b) {
                                  term.add_forces(p.batch(b), p.force.data());
                                  term.add_tangents(p.batch(b), {1, 0, 1}, p.tangent.data());
                                }
                              }) /
                              64;
          const bool h12 = shapes == ShapeSet::h12;
          const double n = p.element.n_shapes();
          const Operations ops = name == "bending" ? bending_operations(designed ? 16 : 9, !h12)
                                 : name == "inertia"
                                     ? Operations{2 * n * n * dim, n * n * (3 * dim + 1)}
                                 : h12 ? gram_operations<3>(dim, !designed)
                                       : gram_operations<4>(dim, !designed);
          std::printf("%-10s %-4s %d   %-8s %9.0f %6.0f %9.2f %14.0f %9.0f %6.2f\n", name.c_str(),
                      h12 ? "h12" : "h16", dim, designed ? "design" : "uniform", force, ops.force,
                      ops.force / force / rate, both, ops.both, ops.both / both / rate);
        }
}

/// A spatial h12 element by the methods of the paper, from shape functions at 7 x 7 points.
class Spatial {
 public:
  static constexpr int kShapes = 12, kLocal = 36, kPoints = 49;
  using Force = Eigen::Matrix<double, kLocal, 1>;
  using Tangent = Eigen::Matrix<double, kLocal, kLocal>;

  explicit Spatial(const AncfPlate& plate) : c_(kSection.thickness * kSection.elasticity()) {
    plate.tabulate(0, 12, Tabulate::gradient, {}, ScaleFactorKind::none, table_);
    // U = ½ Σ T_ij,kl q_i q_j q_k q_l - ½ Σ c_ij q_i q_j, because εᵀ C ε is quadratic in qᵀ S q.
    std::vector<Eigen::Triplet<double>> first, second;
    scalar_.setZero(144, 144);
    linear_.setZero(kShapes, kShapes);
    for (Eigen::Index p = 0; p < table_.weight.size(); ++p) {
      const Eigen::RowVectorXd m = table_.N_m.row(p), n = table_.N_n.row(p);
      const MatrixXd s11 = 0.5 * m.transpose() * m, s22 = 0.5 * n.transpose() * n,
                     s12 = 0.5 * (m.transpose() * n + n.transpose() * m);
      MatrixXd s(144, 3);
      s << s11.reshaped(), s22.reshaped(), s12.reshaped();
      scalar_ += table_.weight[p] * s * c_ * s.transpose();
      linear_ += table_.weight[p] * (c_(0, 0) + c_(0, 1)) * (s11 + s22);
    }
    full_.setZero(kLocal * kLocal, kLocal * kLocal);
    crossed_.setZero(kLocal * kLocal, kLocal * kLocal);
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < 12; ++j)
        for (int k = 0; k < 12; ++k)
          for (int l = 0; l < 12; ++l)
            for (int a = 0; a < 3; ++a)
              for (int b = 0; b < 3; ++b) {
                const double value = scalar_(i + 12 * j, k + 12 * l);
                const int ia = 3 * i + a, ja = 3 * j + a, kb = 3 * k + b, lb = 3 * l + b;
                full_(ia + kLocal * ja, kb + kLocal * lb) = value;
                crossed_(ia + kLocal * kb, ja + kLocal * lb) = value;
                first.emplace_back(ia + kLocal * ja, kb + kLocal * lb, value);
                second.emplace_back(ia + kLocal * kb, ja + kLocal * lb, value);
              }
    sparse_.resize(full_.rows(), full_.cols());
    sparse_.setFromTriplets(first.begin(), first.end());
    sparse_crossed_.resize(full_.rows(), full_.cols());
    sparse_crossed_.setFromTriplets(second.begin(), second.end());
  }

  /// F_i = 2 Σ T_ij,kl q_j q_k q_l - c_ij q_j;  K_ij = 2 T_ij,kl q_k q_l + 4 T_ik,jl q_k q_l -
  /// c_ij.
  template <class Matrix>
  void by_tensor(const Matrix& t, const Matrix* crossed, const Force& q, Force& f, Tangent* k) {
    Eigen::Map<Tangent>(square_.data()).noalias() = q * q.transpose();
    product_.noalias() = t * square_;
    Tangent matrix = 2 * Eigen::Map<const Tangent>(product_.data());
    for (int a = 0; a < 3; ++a)
      for (int i = 0; i < 12; ++i)
        for (int j = 0; j < 12; ++j) matrix(3 * i + a, 3 * j + a) -= linear_(i, j);
    f.noalias() = matrix * q;
    if (!k) return;
    product_.noalias() = *crossed * square_;
    *k = matrix + 4 * Eigen::Map<const Tangent>(product_.data());
  }
  void by_full_tensor(const Force& q, Force& f, Tangent* k) {
    by_tensor(full_, &crossed_, q, f, k);
  }
  void by_nonzeros(const Force& q, Force& f, Tangent* k) {
    by_tensor(sparse_, &sparse_crossed_, q, f, k);
  }

  void by_gauss(const Force& q, Force& f, Tangent* k) {
    const Eigen::Map<const Eigen::Matrix<double, 12, 3, Eigen::RowMajor>> rows(q.data());
    r_m_.noalias() = table_.N_m * rows;
    r_n_.noalias() = table_.N_n * rows;
    for (int p = 0; p < kPoints; ++p) {
      const Vec3 e(0.5 * (r_m_.row(p).squaredNorm() - 1), 0.5 * (r_n_.row(p).squaredNorm() - 1),
                   r_m_.row(p).dot(r_n_.row(p)));
      stress_.row(p) = table_.weight[p] * (c_ * e).transpose();
    }
    const auto s = [&](int c) { return stress_.col(c).asDiagonal(); };
    Eigen::Map<Eigen::Matrix<double, 12, 3, Eigen::RowMajor>> force(f.data());
    force.noalias() = table_.N_m.transpose() * (s(0) * r_m_ + s(2) * r_n_) +
                      table_.N_n.transpose() * (s(1) * r_n_ + s(2) * r_m_);
    if (!k) return;
    for (int i = 0; i < 12; ++i)
      for (int a = 0; a < 3; ++a) {
        const auto m = table_.N_m.col(i), n = table_.N_n.col(i);
        auto column = b_.col(3 * i + a);
        column.head<kPoints>() = m.cwiseProduct(r_m_.col(a));
        column.segment<kPoints>(kPoints) = n.cwiseProduct(r_n_.col(a));
        column.tail<kPoints>() = m.cwiseProduct(r_n_.col(a)) + n.cwiseProduct(r_m_.col(a));
        for (int c = 0; c < 3; ++c)
          db_.col(3 * i + a).segment<kPoints>(kPoints * c) = table_.weight.cwiseProduct(
              c_(c, 0) * column.head<kPoints>() + c_(c, 1) * column.segment<kPoints>(kPoints) +
              c_(c, 2) * column.tail<kPoints>());
      }
    k->noalias() = b_.transpose() * db_;
    geometric_.noalias() = table_.N_m.transpose() * (s(0) * table_.N_m + s(2) * table_.N_n) +
                           table_.N_n.transpose() * (s(1) * table_.N_n + s(2) * table_.N_m);
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < 12; ++j)
        for (int a = 0; a < 3; ++a) (*k)(3 * i + a, 3 * j + a) += geometric_(i, j);
  }

 private:
  Eigen::Matrix3d c_;
  ShapeTable table_;
  MatrixXd scalar_, linear_, full_, crossed_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> sparse_, sparse_crossed_;
  VectorXd square_ = VectorXd(kLocal * kLocal), product_ = VectorXd(kLocal * kLocal);
  Eigen::Matrix<double, kPoints, 3> r_m_, r_n_, stress_;
  MatrixXd b_ = MatrixXd::Zero(3 * kPoints, kLocal), db_ = b_;
  MatrixXd geometric_ = MatrixXd(kShapes, kShapes);
};

/// @returns true if all methods agree with the term.
bool ways() {
  Plate p(ShapeSet::h12, 3, false);
  const BodyTerm term = make_term("membrane", kSection);
  term->prepare(p.element, p.factors, true);
  std::fill(p.force.begin(), p.force.end(), Pack{});
  std::fill(p.tangent.begin(), p.tangent.end(), Pack{});
  term.add_forces(p.batch(0), p.force.data());
  term.add_tangents(p.batch(0), {1, 0, 0}, p.tangent.data());
  Spatial::Force q, expected, f;
  Spatial::Tangent tangent, k;
  for (int i = 0; i < 36; ++i) {
    q[i] = p.q[static_cast<std::size_t>(i)][0];
    expected[i] = p.force[static_cast<std::size_t>(i)][0];
    for (int j = 0; j < 36; ++j) tangent(i, j) = p.tangent[static_cast<std::size_t>(36 * j + i)][0];
  }
  Spatial spatial(p.element);
  using Way = void (Spatial::*)(const Spatial::Force&, Spatial::Force&, Spatial::Tangent*);
  bool agree = true;
  std::printf("\nin-plane force, spatial h12     force ns   with tangent ns   differences\n");
  for (const auto& [name, way] :
       {std::pair<const char*, Way>{"tensors of 36^4", &Spatial::by_full_tensor},
        {"their nonzeros", &Spatial::by_nonzeros},
        {"7 x 7 Gauss points", &Spatial::by_gauss}}) {
    (spatial.*way)(q, f, &k);
    const double df = (f - expected).norm() / expected.norm(),
                 dk = (k - tangent).norm() / tangent.norm();
    agree = agree && df < 1e-12 && dk < 1e-12;
    const double force = nanoseconds([&] { (spatial.*way)(q, f, nullptr); }),
                 both = nanoseconds([&] { (spatial.*way)(q, f, &k); });
    std::printf("%-28s %11.0f %17.0f   %.1e, %.1e\n", name, force, both, df, dk);
  }
  return agree;
}

}  // namespace

int main(int, char** argv) {
  flexmorph::benchmark::begin(argv);
  term_rows(dgemm_rate());
  if (ways()) return 0;
  std::printf("THE WAYS DISAGREE\n");
  return 1;
}
