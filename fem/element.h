#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fem/shapes/shape.h"
#include "geometry/grid.h"

namespace flexmorph::fem {

struct FreeTable;  // fem/free_lines.h

inline constexpr int kMaxShapes = 16;  ///< shape functions of one element
inline constexpr int kMaxDim = 3;

/// Values of the unknowns of one element: one row per shape function, one column per direction.
using LocalRows =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kMaxShapes, kMaxDim>;

/// Stiffness and mass factors of the design, cell by cell over material coordinates; an element is
/// cut by its cells and integrated exactly. Empty vectors: uniform full material.
struct Factors {
  Grid grid;
  VectorXd stiffness, mass;  ///< (n_cells), or empty

  bool uniform() const { return stiffness.size() == 0; }
};

/// Derivatives of a number by the factors of a body's cells (n_cells each).
struct FactorSlopes {
  VectorXd stiffness, mass;

  void set_zero(Eigen::Index n_cells) {
    stiffness.setZero(n_cells);
    mass.setZero(n_cells);
  }
};

/// Shape functions at quadrature points, a row per point and a column per function. Filled as far
/// as asked for: N always, the others on demand (their size is zero otherwise).
struct ShapeTable {
  VectorXd weight;             ///< reference area of the point times the factor [m^2]
  std::vector<Vec2> material;  ///< material coordinates (m, n) [m]
  MatrixXd N;                  ///< r = Qᵀ N
  MatrixXd N_t, N_tt;  ///< ∂N/∂t, ∂²N/∂t² at fixed material point: zero unless lines move
  MatrixXd N_m, N_n;   ///< derivatives by the material coordinates
  MatrixXd N_mt, N_nt;           ///< their rates at fixed material point
  MatrixXd N_mm, N_nn, N_mn;     ///< second derivatives by the material coordinates
  MatrixXd N_mmt, N_nnt, N_mnt;  ///< their rates at fixed material point
};

/// Shape functions that are products of functions of one coordinate each, at a tensor grid of
/// points (g, h): N_k = f_m(g, function_m[k]) f_n(h, function_n[k]).
struct ProductTable {
  MatrixXd weight;              ///< reference area of the point times the factor [m^2]
  MatrixXd f_m, d_m, f_n, d_n;  ///< functions and their material derivatives (points x functions)
  std::vector<int> function_m, function_n;  ///< (n_shapes)
  bool curvature = false;   ///< said by the caller: are the second derivatives wanted, too?
  MatrixXd dd_m{}, dd_n{};  ///< they, where wanted
};

/// What to fill besides N; `curvature` is the first and second derivatives without rates,
/// `curvature_rates` everything.
enum class Tabulate {
  position,
  position_rates,
  gradient,
  gradient_rates,
  curvature,
  curvature_rates
};

/// Which factor multiplies the quadrature weight.
enum class FactorKind { none, stiffness, mass };

/// The vector unknowns of one node (-1: the element has none of that kind).
struct NodeVectors {
  int r = -1, r_m = -1, r_n = -1, r_mn = -1;
  Vec2 material{0, 0};
  bool moving = false;  ///< lies on a material line that is driven
};

/// The seam of kinematics: the elements of one body, r = Qᵀ N(X, t).
///
/// An element knows its shape functions, their derivatives by the material coordinates and their
/// rates when material flows through the mesh; it knows no physics. Unknowns come as vectors of
/// dim() entries; vector unknown k of the body has the entries dim() k + c of its q.
class Element {
 public:
  virtual ~Element() = default;

  /// A copy that shares nothing with this one.
  virtual std::unique_ptr<Element> clone() const = 0;

  virtual int dim() const = 0;
  virtual int n_shapes() const = 0;  ///< shape functions of one element, <= kMaxShapes
  virtual int n_elements() const = 0;
  virtual int n_vectors() const = 0;  ///< vector unknowns of the body

  /// Numbers of the vector unknowns of element e, in the order of its shape functions.
  virtual std::span<const int> vectors(int e) const = 0;

