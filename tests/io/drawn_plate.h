#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/components/outline.h"
#include "io/drawings/drawing.h"
#include "tests/io/scratch.h"

/// Drawings of a plate of 80 x 50 mm with two holes of 5 and 8 mm radius.
namespace flexmorph::io {

inline std::string pair(int code, const std::string& value) {
  return std::to_string(code) + "\n" + value + "\n";
}
inline std::string pair(int code, double value) { return pair(code, std::to_string(value)); }

/// Returns an entity with its codes and numbers in order, x of a point before its y.
inline std::string entity(const std::string& name,
                          const std::vector<std::pair<int, double>>& values,
                          const std::string& layer = "0") {
  std::string out = pair(0, name) + pair(8, layer);
  for (const auto& [code, value] : values) {
    const bool whole = code >= 60 && code < 100;
    out += whole ? pair(code, std::to_string(static_cast<int>(value))) : pair(code, value);
  }
  return out;
}

inline std::string dxf(const std::string& entities, int unit = 4) {
  return "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n" + std::to_string(unit) +
         "\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n" + entities + "0\nENDSEC\n0\nEOF\n";
}

inline std::string line(double x0, double y0, double x1, double y1) {
  return entity("LINE", {{10, x0}, {20, y0}, {30, 0}, {11, x1}, {21, y1}, {31, 0}});
}
inline std::string circle(double x, double y, double r, const std::string& layer = "0") {
  return entity("CIRCLE", {{10, x}, {20, y}, {30, 0}, {40, r}}, layer);
}
inline std::string arc(double x, double y, double r, double from, double to) {
  return entity("ARC", {{10, x}, {20, y}, {30, 0}, {40, r}, {50, from}, {51, to}});
}

inline const std::string kFrame =
    line(0, 0, 80, 0) + line(80, 50, 80, 0) + line(0, 50, 0, 0) + line(0, 50, 80, 50);
inline const std::string kHoles = circle(20, 25, 5) + circle(50, 25, 8);
inline constexpr double kArea = 80e-3 * 50e-3 - std::numbers::pi * (25e-6 + 64e-6);
/// Tolerance of the area: sides are within 1e-5 of 80 mm from the circles.
inline constexpr double kOff = 2 * std::numbers::pi * 13e-3 * 80e-3 * kDrawingTolerance;

class Drawings : public ::testing::Test {
 protected:
  Region plate(const std::string& name, const std::string& text,
               const DrawingSettings& settings = {}) const {
    return region_of(read_drawing(scratch_.write(name, text), settings).rings);
  }
  /// Returns the notes about a drawing, each without the path in front.
  std::vector<std::string> notes(const std::string& text,
                                 const DrawingSettings& settings = {}) const {
    const std::string path = scratch_.write("part.dxf", text);
    std::vector<std::string> out = read_drawing(path, settings).notes;
    for (std::string& note : out) {
      EXPECT_TRUE(note.starts_with(path + ": ")) << note;
      note = note.substr(path.size() + 2);
    }
    return out;
  }
  std::string complaint(const std::string& name, const std::string& text,
                        const DrawingSettings& settings = {}) const {
    try {
      plate(name, text, settings);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), Error::Kind::input);
      return error.what();
    }
    return "";
  }
  /// Asks for a refusal that begins with the file and contains all of the parts.
  ::testing::AssertionResult refused(const std::string& name, const std::string& text,
                                     const std::vector<std::string>& parts,
                                     const DrawingSettings& settings = {}) const {
    return says(complaint(name, text, settings), scratch_ / (name + ": "), parts);
  }
  void expect_plate(const Region& r) const {
    EXPECT_EQ(r.holes.size(), 2u);
    EXPECT_NEAR(area(r), kArea, kOff);
    // vertices are on the circles, so that polygons of holes are slightly smaller
    EXPECT_GE(area(r), kArea - 1e-16);
    const Box box = bounds_of(r.outer);
    EXPECT_NEAR(box.lower.norm(), 0, 1e-12);
    EXPECT_NEAR((box.upper - Vec2(0.08, 0.05)).norm(), 0, 1e-12);
    for (const Vec2& p : r.holes[0]) EXPECT_NEAR((p - Vec2(0.05, 0.025)).norm(), 8e-3, 1e-9);
    for (const Vec2& p : r.holes[1]) EXPECT_NEAR((p - Vec2(0.02, 0.025)).norm(), 5e-3, 1e-9);
  }

  Scratch scratch_;
};

}  // namespace flexmorph::io
