#pragma once

#include <functional>

#include "fem/element.h"

namespace flexmorph::fem {

/// A line of the tensor grid in material coordinates: fixed, prescribed in time, or an unknown.
struct MaterialLine {
  double value = 0;                     ///< [m]; ignored when driven; where a free line starts
  std::function<Motion(double)> drive;  ///< empty: fixed or free
  bool free = false;
};

/// Elements on a tensor grid of material lines m_i(t) x n_j(t): what growing and shrinking bodies
/// need to know of their mesh. The first m-line is the "root" edge, the last the "free_end".
///
/// Nodes are numbered column by column from the root, n fastest; the vector unknowns of a node are
/// value, derivative by m, by n and, when per_node() is 4, the mixed one.
class LineGrid : public Element, public ShapeElement, public MovingElement {
 public:
  std::unique_ptr<Element> clone() const final { return copy(); }
  // Of the interfaces directly: an element that is known to be a grid needs no question.
  using MovingElement::move_to, MovingElement::moving;
  using ShapeElement::edge, ShapeElement::locate, ShapeElement::nodes, ShapeElement::tabulate;

  virtual int per_node() const = 0;
  virtual const std::vector<MaterialLine>& lines_m() const = 0;
  virtual const Motion& line_m(int i) const = 0;  ///< at the time of the last move_to()
  virtual const Motion& line_n(int j) const = 0;
  virtual int n_n() const = 0;  ///< elements along n

  int n_m() const { return static_cast<int>(lines_m().size()) - 1; }
  std::array<std::vector<double>, 2> lines() const final {
    std::array<std::vector<double>, 2> out;
    for (int i = 0; i <= n_m(); ++i) out[0].push_back(line_m(i).value);
    for (int j = 0; j <= n_n(); ++j) out[1].push_back(line_n(j).value);
    return out;
  }
  int n_nodes() const { return (n_m() + 1) * (n_n() + 1); }
  int node(int i, int j) const { return i * (n_n() + 1) + j; }
  int element(int i, int j) const { return i * n_n() + j; }

  /// Shape functions of element e at local coordinates s, u in [0, 1] (one point, weight 1).
  virtual void at(int e, double s, double u, Tabulate what, ShapeTable& out) const = 0;

  /// Copies of this mesh at its time: as it is, with an m-line inserted behind line i, without
  /// line i, with all lines fixed where they are.
  virtual std::unique_ptr<LineGrid> copy() const = 0;
  virtual std::unique_ptr<LineGrid> with_line(int i, double value) const = 0;
  virtual std::unique_ptr<LineGrid> without_line(int i) const = 0;
  virtual std::unique_ptr<LineGrid> frozen() const = 0;
  /// The same elements on other m-lines, which increase at t; free lines start at their values.
  virtual std::unique_ptr<LineGrid> with_lines_m(std::vector<MaterialLine> m, double t) const = 0;

 protected:
  template <class Grid>
  explicit LineGrid(Kind<Grid> kind) : Element(kind) {}
};

}  // namespace flexmorph::fem
