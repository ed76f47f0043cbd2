#pragma once

#include <Eigen/SparseCore>
#include <span>
#include <vector>

#include "geometry/components/component.h"
#include "geometry/grid.h"

namespace flexmorph {

class ComponentFrame;

/// Settings of the topology description function (TDF) φ and of its Heaviside on the nodes of a
/// grid.
struct TdfSettings {
  /// Definition of φ of one component, and of the union of components.
  enum class Kind {
    /// φ = (1 - s)/|∇s|, s = ((x/L)^p + (y/g)^p)^(1/p), bounded by g(x) inside. This is the
    /// distance to first order all around the outline, including the tips. Components are united by
    /// a smooth maximum (default). (1 - s) g would be a distance across the flanks only: its band
    /// would extend by ε L/g beyond a tip, and rows of components would bridge gaps through the
    /// band.
    distance,
    paper  ///< φ = χ = 1 - (x/L)^p - (y/g)^p of P (24); components are united by the plain maximum.
  };
  Kind kind = Kind::distance;  ///< Kind of TDF.
  double band = 0.00375;       ///< Half-width ε of the band of the Heaviside [m] ([-] for paper).
  double sharpness = 1500;     ///< Sharpness λ of the Kreisselmeier-Steinhauser function [1/m].

  /// Depth δ of the erosion in UnionTdf::eroded() [m] ([-] for paper).
  double erosion = 0;
  double alpha = 1e-3;               ///< Value α of the Heaviside in the void [-].
  double min_half_thickness = 1e-4;  ///< Lower bound of every half-thickness [m].
};

/// The Heaviside H_ε(φ) and its derivatives by φ (optim/README.md, TDF). H is 1 above ε and α below
/// -ε. Between them, with t = φ/ε,
///
///   distance: H = (1 - α)/16 (15 t - 10 t³ + 3 t⁵) + (1 + α)/2, twice continuously differentiable
///   paper:    H = 3 (1 - α)/4 (t - t³/3) + (1 + α)/2, once continuously differentiable
struct Heaviside {
  double value, slope, curvature;  ///< Value, first and second derivative by φ.
};
/// Returns the Heaviside and its derivatives at φ.
Heaviside heaviside(double phi, const TdfSettings& settings);

/// Returns φ of one component at a point (X, Y) [m] ([-] for paper), and its derivatives by the
/// seven parameters.
///
/// φ is smooth except at two locations. At the component's center s is not differentiable, as a
/// distance; the derivatives are the mean of both sides there. On the lines x = ±L a profile with
/// g' ≠ 0 at its end is cut off; the derivatives are those of the outer side there.
/// @param d_parameters  derivatives by the parameters (7), or nullptr
double component_tdf(const Component& c, const TdfSettings& s, double X, double Y,
                     double* d_parameters /* 7, or nullptr */);

/// The TDF of a union of components on the nodes of a grid, its Heaviside, and the chain rule from
/// nodal derivatives back to the parameters. Only nodes in the range of a component (φ_i > φ_cut)
/// are visited. Only one thread at a time may use an object, because pull_back() uses internal
/// buffers.
///
/// distance: φ is the smooth maximum of Kreisselmeier and Steinhauser over the components in whose
/// range a node lies. It is twice continuously differentiable where a component enters the range,
///
///   φ = 1/λ log Σ_i S(z_i) exp(λ φ_i),   z_i = λ (φ_i - φ_cut),   φ >= φ_cut = -ε - 10/λ
///
/// S = s³ (10 - 15 s + 6 s²), s = z/2, grows from 0 to 1 for z from 0 to 2. Therefore components
/// that are about to leave the range lose their weight, which is below exp(-8) of the weights in
/// the band.
///
/// paper: φ = max φ_i, φ_cut = -ε - 1; the derivative is that of the first component with the
/// maximum. Nodes outside the range of all components have φ = φ_cut and H = α.
class UnionTdf {
 public:
  /// Creates the TDF on the nodes of a grid.
  /// @throws Error (input) when a setting is out of its range.
  UnionTdf(const Grid& grid, TdfSettings settings);

  /// Returns the settings of the TDF.
  const TdfSettings& settings() const { return settings_; }

  /// Computes phi(), density() and eroded() of components. After the first calls of similar size it
  /// allocates no memory.
  /// @throws Error (numerical) when a parameter is not finite or a length is not positive.
  void evaluate(std::span<const Component> components);

