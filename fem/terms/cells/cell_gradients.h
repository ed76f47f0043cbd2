#pragma once

#include "fem/terms/cells/void_cells.h"
#include "fem/terms/element_invariants.h"

/// Derivatives of membrane forces and energies of cells with respect to the scale factors of the
/// design.
namespace flexmorph::fem {

/// Data of eight cells side by side, as the membrane term stores them.
struct CellBatch {
  const std::vector<Pack>& w;          ///< W of every cell, packed.
  const std::vector<Pack>& reference;  ///< Products g° of the undeformed cells.
  const VoidCells& cells;              ///< Small-strain energies of the nearly empty cells.
};

/// Adds, times weight, the derivatives of ψ · f, f the force of cell e, or of its energy, with
/// respect to the scale factors of the design cells that lie in it:
///
///   U = γ(κ̄) U_solid + (1 - γ(κ̄)) U_empty, both linear in the scale factors, κ̄ their mean.
///
/// @param q  positions of its four nodes (8)
/// @param psi  vectors ψ at its four nodes (8); null for derivatives of the energy
/// @param out  derivatives by the cells of the design
void add_cell_gradient(const Element& element, const ScaleFactors& factors,
                       const ElementInvariants& invariants, const CellBatch& batch, int e,
                       const double* q, const double* psi, double weight, VectorXd& out);

}  // namespace flexmorph::fem
