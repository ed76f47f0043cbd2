// CPU time of the static part of one design iteration, 400 x 40 cells and 100 loads whose root
// moves from column 200 to 0, beside CHOLMOD used directly; of the moving root beside refactoring;
// and of load compression. One thread. Prints tables and asserts nothing.

#include <cholmod.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "fem/solve/static_solver.h"
#include "optim/mmc/responses.h"

extern "C" void openblas_set_num_threads(int n);  // cblas.h of other vendors has no such call

namespace {

using namespace flexmorph;

const Grid kGrid{0, -0.05, 1.0, 0.1, 400, 40};
const fem::PlaneSection kSection{0.01, 1e8, 0.3, 2700};
constexpr int kLoads = 100;

/// Process CPU milliseconds of a call: median.
double milliseconds(const std::function<void()>& call, int repeats = 9) {
  std::vector<double> times;
  for (int k = 0; k <= repeats; ++k) {
    timespec start{}, end{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &start);
    call();
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
    const double ms = 1e3 * static_cast<double>(end.tv_sec - start.tv_sec) +
                      1e-6 * static_cast<double>(end.tv_nsec - start.tv_nsec);
    if (k > 0) times.push_back(ms);  // the first call touches its memory for the first time
  }
  std::nth_element(times.begin(), times.begin() + repeats / 2, times.end());
  return times[static_cast<std::size_t>(repeats / 2)];
}

/// Half of the cells solid, in patches of 4 x 4.
VectorXd random_design(unsigned seed, double empty) {
  std::mt19937 engine(seed);
  std::bernoulli_distribution solid(0.5);
  VectorXd factor(kGrid.n_cells());
  for (int i = 0; i < kGrid.nx; i += 4) {
    for (int j = 0; j < kGrid.ny; j += 4) {
      const double f = solid(engine) ? 1.0 : empty;
      for (int k = 0; k < 16; ++k) factor(kGrid.cell(i + k / 4, j + k % 4)) = f;
    }
  }
  return factor;
}

/// CHOLMOD used as its manual says, on the plate clamped at one column.
class Reference {
 public:
  Reference(const VectorXd& factor, int root, int ordering) : root_(root) {
    cholmod_start(&common_);
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.nmethods = 1;
    common_.method[0].ordering = ordering;
    common_.postorder = ordering != CHOLMOD_NATURAL;
    n_ = 2 * (kGrid.nx - root) * (kGrid.ny + 1);
    const auto K = fem::q4_stiffness(kSection, kGrid.dx(), kGrid.dy());
    const auto n = static_cast<std::size_t>(n_);
    cholmod_triplet* t = cholmod_allocate_triplet(n, n, 20 * n, -1, CHOLMOD_REAL, &common_);
    for (int i = root; i < kGrid.nx; ++i) {
      for (int j = 0; j < kGrid.ny; ++j) {
        const std::array<int, 8> d = dofs(i, j);
        for (std::size_t a = 0; a < 8; ++a) {
          for (std::size_t b = 0; b <= a; ++b) {
            if (d[a] < 0 || d[b] < 0) continue;
            static_cast<int*>(t->i)[t->nnz] = std::max(d[a], d[b]);
            static_cast<int*>(t->j)[t->nnz] = std::min(d[a], d[b]);
            static_cast<double*>(t->x)[t->nnz++] =
                factor(kGrid.cell(i, j)) * K(static_cast<int>(a), static_cast<int>(b));
          }
        }
      }
    }
    K_ = cholmod_triplet_to_sparse(t, t->nnz, &common_);
    cholmod_free_triplet(&t, &common_);
    L_ = cholmod_analyze(K_, &common_);
  }
  ~Reference() {
    cholmod_free_factor(&L_, &common_);
    cholmod_free_sparse(&K_, &common_);
    for (cholmod_dense** x : {&F_, &X_, &Y_, &E_}) cholmod_free_dense(x, &common_);
    cholmod_finish(&common_);
  }
  Reference(const Reference&) = delete;
  Reference& operator=(const Reference&) = delete;

  void factorize() { cholmod_factorize(K_, L_, &common_); }

