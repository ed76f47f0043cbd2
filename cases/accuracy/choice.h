#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

/// Which levels together are the cheapest for a promised error.
namespace flexmorph::cases {

/// A level of a group of knobs as it may be recommended.
struct Candidate {
  std::string name;
  std::vector<std::string> overrides;
  std::vector<double> errors;  ///< of each quantity, relative; 0 where the group does not touch it
  std::vector<double> costs;   ///< of each part, in times of the case itself
};

/// Knobs of which one level is taken.
struct Group {
  std::string name;
  std::vector<Candidate> candidates;
};

struct Choice {
  std::vector<size_t> picked;  ///< a candidate of each group
  std::vector<double> errors;  ///< of each quantity: sum over groups, and what is uncertain anyway
  double cost = 0;             ///< [s]
};

/// Candidates that no other one of the group beats or equals in all errors and costs; of equal ones
/// the first.
std::vector<size_t> undominated(const std::vector<Candidate>& candidates);

/// The cheapest choice with Σ errors + uncertainty <= promise for each quantity, where the cost is
/// Σ over parts of base cost times the ratios of all groups. Candidates whose errors or costs are
/// not finite are passed over; of equal costs the smaller error wins.
/// @return nothing where no choice keeps the promise
std::optional<Choice> cheapest(const std::vector<Group>& groups, std::span<const double> base_costs,
                               std::span<const double> uncertainties, double promise);

/// Places of the points that no other point beats or equals in cost and error, by rising cost.
/// Points that are not finite are passed over.
std::vector<size_t> pareto_front(std::span<const std::pair<double, double>> cost_and_error);

}  // namespace flexmorph::cases
