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

/// The plates and beams of a case, [[body]], and the point masses on them. A hub is a rigid frame
/// with prescribed motion that carries a body.
namespace flexmorph::cases {

/// Model of the material reservoir of a plate out of which material flows: none, a coil, or a rigid
/// rod behind the outlet.
enum class Reservoir { none, coil, rod };

/// Material flow through the root of a plate, and the mesh control that goes with it: lines of
/// nodes are inserted and removed (fem/README.md, Insertion and removal), or all lines move and the
/// mesh stays uniform (Uniform meshes).
struct Flow {
  double speed = 0;  ///< Rate at which material leaves the hub [m/s]; negative: it enters.
  Law length;        ///< Drive of the length outside of the hub [m]; `speed` is then 0.
  std::function<fem::Motion(double)> motion;  ///< The drive `length`; empty: constant speed.
  double longest = 0, shortest = 0;           ///< Extreme lengths of that drive over the run [m].
  bool uniform = false;  ///< True if all lines move and elements stay equally long.

  /// Upper limit of the element length [m]: longer boundary elements are split, and a uniform mesh
  /// has enough elements to keep the limit. 0: a uniform mesh has no limit.
  double max_length = 0;
  /// Lower limit of the element length [m]: shorter boundary elements are merged with their
  /// neighbours, and a uniform mesh that violates the limit is an error. 0: a uniform mesh has no
  /// limit.
  double min_length = 0;

  Reservoir reservoir = Reservoir::none;  ///< Model of the material reservoir.

  /// Location of the coil, or of the front end of the rod, in the axes of the body that carries the
  /// root [m]; absent: the outlet.
  std::optional<Vec2> reservoir_at;
  /// Length of the stored material at the start [m]; absent: the length that leaves until the body
  /// is longest.
  std::optional<double> reservoir_length;
};

/// An m-line of the mesh of a body that is not at its location in a uniform mesh, or is free: its
/// material coordinate is then an unknown (Eulerian coordinate).
struct BodyLine {
  int index = 0;             ///< Number of the m-line; 0 is the root.
  bool free = false;         ///< True if the line is free to move through the material.
  std::optional<double> at;  ///< Material coordinate at the start [m]; absent: uniform mesh.

  /// Limits of the length of the element at a free root line [m], at which lines of nodes are
  /// inserted and removed. By default there are no limits.
  double max_length = std::numeric_limits<double>::infinity(), min_length = 0;

  /// Returns true if lines of nodes are inserted and removed at this line.
  bool has_limits() const { return std::isfinite(max_length); }
};

/// Uniform temperature rise of a body above its unstressed state.
struct BodyHeat {
  double expansion = 0;  ///< Coefficient of thermal expansion [1/K].
  Law rise;              ///< Final temperature rise, or the drive of the temperature rise [K].
  std::string profile;   ///< Time profile of the rise; empty: constant, or given by a drive.
  double start = 0, duration = 0;  ///< Start and duration of the rise [s].

  /// Volume over which the elastic energy is integrated.
  fem::ThermalVolume volume = fem::ThermalVolume::grown;

  bool force = false;  ///< True if the thermal force Q_tk acts.
};

struct ElementRow;  // elements/row.h
struct Material;    // materials/material.h

/// A plate or a beam. Material coordinates: X from the root to the free end; Y across,
/// -width/2..width/2 in the plane and 0..width in space.
struct Body {
  std::string name;                 ///< Name by which joints, loads and tables refer to the body.
  const ElementRow* row = nullptr;  ///< Kind of element.
  std::string shape;                ///< Shape function set: "h16", "h12" or "q4".
  std::string space;                ///< Space of the body: "plane" (2 components) or "space" (3).
  std::vector<std::string> terms;   ///< Names of rows of the table of terms.
  double length = 0;                ///< Length outside of the hub at the start [m].

  /// Dimensions across the axis and across the surface of a plate [m]. Of a beam: height in the
  /// plane of the motion and width across it (`height` and `width` in the case).
  double width = 0, thickness = 0;