  void set_loads(int n_loads) {
    F_ = cholmod_zeros(static_cast<std::size_t>(n_), static_cast<std::size_t>(n_loads),
                       CHOLMOD_REAL, &common_);
    for (int k = 0; k < n_ * n_loads; ++k) static_cast<double*>(F_->x)[k] = std::sin(1.7 * k);
  }
  void solve() { cholmod_solve2(CHOLMOD_A, L_, F_, nullptr, &X_, nullptr, &Y_, &E_, &common_); }

  /// Energies of all cells, load by load, with the 8 x 8 product.
  void energies(VectorXd& out) const {
    const auto K = fem::q4_stiffness(kSection, kGrid.dx(), kGrid.dy());
    out.setZero(kGrid.n_cells());
    for (int l = 0; l < kLoads; ++l) {
      const double* x = static_cast<const double*>(X_->x) + static_cast<std::ptrdiff_t>(l) * n_;
      for (int i = root_; i < kGrid.nx; ++i) {
        for (int j = 0; j < kGrid.ny; ++j) {
          Eigen::Matrix<double, 8, 1> u;
          const std::array<int, 8> d = dofs(i, j);
          for (std::size_t a = 0; a < 8; ++a) u(static_cast<int>(a)) = d[a] < 0 ? 0 : x[d[a]];
          out(kGrid.cell(i, j)) += u.dot(K * u) / kLoads;
        }
      }
    }
  }

 private:
  std::array<int, 8> dofs(int i, int j) const {
    std::array<int, 8> d{};
    for (std::size_t a = 0; a < 4; ++a) {
      const int ni = i + fem::kCornerI[a], nj = j + fem::kCornerJ[a];
      const int row = ni <= root_ ? -1 : 2 * ((kGrid.nx - ni) * (kGrid.ny + 1) + nj);
      d[2 * a] = row;
      d[2 * a + 1] = row < 0 ? -1 : row + 1;
    }
    return d;
  }

