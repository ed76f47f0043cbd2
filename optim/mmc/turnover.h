#pragma once

#include <string>
#include <vector>

#include "geometry/tdf.h"
#include "optim/mmc/ersatz.h"

namespace flexmorph::mmc {

/// A change of the list of components while a design is made.
struct ComponentEvent {
  enum class Kind {
    outside,  ///< dropped: it lay outside of the domain
    hidden,   ///< dropped: it lay under others
    split,    ///< made two of one, in place of a dropped one
    restored  ///< an earlier design, with its components, was the best one
  };
  Kind kind = Kind::hidden;
  int component = 0;     ///< its place in the list before the change, from 0
  int n_components = 0;  ///< after it
};
std::string to_string(ComponentEvent::Kind kind);

/// Two components that are one, cut in the middle: the same profile, each reaching over the middle
/// by a tenth of the half-length.
std::vector<Component> split(const Component& c, double min_half_thickness);

/// Finds components that leave a design without a trace: outside of the domain, or under others.
/// Their derivatives vanish; they only make the design problem larger.
class Turnover {
 public:
  /// @param min_half_length  of the halves of a component that is split; 0: none is split
  /// @param images  of symmetric designs (Design): so many blocks of components are one another's
  ///                images, and go or are split together
  Turnover(const Grid& grid, const TdfSettings& tdf, const Ersatz& ersatz, double min_half_length,
           size_t images = 1);

  /// One look at a design. A component goes when it was dead at the last look as well: a passing
  /// overlap is no death.
  /// @return is there something to change? Then next() and events() say what.
  bool look(const std::vector<Component>& components);

  const std::vector<Component>& next() const { return next_; }
  const std::vector<ComponentEvent>& events() const { return events_; }

 private:
  /// A component and its images.
  using Group = std::vector<Component>;
  bool outside(const Group& group);
  bool hidden(size_t c, const std::vector<double>& influence);
  void drop(std::vector<int>& places, const std::vector<bool>& suspects);
  void refill(size_t count);
  std::vector<Component> listed(const std::vector<Group>& groups) const;

  UnionTdf tdf_;
  std::vector<signed char> shaped_;
  double min_half_length_;
  size_t images_;
  std::vector<Group> groups_;  // of next_
  std::vector<bool> dead_;     // at the last look
  std::vector<Component> next_;
  std::vector<ComponentEvent> events_;
};

}  // namespace flexmorph::mmc
