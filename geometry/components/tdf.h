#pragma once

#include <Eigen/SparseCore>
#include <span>
#include <vector>

#include "geometry/components/component.h"
#include "geometry/grid.h"

namespace flexmorph {

class ComponentFrame;

/// How components become a topology description function on the nodes of a grid.
struct TdfSettings {
  enum class Kind {
    /// φ = (1 - s)/|∇s|, s = ((x/L)^p + (y/g)^p)^(1/p), inside bounded by g(x): a distance to first
    /// order all around the outline, tips included; smooth maximum (default). With (1 - s) g, a
    /// distance across the flanks only, the band reaches ε L/g beyond a tip, and rows of
    /// components bridge gaps through it.
    distance,
    paper  ///< φ = χ = 1 - (x/L)^p - (y/g)^p of P (24), plain maximum
  };
  Kind kind = Kind::distance;
  double band = 0.00375;    ///< ε of the Heaviside: half-width of the band [m] ([-] for paper)
  double sharpness = 1500;  ///< Kreisselmeier-Steinhauser sharpness λ [1/m]
  /// Depth δ of the erosion behind UnionTdf::eroded() [m] ([-] for paper).
  double erosion = 0;
  double alpha = 1e-3;               ///< value of the Heaviside in the void
  double min_half_thickness = 1e-4;  ///< lower bound of every profile [m]
};

/// H_ε(φ) and its derivatives by φ, optim/README.md, TDF: 1 above ε, α below -ε. Between, with
/// t = φ/ε,
///
///   distance: H = (1 - α)/16 (15 t - 10 t³ + 3 t⁵) + (1 + α)/2, twice continuously differentiable
///   paper:    H = 3 (1 - α)/4 (t - t³/3) + (1 + α)/2, once
struct Heaviside {
  double value, slope, curvature;
};
Heaviside heaviside(double phi, const TdfSettings& settings);

/// TDF of one component at one point, with its derivatives by the seven parameters.
///
/// φ is smooth except at the component's center, where s has the kink of a distance (the
/// derivatives are the mean of both sides there), and on the lines x = ±L, where a profile with
/// g' ≠ 0 at its end is cut off (the derivatives are those of the outer side there).
double component_tdf(const Component& c, const TdfSettings& s, double X, double Y,
                     double* d_parameters /* 7, or nullptr */);

/// TDF of a union of components on the nodes of a grid, its Heaviside, and the chain rule back
/// to the parameters. Only nodes within a component's reach (φ_i > φ_cut) are visited. One object
/// serves one thread at a time: pull_back() uses buffers of its own.
///
/// distance: smooth maximum of Kreisselmeier and Steinhauser over the components that reach a
/// node, twice continuously differentiable where one comes into reach,
///
///   φ = 1/λ log Σ_i S(z_i) exp(λ φ_i),   z_i = λ (φ_i - φ_cut),   φ >= φ_cut = -ε - 10/λ
///
/// S = s³ (10 - 15 s + 6 s²), s = z/2, from 0 to 1 where z is: components that are about to leave
/// the reach lose their weight, which is below exp(-8) of what is in the band.
///
/// paper: φ = max φ_i, φ_cut = -ε - 1; the derivative is that of the first highest component.
/// Nodes no component reaches have φ = φ_cut and H = α.
class UnionTdf {
 public:
  /// @throws Error(input) when a setting is out of its range.
  UnionTdf(const Grid& grid, TdfSettings settings);

  const TdfSettings& settings() const { return settings_; }

  /// Fills phi() and density(); no allocation after the first calls of similar size.
  /// @throws Error(numerical) when a parameter is not finite or a length not positive.
  void evaluate(std::span<const Component> components);

  /// Largest change of density() and eroded() at any node that counts, were a component taken out
  /// of the union (N): 0 for one outside of the grid or deep under others.
  /// @param counts  nodes that matter: not 0 (n_nodes)
  std::vector<double> influence(std::span<const signed char> counts) const;

  const VectorXd& phi() const { return phi_; }    ///< (n_nodes) [m], at least φ_cut
  const VectorXd& density() const { return h_; }  ///< H(φ) (n_nodes), α..1
  /// H(φ - δ) (n_nodes): the design with δ taken off all around.
  const VectorXd& eroded() const { return eroded_; }

  /// df/d(density), df/d(eroded) (n_nodes) -> df/dparameters (7 N), at the components of the last
  /// evaluate(). @throws Error(numerical) when the result is not finite.
  void pull_back(const VectorXd& df_dh, const VectorXd& df_deroded, VectorXd& df_dp) const;
  /// The same for many functions at once: (n_functions x n_nodes) each -> (n_functions x 7 N).
  /// An empty df_dh stands for zeros.
  void pull_back(const MatrixXd& df_dh, const MatrixXd& df_deroded, MatrixXd& df_dp) const;
  /// The same for a function of density() only.
  void pull_back(const VectorXd& df_dh, VectorXd& df_dp) const { pull_back(df_dh, zero_, df_dp); }

  /// Second derivatives of a function f of the nodes by the parameters of components (7 N x 7 N),
  ///
  ///   Σ_n f_E E' φ_pp + (f_E E'' + f_EE E'²) φ_p φ_pᵀ, and the same of H,
  ///   φ_pp = Σ_i (J'_i φ_i,pp + λ J''_i φ_i,p φ_i,pᵀ) / Σ J - λ φ_p φ_pᵀ
  ///
  /// J = S exp(λ φ_i), ' by z, at the components of the last evaluate(). For `distance` only: a
  /// plain maximum has none.
  struct NodeSlopes {
    VectorXd df_dh, df_deroded, d2f_deroded2;  ///< (n_nodes) each
  };
  /// @param slopes  φ_p at the nodes where H or its eroded form change (n_nodes x 7 N), see
  /// slopes()
  /// @throws Error(numerical) when the result is not finite.
  MatrixXd curvature(const NodeSlopes& f, const Eigen::SparseMatrix<double>& slopes) const;
  Eigen::SparseMatrix<double> slopes() const;
  /// d(eroded)/dφ (n_nodes).
  VectorXd eroded_slopes() const;

 private:
  struct Run {  // neighbouring nodes of one grid column within the reach of one component
    int column, row, count;
  };
  struct Scratch {  // local coordinates and seeds of one component's nodes
    std::vector<double> x, y, seed;
    std::vector<int> node;
    MatrixXd node_seeds, seeds, chain;  // of many functions
    void make_room(std::size_t n);
  };
  void find_reach(std::span<const Component> components);
  void add_runs(const ComponentFrame& frame);
  void join_smoothly();
  void join_by_maximum();
  void fill_density();
  int add_points(const ComponentFrame& frame, const Run& run, const double* visit, int count) const;
  double taken_out(const Run& run, int k, std::size_t visit) const;
  int add_seeds(const ComponentFrame& frame, const Run& run, const double* visit,
                const VectorXd& df_dh, const VectorXd& df_deroded, int count) const;

  Grid grid_;
  TdfSettings settings_;
  bool evaluated_ = false;
  double cut_ = 0;
  std::vector<Component> components_;
  std::vector<Run> runs_;          // component by component
  std::vector<std::size_t> ends_;  // where the runs of each component end
  std::vector<double> visits_;     // run by run: φ_i, then the weight dφ/dφ_i times sum_
  std::vector<double> terms_;      // likewise: what they have in sum_
  mutable Scratch scratch_;
  VectorXd phi_, h_, eroded_, highest_, sum_, zero_;
  VectorXd chain_, chain_eroded_;  // dH/dφ / sum_
};

}  // namespace flexmorph
