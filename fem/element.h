#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "fem/shapes/shape.h"
#include "geometry/grid.h"

namespace flexmorph::fem {

struct EulerianTable;  // fem/eulerian_lines.h
class RigidClock;      // fem/rigid.h

inline constexpr int kMaxShapes = 16;  ///< Largest number of shape functions of one element.
inline constexpr int kMaxDim = 3;      ///< Largest number of directions in space.

/// Values of the unknowns of one element: one row per shape function, one column per direction.
using LocalRows =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kMaxShapes, kMaxDim>;

/// Scale factors of stiffness and mass of a design, one per cell of a grid over the material
/// coordinates. The quadrature splits an element at the cell borders and is exact for these
/// piecewise constant factors. Empty vectors mean uniform full material.
struct ScaleFactors {
  Grid grid;                 ///< Grid of the cells over the material coordinates [m].
  VectorXd stiffness, mass;  ///< Scale factors of stiffness and of mass (n_cells), or empty.

  /// Returns true if there are no factors, that is for uniform full material.
  bool uniform() const { return stiffness.size() == 0; }
};

/// Gradient of a number with respect to the scale factors of the cells of a body.
struct ScaleFactorGradient {
  /// Derivatives by the stiffness factors and by the mass factors (n_cells each).
  VectorXd stiffness, mass;

  /// Sets both gradients to zeros for n_cells cells.
  void set_zero(Eigen::Index n_cells) {
    stiffness.setZero(n_cells);
    mass.setZero(n_cells);
  }
};

/// Shape functions at quadrature points, one row per point and one column per function. N is always
/// filled; the other tables are filled on request and have size zero otherwise.
struct ShapeTable {
  VectorXd weight;  ///< Reference area of the point times the scale factor (n_points) [m²].
  std::vector<Vec2> material;  ///< Material coordinates (m, n) of the points [m].
  MatrixXd N;                  ///< Values of the shape functions, r = Qᵀ N.

  /// Rates ∂N/∂t and ∂²N/∂t² at a fixed material point; zero unless material lines move.
  MatrixXd N_t, N_tt;
  MatrixXd N_m, N_n;             ///< First derivatives by the material coordinates.
  MatrixXd N_mt, N_nt;           ///< Rates of the first derivatives at a fixed material point.
  MatrixXd N_mm, N_nn, N_mn;     ///< Second derivatives by the material coordinates.
  MatrixXd N_mmt, N_nnt, N_mnt;  ///< Rates of the second derivatives at a fixed material point.
};

/// Shape functions that are products of functions of one coordinate each, on a tensor grid of
/// points (g, h): N_k = f_m(g, function_m[k]) f_n(h, function_n[k]).
struct ProductTable {
  MatrixXd weight;  ///< Reference area of the point (g, h) times the scale factor [m²].

  /// Functions and their material derivatives (n_points x n_functions).
  MatrixXd f_m, d_m, f_n, d_n;
  std::vector<int> function_m, function_n;  ///< Numbers of the functions along m and n (n_shapes).
  bool curvature = false;   ///< True if the caller wants the second derivatives, too.
  MatrixXd dd_m{}, dd_n{};  ///< Second derivatives (n_points x n_functions), if wanted.
};

/// Tables that are filled in addition to N: `curvature` adds the first and second derivatives
/// without rates, `curvature_rates` adds all tables.
enum class Tabulate {
  position,
  position_rates,
  gradient,
  gradient_rates,
  curvature,
  curvature_rates
};

/// Selects the scale factor that multiplies the quadrature weight.
enum class ScaleFactorKind { none, stiffness, mass };

/// Numbers of the vector unknowns of one node (-1: the element has no unknown of that kind).
struct NodeVectors {
  int r = -1, r_m = -1, r_n = -1, r_mn = -1;  ///< Numbers of r, r_m, r_n and r_mn.
  Vec2 material{0, 0};                        ///< Material coordinates (m, n) of the node [m].
  bool moving = false;                        ///< True if the node lies on a driven material line.
};

/// Range of the design cells that an element overlaps: columns [i0, i1) and rows [j0, j1).
struct CellRange {
  /// First column, end of the columns, first row, end of the rows.
  int i0 = 0, i1 = 0, j0 = 0, j1 = 0;
  double area = 0;  ///< Reference area of the element [m²].

