#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "geometry/components/component.h"
#include "optim/mmc/problem/design_state.h"
#include "optim/mmc/problem/ersatz.h"
#include "optim/mmc/problem/plate.h"

namespace flexmorph::mmc {

struct MotionSeat;

/// A design as responses see it.
struct Seen {
  const CellFactors& factors;
  std::span<const Component> components;
  DesignState& state;                  ///< solved when asked
  const MotionSeat* motion = nullptr;  ///< moved when asked, where there is a mechanism
};

/// What makes a design good or allowed: its values, and their derivatives by the factors of the
/// cells and by components. Nothing else is known of a response; a design problem is a list of
/// them (optim/README.md, Design problem).
class Response {
 public:
  virtual ~Response() = default;
  /// @param out  as it was left by the last call
  /// @throws Error (numerical) when the state cannot be solved.
  virtual void evaluate(const Seen& at, Values& out) = 0;
};

/// A row of the table: what there is to know about a response before it is made.
struct ResponseRow {
  std::string_view name;        ///< as cases say it
  std::string_view loads = {};  ///< how it puts loads together, as cases say it; empty: it has none
  std::string_view words;       ///< "moment of inertia"
  std::string_view unit = {};   ///< of its values; empty: a pure number
  /// Has it a value per load? A limit is one on each of them; as an objective it asks for one more
  /// variable, which bounds them all.
  bool per_load = false;
  /// Value when all of the domain is full, and the unit of an objective. Null: there is none, and
  /// the logarithm is taken, because values span decades.
  double (*full)(const Plate&) = nullptr;
  bool even = false;  ///< Does every piece of material count alike, so that a limit is a volume?
  /// Is it a sum over the mass factors of cells? Second derivatives of others are not known, but
  /// for those that need a state.
  bool linear = false;
  /// Is it a number of the motion of the mechanism (motion_response.h)? And of this body of it?
  bool of_motion = false, of_body = false;
  std::unique_ptr<Response> (*make)(const Plate&) = nullptr;

  bool needs_state() const { return !loads.empty(); }
  /// Is it less where there is more material?
  bool falls_with_material() const { return needs_state() || of_motion; }
};

/// What `make` is of a response that is made of a plate, or of nothing.
template <class Of>
std::unique_ptr<Response> make_response([[maybe_unused]] const Plate& plate) {
  if constexpr (std::is_constructible_v<Of, const Plate&>)
    return std::make_unique<Of>(plate);
  else
    return std::make_unique<Of>();
}

/// All rows. A new one is one file in optim/mmc/problem/responses/ and its row in table.cpp there.
std::span<const ResponseRow* const> responses();
/// Adds a row, see Registry::add(); key_of() tells it from others.
void register_response(const ResponseRow& row);

/// The row of this name. Of rows that put loads together, the one that does it like that.
/// @return null when there is none
const ResponseRow* find_response(std::string_view name, std::string_view loads);

/// What a row is called where each needs a name of its own: "mass", "compliance_worst".
std::string key_of(const ResponseRow& row);

}  // namespace flexmorph::mmc
