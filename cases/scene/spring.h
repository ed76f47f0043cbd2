#pragma once

#include <string>

#include "cases/scene/rigid_body.h"

/// [[spring]].
namespace flexmorph::cases {

/// Spring and damper between two anchors: along the line between them, or between their axes.
struct Spring {
  std::string name;
  bool torsion = false;
  Anchor a, b;
  double stiffness = 0, damping = 0;  ///< [N/m], [N s/m]; torsion: [N m/rad], [N m s/rad]
  double rest = 0;                    ///< length [m] or angle [rad] without force
};

}  // namespace flexmorph::cases
