#pragma once

#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "optim/mmc/body_problem.h"

namespace flexmorph::mmc {

/// A design that is being mended: its components, and what there is to say about them.
class UnderRepair {
 public:
  /// @param go_on  asked between the steps of a repair, which may take a minute together; empty:
  ///               it does
  UnderRepair(const BodyProblem& problem, ComplianceEvaluator& loads, const Widths& wanted,
              std::function<bool()> go_on = {});

  bool goes_on() const { return !go_on_ || go_on_(); }

  const BodyProblem& problem() const { return problem_; }
  const Widths& wanted() const { return wanted_; }

  std::vector<Component> parts;
  std::vector<bool> patch;  ///< was the part put there by a repair?

  std::vector<Component> less(size_t k) const;  ///< all parts but one
  void drop(size_t k);

  /// Exact union. Lists that were asked for last are known: questions come in a row.
  std::vector<Region> regions(const std::vector<Component>& of) const;
  /// Area fractions of cells.
  VectorXd fractions(const std::vector<Component>& of) const;
  double volume(const std::vector<Component>& of) const;  ///< sharp, a part of the domain
  double compliance(const std::vector<Component>& of) const;
  /// Compliance times volume of the sharp design; infinite when it has come apart into more pieces
  /// than at the last count_islands(). (Cells do not see slits; what a piece carries through one
  /// counts for nothing.)
  /// @param below  a merit that is no less than this may come back infinite
  double merit(const std::vector<Component>& of,
               double below = std::numeric_limits<double>::infinity()) const;
  void count_islands();
  /// A bound of merit(less(k)) from below, without a state: compliance is convex in the stiffness
  /// of cells, and first-order in what the part has alone. As of the last look_at_energy().
  double least_merit_without(size_t k) const;

  /// Narrow material and gaps, and slits between pieces that should be one.
  std::vector<NarrowPlace> places() const;
  /// Gaps wide enough, but closed by their partly filled cells: without those the design would be
  /// softer; and gaps to what holds it that would make it stiffer when closed. As of the last
  /// look_at_energy().
  std::vector<NarrowPlace> torn_gaps() const;
  /// Of these the gaps to what holds it. What they cut off seems idle.
  std::vector<NarrowPlace> cuts_from_held() const;
  /// The narrowest as a part of what is wanted, of gaps that are wide enough more than 1; infinite
  /// for none.
  double smallest(const std::vector<NarrowPlace>& narrow) const;

  /// Energy of full material in every cell by the mean one of the design (n_cells), as it was at
  /// the last look_at_energy().
  const VectorXd& density() const { return density_; }
  void look_at_energy();
  /// Of so many loads at most, evenly taken (2 n_nodes each) [m].
  std::vector<VectorXd> displacements(int most) const;

 private:
  bool looks_torn(const NarrowPlace& p) const;
  double compliance_cut_at(const NarrowPlace& p) const;
  double compliance_filled_at(const NarrowPlace& p) const;
  bool ends_at_held(const NarrowPlace& p) const;
  /// @param whole  compliance as it is
  bool is_cut_from_held(const NarrowPlace& p, double whole) const;
  std::vector<int> cells_around(const NarrowPlace& p) const;
  std::vector<int> cells_between(const NarrowPlace& p) const;

  /// What is known of a list of components.
  struct Known {
    std::vector<Component> of;
    std::optional<std::vector<Region>> regions;
    std::optional<VectorXd> fractions;
  };
  Known& known(const std::vector<Component>& of) const;

  const BodyProblem& problem_;
  ComplianceEvaluator& loads_;
  std::function<bool()> go_on_;
  mutable std::deque<Known> known_;  // newest first
  Widths wanted_;
  Ersatz ersatz_;
  int islands_ = 0;
  double compliance_ = 0;         // at the last look
  VectorXd fractions_, density_;  // likewise
};

}  // namespace flexmorph::mmc
