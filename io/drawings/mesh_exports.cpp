#include "io/drawings/mesh_exports.h"

#include <algorithm>
#include <cstddef>

#include "io/files.h"

namespace flexmorph::io {
namespace {

/// Returns a number as text of at most 20 characters, because CalculiX reads no more.
std::string short_text(double value) { return to_text(value, 13); }

std::string number(std::size_t k) { return to_text(static_cast<long long>(k)); }
std::string number(int k) { return to_text(k + 1); }  // other programs count from 1

/// Returns true for nodes that all loads hold in both directions.
std::vector<char> always_held(const PlateModel& model) {
  std::vector<int> count(model.mesh.points.size(), 0);
  for (const MeshLoad& l : model.loads)
    for (const HeldNode& h : l.held) ++count[static_cast<std::size_t>(h.node)];
  std::vector<char> out(count.size());
  for (std::size_t k = 0; k < out.size(); ++k)
    out[k] = count[k] == 2 * static_cast<int>(model.loads.size());
  return out;
}

/// Returns the triangles that are written: triangles with a node that moves, except those in
/// left_out.
std::vector<std::size_t> moving_triangles(const PlateModel& model) {
  const std::vector<char> held = always_held(model);
  std::vector<std::size_t> out;
  for (std::size_t t = 0; t < model.mesh.triangles.size(); ++t) {
    if (!model.left_out.empty() && model.left_out[t] != 0) continue;
    const auto& nodes = model.mesh.triangles[t];
    if (std::any_of(nodes.begin(), nodes.end(),
                    [&](int n) { return !held[static_cast<std::size_t>(n)]; }))
      out.push_back(t);
  }
  return out;
}

/// Returns a name for input files, without spaces and commas.
std::string name_of(const std::string& words) {
  std::string out = words;
  for (char& c : out)
    if (c == ' ' || c == ',' || c == '*' || c == '\n') c = '_';
  return out;
}

/// Returns the thickness of the elements [m]. CalculiX converts plane elements to solids whose
/// displacements are continuous across the thickness. This makes a plate that is thicker than its
/// triangles are wide too stiff (by 2 to 3 % for designs of unit thickness), and it changes the
/// stresses where triangles are smallest. A slice thinner than a hundredth of the median side loses
/// accuracy: the compliance has an error of 0.6 % at a ten thousandth and 2e-5 at a hundredth
/// (rotating plate, whose smallest side is a thousandth of the median).
double slice_of(const PlateModel& model) {
  constexpr double kLengthFraction = 0.2, kMinLength = 0.01;
  std::vector<double> sides;
  for (std::size_t t = 0; t < model.mesh.triangles.size(); ++t) {
    const auto [a, b, c] = model.mesh.corners(t);
    sides.insert(sides.end(), {(b - a).norm(), (c - b).norm(), (a - c).norm()});
  }
  const double smallest = std::ranges::min(sides);
  const auto middle = sides.begin() + static_cast<std::ptrdiff_t>(sides.size() / 2);
  std::ranges::nth_element(sides, middle);
  return std::min(model.thickness, std::max(kLengthFraction * smallest, kMinLength * *middle));
}

/// Appends one step with a load.
/// @param part  fraction of the forces that the slice carries
void add_step(const MeshLoad& load, double part, const std::vector<char>& used, std::string& out) {
  out += "*STEP\n** load: " + name_of(load.name) + "\n*STATIC\n";
  // Supports and loads of earlier steps are removed.
  out += "*BOUNDARY, OP=NEW\n";
  for (const HeldNode& h : load.held)
    if (used[static_cast<std::size_t>(h.node)])
      out += number(h.node) + "," + to_text(h.component + 1) + "," + to_text(h.component + 1) +
             "," + short_text(h.value) + "\n";
  out += "*CLOAD, OP=NEW\n";
  for (const NodeForce& f : load.forces)
    for (int c = 0; c < 2; ++c)
      if (f.force[c] != 0 && used[static_cast<std::size_t>(f.node)])
        out += number(f.node) + "," + to_text(c + 1) + "," + short_text(part * f.force[c]) + "\n";
  out += "*NODE FILE, OUTPUT=2D\nU\n*EL FILE, OUTPUT=2D\nS\n*END STEP\n";
}

}  // namespace

void write_inp(const std::string& path, const PlateModel& model) {
  const PartMesh& mesh = model.mesh;
  const std::vector<std::size_t> triangles = moving_triangles(model);
  std::vector<char> used(mesh.points.size(), 0);
  for (const std::size_t t : triangles)
    for (const int node : mesh.triangles[t]) used[static_cast<std::size_t>(node)] = 1;
  const double slice = slice_of(model);
  std::string out = "** Plate in plane stress; its thickness is ";
  out += short_text(model.thickness);
  out += " m. Units: m, N, Pa.\n";
  if (slice < model.thickness)
    out +=
        "** The elements are thinner than the plate, and the forces are reduced by the same "
        "factor.\n** The displacements and stresses are those of the plate, also if solids replace "
        "the plane\n** elements.\n";
  out += "*NODE, NSET=NODES\n";
  for (std::size_t k = 0; k < used.size(); ++k)
    if (used[k])
      out += number(k + 1) + "," + short_text(mesh.points[k].x()) + "," +
             short_text(mesh.points[k].y()) + ",0\n";
  out += "*ELEMENT, TYPE=CPS6, ELSET=PART\n";
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    out += number(k + 1);
    for (const int node : mesh.triangles[triangles[k]]) out.append(",").append(number(node));
    out += "\n";
  }
  out.append("*MATERIAL, NAME=MATERIAL\n*ELASTIC\n").append(short_text(model.youngs_modulus));
  out.append(",").append(short_text(model.poisson_ratio));
  out.append("\n*SOLID SECTION, ELSET=PART, MATERIAL=MATERIAL\n").append(short_text(slice));
  out += "\n";
  for (const MeshLoad& load : model.loads) add_step(load, slice / model.thickness, used, out);
  write_file(path, out);
}

