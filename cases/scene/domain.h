#pragma once

#include <string>
#include <vector>

#include "geometry/components/outline.h"
#include "geometry/disc.h"

/// [domain], [[support]], [[load]]: a plate at rest.
namespace flexmorph::cases {

/// Where a plate at rest is held or pulled.
struct Place {
  enum class Kind { edge, point, box, disc };
  Kind kind = Kind::point;
  Box box;    ///< an edge is a box without width; of a disc the box around it [m]
  Disc disc;  ///< of its kind: the rim of a bore that it matches, otherwise all within
};

struct PlaneSupport {
  Place place;
  bool x = false, y = false;  ///< held directions
};

/// A force and a moment on a place.
struct PlaneForce {
  Place place;
  Vec2 force{0, 0};      ///< in all [N]
  double moment = 0;     ///< in all, counterclockwise [N m]
  bool bearing = false;  ///< whether a pin presses the force on half of a bore, else it is even
};

/// Forces that act at the same time.
struct LoadCase {
  std::string name;
  double weight = 1;
  std::vector<PlaneForce> forces;
};

/// A plate at rest: what a static scene has instead of bodies that move.
struct Domain {
  std::string name;
  Box bounds;                 ///< of the design mesh [m]
  Region shape;               ///< the domain within; without an outer ring: all of it
  double thickness = 1;       ///< [m]
  double youngs_modulus = 1;  ///< [Pa]
  double poisson_ratio = 0.3;
  double density = 0;  ///< [kg/m^3], 0: it has none, and no mass
  std::vector<PlaneSupport> supports;
  std::vector<LoadCase> loads;
};

}  // namespace flexmorph::cases
