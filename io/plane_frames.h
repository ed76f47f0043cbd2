#pragma once

#include <string>
#include <vector>

#include "geometry/base.h"

/// Pictures of mechanisms in the plane.
namespace flexmorph::io {

/// A deformed plate as a grid of cells. Point (i, j) has the index i (n_across + 1) + j, cell (i,
/// j) the index i n_across + j.
struct PlanePlate {
  int n_across = 1;             ///< Number of cells across the plate.
  std::vector<double> points;   ///< Positions of the points (2 n_points) [m].
  std::vector<double> density;  ///< Density of each cell, from 0 (white) to 1 (dark).
};

/// A snapshot of a mechanism.
struct PlaneFrame {
  std::string title;               ///< Title above the snapshot.
  std::vector<PlanePlate> plates;  ///< Deformed plates.

  /// Closed outlines of rigid bodies, drawn above the plates [m].
  std::vector<std::vector<Vec2>> outlines;
};

/// Returns an SVG page with the snapshots side by side, `columns` in a row. All have the same view
/// and scale, and a bar shows the scale in metres. Densities are averaged over areas of about 1/400
/// of the width of the picture and rounded to eighths.
/// @throws Error (input) when there is no snapshot, when points and cells of a plate do not fit,
///         and for numbers that are not finite.
std::string plane_frames_svg(const std::string& title, const std::vector<PlaneFrame>& frames,
                             int columns = 2);

}  // namespace flexmorph::io
