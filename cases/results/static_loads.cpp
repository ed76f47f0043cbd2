#include "cases/results/static_loads.h"

#include <algorithm>
#include <cmath>

#include "fem/triangles/t6.h"

namespace flexmorph::cases {
namespace {

/// Smallest area fraction of material of a cell that counts as material [-].
constexpr double kHalfFull = 0.5;

/// Computes the largest displacement of the corners of the cells of material, and the largest von
/// Mises stress at the centres of these cells.
/// @param u  displacements of the nodes (2 n_nodes) [m]
void measure_cells(const mmc::BodyProblem& problem, const VectorXd& fractions, const VectorXd& u,
                   StaticLoad& out) {
  const Grid& g = problem.grid;
  const Eigen::Matrix3d elasticity = problem.section.elasticity();
  for (int i = 0; i < g.nx; ++i)
    for (int j = 0; j < g.ny; ++j) {
      if (fractions[g.cell(i, j)] < kHalfFull) continue;
      const auto at = [&](int di, int dj) -> Vec2 {
        return u.segment<2>(2 * g.node(i + di, j + dj));
      };
      for (const int di : {0, 1})
        for (const int dj : {0, 1})
          out.largest_displacement = std::max(out.largest_displacement, at(di, dj).norm());
      const Vec2 by_x = 0.5 * (at(1, 0) + at(1, 1) - at(0, 0) - at(0, 1)) / g.dx();
      const Vec2 by_y = 0.5 * (at(0, 1) + at(1, 1) - at(0, 0) - at(1, 0)) / g.dy();
      const Vec3 strain(by_x.x(), by_y.y(), by_x.y() + by_y.x());
      out.largest_stress = std::max(out.largest_stress, fem::von_mises(elasticity * strain));
    }
}

}  // namespace

std::vector<StaticLoad> static_loads_of(const Domain& domain, const mmc::BodyProblem& problem,
                                        mmc::ComplianceEvaluator& loads,
                                        const mmc::BodyOutcome& outcome,
                                        const VerifiedOutline* outline) {
  const verification::OutlineVerification* verified =
      outline && outline->verification && std::isfinite(outline->verification->compliance)
          ? &*outline->verification
          : nullptr;
  const mmc::CellScaleFactors crisp = mmc::ersatz_of(problem).crisp(outcome.crisp.fractions);
  std::vector<StaticLoad> out;
  for (size_t l = 0; l < domain.loads.size(); ++l) {
    StaticLoad& load = out.emplace_back();
    load.name = domain.loads[l].name;
    load.weight = domain.loads[l].weight;
    load.compliance = outcome.load_compliances[l];
    load.active = load.compliance >= 0.99 * outcome.worst_compliance;
    load.source = verified ? "outline" : "cells";
    if (verified) {
      load.strain_energy = 0.5 * verified->compliances[l];
      load.largest_displacement = verified->largest_displacements[l];
      load.largest_stress = verified->largest_stresses[l].value;
    } else {
      load.strain_energy = 0.5 * load.compliance;
      load.displacement =
          loads.displacement(crisp.stiffness, crisp.mass, loads.position(static_cast<int>(l)));
      measure_cells(problem, outcome.crisp.fractions, load.displacement, load);
    }
  }
  return out;
}

}  // namespace flexmorph::cases
