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

struct FreeTable;  // fem/free_lines.h
class RigidClock;  // fem/rigid.h

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

/// Cells of a design that an element lies in: columns [i0, i1) and rows [j0, j1).
struct CellRange {
  int i0 = 0, i1 = 0, j0 = 0, j1 = 0;
  double area = 0;  ///< of the element [m²]
  /// Tells whether it is one cell.
  bool single() const { return i1 - i0 == 1 && j1 - j0 == 1; }
};

/// Shape functions over material coordinates, r = Qᵀ N(X, t): elements of plates and beams have
/// them, rigid bodies have none.
class ShapeElement {
 public:
  virtual ~ShapeElement() = default;
  /// Fills points for integrands of the given degree per direction in element e, exact for a factor
  /// that is constant in every design cell.
  virtual void tabulate(int e, int degree, Tabulate what, const Factors& factors, FactorKind kind,
                        ShapeTable& out) const = 0;
  /// Fills the shape functions at one material point (weight 1). @return the element it lies in
  /// @throws Error (input) when the point is outside the body.
  virtual int locate(const Vec2& material, Tabulate what, ShapeTable& out) const = 0;
  /// Returns the nodes of a named edge ("root", "free_end": first and last m-line; "side_low",
  /// "side_high": first and last n-line; "line 3": an m-line by its number), in the order of the
  /// coordinate along it.
  /// @throws Error (input) naming the known edges.
  virtual std::vector<NodeVectors> edge(const std::string& name) const = 0;
  /// Returns all nodes.
  virtual std::vector<NodeVectors> nodes() const = 0;
  /// Returns the material coordinates at which elements meet, along m and along n: elements are
  /// numbered along n first.
  virtual std::array<std::vector<double>, 2> lines() const = 0;
};

/// Elements whose shape changes in time.
class MovingElement {
 public:
  virtual ~MovingElement() = default;
  /// Puts driven material lines, or what else moves, where they are at time t.
  virtual void move_to(double t) = 0;
  /// Tells whether the shape of element e changes in time.
  virtual bool moving(int e) const = 0;
};

/// Elements between material lines that are unknowns: scalar unknowns of the body, which follow its
/// vector unknowns, coordinates of the free lines [m].
class FreeLineElement {
 public:
  virtual ~FreeLineElement() = default;
  /// Returns where the free lines are.
  virtual VectorXd scalars() const = 0;
  /// Puts them there (n_scalars), with their rates and accelerations.
  virtual void move_lines(const VectorXd& p, const VectorXd& rate,
                          const VectorXd& acceleration) = 0;
  /// Returns the scalar unknowns of the lines around element e (see Side), -1 for those that are
  /// none; empty when no line is free.
  virtual std::span<const int> free_sides(int e) const = 0;
  /// Does what tabulate() does for an element with free lines, of uniform material.
  virtual void tabulate_free(int e, int degree, Tabulate what, FreeTable& out) const = 0;
};

/// Elements that cells of a design cut.
class CellElement {
 public:
  virtual ~CellElement() = default;
  /// Adds, for every cell of a grid, the integral over its part of element e of a function that is
  /// given at the points of tabulate() with factors: the derivative of Σ weight · value by the
  /// factor of that cell.
  /// @param values  (n_points)   @param out  (n_cells)
  virtual void add_cell_integrals(int e, int degree, const VectorXd& values, const Grid& grid,
                                  VectorXd& out) const = 0;
  /// Returns the cells that element e lies in.
  virtual CellRange cells(int e, const Grid& grid) const = 0;
};

/// Elements whose shape functions are products of functions of one coordinate: integrals of their
/// products are sums over one direction after the other.
class ProductElement {
 public:
  virtual ~ProductElement() = default;
  /// Fills the points of tabulate(). @return false, with nothing done, where they are no products
  virtual bool tabulate_products(int e, int degree, const Factors& factors, FactorKind kind,
                                 ProductTable& out) const = 0;
};

/// Numbers of a body's elements and unknowns.
struct ElementSizes {
  int dim = 2;
  int n_shapes = 0;  ///< shape functions of one element, <= kMaxShapes
  int n_elements = 0;
  int n_vectors = 0;  ///< vector unknowns of the body
  int n_scalars = 0;  ///< scalar unknowns of the body, see FreeLineElement
};

/// The elements of one body.
///
/// An element knows its unknowns; what it knows besides it says by deriving from the interfaces
/// above, too: shape functions, material flow through the mesh, cells of a design. Its constructor
/// names its class, Element(Kind<MyElement>{}), and with it what it derives from. An element knows
/// no physics. Unknowns come as vectors of dim() entries; vector unknown k of the body has the
/// entries dim() k + c of its q.
class Element {
 public:
  virtual ~Element() = default;

