#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cases/scene/drive.h"
#include "fem/heat.h"
#include "fem/terms.h"

/// [[body]], and the masses on it.
namespace flexmorph::cases {

/// Where material of a growing plate is before it leaves: nowhere, on a coil, or in a rigid rod
/// behind the outlet.
enum class Stored { none, coil, rod };

/// Material that leaves the hub, and what the mesh does then: lines of nodes come and go
/// (fem/README.md, Insertion and removal), or all of them move (there, Even meshes).
struct Flow {
  double speed = 0;  ///< rate at which material leaves the hub [m/s]; negative: enters it
  Law length;        ///< or the drive of the length outside of the hub; `speed` is 0 then
  std::function<fem::Motion(double)> motion;  ///< that drive; empty: constant speed
  double longest = 0, shortest = 0;           ///< with that drive: over the run [m]
  bool even = false;                          ///< all lines move, and elements stay equal
  /// No element is longer: boundary elements are split, of an even mesh there are as many elements
  /// as that takes [m]; 0: there is no limit, of an even mesh.
  double max_length = 0;
  /// No element is shorter: boundary elements are merged with their neighbours, an even mesh is
  /// refused [m]; 0: there is no limit, of an even mesh.
  double min_length = 0;
  Stored stored = Stored::none;
  std::optional<Vec2> stored_at;        ///< in the axes of the carrier; none: the outlet [m]
  std::optional<double> stored_length;  ///< at the start; none: what leaves until the longest [m]
};

/// An m-line of a body's mesh that is not where an even mesh has it, or is free to move through the
/// material.
struct BodyLine {
  int index = 0;  ///< 0 is the root
  bool free = false;
  std::optional<double> at;  ///< material coordinate at the start [m]
  /// Of a free root line: limits of the element next to it, as those of a Flow; none by default.
  double max_length = std::numeric_limits<double>::infinity(), min_length = 0;
  bool has_limits() const { return std::isfinite(max_length); }
};

/// Uniform heat of a body: what it is warmer than without stress.
struct BodyHeat {
  double expansion = 0;          ///< [1/K]
  Law rise;                      ///< [K]: in the end, or at all times where a drive says it
  std::string profile;           ///< of the rise in time; empty: constant, or a drive
  double start = 0, settle = 0;  ///< the rise begins, and how long it takes [s]
  fem::ThermalVolume volume = fem::ThermalVolume::grown;
  bool force = false;  ///< the thermal force Q_tk acts
};

struct ElementRow;  // elements/row.h

/// A plate or a beam. Material coordinates: X from the root to the free end; Y across,
/// -width/2..width/2 in the plane and 0..width in space.
struct Body {
  std::string name;
  const ElementRow* row = nullptr;  ///< of the table of elements
  std::string shape;                ///< shape set: "h16", "h12"
  std::string space;                ///< "plane" or "space": two or three components
  std::vector<std::string> terms;   ///< rows of the table of terms
  double length = 0;                ///< at the start [m]
  /// Across the axis, and across the surface [m]. Of a beam (in the case: `height` and `width`): in
  /// the plane of the motion, and across it.
  double width = 0, thickness = 0;
  double density = 0;                     ///< [kg/m^3]
  double youngs_modulus = 0;              ///< [Pa]
  double poisson_ratio = 0;               ///< [-]
  std::map<std::string, double> numbers;  ///< that its terms read, by key
  std::array<int, 2> elements{1, 1};      ///< along the length at the start, across the width
  double cell = 0;           ///< of the shape set q4: length of its cells [m]; 0: of its elements
  std::optional<Flow> flow;  ///< absent: no material flows
  std::vector<BodyLine> lines;   ///< by index
  std::optional<Vec2> position;  ///< of the middle of the root at the start, where given [m]
  double angle = 0;              ///< of its axis, with `position` [rad]
  double arc = 0;  ///< angle that the axis of an undeformed beam turns by, an arc of a circle [rad]
  std::optional<BodyHeat> heat;  ///< absent: cold

  double length_at(double time) const;
  fem::Motion length_motion(double time) const;
  double longest(double end) const;   ///< in [0, end], the time of the run
  double shortest(double end) const;  ///< likewise
  /// Are its elements cells? Those in front of a root that moves lie where they lie when the body
  /// is longest.
  bool on_cells() const { return shape == "q4"; }
  double cell_length() const { return cell > 0 ? cell : length / elements[0]; }
  bool in_space() const { return space == "space"; }
  int dim() const { return in_space() ? 3 : 2; }
  double low() const { return in_space() ? 0 : -0.5 * width; }  ///< where Y begins [m]
  fem::TermPlace place() const;                                 ///< of its terms
  /// Has it a term of which that is so?
  template <class Condition>
  bool has_term(const Condition& condition) const {
    return std::any_of(terms.begin(), terms.end(),
                       [&](const std::string& name) { return condition(fem::term_row(name)); });
  }
  /// A number that a term reads; 0 where none of its terms does.
  double number(const std::string& key) const {
    const auto found = numbers.find(key);
    return found == numbers.end() ? 0 : found->second;
  }
  /// What is stored at the start [m]; 0 where nothing says that anything is.
  double stored_at_start(double end) const {
    if (!flow || flow->stored == Stored::none) return 0;
    return flow->stored_length.value_or(longest(end) - length);
  }
  bool has_free_lines() const {
    return std::any_of(lines.begin(), lines.end(), [](const BodyLine& l) { return l.free; });
  }
  /// Do lines of nodes come and go?
  bool mesh_changes() const {
    return (flow && !is_even()) || (!lines.empty() && lines.front().has_limits());
  }
  /// Do all its lines move with its length, so that its elements stay equal? Not those of cells,
  /// which lie where they lie in the design.
  bool is_even() const { return flow && flow->even && !on_cells(); }
  /// Material coordinates of the m-lines at the start, the first at `root` [m].
  std::vector<double> start_lines(double root, int count) const;
};

/// Of a mesh of cells: length of the element at a moving root, in cells, when a line comes or goes.
/// A line comes where it lies in the design, so that 0.3 of a cell is left at the root.
inline constexpr double kLongestCell = 1.3, kShortestCell = 0.25;

struct PointMass {
  std::string body;
  Vec2 point{0, 0};     ///< material [m]
  bool at_end = false;  ///< is it said to be in the middle of the free end?
  double mass = 0;      ///< [kg]
};

}  // namespace flexmorph::cases