  /// Returns true if the element lies in one cell.
  bool single() const { return i1 - i0 == 1 && j1 - j0 == 1; }
};

/// Interface of elements with shape functions over material coordinates, r = Qᵀ N(X, t): plates and
/// beams have them, rigid bodies do not.
class ShapeElement {
 public:
  virtual ~ShapeElement() = default;
  /// Fills the tables at quadrature points that integrate polynomials of the given degree per
  /// direction exactly over element e, also with a scale factor that is constant in every design
  /// cell.
  virtual void tabulate(int e, int degree, Tabulate what, const ScaleFactors& factors,
                        ScaleFactorKind kind, ShapeTable& out) const = 0;
  /// Fills the shape functions at one material point (weight 1).
  /// @returns the element that contains the point
  /// @throws Error (input) when the point is outside the body.
  virtual int locate(const Vec2& material, Tabulate what, ShapeTable& out) const = 0;
  /// Returns the nodes of a named edge, ordered by the coordinate along the edge. Names are "root"
  /// and "free_end" (first and last m-line), "side_low" and "side_high" (first and last n-line),
  /// and "line 3" (an m-line by its number).
  /// @throws Error (input) naming the known edges.
  virtual std::vector<NodeVectors> edge(const std::string& name) const = 0;
  /// Returns all nodes of the body.
  virtual std::vector<NodeVectors> nodes() const = 0;
  /// Returns the material coordinates of the element borders along m and along n [m]; elements are
  /// numbered along n first.
  virtual std::array<std::vector<double>, 2> lines() const = 0;
};

/// Interface of elements whose shape changes in time.
class MovingElement {
 public:
  virtual ~MovingElement() = default;
  /// Updates everything that is prescribed in time, such as driven material lines, to time t [s].
  virtual void move_to(double t) = 0;
  /// Returns true if the shape of element e changes in time.
  virtual bool moving(int e) const = 0;
};

/// Interface of elements between free lines, that is mesh lines whose material coordinate [m] is an
/// unknown (Eulerian coordinate). These coordinates are the scalar unknowns of the body, which
/// follow its vector unknowns.
class EulerianLineElement {
 public:
  virtual ~EulerianLineElement() = default;
  /// Returns the current material coordinates of the free lines (n_scalars) [m].
  virtual VectorXd scalars() const = 0;
  /// Sets the material coordinates of the free lines with their rates and accelerations (n_scalars
  /// each) [m], [m/s], [m/s²].
  virtual void move_lines(const VectorXd& p, const VectorXd& rate,
                          const VectorXd& acceleration) = 0;
  /// Returns the numbers of the scalar unknowns of the lines around element e (see Side), -1 for a
  /// line that is no unknown; empty when none of the lines is free.
  virtual std::span<const int> free_sides(int e) const = 0;
  /// Fills the tables of an element with free lines and uniform material, see
  /// ShapeElement::tabulate().
  virtual void tabulate_eulerian(int e, int degree, Tabulate what, EulerianTable& out) const = 0;
};

/// Interface of elements that are split at the borders of design cells.
class CellElement {
 public:
  virtual ~CellElement() = default;
  /// Adds, for every cell of a grid, the integral of a function over the common area of the cell
  /// and element e. The function is given at the points that tabulate() uses with scale factors.
  /// The result is the derivative of Σ weight · value by the scale factor of each cell.
  /// @param values  function at the points (n_points)
  /// @param out     integrals (n_cells)
  virtual void add_cell_integrals(int e, int degree, const VectorXd& values, const Grid& grid,
                                  VectorXd& out) const = 0;
  /// Returns the range of cells that element e overlaps.
  virtual CellRange cells(int e, const Grid& grid) const = 0;
};

/// Interface of elements whose shape functions are products of functions of one coordinate.
/// Integrals of products of shape functions are then summed along one direction after the other.
class ProductElement {
 public:
  virtual ~ProductElement() = default;
  /// Fills the one-dimensional functions at the points of ShapeElement::tabulate().
  /// @returns false, with nothing filled, where the shape functions are no products
  virtual bool tabulate_products(int e, int degree, const ScaleFactors& factors,
                                 ScaleFactorKind kind, ProductTable& out) const = 0;
};

/// Numbers of elements and unknowns of a body.
struct ElementSizes {
  int dim = 2;         ///< Number of directions in space.
  int n_shapes = 0;    ///< Number of shape functions of one element, <= kMaxShapes.
  int n_elements = 0;  ///< Number of elements of the body.
  int n_vectors = 0;   ///< Number of vector unknowns of the body.
  int n_scalars = 0;   ///< Number of scalar unknowns of the body, see EulerianLineElement.
};

/// The elements of one body.
///
/// An element defines its unknowns. Further abilities are the interfaces above, from which its
/// class also derives: shape functions, material flow through the mesh, cells of a design. The
/// constructor of a derived class passes the class, Element(Kind<MyElement>{}), and thereby the
/// list of its interfaces. An element contains kinematics only, no physics. Unknowns are grouped in
/// vectors of dim() entries; vector unknown k of the body has the entries dim() k + c of its q.
class Element {
 public:
  virtual ~Element() = default;

