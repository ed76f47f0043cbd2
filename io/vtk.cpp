#include "io/vtk.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLImageDataWriter.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "geometry/plain_numbers.h"
#include "io/files.h"
#include "io/png.h"
#include "io/tables.h"

namespace flexmorph::io {
namespace {

/// Returns a number rounded to this number of bits of its mantissa.
float rounded(float value, int bits) {
  constexpr int kAll = 23;
  if (bits >= kAll) return value;
  const uint32_t unit = uint32_t{1} << (kAll - bits);
  return std::bit_cast<float>((std::bit_cast<uint32_t>(value) + unit / 2) & ~(unit - 1));
}

/// Adds fields to point or cell data; place(k) is the index at which VTK stores value k of the
/// field.
template <class Location>
void add_fields(vtkFieldData* data, std::span<const Field> fields, int n, const std::string& path,
                Location location) {
  for (const Field& field : fields) {
    const int c = field.components;
    if (c < 1 || field.values.size() != static_cast<size_t>(n) * c)
      throw Error::numerical(path + ": field '" + field.name + "' has " +
                             std::to_string(field.values.size()) + " values, but " +
                             std::to_string(n) + " times " + std::to_string(c) +
                             " values are needed");
    vtkNew<vtkFloatArray> array;
    array->SetName(field.name.c_str());
    const int width = c == 2 ? 3 : c;
    array->SetNumberOfComponents(width);
    array->SetNumberOfTuples(n);
    for (int k = 0; k < n; ++k) {
      float* tuple = array->GetPointer(static_cast<vtkIdType>(location(k)) * width);
      if (c == 2) tuple[2] = 0;
      for (int i = 0; i < c; ++i) {
        const double value = field.values[static_cast<size_t>(k) * c + i];
        if (!std::isfinite(value))
          throw Error::numerical(path + ": field '" + field.name + "' is not finite at entry " +
                                 std::to_string(k));
        tuple[i] = rounded(static_cast<float>(value), field.bits);
      }
    }
    if (!field.unit.empty())
      array->GetInformation()->Set(vtkDataArray::UNITS_LABEL(), field.unit.c_str());
    data->AddArray(array);
  }
}

int same_location(int k) { return k; }

/// Writes data to a file. VTK writes into memory, so that all files appear in the same way.
template <class Writer, class Data>
void write_xml(const std::string& path, Data* data) {
  vtkNew<Writer> writer;
  writer->SetInputData(data);
  // Base64 is used because ParaView 5.11 of Debian cannot read raw appended data.
  writer->SetDataModeToBinary();
  writer->SetHeaderTypeToUInt32();
  writer->SetCompressorTypeToZLib();
  writer->SetCompressionLevel(1);
  writer->WriteToOutputStringOn();
  const PlainNumbers plain;  // VTK prints ranges in the locale of the process
  if (writer->Write() != 1) throw Error::numerical(path + ": VTK cannot encode the data");
  write_file(path, writer->GetOutputString());
}

vtkNew<vtkPoints> float_points(int n) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToFloat();
  points->SetNumberOfPoints(n);
  return points;
}

/// Writes cells of one type, given by their nodes.
template <std::size_t n>
void write_cells(const std::string& path, vtkPoints* points, int type,
                 const std::vector<std::array<int, n>>& nodes, std::span<const Field> cell_fields,
                 std::span<const Field> point_fields) {
  vtkNew<vtkCellArray> cells;
  cells->Use32BitStorage();
  for (const std::array<int, n>& each : nodes) {
    std::array<vtkIdType, n> ids;
    std::copy(each.begin(), each.end(), ids.begin());
    cells->InsertNextCell(n, ids.data());
  }
  vtkNew<vtkUnstructuredGrid> grid;
  grid->SetPoints(points);
  grid->SetCells(type, cells);
  add_fields(grid->GetCellData(), cell_fields, static_cast<int>(nodes.size()), path, same_location);
  add_fields(grid->GetPointData(), point_fields, static_cast<int>(points->GetNumberOfPoints()),
             path, same_location);
  write_xml<vtkXMLUnstructuredGridWriter>(path, grid.Get());
}

}  // namespace

void write_image_data(const std::string& path, const Grid& grid, std::span<const Field> cell_fields,
                      std::span<const Field> point_fields, std::span<const Field> data_fields) {
  vtkNew<vtkImageData> image;
  image->SetDimensions(grid.nx + 1, grid.ny + 1, 1);
  image->SetOrigin(grid.x0, grid.y0, 0);
  // The third spacing has no meaning, but ParaView needs a positive value.
  image->SetSpacing(grid.dx(), grid.dy(), std::min(grid.dx(), grid.dy()));
  // In VTK x is the fastest index, in the grid y.
  add_fields(image->GetCellData(), cell_fields, grid.n_cells(), path,
             [&](int k) { return (k % grid.ny) * grid.nx + k / grid.ny; });
  add_fields(image->GetPointData(), point_fields, grid.n_nodes(), path,
             [&](int k) { return (k % (grid.ny + 1)) * (grid.nx + 1) + k / (grid.ny + 1); });
  for (const Field& field : data_fields)
    add_fields(image->GetFieldData(), {&field, 1},
               static_cast<int>(field.values.size()) / std::max(1, field.components), path,
               same_location);
  write_xml<vtkXMLImageDataWriter>(path, image.Get());
}

