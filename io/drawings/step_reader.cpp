#include "io/drawings/step_reader.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepTools_WireExplorer.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Pln.hxx>
#include <limits>
#include <memory>

#include "io/drawings/drawing.h"
#include "io/files.h"

namespace flexmorph::io {
namespace {

/// OpenCASCADE converts lengths to millimetres when it reads a file.
constexpr double kUnit = 1e-3;
constexpr double kStraight = 1e-6;  ///< Tolerance of directions [rad].

/// A plane face that is normal to z, with its height.
struct Level {
  double z = 0;  ///< Height of the face [mm].
  TopoDS_Face face;
};

bool is_along_z(const gp_Dir& direction) {
  return std::hypot(direction.X(), direction.Y()) < kStraight;
}

/// Returns true if a face is a wall along z, whose normals lie in the x-y plane.
bool is_wall(const BRepAdaptor_Surface& surface) {
  switch (surface.GetType()) {
    case GeomAbs_Plane:
      return std::abs(surface.Plane().Axis().Direction().Z()) < kStraight;
    case GeomAbs_Cylinder:
      return is_along_z(surface.Cylinder().Axis().Direction());
    case GeomAbs_SurfaceOfExtrusion:
      return is_along_z(surface.Direction());
    default:
      break;
  }
  // The surface is a spline surface: the normals at a few points are tested.
  constexpr int kPoints = 5;
  for (int i = 0; i < kPoints; ++i)
    for (int j = 0; j < kPoints; ++j) {
      const auto between = [](double from, double to, int k) {
        return from + (to - from) * k / (kPoints - 1.0);
      };
      gp_Pnt p;
      gp_Vec u, v;
      surface.D1(between(surface.FirstUParameter(), surface.LastUParameter(), i),
                 between(surface.FirstVParameter(), surface.LastVParameter(), j), p, u, v);
      const gp_Vec normal = u.Crossed(v);
      if (std::abs(normal.Z()) > kStraight * normal.Magnitude()) return false;
    }
  return true;
}

/// Returns the faces normal to z of a solid or a sheet, the lowest first.
/// @throws Error (input) when another face is not a wall along z
std::vector<Level> levels_of(const TopoDS_Shape& shape) {
  std::vector<Level> out;
  for (TopExp_Explorer faces(shape, TopAbs_FACE); faces.More(); faces.Next()) {
    const TopoDS_Face& face = TopoDS::Face(faces.Current());
    const BRepAdaptor_Surface surface(face);
    if (surface.GetType() == GeomAbs_Plane && is_along_z(surface.Plane().Axis().Direction()))
      out.push_back({surface.Plane().Location().Z(), face});
    else if (!is_wall(surface))
      throw Error::input("a face is neither normal nor parallel to z; a plate is extruded along z");
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Level& a, const Level& b) { return a.z < b.z; });
  return out;
}

int count(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  int n = 0;
  for (TopExp_Explorer all(shape, kind); all.More(); all.Next()) ++n;
  return n;
}

/// Returns the face whose edges are the outline.
/// @throws Error (input) when the shape is not a plate
TopoDS_Face outline_face(const TopoDS_Shape& shape, double thickness) {
  const int n_solids = count(shape, TopAbs_SOLID);
  const std::vector<Level> levels = levels_of(shape);
  const std::string wanted =
      "it must contain one solid that is extruded along z, or one face normal to z";
  if (n_solids > 1)
    throw Error::input("it contains " + std::to_string(n_solids) + " solids; " + wanted +
                       "; a drawing (.dxf) may contain several pieces");
  if (n_solids == 0) {
    const int n_faces = count(shape, TopAbs_FACE);
    if (n_faces != 1 || levels.size() != 1)
      throw Error::input("it contains no solid and " + std::to_string(n_faces) + " faces, " +
                         std::to_string(levels.size()) + " of them normal to z; " + wanted);
    return levels.front().face;
  }
  if (levels.size() != 2)
    throw Error::input("its solid has " + std::to_string(levels.size()) +
                       " faces normal to z, but a plate has two, below and above; " + wanted);
  const double height = kUnit * (levels[1].z - levels[0].z);
  if (std::abs(height - thickness) > 1e-3 * thickness)
    throw Error::input("its solid is " + to_text(height, 6) +
                       " m thick along z, but the thickness of the body is " +
                       to_text(thickness, 6) + " m");
  return levels.front().face;
}

/// Returns one edge of a wire as a curve in the direction of the wire [mm].
drawing::Curve curve_of(const TopoDS_Edge& edge) {
  const auto curve = std::make_shared<const BRepAdaptor_Curve>(edge);
  const bool backwards = edge.Orientation() == TopAbs_REVERSED;
  const double from = backwards ? curve->LastParameter() : curve->FirstParameter(),
               to = backwards ? curve->FirstParameter() : curve->LastParameter();
  return {[curve, from, to](double t) {
            const gp_Pnt p = curve->Value(t == 1 ? to : from + t * (to - from));
            return Vec2(p.X(), p.Y());
          },
          curve->GetType() == GeomAbs_Line};
}

drawing::Drawing drawing_of(const TopoDS_Face& face) {
  drawing::Drawing out;
  for (TopExp_Explorer wires(face, TopAbs_WIRE); wires.More(); wires.Next()) {
    drawing::Path& path = out.paths.emplace_back();
    path.closed = true;
    for (BRepTools_WireExplorer edges(TopoDS::Wire(wires.Current()), face); edges.More();
         edges.Next())
      path.curves.push_back(curve_of(edges.Current()));
    if (path.curves.empty()) throw Error::input("a closed curve of its outline has no edges");
  }
  return out;
}

TopoDS_Shape shape_of(const std::string& path) {
  // Without this line the library prints its progress to standard output.
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
  STEPControl_Reader reader;
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone)
    throw Error::input("this is not a STEP file");
  reader.TransferRoots();
  const TopoDS_Shape shape = reader.OneShape();
  if (shape.IsNull()) throw Error::input("it contains no solid and no face");
  return shape;
}

}  // namespace

std::vector<std::vector<Vec2>> read_step_outline(const std::string& path, double thickness) {
  read_regular_file(path, "a STEP file");  // throws with the reason if the file cannot be read
  try {
    return drawing::closed_rings(drawing_of(outline_face(shape_of(path), thickness)), kUnit).rings;
  } catch (const Standard_Failure& failure) {
    throw Error::input(path + ": OpenCASCADE cannot read it: " + failure.GetMessageString());
  } catch (const Error& error) {
    throw Error::input(path + ": " + error.what());
  }
}

}  // namespace flexmorph::io
