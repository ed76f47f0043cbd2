// Shows that outlines of plates in STEP files are read as they were written, in the plane and in
// metres, and that other shapes are refused.
#include "io/drawings/step_reader.h"

#include <gtest/gtest.h>

#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <STEPControl_Writer.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Shape.hxx>
#include <numbers>

#include "geometry/components/outline.h"
#include "io/drawings/drawing.h"
#include "io/drawings/step.h"
#include "tests/io/scratch.h"

namespace flexmorph::io {
namespace {

constexpr double kThickness = 0.004;

class StepOutlines : public ::testing::Test {
 protected:
  /// Returns the path of a file of a shape whose sizes are in millimetres.
  std::string file_of(const TopoDS_Shape& shape) const {
    STEPControl_Writer writer;
    writer.Transfer(shape, STEPControl_AsIs);
    writer.Write((scratch_ / "part.step").c_str());
    return scratch_ / "part.step";
  }
  /// Asks for a refusal that begins with the file and contains all of the parts.
  ::testing::AssertionResult refused(const std::string& path,
                                     const std::vector<std::string>& parts) const {
    try {
      read_step_outline(path, kThickness);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), Error::Kind::input);
      return says(error.what(), path + ": ", parts);
    }
    return ::testing::AssertionFailure() << path << " is not refused";
  }

  Scratch scratch_;
};

TEST_F(StepOutlines, AreThoseThatWereWritten) {
  const Region plate =
      region_of({corners_of({{0, -0.02}, {0.08, 0.03}}), corners_of({{0.01, 0}, {0.02, 0.01}}),
                 corners_of({{0.05, 0}, {0.06, 0.02}})});
  const std::string path = scratch_ / "part.step";
  ASSERT_EQ(write_step(path, curves_of({&plate, 1}, 1e-6), kThickness), "");
  const Region read = region_of(read_step_outline(path, kThickness));
  EXPECT_EQ(read.outer.size(), 4u);
  ASSERT_EQ(read.holes.size(), 2u);
  EXPECT_NEAR(area(read), area(plate), 1e-12);
  const Box box = bounds_of(read.outer);
  EXPECT_NEAR((box.lower - Vec2(0, -0.02)).norm(), 0, 1e-9);
  EXPECT_NEAR((box.upper - Vec2(0.08, 0.03)).norm(), 0, 1e-9);
}

// The edge of a disc of 20 mm radius is its circle.
TEST_F(StepOutlines, HaveArcs) {
  const auto rings =
      read_step_outline(file_of(BRepPrimAPI_MakeCylinder(20, 4).Shape()), kThickness);
  ASSERT_EQ(rings.size(), 1u);
  const double tolerance = 2 * std::numbers::pi * 0.02 * 0.04 * kDrawingTolerance;
  EXPECT_NEAR(area(region_of(rings)), std::numbers::pi * 4e-4, tolerance);
  for (const Vec2& p : rings[0]) EXPECT_NEAR(p.norm(), 0.02, 1e-9);
}

TEST_F(StepOutlines, OfOneFaceNeedNoThickness) {
  const TopoDS_Shape solid = BRepPrimAPI_MakeBox(30, 20, 7).Shape();
  TopExp_Explorer faces(solid, TopAbs_FACE);
  std::vector<TopoDS_Shape> all;
  for (; faces.More(); faces.Next()) all.push_back(faces.Current());
  ASSERT_EQ(all.size(), 6u);  // the last two are normal to z
  EXPECT_NEAR(area(region_of(read_step_outline(file_of(all[5]), kThickness))), 6e-4, 1e-12);
  EXPECT_TRUE(refused(file_of(all[0]), {"1 face", "0", "normal to z"}));
}

TEST_F(StepOutlines, OfOtherShapesAreRefused) {
  EXPECT_TRUE(refused(file_of(BRepPrimAPI_MakeBox(30, 20, 7).Shape()), {"0.007 m", "0.004 m"}));
  EXPECT_TRUE(refused(file_of(BRepPrimAPI_MakeSphere(20).Shape()), {"parallel to z"}));
  EXPECT_TRUE(refused(scratch_.write("none.step", "hello"), {"STEP"}));
  EXPECT_TRUE(refused(scratch_ / "missing.step", {"cannot"}));
  const Region pieces[] = {{corners_of({{0, 0}, {0.01, 0.01}}), {}},
                           {corners_of({{0.02, 0}, {0.03, 0.01}}), {}}};
  const std::string path = scratch_ / "two.step";
  ASSERT_EQ(write_step(path, curves_of(pieces, 1e-6), kThickness), "");
  EXPECT_TRUE(refused(path, {"2 solids"}));
}

}  // namespace
}  // namespace flexmorph::io
