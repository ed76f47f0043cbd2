#include "cases/accuracy/choice.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace flexmorph::cases {
namespace {

bool finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

bool no_worse(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) { return x <= y; });
}

/// Depth-first over the groups; branches that cannot keep the promise are left at once.
class Search {
 public:
  Search(const std::vector<Group>& groups, std::span<const double> base_costs,
         std::span<const double> uncertainties, double promise)
      : groups_(groups), promise_(promise) {
    for (const Group& g : groups) order_.push_back(undominated(g.candidates));
    now_.errors.assign(uncertainties.begin(), uncertainties.end());
    go(0, {base_costs.begin(), base_costs.end()});
  }
  const std::optional<Choice>& best() const { return best_; }

 private:
  void go(size_t depth, const std::vector<double>& costs) {
    for (const double error : now_.errors)
      if (!(error <= promise_)) return;
    if (depth == groups_.size()) return finish(costs);
    for (const size_t k : order_[depth]) {
      const Candidate& candidate = groups_[depth].candidates[k];
      std::vector<double> next = costs;
      for (size_t p = 0; p < next.size(); ++p) next[p] *= candidate.costs[p];
      const std::vector<double> before = now_.errors;
      for (size_t q = 0; q < now_.errors.size(); ++q) now_.errors[q] += candidate.errors[q];
      now_.picked.push_back(k);
      go(depth + 1, next);
      now_.picked.pop_back();
      now_.errors = before;
    }
  }
  void finish(const std::vector<double>& costs) {
    now_.cost = std::accumulate(costs.begin(), costs.end(), 0.0);
    const auto worst = [](const Choice& c) {
      return c.errors.empty() ? 0 : *std::max_element(c.errors.begin(), c.errors.end());
    };
    if (best_ &&
        (now_.cost > best_->cost || (now_.cost == best_->cost && worst(now_) >= worst(*best_))))
      return;
    best_ = now_;
  }

  const std::vector<Group>& groups_;
  double promise_;
  std::vector<std::vector<size_t>> order_;
  Choice now_;
  std::optional<Choice> best_;
};

}  // namespace

std::vector<size_t> undominated(const std::vector<Candidate>& candidates) {
  std::vector<size_t> out;
  for (size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& c = candidates[i];
    if (!finite(c.errors) || !finite(c.costs)) continue;
    bool beaten = false;
    for (size_t j = 0; j < candidates.size() && !beaten; ++j) {
      const Candidate& other = candidates[j];
      if (j == i || !finite(other.errors) || !finite(other.costs)) continue;
      const bool better = no_worse(other.errors, c.errors) && no_worse(other.costs, c.costs);
      const bool equal = other.errors == c.errors && other.costs == c.costs;
      beaten = better && (!equal || j < i);
    }
    if (!beaten) out.push_back(i);
  }
  return out;
}

std::optional<Choice> cheapest(const std::vector<Group>& groups, std::span<const double> base_costs,
                               std::span<const double> uncertainties, double promise) {
  return Search(groups, base_costs, uncertainties, promise).best();
}

std::vector<size_t> pareto_front(std::span<const std::pair<double, double>> points) {
  std::vector<size_t> order;
  for (size_t i = 0; i < points.size(); ++i)
    if (std::isfinite(points[i].first) && std::isfinite(points[i].second)) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return points[a] < points[b]; });
  std::vector<size_t> out;
  for (const size_t i : order)
    if (out.empty() || points[i].second < points[out.back()].second) out.push_back(i);
  return out;
}

}  // namespace flexmorph::cases
