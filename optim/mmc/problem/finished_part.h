#pragma once

#include <optional>
#include <span>
#include <vector>

#include "optim/mmc/problem/body_problem.h"

/// The part that a design stands for: what is exported, verified and moved.
namespace flexmorph::mmc {

/// The outline of a part.
struct FinishedPart {
  std::vector<Region> regions;
  int widened = 0;         ///< narrow places that were widened
  bool has_widths = true;  ///< false: too narrow in too many places to be smoothed and widened
};

/// Returns the part that a design stands for: BodyProblem::part, or the union of its components
/// with fillets. Where that is narrower than asked for, discs of the width asked for widen it, and
/// its outlines are smoothed. Components that are narrower themselves in more than six places, or
/// by more than half, have not come to their widths: the part stays as it is. Material that fills a
/// gap between components may have any width before. The part of a symmetric design is its own
/// mirror image. Without fillets the part is the union.
/// @param tolerance  how far sides may be off the true outlines [m]
/// @throws Error (numerical) from unite() and with_fillets()
FinishedPart finished_part(const BodyProblem& problem, std::span<const Component> components,
                           double tolerance);
/// Returns the regions of finished_part().
std::vector<Region> part_of(const BodyProblem& problem, std::span<const Component> components,
                            double tolerance);
/// Returns the part within kOutlineTolerance cells; nothing where the part is the union of the
/// components and that cannot be computed.
/// @throws Error (numerical) from with_fillets(), and from unite() where the part has fillets
std::optional<FinishedPart> part_where_united(const BodyProblem& problem,
                                              std::span<const Component> components);

/// Returns the area fractions of a part (n_cells): 0 outside of the domain, 1 in the bores. Without
/// fillets, and without a drawn part, they are fractions_of() the components.
VectorXd part_fractions(const BodyProblem& problem, std::span<const Component> components);
/// Returns the same of a part that is known.
VectorXd part_fractions(const BodyProblem& problem, std::span<const Component> components,
                        const FinishedPart& part);

}  // namespace flexmorph::mmc
