#pragma once

#include <optional>
#include <span>
#include <vector>

#include "optim/mmc/problem/body_problem.h"

/// The finished part of a design: the geometry that is exported, verified and used in motions.
namespace flexmorph::mmc {

/// The outline of a finished part.
struct FinishedPart {
  std::vector<Region> regions;  ///< Connected regions of material with their holes [m].
  int widened = 0;              ///< Number of discs that widen violations of the minimum width.

  /// False if the components violate the minimum width so much that the part was neither widened
  /// nor smoothed.
  bool has_widths = true;
};

/// Returns the finished part of a design: BodyProblem::part, or the union of its components with
/// fillets. Where it is narrower than BodyProblem::widths, discs of slightly more than that width
/// are added, and then its outlines are smoothed. If the components themselves are narrower at more
/// than six locations, or by more than half, the part is neither widened nor smoothed. Material
/// that fills a gap between components does not count in this test. The part of a symmetric design
/// is its own mirror image. Without fillets the part is the union of the components.
/// @param tolerance  largest distance of the sides from the exact outlines [m]
/// @throws Error (numerical) from unite() and with_fillets()
FinishedPart finished_part(const BodyProblem& problem, std::span<const Component> components,
                           double tolerance);
/// Returns the regions of finished_part().
std::vector<Region> part_of(const BodyProblem& problem, std::span<const Component> components,
                            double tolerance);
/// Returns the finished part with a tolerance of kOutlineTolerance cells; nothing where the part is
/// the union of the components and this union cannot be computed.
/// @throws Error (numerical) from with_fillets(), and from unite() where the part has fillets
std::optional<FinishedPart> part_where_united(const BodyProblem& problem,
                                              std::span<const Component> components);

/// Returns the area fractions of the finished part (n_cells): 0 outside of the domain, 1 in the
/// bores. Without fillets and without BodyProblem::part they are fractions_of() the components.
VectorXd part_fractions(const BodyProblem& problem, std::span<const Component> components);
/// Returns the area fractions (n_cells) of a finished part that has been computed before.
VectorXd part_fractions(const BodyProblem& problem, std::span<const Component> components,
                        const FinishedPart& part);

}  // namespace flexmorph::mmc
