#pragma once

#include <string>
#include <vector>

#include "geometry/components/outline.h"
#include "geometry/disc.h"

/// A static scene, which consists of one plate: [domain], [[support]], [[load]].
namespace flexmorph::cases {

/// A location where a static plate is supported or loaded.
struct NodeRegion {
  /// Kind of a location: an edge of the bounding box, a point, or the nodes in a box or disc.
  enum class Kind { edge, point, box, disc };
  Kind kind = Kind::point;  ///< Kind of this location.

  /// Bounding box of the location [m]; it has no width for an edge, and no size for a point.
  Box box;

  /// Disc of Kind::disc [m]: it stands for the rim of a bore that it matches, otherwise for all
  /// nodes inside.
  Disc disc;
};

/// A support of a static plate.
struct PlaneSupport {
  NodeRegion location;        ///< Location of the supported nodes.
  bool x = false, y = false;  ///< True if displacements in x (in y) are held at zero.
};

/// A force and a moment on a static plate.
struct PlaneForce {
  NodeRegion location;   ///< Location of the loaded nodes.
  Vec2 force{0, 0};      ///< Resultant force [N].
  double moment = 0;     ///< Moment about the middle of the location, counterclockwise [N m].
  bool bearing = false;  ///< True if a pin presses on half of a bore; false: evenly spread force.
};

/// A set of forces that act at the same time.
struct StaticLoadCase {
  std::string name;                ///< Name of the load case in tables.
  double weight = 1;               ///< Weight of its compliance in the sum [-].
  std::vector<PlaneForce> forces;  ///< Forces of the load case.
};

/// The plate of a static scene, which takes the place of moving bodies.
struct Domain {
  std::string name;                    ///< Name of the plate in file names.
  Box bounds;                          ///< Bounding box, which the design mesh covers [m].
  Region shape;                        ///< Shape of the plate [m]; no outer ring: all of `bounds`.
  bool is_drawn = false;               ///< True if the shape was read from a drawing.
  double thickness = 1;                ///< Thickness of the plate [m].
  double youngs_modulus = 1;           ///< Young's modulus [Pa].
  double poisson_ratio = 0.3;          ///< Poisson's ratio [-].
  double density = 0;                  ///< Density [kg/m^3]; 0: neither mass nor weight is defined.
  std::vector<PlaneSupport> supports;  ///< Supports of the plate.
  std::vector<StaticLoadCase> loads;   ///< Load cases of the plate.
};

}  // namespace flexmorph::cases