  /// Returns a copy that shares nothing with this one.
  virtual std::unique_ptr<Element> clone() const = 0;
  /// Returns the numbers of the vector unknowns of element e, in the order of its shape functions.
  virtual std::span<const int> vectors(int e) const = 0;
  /// Returns a length that makes vector unknown k a displacement when multiplied: 1 for positions,
  /// the element size for slopes, its square for mixed derivatives [m^order].
  virtual double scale(int k) const = 0;
  /// Tells whether vector unknown k is a position (and not a derivative of it).
  virtual bool is_position(int k) const = 0;
  /// Returns the values of the undeformed body at rest in its own frame, all unknowns
  /// (n_vectors x dim).
  virtual MatrixXd reference() const = 0;

  int dim() const { return sizes_.dim; }
  int n_shapes() const { return sizes_.n_shapes; }
  int n_elements() const { return sizes_.n_elements; }
  int n_vectors() const { return sizes_.n_vectors; }
  int n_scalars() const { return sizes_.n_scalars; }
  /// Tells whether it has shape functions over material coordinates.
  bool has_shapes() const { return shape_element() != nullptr; }
  /// Tells whether this is a rigid body: vector unknowns r and u (elements/rigid_body.h).
  bool is_rigid() const { return abilities_->rigid; }

  // What the interfaces above say, and what holds for an element that is none of them.

  /// @throws Error (input) for an element without shape functions.
  void tabulate(int e, int degree, Tabulate what, const Factors& factors, FactorKind kind,
                ShapeTable& out) const {
    with_shapes().tabulate(e, degree, what, factors, kind, out);
  }
  int locate(const Vec2& material, Tabulate what, ShapeTable& out) const {
    return with_shapes().locate(material, what, out);
  }
  std::vector<NodeVectors> edge(const std::string& name) const;
  std::vector<NodeVectors> nodes() const {
    return shape_element() ? shape_element()->nodes() : std::vector<NodeVectors>{};
  }
  std::array<std::vector<double>, 2> lines() const {
    return shape_element() ? shape_element()->lines() : std::array<std::vector<double>, 2>{};
  }

  void move_to(double t) {
    if (MovingElement* moves = abilities_->moving(*this)) moves->move_to(t);
  }
  bool moving(int e) const {
    const MovingElement* moves = abilities_->moving(const_cast<Element&>(*this));
    return moves != nullptr && moves->moving(e);
  }

  VectorXd scalars() const { return n_scalars() > 0 ? free_lines()->scalars() : VectorXd(); }
  void move_lines(const VectorXd& p, const VectorXd& rate, const VectorXd& acceleration) {
    if (n_scalars() > 0) abilities_->free_lines(*this)->move_lines(p, rate, acceleration);
  }
  std::span<const int> free_sides(int e) const {
    return n_scalars() > 0 ? free_lines()->free_sides(e) : std::span<const int>{};
  }
  /// @throws Error (input) for an element that knows no free lines.
  void tabulate_free(int e, int degree, Tabulate what, FreeTable& out) const;

  void add_cell_integrals(int e, int degree, const VectorXd& values, const Grid& grid,
                          VectorXd& out) const {
    if (const CellElement* cut = abilities_->cells(*this))
      cut->add_cell_integrals(e, degree, values, grid, out);
  }
  CellRange cells(int e, const Grid& grid) const {
    const CellElement* cut = abilities_->cells(*this);
    return cut != nullptr ? cut->cells(e, grid) : CellRange{};
  }
  bool tabulate_products(int e, int degree, const Factors& factors, FactorKind kind,
                         ProductTable& out) const {
    const ProductElement* product = abilities_->products(*this);
    return product != nullptr && product->tabulate_products(e, degree, factors, kind, out);
  }

 protected:
  /// Names the class of an element.
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
  /// An element as what it is besides, null where it is not: functions, not pointers, which copies
  /// of an element may share.
  struct Abilities {
    const ShapeElement* (*shapes)(const Element&);
    MovingElement* (*moving)(Element&);
    FreeLineElement* (*free_lines)(Element&);
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
      as<E, ShapeElement>, as_changing<E, MovingElement>, as_changing<E, FreeLineElement>,
      as<E, CellElement>,  as<E, ProductElement>,         std::is_base_of_v<RigidClock, E>};

  const ShapeElement* shape_element() const { return abilities_->shapes(*this); }
  /// @throws Error (input) where there are none.
  const ShapeElement& with_shapes() const;
  const FreeLineElement* free_lines() const {
    return abilities_->free_lines(const_cast<Element&>(*this));
  }

  const Abilities* abilities_;
  ElementSizes sizes_;
};

}  // namespace flexmorph::fem
