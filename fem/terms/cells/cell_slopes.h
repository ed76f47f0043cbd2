#pragma once

#include "fem/terms/cells/void_cells.h"
#include "fem/terms/element_invariants.h"

/// Membrane forces and energies of cells of a design by the factors of its cells.
namespace flexmorph::fem {

/// Eight cells side by side, as the membrane term keeps them.
struct CellBatch {
  const std::vector<Lanes>& w;          ///< packed, of every cell
  const std::vector<Lanes>& reference;  ///< g°
  const VoidCells& cells;
};

/// Adds the derivatives of ψ · f, f the force of cell e, or of its energy, by the factors of design
/// cells that lie in it, times weight:
///
///   U = γ(κ̄) U_solid + (1 - γ(κ̄)) U_empty, both linear in the factors, κ̄ the mean one.
///
/// @param q  positions of its four nodes (8)   @param psi  likewise; null: energies
/// @param out  by the design's cells
void add_cell_slopes(const Element& element, const Factors& factors,
                     const ElementInvariants& invariants, const CellBatch& batch, int e,
                     const double* q, const double* psi, double weight, VectorXd& out);

}  // namespace flexmorph::fem
