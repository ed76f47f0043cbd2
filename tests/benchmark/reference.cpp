#include "tests/benchmark/reference.h"

#include <cholmod.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "geometry/cpu_time.h"

namespace flexmorph::benchmark {

double milliseconds(const std::function<void()>& call, int repeats) {
  std::vector<double> times;
  for (int k = 0; k <= repeats; ++k) {
    const double start = cpu_seconds();
    call();
    if (k > 0)
      times.push_back(
          1e3 * (cpu_seconds() - start));  // the first call touches its memory for the first time
  }
  std::nth_element(times.begin(), times.begin() + repeats / 2, times.end());
  return times[static_cast<std::size_t>(repeats / 2)];
}

struct Reference::Impl {
  Grid grid;
  fem::PlaneSection section{0.01, 1e8, 0.3, 2700};
  int root = 0, n = 0;
  cholmod_common common;
  cholmod_sparse* K = nullptr;
  cholmod_factor* L = nullptr;
  cholmod_dense *F = nullptr, *X = nullptr, *Y = nullptr, *E = nullptr;

  ~Impl() {
    cholmod_free_factor(&L, &common);
    cholmod_free_sparse(&K, &common);
    for (cholmod_dense** x : {&F, &X, &Y, &E}) cholmod_free_dense(x, &common);
    cholmod_finish(&common);
  }

  std::array<int, 8> dofs(int i, int j) const {
    std::array<int, 8> d{};
    for (std::size_t a = 0; a < 4; ++a) {
      const int ni = i + fem::kCornerI[a], nj = j + fem::kCornerJ[a];
      const int row = ni <= root ? -1 : 2 * ((grid.nx - ni) * (grid.ny + 1) + nj);
      d[2 * a] = row;
      d[2 * a + 1] = row < 0 ? -1 : row + 1;
    }
    return d;
  }

  void assemble(const VectorXd& factor) {
    const auto K_cell = fem::q4_stiffness(section, grid.dx(), grid.dy());
    const auto size = static_cast<std::size_t>(n);
    cholmod_triplet* t = cholmod_allocate_triplet(size, size, 20 * size, -1, CHOLMOD_REAL, &common);
    for (int i = root; i < grid.nx; ++i) {
      for (int j = 0; j < grid.ny; ++j) {
        const std::array<int, 8> d = dofs(i, j);
        for (std::size_t a = 0; a < 8; ++a) {
          for (std::size_t b = 0; b <= a; ++b) {
            if (d[a] < 0 || d[b] < 0) continue;
            static_cast<int*>(t->i)[t->nnz] = std::max(d[a], d[b]);
            static_cast<int*>(t->j)[t->nnz] = std::min(d[a], d[b]);
            static_cast<double*>(t->x)[t->nnz++] =
                factor(grid.cell(i, j)) * K_cell(static_cast<int>(a), static_cast<int>(b));
          }
        }
      }
    }
    K = cholmod_triplet_to_sparse(t, t->nnz, &common);
    cholmod_free_triplet(&t, &common);
  }
};

Reference::Reference(const VectorXd& factor, int root, Ordering ordering, const Grid& grid,
                     const fem::PlaneSection& section)
    : impl_(std::make_unique<Impl>()) {
  Impl& m = *impl_;
  m.grid = grid;
  m.section = section;
  cholmod_start(&m.common);
  m.common.supernodal = CHOLMOD_SUPERNODAL;
  if (ordering != Ordering::best) {
    m.common.nmethods = 1;
    m.common.method[0].ordering = ordering == Ordering::natural ? CHOLMOD_NATURAL
                                  : ordering == Ordering::amd   ? CHOLMOD_AMD
                                                                : CHOLMOD_METIS;
    m.common.postorder = ordering != Ordering::natural;
  }
  m.root = root;
  m.n = 2 * (grid.nx - root) * (grid.ny + 1);
  m.assemble(factor);
  m.L = cholmod_analyze(m.K, &m.common);
}

Reference::~Reference() = default;

void Reference::factorize() { cholmod_factorize(impl_->K, impl_->L, &impl_->common); }

void Reference::set_loads(int n_loads) {
  Impl& m = *impl_;
  m.F = cholmod_zeros(static_cast<std::size_t>(m.n), static_cast<std::size_t>(n_loads),
                      CHOLMOD_REAL, &m.common);
  for (int k = 0; k < m.n * n_loads; ++k) static_cast<double*>(m.F->x)[k] = std::sin(1.7 * k);
}

void Reference::solve() {
  Impl& m = *impl_;
  cholmod_solve2(CHOLMOD_A, m.L, m.F, nullptr, &m.X, nullptr, &m.Y, &m.E, &m.common);
}

void Reference::energies(VectorXd& out) const {
  const Impl& m = *impl_;
  const Grid& grid = m.grid;
  const auto K_cell = fem::q4_stiffness(m.section, grid.dx(), grid.dy());
  out.setZero(grid.n_cells());
  for (std::size_t l = 0; l < m.X->ncol; ++l) {
    const double* x = static_cast<const double*>(m.X->x) + l * static_cast<std::size_t>(m.n);
    for (int i = m.root; i < grid.nx; ++i) {
      for (int j = 0; j < grid.ny; ++j) {
        Eigen::Matrix<double, 8, 1> u;
        const std::array<int, 8> d = m.dofs(i, j);
        for (std::size_t a = 0; a < 8; ++a) u(static_cast<int>(a)) = d[a] < 0 ? 0 : x[d[a]];
        out(grid.cell(i, j)) += u.dot(K_cell * u) / static_cast<double>(m.X->ncol);
      }
    }
  }
}

ReferenceTimes reference_times(const VectorXd& factor, Ordering ordering, int n_loads,
                               const Grid& grid, const fem::PlaneSection& section) {
  Reference reference(factor, 0, ordering, grid, section);
  reference.set_loads(n_loads);
  VectorXd energies;
  ReferenceTimes t;
  t.factor = milliseconds([&] { reference.factorize(); });
  t.solve = milliseconds([&] { reference.solve(); });
  t.energies = milliseconds([&] { reference.energies(energies); });
  return t;
}

}  // namespace flexmorph::benchmark
