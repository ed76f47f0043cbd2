#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "cases/scene/scene.h"
#include "fem/element.h"

/// The shelf of elements: all that the program knows of a kind of [[body]] stands in one file of
/// this folder, and table.cpp lists it.
namespace flexmorph::cases {

/// Estimated operations of one element.
struct ElementOperations {
  double force = 0, tangent = 0;
};

/// A row of the table of elements.
struct ElementRow {
  const char* name;      ///< as cases say it: element = "ancf_plate"
  const char* sentence;  ///< what it is

  /// Reads the keys of its [[body]] that follow `element`, but for its place and its heat.
  /// @param has_density  without it the density does not matter: nothing moves and nothing weighs
  /// @throws Error (input) located in the file
  void (*read)(const io::Table& t, const Scene& scene, bool has_density, Body& body);
  /// How a joint that welds an edge of it holds that edge.
  fem::WeldMode (*read_weld)(const io::Table& joint);
  /// @param end    of the run: the lines of growing bodies are numbered for it [s]
  /// @param count  elements along and across
  std::unique_ptr<fem::Element> (*make)(const Body& body, double end,
                                        const std::array<int, 2>& count);
  ElementOperations (*operations)(const Body& body, const fem::Element& element);

  fem::TermPlace in_plane = fem::TermPlace::plane;  ///< where its terms stand; in space: `space`
  const char* term = "a term";                      ///< what messages call one of them
  const char* thinnest = "thickness";               ///< the key of the length that makes it thin
  bool across = true;                               ///< are elements counted across its axis, too?
  bool lines = true;           ///< does it have material lines, of hubs, sleeves and [[body.line]]?
  bool spreads = true;         ///< are there loads on its edges and its surface?
  bool designable = true;      ///< may it have a [[design]]?
  bool thermal_force = false;  ///< is body.heat.force true unless said?
  std::array<int, 2> drawn{4, 4};  ///< quads along and across one element in pictures
  bool draws_strain = false;       ///< is its elastic strain written beside the energy?
};

/// All rows, in the order in which messages list them.
std::span<const ElementRow* const> element_rows();
/// Returns the row of this name; null where there is none.
const ElementRow* find_element(std::string_view name);
/// Adds a row, see Registry::add(). Keys that it reads are declared with io::key().
void register_element(const ElementRow& row);

}  // namespace flexmorph::cases
