#pragma once

#include <array>
#include <vector>

#include "fem/line_grid.h"
#include "fem/model/model.h"

namespace flexmorph::fem {

/// A line of nodes next to the root comes or goes.
enum class MeshChange { insertion, removal };

/// Where an insertion puts the new line: a cell behind the first one, or in the middle of the
/// element at the root where there are no cells (0).
double inserted_line(const LineGrid& lines, double cell);

/// What a change of a body's mesh does to the vectors of the model, between the n unknowns before
/// and the n' after it:
///
///   q' = A q,   q̇' = A q̇ + B q,   q̈' = A q̈ + 2 B q̇ + C q,   λ' = λ
///
/// Unknowns that stay keep their values; those of a line that goes are left out. Those of a new
/// line are the field at its material points: A has values and derivatives by m, n, mn of the shape
/// functions there, for cubics in the middle of an element of length l along m
///
///   f = (f₁ + f₂)/2 + l (f₁' - f₂')/8,   f' = 3 (f₂ - f₁)/(2 l) - (f₁' + f₂')/4,
///
/// B and C their first and second rates at fixed material point, which are zero unless the lines of
/// the element move. With h16 the field does not change at all.
///
/// What follows a change in a motion is no part of it: forces are balanced (balance_forces()), and
/// velocities moved onto the constraints (Integrator::project_velocity()).
///
/// Source: P Fig. 3, 4; fem/README.md, Insertion and removal.
class MeshMap {
 public:
  /// Vectors of a state, or of derivatives by a state.
  struct Vectors {
    VectorXd q, v, a;
  };

  MeshMap() = default;
  /// Of the change next to the root of a body, its lines where they are now.
  /// @param n_dofs  of the model
  /// @param cell    see inserted_line()
  /// @throws Error (input) when the body has other elements.
  MeshMap(const Body& body, MeshChange change, int n_dofs, double cell = 0);

  int n_before() const { return n_before_; }
  int n_after() const { return n_before_ + added_ - removed_; }

  /// (n each) -> (n' each).
  Vectors apply(const Vectors& before) const;
  /// Transposed, (n' each) -> (n each): y · apply(x) = apply_transposed(y) · x, all three vectors
  /// of both together.
  Vectors apply_transposed(const Vectors& after) const;
  /// The acceleration alone, A a + 2 B q̇ + C q.
  VectorXd acceleration(const VectorXd& q, const VectorXd& v, const VectorXd& a) const;
  /// q, q̇, q̈ of a state.
  void carry(State& x) const;

 private:
  /// How a new node takes its values, derivatives and rates from the element it lies in.
  struct Node {
    std::vector<int> dofs;  // first of each vector unknown of the element
    // Value and derivative at the node, by the values at the four points along m, or n.
    Eigen::Matrix<double, 2, 4> along, across;
    // Shape functions and their rates at the 4 x 4 points: N, Ṅ, N̈ (1 x n_shapes, or empty).
    std::array<std::array<MatrixXd, 3>, 16> tables;
  };

  Node make_node(const Body& body, const LineGrid& plate, int e, double s, double u) const;
  MatrixXd rows_of(const Node& node, const VectorXd& all) const;
  /// Value and derivatives by m, n, mn (4 x dim) of N (rates 0), Ṅ (1) or N̈ (2) times rows.
  static MatrixXd sample(const Node& node, const MatrixXd& rows, size_t rates);
  void add_transposed(const Node& node, const MatrixXd& fresh, size_t rates, double factor,
                      VectorXd& out) const;
  /// `all` with what stays in its places; new nodes as `fresh`.
  VectorXd place(const VectorXd& all, const std::vector<MatrixXd>& fresh) const;
  /// What `after` says of new nodes (4 x dim each, rows that a node does not have zero); and of
  /// what stays, in its places before.
  std::vector<MatrixXd> taken(const VectorXd& after) const;
  VectorXd kept(const VectorXd& after) const;

  int n_before_ = 0;
  int dim_ = 0, per_node_ = 0;
  int at_ = 0;                   // entries before it stay where they are
  int added_ = 0, removed_ = 0;  // entries there
  std::vector<Node> nodes_;      // new ones
};

}  // namespace flexmorph::fem
