#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "geometry/components/component.h"
#include "geometry/grid.h"
#include "geometry/parts/part_mesh.h"

/// Files for ParaView: XML with base64 data inline, zlib level 1, Float32. The same input gives the
/// same bytes. Every file appears under its name only when it is complete.
namespace flexmorph::io {

/// Values to show at cells or points: `components` next to each other per cell or point. Two
/// components become vectors of three, so that ParaView can warp by them.
struct Field {
  std::string name;
  std::span<const double> values;  ///< (n) or (components n)
  int components = 1;
};

/// Image data (.vti) on a grid; fields in the order of the grid (y fastest).
/// @throws Error (input) when the file cannot be written; Error (numerical) naming the field that
///         has the wrong size or a value that is not finite. All writers below likewise.
void write_image_data(const std::string& path, const Grid& grid, std::span<const Field> cell_fields,
                      std::span<const Field> point_fields);

/// A mesh of quadrilaterals, in the plane or in space.
struct QuadMesh {
  int dimension = 2;                      ///< components of a point, 2 or 3
  std::vector<double> points;             ///< (dimension n_points) [m]
  std::vector<std::array<int, 4>> quads;  ///< corners, counterclockwise
};

/// Unstructured grid (.vtu).
void write_quad_mesh(const std::string& path, const QuadMesh& mesh,
                     std::span<const Field> cell_fields, std::span<const Field> point_fields);

/// Six-node triangles of a part (.vtu).
void write_part_mesh(const std::string& path, const PartMesh& mesh,
                     std::span<const Field> cell_fields, std::span<const Field> point_fields);

/// Closed lines (.vtp), one cell each; no vertex repeated in the input.
void write_outlines(const std::string& path, std::span<const std::vector<Vec2>> outlines,
                    std::span<const Field> cell_fields);

/// Outlines of components with their number (`component`, from 0) and parameters (X0, Y0,
/// half_length, angle, c1, c2, c3).
void write_components(const std::string& path, std::span<const Component> components,
                      double min_half_thickness, int segments = 64);

/// A time series (.pvd) that grows while the run goes on: the index is complete after every add().
class Series {
 public:
  /// Nothing is written before the first frame.
  explicit Series(std::string path) : path_(std::move(path)) {}

  /// @param file  of the frame, relative to the folder of the index
  /// @param part  number of the body, where one time has several files
  void add(double time, const std::string& file, int part = 0);

  int size() const { return static_cast<int>(frames_.size()); }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::vector<std::string> frames_;
};

/// How a cell field becomes a picture in grey.
struct Picture {
  double lower = 0, upper = 1;  ///< white and black; values outside are clamped
  int pixels_per_cell = 4;
};

/// Picture (.png) of one value per cell, y up, no axes.
void write_png(const std::string& path, const Grid& grid, std::span<const double> cell_values,
               const Picture& picture = {});

}  // namespace flexmorph::io
