// Shows that pictures of parts have pixels where the part is, in the colours of the values there.
#include "io/part_picture.h"

#include <gtest/gtest.h>
#include <vtkBase64Utilities.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <array>
#include <cmath>
#include <fstream>

#include "io/png.h"
#include "tests/io/scratch.h"

namespace flexmorph::io {
namespace {

/// Returns the rectangle (0, 0) to (2, 1) in two triangles; middles of sides are nodes 4 to 8.
PartMesh rectangle() {
  PartMesh out;
  out.points = {{0, 0}, {2, 0}, {2, 1}, {0, 1}, {1, 0}, {1, 0.5}, {0, 0.5}, {2, 0.5}, {1, 1}};
  out.n_corners = 4;
  out.triangles = {{0, 1, 3, 4, 5, 6}, {1, 2, 3, 7, 8, 5}};
  out.piece = {0, 0};
  out.n_connected_regions = 1;
  return out;
}

/// The picture inside an SVG file.
class Decoded {
 public:
  explicit Decoded(const std::string& svg) {
    const std::string begin = "base64,";
    const size_t first = svg.find(begin) + begin.size(), end = svg.find('"', first);
    const std::string code = svg.substr(first, end - first);
    std::string bytes(code.size(), '\0');
    bytes.resize(vtkBase64Utilities::DecodeSafely(
        reinterpret_cast<const unsigned char*>(code.data()), code.size(),
        reinterpret_cast<unsigned char*>(bytes.data()), bytes.size()));
    const std::string path = scratch_ / "a.png";
    std::ofstream(path, std::ios::binary) << bytes;
    reader_->SetFileName(path.c_str());
    reader_->Update();
    reader_->GetOutput()->GetDimensions(size_.data());
  }
  int width() const { return size_[0]; }
  int height() const { return size_[1]; }
  /// Returns the colour at fractions of the width and, from below, of the height.
  std::array<int, 3> at(double x, double y) const {
    std::array<int, 3> out{};
    for (int c = 0; c < 3; ++c)
      out[static_cast<size_t>(c)] =
          static_cast<int>(reader_->GetOutput()->GetScalarComponentAsDouble(
              static_cast<int>(x * width()), static_cast<int>(y * height()), 0, c));
    return out;
  }

 private:
  Scratch scratch_;
  vtkNew<vtkPNGReader> reader_;
  std::array<int, 3> size_{};
};

void expect_color(const std::array<int, 3>& found, const std::array<unsigned char, 3>& wanted) {
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(found[c], wanted[c], 2) << c;
}

TEST(PartPicture, HasTheColoursOfItsValues) {
  const PartMesh mesh = rectangle();
  std::vector<double> values;  // 3 x + y, linear: exact everywhere
  for (const Vec2& p : mesh.points) values.push_back(3 * p.x() + p.y());
  PartPicture picture{.title = "a < b", .unit = "Pa", .values = values, .upper = 5};
  const std::string svg = part_svg(mesh, picture);
  EXPECT_NE(svg.find("a &lt; b"), std::string::npos);
  EXPECT_NE(svg.find("5 Pa"), std::string::npos);
  const Decoded found(svg);
  EXPECT_EQ(found.width(), 2 * found.height());
  for (const Vec2& p : {Vec2(0.2, 0.3), Vec2(1.1, 0.8), Vec2(0.4, 0.9)})
    expect_color(found.at(p.x() / 2, p.y()), map_color((3 * p.x() + p.y()) / 5));
  expect_color(found.at(0.97, 0.9), map_color(1));  // above the largest colour
}

TEST(PartPicture, ShowsTheDisplacedPart) {
  const PartMesh mesh = rectangle();
  const std::vector<double> values(mesh.points.size(), 1);
  std::vector<double> displacement;  // upwards by 0.1, magnified by 5
  for (size_t k = 0; k < mesh.points.size(); ++k) displacement.insert(displacement.end(), {0, 0.1});
  PartPicture picture{.title = "",
                      .unit = "Pa",
                      .values = values,
                      .displacement = displacement,
                      .upper = 2,
                      .magnification = 5};
  const Decoded found(part_svg(mesh, picture));  // the picture is 2 x 1.5
  expect_color(found.at(0.5, 0.9), map_color(0.5));
  expect_color(found.at(0.5, 0.5), map_color(0.5));
  expect_color(found.at(0.5, 0.1), {225, 225, 225});
  // 960 pixels for 2 m; the node next to the middle is shown at (1, 1) of 1.5 m, and the picture is
  // 20 pixels from the left and 34 pixels from the top.
  picture.marked = Vec2(1.1, 0.55);
  picture.mark = "the middle";
  const std::string marked = part_svg(mesh, picture);
  EXPECT_NE(marked.find("<circle cx=\"500\" cy=\"274\""), std::string::npos);
  EXPECT_NE(marked.find(">the middle<"), std::string::npos);
  const std::array<signed char, 2> left_out = {0, 1};  // the upper right half
  picture.left_out = left_out;
  const Decoded half(part_svg(mesh, picture));
  expect_color(half.at(0.9, 0.95), {255, 255, 255});
  expect_color(half.at(0.95, 0.6), {225, 225, 225});
}

TEST(PartPicture, DisplacementsAreShownAsLargeAsIsClear) {
  const PartMesh mesh = rectangle();
  for (const auto& [largest, times] :
       {std::array{1e-3, 200.}, {0.2, 1.}, {2.4e-9, 1e8}, {3., 0.05}}) {
    std::vector<double> displacement(2 * mesh.points.size(), 0);
    displacement[7] = -largest;
    EXPECT_NEAR(clear_magnification(mesh, displacement), times, 1e-9 * times) << largest;
  }
  EXPECT_EQ(clear_magnification(mesh, {}), 1);
}

TEST(PartPicture, RefusesWhatItCannotShow) {
  const PartMesh mesh = rectangle();
  std::vector<double> values(mesh.points.size(), 1);
  PartPicture picture{.title = "", .unit = "", .values = values, .upper = 1};
  picture.values = picture.values.first(3);
  EXPECT_THROW(part_svg(mesh, picture), Error);
  picture.values = values;
  picture.upper = 0;
  EXPECT_THROW(part_svg(mesh, picture), Error);
  picture.upper = 1;
  values[2] = std::nan("");
  EXPECT_THROW(part_svg(mesh, picture), Error);
}

}  // namespace
}  // namespace flexmorph::io
