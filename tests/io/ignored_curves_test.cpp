// Shows that superfluous contents of drawings are ignored with a note: curves that are drawn twice,
// lines of no length, dimensions, texts and their layers; and that every unit of DXF is read.
#include "io/drawings/length_unit.h"
#include "tests/io/drawn_plate.h"

namespace flexmorph::io {
namespace {

// The numbers of $INSUNITS and their lengths, from the reference of DXF. The length of the drawing
// is 80 units.
TEST_F(Drawings, HaveEveryUnitOfDxf) {
  const std::vector<double> metres = {0.0254,
                                      0.3048,
                                      1609.344,
                                      1e-3,
                                      1e-2,
                                      1,
                                      1e3,
                                      2.54e-8,
                                      2.54e-5,
                                      0.9144,
                                      1e-10,
                                      1e-9,
                                      1e-6,
                                      0.1,
                                      10,
                                      100,
                                      1e9,
                                      149597870700,
                                      9.4607305e15,
                                      3.0856776e16,
                                      0.3048 / 0.999998,
                                      0.0254 / 0.999998,
                                      0.9144 / 0.999998,
                                      1609.344 / 0.999998};
  for (size_t k = 0; k < metres.size(); ++k) {
    const Region r = plate("part.dxf", dxf(kFrame, static_cast<int>(k) + 1));
    EXPECT_NEAR(bounds_of(r.outer).upper.x() / (80 * metres[k]), 1, 1e-8) << k + 1;
  }
  for (const int none : {0, 25}) EXPECT_TRUE(refused("part.dxf", dxf(kFrame, none), {"`unit`"}));
  EXPECT_EQ(find_length_unit("mil")->metres, 2.54e-5);
  EXPECT_EQ(find_length_unit("yd")->metres, 0.9144);
}

TEST_F(Drawings, IgnoreWhatIsDrawnTwiceOrHasNoLength) {
  using Notes = std::vector<std::string>;
  const std::string plain = kFrame + kHoles;
  EXPECT_EQ(notes(dxf(plain)), Notes());
  const auto one_note = [&](const std::string& more, const Notes& parts) {
    const std::string text = dxf(plain + more);
    expect_plate(plate("part.dxf", text));
    const Notes found = notes(text);
    ASSERT_EQ(found.size(), 1u) << more;
    EXPECT_TRUE(says(found[0], "", parts));
  };
  one_note(line(0, 0, 0, 0), {"1 line ", "length", "(0, 0)"});
  one_note(line(33, 7, 33, 7) + line(-900, 0, -900, 0), {"2 lines", "length", "(33, 7)"});
  one_note(line(0, 0, 1e-4, 0), {"1 line ", "length"});  // within the tolerance of 8e-4
  one_note(circle(3, 4, 0), {"1 curve ", "size", "(3, 4)"});
  one_note(circle(20, 25, 5), {"1 curve ", "twice"});
  one_note(circle(20, 25, 5) + circle(20, 25, 5) + circle(50, 25, 8), {"3 curves", "twice"});
  one_note(line(0, 0, 80, 0), {"1 curve ", "twice", "(0, 0)"});
  one_note(line(80, 0, 0, 0) + line(80, 0, 80, 50), {"2 curves", "twice"});
  // A circle that consists of two arcs and begins elsewhere.
  one_note(arc(20, 25, 5, 30, 200) + arc(20, 25, 5, 200, 30), {"1 curve ", "twice"});
  // A frame that is drawn as a polyline, too.
  const std::vector<std::pair<int, double>> frame = {
      {90, 4}, {70, 1}, {10, 80}, {20, 50}, {10, 0}, {20, 50}, {10, 0}, {20, 0}, {10, 80}, {20, 0}};
  one_note(entity("LWPOLYLINE", frame), {"1 curve ", "twice"});
  // Two different arcs with common ends are not one arc.
  EXPECT_NEAR(area(plate("part.dxf", dxf(arc(0, 0, 5, 0, 180) + arc(0, 0, 5, 180, 360)))),
              25e-6 * std::numbers::pi, 2 * std::numbers::pi * 5e-3 * 10e-3 * kDrawingTolerance);
  const std::string twice =
      "<svg width=\"1mm\" viewBox=\"0 0 1 1\"><rect width=\"1\" height=\"1\"/><circle cx=\".5\" "
      "cy=\".5\" r=\".2\"/><circle cx=\".5\" cy=\".5\" r=\".2\"/></svg>";
  EXPECT_EQ(plate("part.svg", twice).holes.size(), 1u);
}

TEST_F(Drawings, IgnoreDimensionsAndTexts) {
  const std::string at = pair(10, 5.0) + pair(20, 5.0) + pair(30, 0.0);
  const std::string text = pair(0, "TEXT") + pair(8, "0") + at + pair(40, 2.0) + pair(1, "plate"),
                    dimension = pair(0, "DIMENSION") + pair(8, "0") + at + pair(70, "0") +
                                pair(13, 0.0) + pair(23, 0.0) + pair(14, 80.0) + pair(24, 0.0);
  const std::string all = dxf(kFrame + kHoles + text + dimension + text);
  expect_plate(plate("part.dxf", all));
  const std::vector<std::string> found = notes(all);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_TRUE(says(found[0], "2 TEXT ", {}));
  EXPECT_TRUE(says(found[1], "1 DIMENSION ", {}));
  // Curves on layers of dimensions and texts, unless `layers` names the layer.
  for (const std::string layer : {"DIM", "dimensions-1", "Text", "3_Bemassung", "DEFPOINTS"}) {
    const std::string drawn = dxf(kFrame + kHoles + circle(0, 0, 20, layer));
    expect_plate(plate("part.dxf", drawn));
    const std::vector<std::string> note = notes(drawn);
    ASSERT_EQ(note.size(), 1u) << layer;
    EXPECT_TRUE(says(note[0], "1 curve ", {"'" + layer + "'"}));
    const Region named = plate("part.dxf", drawn, {{}, {layer}});
    EXPECT_NEAR(bounds_of(named.outer).upper.x(), 20e-3, 1e-6);
  }
  for (const char* other : {"0", "outline", "DIMPLE", "context", "HOLES"})
    EXPECT_FALSE(is_annotation_layer(other)) << other;
}

}  // namespace
}  // namespace flexmorph::io