  /// Material from which numbers were taken; null if all of them are given.
  const Material* material = nullptr;
  double density = 0;                     ///< Density [kg/m^3].
  double youngs_modulus = 0;              ///< Young's modulus [Pa].
  double poisson_ratio = 0;               ///< Poisson's ratio [-].
  std::map<std::string, double> numbers;  ///< Numbers that the terms need, by key.
  std::array<int, 2> elements{1, 1};      ///< Elements along the length at the start, and across.
  double cell = 0;               ///< Cell length with shape set q4 [m]; 0: length of the elements.
  std::optional<Flow> flow;      ///< Material flow; absent: no material flows.
  std::vector<BodyLine> lines;   ///< Material lines given by the case, sorted by index.
  std::optional<Vec2> position;  ///< Middle of the root at the start, where given [m].
  double angle = 0;              ///< Angle of the axis at the start, with `position` [rad].
  double arc = 0;  ///< Angle of the circular arc that an undeformed beam forms [rad]; 0: straight.
  std::optional<BodyHeat> heat;  ///< Temperature rise; absent: the body is not heated.

  /// Returns the length outside of the hub at a time [m].
  double length_at(double time) const;
  /// Returns the length outside of the hub at a time, with rate and acceleration
  /// [m, m/s, m/s^2].
  fem::Motion length_motion(double time) const;
  /// Returns the largest length in [0, end], where `end` is the end of the run [m].
  double longest(double end) const;
  /// Returns the smallest length in [0, end], where `end` is the end of the run [m].
  double shortest(double end) const;
  /// Returns true if the elements are cells (shape set q4). With a moving root, the mesh lines in
  /// front of it have the material coordinates that they have when the body is longest.
  bool on_cells() const { return shape == "q4"; }
  /// Returns the length of a cell, or of an element at the start [m].
  double cell_length() const { return cell > 0 ? cell : length / elements[0]; }
  /// Returns true if positions have three components.
  bool in_space() const { return space == "space"; }
  /// Returns the number of position components, 2 or 3.
  int dim() const { return in_space() ? 3 : 2; }
  /// Returns the smallest material coordinate Y [m].
  double low() const { return in_space() ? 0 : -0.5 * width; }
  /// Returns the kind of body to which its terms must belong.
  fem::TermDomain term_domain() const;
  /// Returns true if the row of one of its terms satisfies a condition.
  template <class Condition>
  bool has_term(const Condition& condition) const {
    return std::any_of(terms.begin(), terms.end(),
                       [&](const std::string& name) { return condition(fem::term_row(name)); });
  }
  /// Returns a number that a term needs; 0 if none of its terms needs it.
  double number(const std::string& key) const {
    const auto found = numbers.find(key);
    return found == numbers.end() ? 0 : found->second;
  }
  /// Returns the length of material in the reservoir at the start [m]; 0 without a reservoir.
  /// @param end  end of the run [s]
  double reservoir_at_start(double end) const {
    if (!flow || flow->reservoir == Reservoir::none) return 0;
    return flow->reservoir_length.value_or(longest(end) - length);
  }
  /// Returns true if the material coordinate of a line is an unknown.
  bool has_eulerian_lines() const {
    return std::any_of(lines.begin(), lines.end(), [](const BodyLine& l) { return l.free; });
  }
  /// Returns true if lines of nodes are inserted and removed during the motion.
  bool mesh_changes() const {
    return (flow && !has_uniform_mesh()) || (!lines.empty() && lines.front().has_limits());
  }
  /// Returns true if all lines move with the length of the body, so that elements stay equally
  /// long. The lines of cells do not, because they keep their locations in the design.
  bool has_uniform_mesh() const { return flow && flow->uniform && !on_cells(); }
  /// Returns the material coordinates of the m-lines at the start (count + 1) [m].
  /// @param root   material coordinate of the first m-line [m]
  /// @param count  number of elements along the body
  std::vector<double> start_lines(double root, int count) const;
};

/// Lengths of the element at the moving root of a mesh of cells, in cells, at which a line is
/// inserted (longest) and removed (shortest). A line is inserted at its location in the design,
/// so that an element of 0.3 cells is left at the root.
inline constexpr double kLongestCell = 1.3, kShortestCell = 0.25;

/// A point mass on a plate or beam.
struct PointMass {
  std::string body;     ///< Name of the body.
  Vec2 point{0, 0};     ///< Material point [m].
  bool at_end = false;  ///< True if the case places it in the middle of the free end.
  double mass = 0;      ///< Mass [kg].
};

}  // namespace flexmorph::cases
