#pragma once

#include <array>
#include <vector>

#include "fem/line_grid.h"
#include "fem/model/model.h"

namespace flexmorph::fem {

/// Kind of a change of the mesh: a line of nodes next to the root is inserted or removed.
enum class MeshChange {
  insertion,  ///< A line is inserted.
  removal     ///< The line is removed.
};

/// Returns the material coordinate of a line to be inserted [m]: the length `cell` before the first
/// line behind the root, or the middle of the element at the root if `cell` is 0.
double inserted_line(const LineGrid& lines, double cell);

/// Linear map of the vectors of the model across a change of the mesh of one body, from the n
/// unknowns before to the n' unknowns after the change:
///
///   q' = A q,   q̇' = A q̇ + B q,   q̈' = A q̈ + 2 B q̇ + C q,   λ' = λ
///
/// Unknowns of remaining lines keep their values; unknowns of a removed line are dropped. Unknowns
/// of an inserted line are the values of the field at its material points. There A contains the
/// values and the derivatives by m, n, mn of the shape functions; for cubics in the middle of an
/// element of length l along m
///
///   f = (f₁ + f₂)/2 + l (f₁' - f₂')/8,   f' = 3 (f₂ - f₁)/(2 l) - (f₁' + f₂')/4.
///
/// B and C contain their first and second rates at a fixed material point, which are zero unless
/// the lines of the element move. With h16 the field does not change at all.
///
/// The map does not contain the operations that follow a change in a motion: the balance of the
/// forces (balance_forces()), and the projection of velocities onto the constraints
/// (Integrator::project_velocity()).
///
/// Source: P Fig. 3, 4; fem/README.md, Insertion and removal.
class MeshMap {
 public:
  /// Vectors of a state, or derivatives with respect to the vectors of a state.
  struct Vectors {
    VectorXd q, v, a;  ///< Positions, velocities and accelerations (n or n' each).
  };

  MeshMap() = default;
  /// Computes the map of a change next to the root of a body, with its lines at their present
  /// positions.
  /// @param n_dofs  Number of unknowns of the model before the change.
  /// @param cell    See inserted_line().
  /// @throws Error (input) if the elements of the body are no LineGrid.
  MeshMap(const Body& body, MeshChange change, int n_dofs, double cell = 0);

  /// Returns the number n of unknowns before the change.
  int n_before() const { return n_before_; }
  /// Returns the number n' of unknowns after the change.
  int n_after() const { return n_before_ + added_ - removed_; }

  /// Maps the vectors of a state before the change (n each) to those after it (n' each).
  Vectors apply(const Vectors& before) const;
  /// Applies the transposed map, (n' each) -> (n each): y · apply(x) = apply_transposed(y) · x,
  /// where the product is summed over the three vectors.
  Vectors apply_transposed(const Vectors& after) const;
  /// Returns the acceleration after the change, A a + 2 B v + C q (n').
  VectorXd acceleration(const VectorXd& q, const VectorXd& v, const VectorXd& a) const;
  /// Maps q, v and a of a state in place.
  void carry(State& x) const;

 private:
  /// Data with which a new node takes values, derivatives and rates from the element that contains
  /// it.
  struct Node {
    std::vector<int> dofs;  // first entry of each vector unknown of the element
    // Value and derivative at the node from the values at four points along m (along) or n
    // (across).
    Eigen::Matrix<double, 2, 4> along, across;
    // Shape functions and their rates at the 4 x 4 points: N, Ṅ, N̈ (1 x n_shapes, or empty).
    std::array<std::array<MatrixXd, 3>, 16> tables;
  };

  Node make_node(const Body& body, const LineGrid& plate, int e, double s, double u) const;
  MatrixXd rows_of(const Node& node, const VectorXd& all) const;
  /// Returns value and derivatives by m, n, mn (4 x dim) of N (rates 0), Ṅ (1) or N̈ (2) times rows.
  static MatrixXd sample(const Node& node, const MatrixXd& rows, size_t rates);
  /// Adds `factor` times the transposed sample() of `fresh` to the unknowns of the element in
  /// `out`.
  void add_transposed(const Node& node, const MatrixXd& fresh, size_t rates, double factor,
                      VectorXd& out) const;
  /// Returns the vector after the change: remaining entries of `all`, and `fresh` for new nodes.
  VectorXd transfer(const VectorXd& all, const std::vector<MatrixXd>& fresh) const;
  /// Returns the entries of `after` for the new nodes (4 x dim each; rows beyond per_node_ are
  /// zero).
  std::vector<MatrixXd> taken(const VectorXd& after) const;
  /// Returns the entries of `after` for the remaining unknowns, at their indices before the change.
  VectorXd kept(const VectorXd& after) const;

  int n_before_ = 0;
  int dim_ = 0, per_node_ = 0;
  int at_ = 0;                   // first entry that is inserted or removed
  int added_ = 0, removed_ = 0;  // numbers of entries inserted or removed at at_
  std::vector<Node> nodes_;      // new nodes
};

}  // namespace flexmorph::fem
