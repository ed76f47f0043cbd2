#include "io/step.h"

#include <APIHeaderSection_MakeHeader.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRep_Builder.hxx>
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
#include <TopoDS_Wire.hxx>
#include <XSControl_WorkSession.hxx>
#include <gp_Pln.hxx>
#include <sstream>

#include "io/files.h"

namespace flexmorph::io {
namespace {

/// OpenCASCADE takes coordinates as millimetres. (Other units for its files are a state of the
/// whole process, which the next writer sees too late.)
constexpr double kScale = 1000;

TopoDS_Wire wire_of(const std::vector<Vec2>& ring) {
  // Points nearer than 1e-6 mm are one: to OpenCASCADE nearly all within 1e-7 is.
  constexpr double kNear = 1e-9;
  BRepBuilderAPI_MakePolygon polygon;
  const Vec2* last = &ring.back();
  for (const Vec2& p : ring) {
    if ((p - *last).norm() < kNear) continue;
    polygon.Add(gp_Pnt(kScale * p.x(), kScale * p.y(), 0));
    last = &p;
  }
  polygon.Close();
  return polygon.Wire();
}

TopoDS_Shape solid_of(const Region& region, double thickness) {
  BRepBuilderAPI_MakeFace face(gp_Pln(gp::XOY()), wire_of(region.outer));
  for (const auto& hole : region.holes) face.Add(wire_of(hole));
  return BRepPrimAPI_MakePrism(face.Face(), gp_Vec(0, 0, kScale * thickness)).Shape();
}

/// Names without what changes from run to run: the time, and a number that counts products.
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

/// Empty where no solid could be made of it.
std::string step_text(const TopoDS_Shape& shape) {
  // It would tell of its progress on standard output.
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
  STEPControl_Writer writer;
  Interface_Static::SetCVal("write.step.schema", "AP214IS");
  Interface_Static::SetCVal("write.step.product.name", "design");
  Interface_Static::SetIVal("write.surfacecurve.mode", 0);  // edges are straight: half the file
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

std::string write_step(const std::string& path, std::span<const Region> regions, double thickness) {
  std::string text;
  try {
    TopoDS_Compound all;
    const BRep_Builder builder;
    builder.MakeCompound(all);
    for (const Region& r : regions) builder.Add(all, solid_of(r, thickness));
    text = step_text(all);
  } catch (const Standard_Failure& failure) {
    return failure.GetMessageString();
  }
  if (text.empty()) return "it was not transferred";
  write_file(path, text);
  return "";
}

}  // namespace flexmorph::io
