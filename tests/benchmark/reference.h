#pragma once

#include <functional>
#include <memory>

#include "fem/solve/static_solver.h"
#include "geometry/grid.h"

/// The reference (CHOLMOD) and the clock for benchmarks of design iterations.
namespace flexmorph::benchmark {

/// The design mesh of rotating_plate_v05.
inline const Grid kGrid{0, -0.05, 1.0, 0.1, 400, 40};
inline const fem::PlaneSection kSection{0.01, 1e8, 0.3, 2700};
inline constexpr int kLoads = 100;

/// Returns the median CPU time of a call of this process [ms].
double milliseconds(const std::function<void()>& call, int repeats = 9);

/// Ordering method of CHOLMOD: one method, or the best of those that it tries by default (AMD and
/// METIS).
enum class Ordering { natural, amd, metis, best };

/// CHOLMOD used according to its manual, on a plate clamped at one column of nodes.
class Reference {
 public:
  /// @param factor  scale factors of the stiffness (n_cells)
  Reference(const VectorXd& factor, int root, Ordering ordering, const Grid& grid = kGrid,
            const fem::PlaneSection& section = kSection);
  ~Reference();

  void factorize();
  void set_loads(int n_loads);
  void solve();
  /// Computes the energies of all cells, load by load, with the 8 x 8 product.
  void energies(VectorXd& out) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// CPU time of one factorization, one block solve of all right-hand sides and one pass for the
/// energies of all cells and loads [ms].
struct ReferenceTimes {
  double factor = 0, solve = 0, energies = 0;
  double total() const { return factor + solve + energies; }
};
ReferenceTimes reference_times(const VectorXd& factor, Ordering ordering, int n_loads = kLoads,
                               const Grid& grid = kGrid,
                               const fem::PlaneSection& section = kSection);

}  // namespace flexmorph::benchmark
