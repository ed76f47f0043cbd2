#pragma once

#include <functional>
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

struct CoupledMotion;

/// View of a design state at which responses are evaluated.
struct DesignView {
  const CellScaleFactors& factors;        ///< Scale factors of stiffness and mass of the cells.
  std::span<const Component> components;  ///< Components of the design.
  DesignState& state;                     ///< State under the loads, solved on demand.

  /// Body index in the coupled problem, with a motion that is computed on demand; null where there
  /// is no mechanism.
  const CoupledMotion* motion = nullptr;
};

/// A response of a design: its values, and their derivatives by the scale factors of the cells and
/// by the component parameters. It can be the objective or a constraint of a design problem, which
/// uses nothing else of it (optim/README.md, Design problem).
class Response {
 public:
  virtual ~Response() = default;
  /// Computes the values and their derivatives at a design.
  /// @param out  receives the result; it is the object that the last call has filled
  /// @throws Error (numerical) when the state cannot be solved.
  virtual void evaluate(const DesignView& at, Values& out) = 0;
};

/// A row of the table of responses: the properties of a response that are available before it is
/// created.
struct ResponseRow {
  std::string_view name;  ///< Name in case files.

  /// Word of case files for the way in which the response combines loads; empty if the response
  /// does not depend on loads.
  std::string_view loads = {};
  std::string_view words;      ///< Name in messages, as in "moment of inertia".
  std::string_view unit = {};  ///< Unit of the values; empty for pure numbers.

  /// True if the response has one value per load. A limit then bounds every value, and an objective
  /// needs one more variable, which bounds all values.
  bool per_load = false;
  /// Returns the value of the full domain, which is the unit of an objective. Null if there is no
  /// such value; the problem then uses the logarithm, because values span decades.
  double (*full)(const Plate&) = nullptr;
  /// True if the response depends only on the amount of material. A limit is then one of the
  /// volume.
  bool even = false;
  /// True if the response is a sum over the mass scale factors of the cells. Second derivatives are
  /// available for such responses and for responses that need the state.
  bool linear = false;
  /// True if the response is a number of the motion of the mechanism (motion_response.h), and true
  /// if this number belongs to one body of the mechanism.
  bool of_motion = false, of_body = false;
  /// Creates the response for a plate.
  std::function<std::unique_ptr<Response>(const Plate&)> make = {};

  /// Returns true if the response needs the state under the loads.
  bool needs_state() const { return !loads.empty(); }
  /// Returns true if the value is smaller where there is more material.
  bool falls_with_material() const { return needs_state() || of_motion; }
};

/// Creates a response from a plate, or without arguments if its class has no constructor from a
/// plate: a function for ResponseRow::make.
template <class Of>
std::unique_ptr<Response> make_response([[maybe_unused]] const Plate& plate) {
  if constexpr (std::is_constructible_v<Of, const Plate&>)
    return std::make_unique<Of>(plate);
  else
    return std::make_unique<Of>();
}

/// Returns all rows of the table. A new response is one file in optim/mmc/problem/responses/ and
/// its row in table.cpp there.
std::span<const ResponseRow* const> responses();
/// Adds a row to the table, see Registry::add(); key_of() distinguishes rows.
/// @throws Error (input) for a row without make().
void register_response(const ResponseRow& row);

/// Returns the row with a name. Where several rows combine loads, it is the row that combines them
/// in the way `loads`.
/// @returns null when there is none
const ResponseRow* find_response(std::string_view name, std::string_view loads);

/// Returns a name that identifies a row in the table: "mass", "compliance_worst".
std::string key_of(const ResponseRow& row);

}  // namespace flexmorph::mmc
