#include "fem/terms/cells/cell_gradients.h"

namespace flexmorph::fem {
namespace {

/// Work of a cell's force on ψ, or its energy, with the whole cell solid and with the whole cell
/// void.
struct Shares {
  double solid = 0, empty = 0;
};

/// Returns the work or the energy of a cell.
/// @param w  W of SIMD lane w.lane
/// @param reference  products g° of that cell, in `lane`
Shares shares(const gram::OneOf& w, const VoidCells& cells, const std::vector<Pack>& reference,
              int lane, const double* q, const double* psi) {
  using N = gram::Numbering<1>;
  double p[2 * N::n], d[2 * N::n], g[N::n_pairs], s[N::n_pairs];
  gram::vectors<1, 2>(q, p);
  gram::products<1, 2>(p, g);
  for (size_t k = 0; k < N::n_pairs; ++k) g[k] -= reference[k][lane];
  gram::multiply<1, gram::Coupling::all>(w, g, s);
  Shares out;
  if (psi) gram::vectors<1, 2>(psi, d);
  for (size_t k = 0; k < N::n_pairs; ++k) {
    const int i = 2 * N::tables.i[k], j = 2 * N::tables.j[k];
    double change = g[k] / 2;
    if (psi) {
      change = p[i] * d[j] + p[i + 1] * d[j + 1];
      if (i != j) change += d[i] * p[j] + d[i + 1] * p[j + 1];
    }
    out.solid += s[k] * change;
  }
  if (cells.any()) out.empty = cells.small_strains(w.lane, p, psi ? d : nullptr);
  return out;
}

/// Full material of one design cell in an element: its W, and its fraction of the area.
struct CellPart {
  VoidCells cells;
  double share = 0;
  std::vector<Pack> w;
};

CellPart part_in(const Element& element, const ScaleFactors& factors,
                 const ElementInvariants& invariants, int e, int cell, const Vec2& size) {
  static thread_local ScaleFactors only;
  only.grid = factors.grid;
  only.stiffness.setZero(factors.stiffness.size());
  only.stiffness[cell] = 1;
  ProductTable table;
  element.tabulate_products(e, ElementInvariants::kCellDegree, only, ScaleFactorKind::stiffness,
                            table);
  CellPart out;
  out.share = table.weight.sum() / size.prod();
  for (const double x : invariants.of_table(table)) out.w.push_back(Pack{} + x);
  out.cells.set(0, size, 0);
  out.cells.fill(1);
  out.cells.set_stiffness(out.w);
  return out;
}

}  // namespace

void add_cell_gradient(const Element& element, const ScaleFactors& factors,
                       const ElementInvariants& invariants, const CellBatch& batch, int e,
                       const double* q, const double* psi, double weight, VectorXd& out) {
  const int lane = e % kLanes;
  const VoidCells& cells = batch.cells;
  const Grid& grid = factors.grid;
  const double factor = cells.factor(lane), solid = VoidCells::solid_part(factor),
               slope = VoidCells::solid_derivative(factor);
  const Shares all = shares({batch.w.data(), lane}, cells, batch.reference, lane, q, psi);
  const CellRange at = element.cells(e, grid);
  if (at.single() && factor > 0) {
    out[grid.cell(at.i0, at.j0)] += weight * ((solid / factor + slope) * all.solid +
                                              ((1 - solid) / factor - slope) * all.empty);
    return;
  }
  for (int i = at.i0; i < at.i1; ++i)
    for (int j = at.j0; j < at.j1; ++j) {
      const int cell = grid.cell(i, j);
      const CellPart part = part_in(element, factors, invariants, e, cell, cells.size(lane));
      const Shares own = shares({part.w.data(), 0}, part.cells, batch.reference, lane, q, psi);
      out[cell] += weight * (solid * own.solid + (1 - solid) * own.empty +
                             slope * part.share * (all.solid - all.empty));
    }
}

}  // namespace flexmorph::fem