void write_quad_mesh(const std::string& path, const QuadMesh& mesh,
                     std::span<const Field> cell_fields, std::span<const Field> point_fields) {
  const int n = static_cast<int>(mesh.points.size()) / mesh.dimension;
  const auto points = float_points(n);
  for (int k = 0; k < n; ++k) {
    const double* p = &mesh.points[static_cast<size_t>(k) * mesh.dimension];
    points->SetPoint(k, p[0], p[1], mesh.dimension == 3 ? p[2] : 0);
  }
  write_cells(path, points, VTK_QUAD, mesh.quads, cell_fields, point_fields);
}

void write_part_mesh(const std::string& path, const PartMesh& mesh,
                     std::span<const Field> cell_fields, std::span<const Field> point_fields) {
  const int n = static_cast<int>(mesh.points.size());
  const auto points = float_points(n);
  for (int k = 0; k < n; ++k) points->SetPoint(k, mesh.point(k).x(), mesh.point(k).y(), 0);
  write_cells(path, points, VTK_QUADRATIC_TRIANGLE, mesh.triangles, cell_fields, point_fields);
}

void write_outlines(const std::string& path, std::span<const std::vector<Vec2>> outlines,
                    std::span<const Field> cell_fields) {
  size_t n = 0;
  for (const std::vector<Vec2>& outline : outlines) n += outline.size();
  const auto points = float_points(static_cast<int>(n));
  vtkNew<vtkCellArray> lines;
  lines->Use32BitStorage();
  vtkIdType next = 0;
  for (const std::vector<Vec2>& outline : outlines) {
    const vtkIdType first = next;
    lines->InsertNextCell(static_cast<int>(outline.size()) + 1);
    for (const Vec2& p : outline) {
      points->SetPoint(next, p.x(), p.y(), 0);
      lines->InsertCellPoint(next++);
    }
    lines->InsertCellPoint(first);
  }
  vtkNew<vtkPolyData> poly;
  poly->SetPoints(points);
  poly->SetLines(lines);
  add_fields(poly->GetCellData(), cell_fields, static_cast<int>(outlines.size()), path,
             same_location);
  write_xml<vtkXMLPolyDataWriter>(path, poly.Get());
}

void write_components(const std::string& path, std::span<const Component> components,
                      double min_half_thickness, int segments) {
  constexpr std::array<const char*, Component::kParameters + 1> kNames = {
      "component", "X0", "Y0", "half_length", "angle", "c1", "c2", "c3"};
  std::vector<std::vector<Vec2>> outlines;
  std::array<std::vector<double>, kNames.size()> values;
  for (const Component& component : components) {
    outlines.push_back(outline(component, min_half_thickness, segments));
    values[0].push_back(static_cast<double>(outlines.size()));
    const auto parameters = component.parameters();
    for (size_t i = 0; i < parameters.size(); ++i) values[i + 1].push_back(parameters[i]);
  }
  std::vector<Field> fields;
  for (size_t i = 0; i < kNames.size(); ++i) fields.push_back({kNames[i], values[i], 1});
  write_outlines(path, outlines, fields);
}

void Series::add(double time, const std::string& file, int part) {
  frames_.push_back({file, "    <DataSet timestep=\"" + to_text(time) + "\" part=\"" +
                               to_text(part) + "\" file=\"" + xml_escaped(file) + "\"/>\n"});
  std::string text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
      "  <Collection>\n";
  for (const Frame& frame : frames_) text += frame.line;
  write_file(path_, text + "  </Collection>\n</VTKFile>\n");
}

void Series::drop(const std::string& file) {
  std::erase_if(frames_, [&](const Frame& frame) { return frame.file == file; });
}

void write_png(const std::string& path, const Grid& grid, std::span<const double> cell_values,
               const Picture& picture) {
  if (cell_values.size() != static_cast<size_t>(grid.n_cells()))
    throw Error::numerical(path + ": " + std::to_string(cell_values.size()) +
                           " values are given for " + std::to_string(grid.n_cells()) + " cells");
  if (!(picture.upper > picture.lower))
    throw Error::numerical(path + ": the value of black, " + to_text(picture.upper) +
                           ", must be above the value of white, " + to_text(picture.lower));
  const int n = picture.pixels_per_cell;
  Pixels pixels{grid.nx * n, grid.ny * n, 1};
  for (int y = grid.ny * n - 1; y >= 0; --y)
    for (int x = 0; x < grid.nx * n; ++x) {
      const double value = cell_values[grid.cell(x / n, y / n)];
      if (!std::isfinite(value)) throw Error::numerical(path + ": a value is not finite");
      const double share =
          std::clamp((value - picture.lower) / (picture.upper - picture.lower), 0.0, 1.0);
      pixels.values.push_back(static_cast<unsigned char>(std::lround(255 * (1 - share))));
    }
  write_file(path, png(pixels));
}

}  // namespace flexmorph::io
