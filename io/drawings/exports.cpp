#include "io/drawings/exports.h"

#include <Eigen/Geometry>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include "geometry/parts/triangulate.h"
#include "io/files.h"
#include "io/tables.h"

namespace flexmorph::io {
namespace {

const std::vector<std::string> kColumns = {"X0", "Y0", "half_length", "angle", "c1", "c2", "c3"};

/// The text of the entities of a DXF file.
class DxfText {
 public:
  explicit DxfText(const LengthUnit& unit) : unit_(unit) {}

  void ring(const CurveRing& ring, const std::string& layer) {
    if (ring.size() == 1 && ring[0].is_circle()) return circle(ring[0], layer);
    begin("POLYLINE", layer);
    text_ += "66\n1\n10\n0\n20\n0\n30\n0\n70\n1\n";
    for (const OutlineCurve& c : ring) {
      begin("VERTEX", layer);
      point(c.from, 0);
      if (!c.is_line()) text_ += "42\n" + to_text(std::tan(0.25 * c.sweep)) + "\n";
    }
    begin("SEQEND", layer);
  }
  /// Adds a point or a line, given by one or two points.
  void shape(const std::vector<Vec2>& ends, const std::string& layer) {
    begin(ends.size() == 1 ? "POINT" : "LINE", layer);
    for (size_t k = 0; k < ends.size(); ++k) point(ends[k], static_cast<int>(k));
  }
  const std::string& text() const { return text_; }

 private:
  void circle(const OutlineCurve& c, const std::string& layer) {
    begin("CIRCLE", layer);
    point(c.center, 0);
    text_ += "40\n" + to_text(c.radius / unit_.metres) + "\n";
  }
  void begin(const char* entity, const std::string& layer) {
    text_ += std::string("0\n") + entity + "\n8\n" + layer + "\n";
  }
  void point(const Vec2& p, int number) {
    const std::string digit = std::to_string(number) + "\n";
    text_ += "1" + digit + to_text(p.x() / unit_.metres) + "\n2" + digit +
             to_text(p.y() / unit_.metres) + "\n3" + digit + "0\n";
  }
  const LengthUnit& unit_;
  std::string text_;
};

class StlText {
 public:
  explicit StlText(const LengthUnit& unit) : unit_(unit) {}

  void facet(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 normal = (b - a).cross(c - a).normalized();
    text_ += "facet normal" + words(normal) + "\nouter loop\n";
    for (const Vec3* p : {&a, &b, &c}) text_ += "vertex" + point(*p) + "\n";
    text_ += "endloop\nendfacet\n";
  }
  std::string take() {
    const std::string name = std::string("design in ") + unit_.name + "\n";
    return "solid " + name + text_ + "endsolid " + name;
  }

 private:
  std::string point(const Vec3& p) const { return words(p / unit_.metres); }
  static std::string words(const Vec3& p) {
    std::string out;
    for (const double each : {p.x(), p.y(), p.z()}) out.append(" ").append(to_text(each));
    return out;
  }
  const LengthUnit& unit_;
  std::string text_;
};

/// Adds the side walls on a ring; the material is on the left of the ring.
void add_walls(StlText& stl, const std::vector<Vec2>& ring, double height) {
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
    const Vec3 a0(a.x(), a.y(), 0), b0(b.x(), b.y(), 0);
    const Vec3 a1(a.x(), a.y(), height), b1(b.x(), b.y(), height);
    stl.facet(a0, b0, b1);
    stl.facet(a0, b1, a1);
  }
}

}  // namespace

void write_dxf(const std::string& path, std::span<const CurvedRegion> regions,
               const LengthUnit& unit, std::span<const DrawingLayer> more) {
  const bool metric = unit.dxf != kInch.dxf && unit.dxf != find_length_unit("ft")->dxf;
  std::vector<std::string> layers = {"OUTLINE", "HOLES"};
  for (const DrawingLayer& layer : more) layers.push_back(layer.name);
  std::string out = "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n" +
                    std::to_string(unit.dxf) + "\n9\n$MEASUREMENT\n70\n" + (metric ? "1" : "0") +
                    "\n0\nENDSEC\n0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n70\n" +
                    std::to_string(layers.size()) + "\n";
  for (const std::string& layer : layers)
    out += "0\nLAYER\n2\n" + layer + "\n70\n0\n62\n7\n6\nCONTINUOUS\n";
  out += "0\nENDTAB\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
  DxfText entities(unit);
  for (const CurvedRegion& r : regions) {
    entities.ring(r.outer, "OUTLINE");
    for (const CurveRing& hole : r.holes) entities.ring(hole, "HOLES");
  }
  for (const DrawingLayer& layer : more) {
    for (const auto& ends : layer.shapes) entities.shape(ends, layer.name);
    for (const CurveRing& ring : layer.rings) entities.ring(ring, layer.name);
  }
  write_file(path, out + entities.text() + "0\nENDSEC\n0\nEOF\n");
}

void write_stl(const std::string& path, std::span<const Region> regions, double thickness,
               const LengthUnit& unit) {
  StlText stl(unit);
  for (const Region& r : regions) {
    const Triangulation t = triangulate(r);
    const auto at = [&](int k, double z) {
      const Vec2& p = t.points[static_cast<std::size_t>(k)];
      return Vec3(p.x(), p.y(), z);
    };
    for (const auto& [a, b, c] : t.triangles) {
      stl.facet(at(a, thickness), at(b, thickness), at(c, thickness));
      stl.facet(at(a, 0), at(c, 0), at(b, 0));
    }
    add_walls(stl, r.outer, thickness);
    for (const auto& hole : r.holes) add_walls(stl, hole, thickness);
  }
  write_file(path, stl.take());
}

void write_components_csv(const std::string& path, std::span<const Component> components) {
  CsvWriter csv(path, kColumns);
  for (const Component& c : components) {
    std::vector<Cell> row;
    for (const double p : c.parameters()) row.emplace_back(p);
    csv.row(row);
  }
}

std::vector<Component> read_components_csv(const std::string& path) {
  const CsvTable table = read_csv(path);
  std::string header;
  for (const std::string& name : kColumns) header += (header.empty() ? "" : ",") + name;
  const auto fail = [&](size_t line, const std::string& what) {
    throw Error::input(path + ":" + std::to_string(line) + ": " + what);
  };
  if (!std::equal(table.columns.begin(), table.columns.end(), kColumns.begin(), kColumns.end()))
    fail(1, "the header of a file of components must be " + header);
  std::vector<Component> out;
  for (size_t r = 0; r < table.n_rows(); ++r) {
    std::array<double, Component::kParameters> values{};
    const std::vector<std::string> row = table.row(r);
    for (size_t n = 0; n < values.size(); ++n) {
      const std::string& cell = row[n];
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), values[n]);
      if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(values[n]))
        fail(r + 2, kColumns[n] + " = '" + cell + "' is not a finite number");
      if (n != 0 && n != 1 && n != 3 && !(values[n] > 0))
        fail(r + 2, kColumns[n] + " = " + cell + ": lengths and thicknesses are positive [m]");
    }
    out.push_back(Component::from_parameters(values.data()));
  }
  if (out.empty()) fail(2, "the file must contain at least one component");
  return out;
}

}  // namespace flexmorph::io
