#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "cases/scene/scene.h"
#include "fem/element.h"

/// The table of elements: everything that is specific to one kind of [[body]] is in one file of
/// this folder, and table.cpp lists all kinds.
namespace flexmorph::cases {

/// Estimated floating point operations of one element.
struct ElementOperations {
  double force = 0, tangent = 0;  ///< Operations of one evaluation of the force (of the tangent).
};

/// A row of the table of elements.
struct ElementRow {
  const char* name;      ///< Name in case files: element = "ancf_plate".
  const char* sentence;  ///< Sentence that describes the element.

  /// Reads the keys of a [[body]] of this kind, except its name, element, position and heat.
  /// @param has_density  false in a static analysis without gravity: the density then has no effect
  ///                     and may be missing
  /// @throws Error (input) located in the file
  void (*read)(const io::Table& t, const Scene& scene, bool has_density, Body& body);
  /// Reads which components a joint keeps at a welded edge of the body.
  fem::WeldMode (*read_weld)(const io::Table& joint);
  /// Creates the finite elements of a body.
  /// @param end    end of the run [s]: material coordinates of a body with material flow refer to
  ///               its largest length in [0, end]
  /// @param count  number of elements along and across
  std::unique_ptr<fem::Element> (*make)(const Body& body, double end,
                                        const std::array<int, 2>& count);
  /// Returns the estimated operations of one element of a body.
  ElementOperations (*operations)(const Body& body, const fem::Element& element);

  fem::TermDomain in_plane = fem::TermDomain::plane;  ///< Kind of its terms in the plane.
  const char* term = "a term";                        ///< Noun for one of its terms in messages.
  const char* thinnest = "thickness";  ///< Key of the smallest dimension of the body.
  bool across = true;                  ///< True if elements are counted across the axis, too.

  /// True if it has material lines, which hubs, sleeves and [[body.line]] need.
  bool lines = true;

  bool spreads = true;             ///< True if loads may act on its edges and its surface.
  bool designable = true;          ///< True if it may have a [[design]].
  bool thermal_force = false;      ///< Default of the key `force` of [body.heat].
  std::array<int, 2> drawn{4, 4};  ///< Quads along and across one element in pictures.
  bool draws_strain = false;       ///< True if the elastic strain is written with the energy.
};

/// Returns all rows, in the order in which messages list them.
std::span<const ElementRow* const> element_rows();
/// Returns the row of this name; null where there is none.
const ElementRow* find_element(std::string_view name);
/// Adds a row to the table of elements, see Registry::add(). The row declares the keys that it
/// reads with io::key().
/// @throws Error (input) if a function of the row is missing, or for a name that is taken
void register_element(const ElementRow& row);

}  // namespace flexmorph::cases
