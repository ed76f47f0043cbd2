#include "io/drawings/step.h"

#include <APIHeaderSection_MakeHeader.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRep_Builder.hxx>
#include <Geom_Circle.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <STEPControl_Writer.hxx>
#include <Standard_Failure.hxx>
#include <StepBasic_Product.hxx>
#include <StepData_Protocol.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_StepWriter.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <XSControl_WorkSession.hxx>
#include <gp_Ax2.hxx>
#include <gp_Pln.hxx>
#include <sstream>

#include "io/files.h"

namespace flexmorph::io {
namespace {

/// OpenCASCADE expects coordinates in millimetres. A different unit for its files is a setting of
/// the whole process, which takes effect too late for the next writer.
constexpr double kScale = 1000;

/// Tolerance for ends of curves on their vertices [mm].
constexpr double kDistanceTolerance = 1e-6;

gp_Pnt point_of(const Vec2& p) { return {kScale * p.x(), kScale * p.y(), 0}; }

TopoDS_Edge edge_of(const OutlineCurve& c, const TopoDS_Vertex& from, const TopoDS_Vertex& to) {
  if (c.is_line()) return BRepBuilderAPI_MakeEdge(from, to).Edge();
  const gp_Dir axis(0, 0, c.sweep > 0 ? 1 : -1);
  // The parameter of the circle begins at `from`.
  const Vec2 begin = c.from - c.center;
  const gp_Ax2 frame(point_of(c.center), axis, gp_Dir(begin.x(), begin.y(), 0));
  const Handle(Geom_Circle) circle = new Geom_Circle(frame, kScale * c.radius);
  return BRepBuilderAPI_MakeEdge(circle, from, to, 0, std::abs(c.sweep)).Edge();
}

TopoDS_Wire wire_of(const CurveRing& ring) {
  const BRep_Builder builder;
  std::vector<TopoDS_Vertex> ends(ring.size());
  for (std::size_t k = 0; k < ring.size(); ++k)
    builder.MakeVertex(ends[k], point_of(ring[k].from), kDistanceTolerance);
  BRepBuilderAPI_MakeWire wire;
  for (std::size_t k = 0; k < ring.size(); ++k)
    wire.Add(edge_of(ring[k], ends[k], ends[(k + 1) % ring.size()]));
  return wire.Wire();
}

TopoDS_Shape solid_of(const CurvedRegion& region, double thickness) {
  BRepBuilderAPI_MakeFace face(gp_Pln(gp::XOY()), wire_of(region.outer));
  for (const CurveRing& hole : region.holes) face.Add(wire_of(hole));
  return BRepPrimAPI_MakePrism(face.Face(), gp_Vec(0, 0, kScale * thickness)).Shape();
}

/// Replaces names that change from run to run: the time, and a number that counts products.
void set_names(const Handle(StepData_StepModel) & model) {
  const auto text = [](const char* words) { return new TCollection_HAsciiString(words); };
  for (int k = 1; k <= model->NbEntities(); ++k) {
    const auto product = Handle(StepBasic_Product)::DownCast(model->Value(k));
    if (product.IsNull()) continue;
    product->SetId(text("design"));
    product->SetName(text("design"));
  }
  APIHeaderSection_MakeHeader header(model);
  header.SetName(text("design"));
  header.SetTimeStamp(text("1970-01-01T00:00:00"));
  header.SetOriginatingSystem(text("flexmorph"));
}

/// Returns the shape as STEP text; empty if it could not be converted.
std::string step_text(const TopoDS_Shape& shape) {
  // Without this line the library prints its progress to standard output.
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
  STEPControl_Writer writer;
  Interface_Static::SetCVal("write.step.schema", "AP214IS");
  Interface_Static::SetCVal("write.step.product.name", "design");
  // Curves on surfaces are omitted: these surfaces are simple, and the file has half the size.
  Interface_Static::SetIVal("write.surfacecurve.mode", 0);
  if (writer.Transfer(shape, STEPControl_AsIs) != IFSelect_RetDone) return "";
  const Handle(StepData_StepModel) model = writer.Model();
  set_names(model);
  StepData_StepWriter text(model);
  text.SendModel(Handle(StepData_Protocol)::DownCast(writer.WS()->Protocol()));
  std::ostringstream out;
  text.Print(out);
  return out.str();
}

}  // namespace

std::string write_step(const std::string& path, std::span<const CurvedRegion> regions,
                       double thickness) {
  std::string text;
  try {
    TopoDS_Compound all;
    const BRep_Builder builder;
    builder.MakeCompound(all);
    for (const CurvedRegion& r : regions) builder.Add(all, solid_of(r, thickness));
    if (!BRepCheck_Analyzer(all).IsValid()) return "the faces of the solid are not closed";
    text = step_text(all);
  } catch (const Standard_Failure& failure) {
    return failure.GetMessageString();
  }
  if (text.empty()) return "the solid could not be written";
  write_file(path, text);
  return "";
}

}  // namespace flexmorph::io
