#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "geometry/components/component.h"
#include "geometry/grid.h"
#include "geometry/parts/part_mesh.h"

/// Files for ParaView: XML with inline base64 data, zlib level 1, Float32. The same input gives the
/// same bytes. Every file appears under its name only when it is complete.
namespace flexmorph::io {

/// Values at cells or points, `components` next to each other per cell or point. Two components are
/// written as vectors of three, because ParaView can displace meshes only by those.
struct Field {
  std::string name;                ///< Name in ParaView.
  std::span<const double> values;  ///< Values (components n).
  int components = 1;              ///< Number of values per cell or point.
  /// Number of bits of the mantissa that are kept, at most 23. Values are rounded to so many bits,
  /// which makes files smaller: with 10 bits the relative error is at most 2⁻¹¹.
  int bits = 23;
  std::string unit = {};  ///< Unit, written as metadata of the array (VTK: UNITS_LABEL).
};

/// Writes image data (.vti) on a grid; fields have the order of the grid (y fastest).
/// @param data_fields  fields of any length that belong to the whole data set (VTK: field data)
/// @throws Error (numerical) when the file cannot be written, or with the name of a field that has
///         the wrong size or a value that is not finite. The other writers below throw it, too.
void write_image_data(const std::string& path, const Grid& grid, std::span<const Field> cell_fields,
                      std::span<const Field> point_fields, std::span<const Field> data_fields = {});

/// A mesh of quadrilaterals in the plane or in space.
struct QuadMesh {
  int dimension = 2;                      ///< Number of coordinates of a point, 2 or 3.
  std::vector<double> points;             ///< Positions of the points (dimension n_points) [m].
  std::vector<std::array<int, 4>> quads;  ///< Indices of the corners, counterclockwise.
};

/// Writes a mesh of quadrilaterals as an unstructured grid (.vtu).
void write_quad_mesh(const std::string& path, const QuadMesh& mesh,
                     std::span<const Field> cell_fields, std::span<const Field> point_fields);

/// Writes the six-node triangles of a part as an unstructured grid (.vtu).
void write_part_mesh(const std::string& path, const PartMesh& mesh,
                     std::span<const Field> cell_fields, std::span<const Field> point_fields);

/// Writes closed lines (.vtp), one cell each; in the input no vertex is repeated.
void write_outlines(const std::string& path, std::span<const std::vector<Vec2>> outlines,
                    std::span<const Field> cell_fields);

/// Writes the outlines of components (.vtp) with their index (`component`, from 1) and parameters
/// (X0, Y0, half_length, angle, c1, c2, c3).
void write_components(const std::string& path, std::span<const Component> components,
                      double min_half_thickness, int segments = 64);

/// A time series (.pvd) that grows during a run; the index file is complete after every add().
class Series {
 public:
  /// Stores the path of the index file. The file is written with the first frame.
  explicit Series(std::string path) : path_(std::move(path)) {}

  /// Adds a frame and writes the index file.
  /// @param time  time of the frame [s]
  /// @param file  path of the frame, relative to the folder of the index file
  /// @param part  index of the body, if one time has several files
  void add(double time, const std::string& file, int part = 0);
  /// Removes the frame of a file, if there is one; the next add() writes the index file without it.
  /// @param file  path of the frame, as it was passed to add()
  void drop(const std::string& file);

  /// Returns the number of frames.
  int size() const { return static_cast<int>(frames_.size()); }
  /// Returns the path of the index file.
  const std::string& path() const { return path_; }

 private:
  struct Frame {
    std::string file, line;  // path of the frame, and its line in the index file
  };
  std::string path_;
  std::vector<Frame> frames_;
};

/// Settings of the picture of a cell field in grey.
struct Picture {
  double lower = 0, upper = 1;  ///< Values of white and black; values outside are clamped.
  int pixels_per_cell = 4;      ///< Width and height of a cell [px].
};

/// Writes a picture (.png) with one grey value per cell; y points upwards, and there are no axes.
/// @throws Error (numerical) for a wrong number of values, a value that is not finite, or a picture
///         whose upper value is not above the lower one.
void write_png(const std::string& path, const Grid& grid, std::span<const double> cell_values,
               const Picture& picture = {});

}  // namespace flexmorph::io