  /// A length that makes vector unknown k a displacement when multiplied: 1 for positions, the
  /// element size for slopes, its square for mixed derivatives [m^order].
  virtual double scale(int k) const = 0;

  /// Is vector unknown k a position (and not a derivative of it)?
  virtual bool is_position(int k) const = 0;

  /// Is this a rigid body: vector unknowns r and u (elements/rigid_body.h), no shape functions?
  virtual bool is_rigid() const { return false; }

  /// Values of the undeformed body at rest in its own frame, all unknowns (n_vectors x dim).
  virtual MatrixXd reference() const = 0;

  /// Nodes of a named edge ("root", "free_end": first and last m-line; "side_low", "side_high":
  /// first and last n-line; "line 3": an m-line by its number), in the order of the coordinate
  /// along it.
  /// @throws Error (input) naming the known edges.
  virtual std::vector<NodeVectors> edge(const std::string& name) const = 0;
  /// All nodes; none where an element has no nodes in material coordinates.
  virtual std::vector<NodeVectors> nodes() const { return {}; }

  /// Material coordinates at which elements meet, along m and along n: elements are numbered along
  /// n first. None where there are none.
  virtual std::array<std::vector<double>, 2> lines() const { return {}; }

  /// Puts the material lines where they are at time t.
  virtual void move_to(double t) = 0;
  /// Does the shape of element e change in time?
  virtual bool moving(int e) const = 0;

  /// Scalar unknowns of the body, which follow its vector unknowns: coordinates of free material
  /// lines [m].
  virtual int n_scalars() const { return 0; }
  virtual VectorXd scalars() const { return {}; }  ///< where they are
  /// Puts free material lines there (n_scalars), with their rates and accelerations.
  virtual void move_lines(const VectorXd& /*p*/, const VectorXd& /*rate*/,
                          const VectorXd& /*acceleration*/) {}
  /// Scalar unknowns of the lines around element e (see Side), -1 for those that are none; empty
  /// when no line is free.
  virtual std::span<const int> free_sides(int /*e*/) const { return {}; }
  /// tabulate() for an element with free lines, of uniform material.
  virtual void tabulate_free(int /*e*/, int /*degree*/, Tabulate, FreeTable& /*out*/) const {}

  /// Points for integrands of the given degree per direction in element e, exact for a factor that
  /// is constant in every design cell.
  virtual void tabulate(int e, int degree, Tabulate what, const Factors& factors, FactorKind kind,
                        ShapeTable& out) const = 0;

  /// Adds, for every cell of a grid, the integral over its part of element e of a function that is
  /// given at the points of tabulate() with factors: the derivative of Σ weight · value by the
  /// factor of that cell. Nothing where elements are not cut by cells.
  /// @param values  (n_points)   @param out  (n_cells)
  virtual void add_cell_integrals(int /*e*/, int /*degree*/, const VectorXd& /*values*/,
                                  const Grid& /*grid*/, VectorXd& /*out*/) const {}
  /// Cells that element e lies in: columns [i0, i1) and rows [j0, j1). None where elements are not
  /// cut by cells.
  struct CellRange {
    int i0 = 0, i1 = 0, j0 = 0, j1 = 0;
    double area = 0;  ///< of the element [m²]
    /// Is it one?
    bool single() const { return i1 - i0 == 1 && j1 - j0 == 1; }
  };
  virtual CellRange cells(int /*e*/, const Grid& /*grid*/) const { return {}; }

  /// The points of tabulate() for an element whose shape functions are products of functions of one
  /// coordinate: integrals of their products are then sums over one direction after the other.
  /// False, and nothing done, where they are not.
  virtual bool tabulate_products(int /*e*/, int /*degree*/, const Factors&, FactorKind,
                                 ProductTable& /*out*/) const {
    return false;
  }

  /// Shape functions at one material point (weight 1), and the element it lies in.
  /// @throws Error (input) when the point is outside the body.
  virtual int locate(const Vec2& material, Tabulate what, ShapeTable& out) const = 0;
};

}  // namespace flexmorph::fem
