#include "optim/mmc/problem/response.h"

namespace flexmorph::mmc {
namespace {

/// Returns the contributions of the cells to the moment of inertia J about the root, with an axis
/// perpendicular to the plane (1 x n_cells).
///
///   J = Σ b m_cell (|x - x_root|² + (dx² + dy²) / 12)
///
/// b       mass factor of a cell [-]
/// m_cell  mass of a full cell, ρ c dx dy [kg]
/// x       centre of the cell; x_root is the middle of the left edge of the grid, where a rotating
///         body is held at its greatest length [m]
/// J       [kg m²]; it is exact where the material of a cell is distributed uniformly in the cell
MatrixXd by_cell(const Plate& plate) {
  const Grid& g = plate.grid;
  const Vec2 root(g.x0, g.y0 + 0.5 * g.height);
  const double own = (g.dx() * g.dx() + g.dy() * g.dy()) / 12;
  const double mass = plate.section.density * plate.section.thickness * g.dx() * g.dy();
  MatrixXd out(1, g.n_cells());
  for (int i = 0; i < g.nx; ++i)
    for (int j = 0; j < g.ny; ++j)
      out(g.cell(i, j)) = mass * ((g.cell_center(i, j) - root).squaredNorm() + own);
  return out;
}

double full_inertia(const Plate& plate) {
  const MatrixXd each = by_cell(plate);
  double sum = 0;
  for (int cell = 0; cell < plate.grid.n_cells(); ++cell)
    if (plate.has(cell)) sum += each(cell);
  return sum;
}

class Inertia final : public Response {
 public:
  explicit Inertia(const Plate& plate) : by_cell_(by_cell(plate)) {}

  void evaluate(const DesignView& at, Values& out) override {
    out.f = by_cell_ * at.factors.mass;
    out.d_mass = by_cell_;
  }

 private:
  MatrixXd by_cell_;
};

}  // namespace

extern const ResponseRow kInertia;
const ResponseRow kInertia{.name = "inertia",
                           .words = "mass moment of inertia about the root",
                           .unit = "kg m^2",
                           .full = full_inertia,
                           .linear = true,
                           .make = make_response<Inertia>};

}  // namespace flexmorph::mmc
