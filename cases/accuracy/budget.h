#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

/// Which levels of which ladders a budget of time allows.
namespace flexmorph::cases {

/// "120s", "2min", "1.5h", or a number of seconds. @throws Error (input).
double read_budget(const std::string& text);

/// Seconds that may be spent, by a clock [s].
class Budget {
 public:
  Budget(double seconds, std::function<double()> clock);
  double total() const { return total_; }
  double left() const;

 private:
  double total_, begin_;
  std::function<double()> clock_;
};

/// The levels of one ladder in their order, and what those took that were measured.
struct Track {
  std::vector<double> h;                       ///< coarse to fine; relative, the case itself is 1
  std::vector<std::optional<double>> seconds;  ///< measured [s]
  std::vector<bool> closed;                    ///< not to be measured: refused, failed, or done
  double cost_exponent = 1;  ///< time ~ h^-cost_exponent, until levels say otherwise
  double weight = 1;         ///< of its seconds, where ladders compete
  double first_guess = 0;    ///< at h = 1, where nothing was measured yet [s]

  /// Seconds that a level will take: the power law through its two nearest measured ones, its
  /// exponent within a factor 2 of `cost_exponent`.
  double predicted(size_t level) const;
  /// The coarsest level that is open.
  std::optional<size_t> next() const;
};

/// Ladders with so many levels wait for those with fewer.
inline constexpr size_t kEnoughLevels = 5;

/// The next level to measure: of all ladders' coarsest open levels that with the shortest
/// predicted time, times the weight of its ladder, doubled for every level beyond kEnoughLevels.
/// Levels that would take more than `left` are closed, and all finer ones of their
/// ladder: `cut` hears of each.
/// @return ladder and level; nothing when all are closed
std::optional<std::pair<size_t, size_t>> next_level(
    std::vector<Track>& tracks, double left,
    const std::function<void(size_t track, size_t level)>& cut);

}  // namespace flexmorph::cases