  /// Returns for every component the largest decrease of density() and eroded() at the counted
  /// nodes if the component were removed from the union (N). It is 0 for a component outside the
  /// grid or deep inside others. For `paper` a node at which the component is the highest counts as
  /// void without it.
  /// @param counts  1 for the nodes that are counted, 0 for all others (n_nodes)
  std::vector<double> influence(std::span<const signed char> counts) const;

  /// Returns φ of the union (n_nodes) [m]; it is at least φ_cut.
  const VectorXd& phi() const { return phi_; }
  /// Returns the density H(φ) (n_nodes), between α and 1.
  const VectorXd& density() const { return h_; }
  /// Returns H(φ - δ) (n_nodes), the density of the design that is eroded by δ on all sides.
  const VectorXd& eroded() const { return eroded_; }

  /// Computes the derivatives of a function f by the parameters (7 N) of the components of the last
  /// evaluate() from df/d(density) and df/d(eroded) (n_nodes).
  /// @throws Error (numerical) when the result is not finite.
  void pull_back(const VectorXd& df_dh, const VectorXd& df_deroded, VectorXd& df_dp) const;
  /// Computes the derivatives of many functions by the parameters (n_functions x 7 N) from their
  /// derivatives by density() and eroded() (n_functions x n_nodes each). An empty df_dh stands for
  /// zeros.
  /// @throws Error (numerical) when the result is not finite.
  void pull_back(const MatrixXd& df_dh, const MatrixXd& df_deroded, MatrixXd& df_dp) const;
  /// Computes the derivatives by the parameters (7 N) of a function of density() only.
  void pull_back(const VectorXd& df_dh, VectorXd& df_dp) const { pull_back(df_dh, zero_, df_dp); }

  /// Derivatives of a function f by the nodal values of density() and eroded().
  struct NodeGradients {
    /// First derivatives by density() and eroded(), second derivative by eroded() (n_nodes each).
    VectorXd df_dh, df_deroded, d2f_deroded2;
  };
  /// Returns the second derivatives of a function f of the nodal values by the parameters of the
  /// components of the last evaluate() (7 N x 7 N),
  ///
  ///   Σ_n f_E E' φ_pp + (f_E E'' + f_EE E'²) φ_p φ_pᵀ + f_H H' φ_pp + f_H H'' φ_p φ_pᵀ,
  ///   φ_pp = Σ_i (J'_i φ_i,pp + λ J''_i φ_i,p φ_i,pᵀ) / Σ J - λ φ_p φ_pᵀ
  ///
  /// where J = S exp(λ φ_i) and ' is the derivative by z. The function is for `distance` only,
  /// because a plain maximum has no second derivatives.
  /// @param slopes  φ_p at the nodes where H or E changes (n_nodes x 7 N), see slopes()
  /// @throws Error (numerical) when the result is not finite.
  MatrixXd curvature(const NodeGradients& f, const Eigen::SparseMatrix<double>& slopes) const;
  /// Returns the derivatives φ_p of φ by the parameters (n_nodes x 7 N) at the nodes where
  /// density() or eroded() changes with φ; all other rows are empty. The function is for `distance`
  /// only.
  Eigen::SparseMatrix<double> slopes() const;
  /// Returns the derivative d(eroded)/dφ (n_nodes).
  VectorXd eroded_gradient() const;

 private:
  /// Neighbouring nodes of one grid column in the range of one component.
  struct Run {
    int column, row, count;
  };
  /// Local coordinates and derivatives at the nodes of one component.
  struct Scratch {
    std::vector<double> x, y, seed;
    std::vector<int> node;
    MatrixXd node_seeds, seeds, chain;  // matrices for many functions
    void reserve_memory(std::size_t n);
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
  std::vector<Run> runs_;          // sorted by component
  std::vector<std::size_t> ends_;  // end of the runs of each component in runs_
  std::vector<double> visits_;     // run by run: φ_i, then the weight dφ/dφ_i times sum_
  std::vector<double> terms_;      // run by run: the term of the component in sum_
  mutable Scratch scratch_;
  VectorXd phi_, h_, eroded_, highest_, sum_, zero_;
  VectorXd chain_, chain_eroded_;  // dH/dφ / sum_
};

}  // namespace flexmorph
