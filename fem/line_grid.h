#pragma once

#include <functional>

#include "fem/element.h"

namespace flexmorph::fem {

/// A mesh line of constant material coordinate in the tensor grid: fixed, prescribed in time, or
/// with an unknown material coordinate (free).
struct MaterialLine {
  /// Material coordinate [m]; the initial one of a free line; ignored for a driven line.
  double value = 0;
  /// Prescribed coordinate as a function of time; empty for other lines.
  std::function<Motion(double)> drive;
  bool free = false;  ///< True if the material coordinate is an unknown.
};

/// Elements on a tensor grid of material lines m_i(t) x n_j(t): the mesh data that bodies of
/// changing length need. The first m-line is the "root" edge, the last one the "free_end".
///
/// Nodes are numbered column by column from the root, n fastest. The vector unknowns of a node are
/// the value, the derivative by m, the derivative by n and, when per_node() is 4, the mixed
/// derivative.
class LineGrid : public Element, public ShapeElement, public MovingElement {
 public:
  std::unique_ptr<Element> clone() const final { return copy(); }
  // Taken from the interfaces directly: a LineGrid always has them, so that no lookup is needed.
  using MovingElement::move_to, MovingElement::moving;
  using ShapeElement::edge, ShapeElement::locate, ShapeElement::nodes, ShapeElement::tabulate;

  /// Returns the number of vector unknowns of one node.
  virtual int per_node() const = 0;
  /// Returns the definitions of the m-lines.
  virtual const std::vector<MaterialLine>& lines_m() const = 0;
  /// Returns the material coordinate of m-line i with its rates at the time of the last move_to()
  /// [m].
  virtual const Motion& line_m(int i) const = 0;
  /// Returns the material coordinate of n-line j with its rates at the time of the last move_to()
  /// [m].
  virtual const Motion& line_n(int j) const = 0;
  /// Returns the number of elements along n.
  virtual int n_n() const = 0;

  /// Returns the number of elements along m.
  int n_m() const { return static_cast<int>(lines_m().size()) - 1; }
  std::array<std::vector<double>, 2> lines() const final {
    std::array<std::vector<double>, 2> out;
    for (int i = 0; i <= n_m(); ++i) out[0].push_back(line_m(i).value);
    for (int j = 0; j <= n_n(); ++j) out[1].push_back(line_n(j).value);
    return out;
  }
  /// Returns the number of nodes of the mesh.
  int n_nodes() const { return (n_m() + 1) * (n_n() + 1); }
  /// Returns the number of the node on m-line i and n-line j.
  int node(int i, int j) const { return i * (n_n() + 1) + j; }
  /// Returns the number of the element in column i along m and row j along n.
  int element(int i, int j) const { return i * n_n() + j; }

  /// Fills the shape functions of element e at the local coordinates s, u in [0, 1] (one point,
  /// weight 1).
  virtual void at(int e, double s, double u, Tabulate what, ShapeTable& out) const = 0;

  /// Returns a copy of this mesh at its current time.
  virtual std::unique_ptr<LineGrid> copy() const = 0;
  /// Returns a copy of this mesh with a fixed m-line inserted behind line i at the material
  /// coordinate `value` [m].
  virtual std::unique_ptr<LineGrid> with_line(int i, double value) const = 0;
  /// Returns a copy of this mesh without m-line i.
  virtual std::unique_ptr<LineGrid> without_line(int i) const = 0;
  /// Returns a copy of this mesh with all lines fixed at their current coordinates.
  virtual std::unique_ptr<LineGrid> frozen() const = 0;
  /// Returns the same kind of elements on other m-lines, whose coordinates must increase at time t
  /// [s]; free lines start at their values.
  virtual std::unique_ptr<LineGrid> with_lines_m(std::vector<MaterialLine> m, double t) const = 0;

 protected:
  template <class Grid>
  explicit LineGrid(Kind<Grid> kind) : Element(kind) {}
};

}  // namespace flexmorph::fem