  int root_ = 0, n_ = 0;
  cholmod_common common_;
  cholmod_sparse* K_ = nullptr;
  cholmod_factor* L_ = nullptr;
  cholmod_dense *F_ = nullptr, *X_ = nullptr, *Y_ = nullptr, *E_ = nullptr;
};

/// A turning, growing plate with `n_modes` vibrations in each direction; the root passes through
/// `n_columns` columns from 200 to 0.
fem::EslSets synthetic_loads(int n_modes, int n_columns) {
  const double omega = 2 * std::numbers::pi, v = 0.5;
  fem::EslSets loads{kGrid, {}};
  for (int k = 0; k < kLoads; ++k) {
    const double t = k / (kLoads - 1.0);
    fem::EslSet set;
    set.weight = 1.0 / kLoads;
    const int step = std::min(k * n_columns / kLoads, n_columns - 1);
    set.root_column = 200 - (n_columns > 1 ? 2 * (step * 99 / (n_columns - 1)) : 200);
    const double root = kGrid.x0 + set.root_column * kGrid.dx();
    set.acceleration.resize(2 * kGrid.n_nodes());
    for (int i = 0; i <= kGrid.nx; ++i) {
      for (int j = 0; j <= kGrid.ny; ++j) {
        const Vec2 X = kGrid.node_position(i, j);
        Vec2 a{-omega * omega * (X.x() - root), 2 * omega * v - omega * omega * X.y()};
        for (int m = 1; m <= n_modes; ++m) {
          a.x() += 4.0 / m * std::cos(70 * m * t) * std::sin(1.5 * m * X.x()) * (1 + X.y());
          a.y() += 20.0 / m * std::cos(19 * m * t + m) * std::sin(1.5 * m * X.x());
        }
        set.acceleration.segment<2>(2 * kGrid.node(i, j)) = a;
      }
    }
    const int tip = kGrid.node(kGrid.nx, kGrid.ny / 2);
    set.forces.push_back({tip, -0.5 * set.acceleration.segment<2>(2 * tip)});
    loads.sets.push_back(std::move(set));
  }
  return loads;
}

struct Times {
  double total, factor, solve, sensitivity;
  int right_hand_sides;
};

Times iteration(const fem::EslSets& loads, const mmc::ComplianceSettings& settings) {
  const std::array<VectorXd, 2> k = {random_design(1, 1e-3), random_design(2, 1e-3)};
  const std::array<VectorXd, 2> m = {random_design(1, 0), random_design(2, 0)};
  mmc::Compliance compliance(loads, kSection, settings, k[0], m[0]);
  mmc::Compliance::Value value;
  std::size_t turn = 0;
  Times t{};
  t.total = milliseconds([&] {
    turn = 1 - turn;  // another design each time: the same one would not be factored again
    compliance.evaluate(k[turn], m[turn], value);
  });
  const auto s = compliance.seconds();
  t.factor = 1e3 * s.factor;
  t.solve = 1e3 * s.solve;
  t.sensitivity = 1e3 * s.sensitivity;
  t.right_hand_sides = compliance.n_right_hand_sides();
  return t;
}

void print(const char* name, const Times& t, double reference) {
  std::printf("%-44s %4d  %7.1f %7.1f %7.1f %7.1f   %.2f\n", name, t.right_hand_sides, t.factor,
              t.solve, t.sensitivity, t.total, t.total / reference);
}

double reference_iteration(int ordering, const char* name) {
  Reference reference(random_design(1, 1e-3), 0, ordering);
  reference.set_loads(kLoads);
  VectorXd energies;
  const double factor = milliseconds([&] { reference.factorize(); });
  const double solve = milliseconds([&] { reference.solve(); });
  const double energy = milliseconds([&] { reference.energies(energies); });
  print(name, {factor + solve + energy, factor, solve, energy, kLoads}, factor + solve + energy);
  return factor + solve + energy;
}

void iterations() {
  std::printf("one iteration, ms CPU%28s  factor   solve   sens.   total   ratio\n", "rhs");
  const double natural = reference_iteration(CHOLMOD_NATURAL, "CHOLMOD, natural order (reference)");
  reference_iteration(CHOLMOD_AMD, "CHOLMOD, AMD");
  using mmc::LoadDefinition, mmc::Support;
  for (int modes : {2, 6, 12}) {
    std::printf("%d + %d vibrations\n", modes, modes);
    const fem::EslSets loads = synthetic_loads(modes, 100);
    print("  inertia, moving root", iteration(loads, {}), natural);
    print("  inertia, moving root, not compressed",
          iteration(loads, {LoadDefinition::inertia, Support::moving_root, false, 0}), natural);
  }
  for (int columns : {1, 4, 100}) {
    std::printf("frozen, far end, 2 + 2 vibrations, %d root columns\n", columns);
    const fem::EslSets loads = synthetic_loads(2, columns);
    print("  compressed", iteration(loads, {LoadDefinition::frozen, Support::far_end, true, 1e-10}),
          natural);
    print("  not compressed",
          iteration(loads, {LoadDefinition::frozen, Support::far_end, false, 0}), natural);
  }
}

void moving_root() {
  std::printf("\nmoving root, one load a time, ms CPU\n");
  std::printf("times   one factorization   refactoring (AMD)   ratio\n");
  const VectorXd design = random_design(1, 1e-3);
  fem::StaticSolver solver(kGrid, kSection);
  for (int k : {1, 2, 4, 8, 20, 100}) {
    std::vector<int> roots;
    for (int t = 0; t < k; ++t) roots.push_back(k > 1 ? 200 - 2 * (t * 100 / (k - 1)) : 0);
    MatrixXd u = MatrixXd::Random(k, solver.n_unknowns());
    const double ours = milliseconds([&] {
      solver.factorize(design);
      solver.solve(u, roots);
    });
    double refactoring = 0;
    for (int root : roots) {
      Reference reference(design, root, CHOLMOD_AMD);
      reference.set_loads(1);
      refactoring += milliseconds(
          [&] {
            reference.factorize();
            reference.solve();
          },
          k > 20 ? 1 : 5);
    }
    std::printf("%5d   %17.1f   %17.1f   %.2f\n", k, ours, refactoring, ours / refactoring);
  }
}

}  // namespace

int main() {
  openblas_set_num_threads(1);
  iterations();
  moving_root();
}