void write_msh(const std::string& path, const PartMesh& mesh) {
  std::string out = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n";
  out += to_text(mesh.n_connected_regions);
  out += "\n";
  for (int piece = 0; piece < mesh.n_connected_regions; ++piece) {
    const std::string name = number(piece);
    out.append("2 ").append(name).append(" \"piece_").append(name).append("\"\n");
  }
  out += "$EndPhysicalNames\n$Nodes\n" + number(mesh.points.size()) + "\n";
  for (std::size_t k = 0; k < mesh.points.size(); ++k)
    out += number(k + 1) + " " + to_text(mesh.points[k].x()) + " " + to_text(mesh.points[k].y()) +
           " 0\n";
  out += "$EndNodes\n$Elements\n" + number(mesh.triangles.size()) + "\n";
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::string piece = number(mesh.piece[t]);
    out += number(t + 1) + " 9 2 " + piece + " " + piece;  // 9: six-node triangle
    for (const int node : mesh.triangles[t]) out.append(" ").append(number(node));
    out += "\n";
  }
  write_file(path, out + "$EndElements\n");
}

void write_geo(const std::string& path, std::span<const Region> regions, double size) {
  std::string out =
      "// This is the outline of a design, in metres.\nsize = " + to_text(size) + ";\n";
  std::size_t points = 0, loops = 0, surfaces = 0;
  const auto add_loop = [&](const std::vector<Vec2>& ring) {
    const std::size_t first = points + 1;
    for (const Vec2& p : ring)
      out += "Point(" + number(++points) + ") = {" + to_text(p.x()) + ", " + to_text(p.y()) +
             ", 0, size};\n";
    std::string lines;
    for (std::size_t k = first; k <= points; ++k) {
      out += "Line(" + number(k) + ") = {" + number(k) + ", " +
             number(k == points ? first : k + 1) + "};\n";
      lines += (lines.empty() ? "" : ", ") + number(k);
    }
    out += "Line Loop(" + number(++loops) + ") = {" + lines + "};\n";
    return number(loops);
  };
  for (const Region& r : regions) {
    std::string all = add_loop(r.outer);
    for (const auto& hole : r.holes) all += ", " + add_loop(hole);
    const std::string surface = number(++surfaces);
    out += "Plane Surface(" + surface + ") = {" + all + "};\n";
    out += "Physical Surface(\"piece_" + surface + "\") = {" + surface + "};\n";
  }
  write_file(path, out);
}

}  // namespace flexmorph::io
