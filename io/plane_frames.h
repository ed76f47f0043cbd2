#pragma once

#include <string>
#include <vector>

#include "geometry/base.h"

/// Pictures of mechanisms in the plane.
namespace flexmorph::io {

/// A deformed plate as a grid of cells: point (i, j) is number i (n_across + 1) + j, cell (i, j)
/// number i n_across + j.
struct PlanePlate {
  int n_across = 1;             ///< cells across
  std::vector<double> points;   ///< (2 n_points) [m]
  std::vector<double> density;  ///< per cell, 0 (white) to 1 (dark)
};

/// A mechanism at one moment.
struct PlaneFrame {
  std::string title;
  std::vector<PlanePlate> plates;
  std::vector<std::vector<Vec2>> outlines;  ///< of rigid bodies: closed, on top of the plates [m]
};

/// The frames side by side, `columns` in a row, all in the same view and to the same scale, with a
/// bar that says how long so many metres are. Densities are averaged over about a thousandth of
/// the picture, in steps of an eighth.
/// @throws Error (input) when there is no frame, when a plate's points and cells do not fit, and
///         for numbers that are not finite.
std::string plane_frames_svg(const std::string& title, const std::vector<PlaneFrame>& frames,
                             int columns = 2);

}  // namespace flexmorph::io