  /// Returns a copy that shares no data with this element.
  virtual std::unique_ptr<Element> clone() const = 0;
  /// Returns the numbers of the vector unknowns of element e, in the order of its shape functions.
  virtual std::span<const int> vectors(int e) const = 0;
  /// Returns the length that turns vector unknown k into a displacement when multiplied: 1 for
  /// positions, the element size for position gradients, the square of the element size for mixed
  /// derivatives [m^order].
  virtual double scale(int k) const = 0;
  /// Returns true if vector unknown k is a position (and not a derivative of it).
  virtual bool is_position(int k) const = 0;
  /// Returns the values of all vector unknowns of the undeformed body in its own frame (n_vectors x
  /// dim).
  virtual MatrixXd reference() const = 0;

  /// Returns the number of directions in space.
  int dim() const { return sizes_.dim; }
  /// Returns the number of shape functions of one element.
  int n_shapes() const { return sizes_.n_shapes; }
  /// Returns the number of elements of the body.
  int n_elements() const { return sizes_.n_elements; }
  /// Returns the number of vector unknowns of the body.
  int n_vectors() const { return sizes_.n_vectors; }
  /// Returns the number of scalar unknowns of the body, see EulerianLineElement.
  int n_scalars() const { return sizes_.n_scalars; }
  /// Returns true if the element has shape functions over material coordinates.
  bool has_shapes() const { return shape_element() != nullptr; }
  /// Returns true for a rigid body, whose vector unknowns are r and u (elements/rigid_body.h).
  bool is_rigid() const { return abilities_->rigid; }

  // Functions of the interfaces above, with defaults for elements that lack the interface.

  /// Fills the tables of element e, see ShapeElement::tabulate().
  /// @throws Error (input) for an element without shape functions.
  void tabulate(int e, int degree, Tabulate what, const ScaleFactors& factors, ScaleFactorKind kind,
                ShapeTable& out) const {
    with_shapes().tabulate(e, degree, what, factors, kind, out);
  }
  /// Fills the shape functions at a material point, see ShapeElement::locate().
  /// @throws Error (input) also for an element without shape functions.
  int locate(const Vec2& material, Tabulate what, ShapeTable& out) const {
    return with_shapes().locate(material, what, out);
  }
  /// Returns the nodes of an edge, see ShapeElement::edge().
  /// @throws Error (input) also for an element without shape functions.
  std::vector<NodeVectors> edge(const std::string& name) const;
  /// Returns all nodes; none for an element without shape functions.
  std::vector<NodeVectors> nodes() const {
    return shape_element() ? shape_element()->nodes() : std::vector<NodeVectors>{};
  }
  /// Returns the element borders, see ShapeElement::lines(); none for an element without shape
  /// functions.
  std::array<std::vector<double>, 2> lines() const {
    return shape_element() ? shape_element()->lines() : std::array<std::vector<double>, 2>{};
  }

  /// Calls MovingElement::move_to(); has no effect on elements without that interface.
  void move_to(double t) {
    if (MovingElement* moves = abilities_->moving(*this)) moves->move_to(t);
  }
  /// Returns true if the shape of element e changes in time.
  bool moving(int e) const {
    const MovingElement* moves = abilities_->moving(const_cast<Element&>(*this));
    return moves != nullptr && moves->moving(e);
  }

  /// Returns the material coordinates of the free lines (n_scalars) [m].
  VectorXd scalars() const { return n_scalars() > 0 ? eulerian_lines()->scalars() : VectorXd(); }
  /// Sets the free lines, see EulerianLineElement::move_lines(); has no effect without free lines.
  void move_lines(const VectorXd& p, const VectorXd& rate, const VectorXd& acceleration) {
    if (n_scalars() > 0) abilities_->eulerian_lines(*this)->move_lines(p, rate, acceleration);
  }
  /// Returns the scalar unknowns around element e, see EulerianLineElement::free_sides(); empty
  /// without free lines.
  std::span<const int> free_sides(int e) const {
    return n_scalars() > 0 ? eulerian_lines()->free_sides(e) : std::span<const int>{};
  }
  /// Fills the tables of an element with free lines, see EulerianLineElement::tabulate_eulerian().
  /// @throws Error (input) for an element without support of free lines.
  void tabulate_eulerian(int e, int degree, Tabulate what, EulerianTable& out) const;

  /// Adds integrals over cells, see CellElement::add_cell_integrals(); has no effect on elements
  /// that are no CellElement.
  void add_cell_integrals(int e, int degree, const VectorXd& values, const Grid& grid,
                          VectorXd& out) const {
    if (const CellElement* cut = abilities_->cells(*this))
      cut->add_cell_integrals(e, degree, values, grid, out);
  }
  /// Returns the range of cells that element e overlaps; an empty range for elements that are no
  /// CellElement.
  CellRange cells(int e, const Grid& grid) const {
    const CellElement* cut = abilities_->cells(*this);
    return cut != nullptr ? cut->cells(e, grid) : CellRange{};
  }
  /// Fills the one-dimensional functions, see ProductElement::tabulate_products().
  /// @returns false for elements that are no ProductElement
  bool tabulate_products(int e, int degree, const ScaleFactors& factors, ScaleFactorKind kind,
                         ProductTable& out) const {
    const ProductElement* product = abilities_->products(*this);
    return product != nullptr && product->tabulate_products(e, degree, factors, kind, out);
  }

 protected:
  /// Tag type that passes the class of an element to the constructor of Element.
  template <class E>
  struct Kind {};
  template <class E>
  explicit Element(Kind<E>, const ElementSizes& sizes = {})
      : abilities_(&kAbilities<E>), sizes_(sizes) {}
  Element(const Element&) = default;
  Element(Element&&) = default;
  Element& operator=(const Element&) = default;
  Element& operator=(Element&&) = default;

  void set_sizes(const ElementSizes& sizes) { sizes_ = sizes; }

 private:
  /// Conversions of an element to the interfaces that its class has, null for an interface that it
  /// lacks. They are functions and not pointers, because copies of an element then share one table.
  struct Abilities {
    const ShapeElement* (*shapes)(const Element&);
    MovingElement* (*moving)(Element&);
    EulerianLineElement* (*eulerian_lines)(Element&);
    const CellElement* (*cells)(const Element&);
    const ProductElement* (*products)(const Element&);
    bool rigid;
  };
  template <class E, class Interface>
  static const Interface* as(const Element& element) {
    if constexpr (std::is_base_of_v<Interface, E>)
      return static_cast<const E*>(&element);
    else
      return nullptr;
  }
  template <class E, class Interface>
  static Interface* as_changing(Element& element) {
    return const_cast<Interface*>(as<E, Interface>(element));
  }
  template <class E>
  static constexpr Abilities kAbilities = {
      as<E, ShapeElement>, as_changing<E, MovingElement>, as_changing<E, EulerianLineElement>,
      as<E, CellElement>,  as<E, ProductElement>,         std::is_base_of_v<RigidClock, E>};

  const ShapeElement* shape_element() const { return abilities_->shapes(*this); }
  /// Returns the element as a ShapeElement.
  /// @throws Error (input) if it is none.
  const ShapeElement& with_shapes() const;
  const EulerianLineElement* eulerian_lines() const {
    return abilities_->eulerian_lines(const_cast<Element&>(*this));
  }

  const Abilities* abilities_;
  ElementSizes sizes_;
};

}  // namespace flexmorph::fem
