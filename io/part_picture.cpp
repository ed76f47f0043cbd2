#include "io/part_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/text.h"
#include "io/encodings.h"
#include "io/files.h"
#include "io/png.h"
#include "io/tables.h"

namespace flexmorph::io {
namespace {

constexpr int kWidth = 960, kMaxHeight = 720;      // pixels
constexpr int kTitle = 34, kBar = 46, kSide = 20;  // margins above, below and beside
constexpr int kMark = 26;                          // height of the line that explains the mark
constexpr double kLetter = 7.3;                    // mean width of a letter of the title
constexpr double kLargest = 0.125;  // largest displacement, as a fraction of the size of the part
constexpr std::array<unsigned char, 3> kInPlace = {225, 225, 225};

/// Splits a six-node triangle into four triangles of corners and middles of sides.
constexpr std::array<std::array<std::size_t, 3>, 4> kParts = {
    {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};

Vec2 size_of(const PartMesh& mesh) {
  Vec2 low = Vec2::Constant(INFINITY), high = -low;
  for (const Vec2& p : mesh.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return high - low;
}

/// Draws the part and the displaced part on pixels.
class Painter {
 public:
  Painter(const PartMesh& mesh, const PartPicture& picture) : mesh_(mesh), picture_(picture) {
    Vec2 low = Vec2::Constant(INFINITY), high = -low;
    for (std::size_t k = 0; k < mesh.points.size(); ++k)
      for (const Vec2& p : {mesh.points[k], displaced(k)}) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
      }
    const Vec2 size = high - low;
    scale_ = std::min(kWidth / size.x(), kMaxHeight / size.y());
    corner_ = {low.x(), high.y()};
    out_.width = std::max(1, static_cast<int>(std::ceil(scale_ * size.x())));
    out_.height = std::max(1, static_cast<int>(std::ceil(scale_ * size.y())));
    out_.values.assign(
        3 * static_cast<std::size_t>(out_.width) * static_cast<std::size_t>(out_.height), 255);
  }

  Pixels paint() {
    for (const bool moved : {false, true})
      for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
        if (moved && !picture_.left_out.empty() && picture_.left_out[t] != 0) continue;
        for (const auto& part : kParts) paint(t, part, moved);
      }
    return std::move(out_);
  }

  /// Returns the pixel at which the node next to a position is shown displaced.
  Vec2 pixel_of(const Vec2& position) const {
    const auto nearest = std::ranges::min_element(
        mesh_.points, {}, [&](const Vec2& p) { return (p - position).squaredNorm(); });
    const Vec2 at = displaced(static_cast<std::size_t>(nearest - mesh_.points.begin()));
    return {scale_ * (at.x() - corner_.x()), scale_ * (corner_.y() - at.y())};
  }

 private:
  Vec2 displaced(std::size_t node) const {
    if (picture_.displacement.empty()) return mesh_.points[node];
    return mesh_.points[node] + picture_.magnification * Vec2(picture_.displacement[2 * node],
                                                              picture_.displacement[2 * node + 1]);
  }

  void paint(std::size_t t, const std::array<std::size_t, 3>& part, bool moved) {
    std::array<Vec2, 3> p;
    std::array<double, 3> value{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto node = static_cast<std::size_t>(mesh_.triangles[t][part[k]]);
      const Vec2 at = moved ? displaced(node) : mesh_.points[node];
      p[k] = {scale_ * (at.x() - corner_.x()), scale_ * (corner_.y() - at.y())};
      value[k] = picture_.values[node];
    }
    const auto cross = [](const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); };
    const double area = cross(p[1] - p[0], p[2] - p[0]);
    if (area == 0) return;
    const auto first = [](double x) { return std::max(0, static_cast<int>(std::floor(x))); };
    const auto [left, right] = std::minmax({p[0].x(), p[1].x(), p[2].x()});
    const auto [top, bottom] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
    for (int y = first(top); y < std::min(out_.height, first(bottom) + 1); ++y)
      for (int x = first(left); x < std::min(out_.width, first(right) + 1); ++x) {
        const Vec2 at(x + 0.5, y + 0.5);
        const double b = cross(at - p[0], p[2] - p[0]) / area,
                     c = cross(p[1] - p[0], at - p[0]) / area, a = 1 - b - c;
        if (a < 0 || b < 0 || c < 0) continue;
        const double share =
            std::clamp((a * value[0] + b * value[1] + c * value[2]) / picture_.upper, 0.0, 1.0);
        const auto color = moved ? map_color(share) : kInPlace;
        std::copy(color.begin(), color.end(),
                  out_.values.begin() + 3 * (static_cast<std::ptrdiff_t>(y) * out_.width + x));
      }
  }

  const PartMesh& mesh_;
  const PartPicture& picture_;
  double scale_ = 1;
  Vec2 corner_{0, 0};  // upper left corner [m]
  Pixels out_;
};

std::string number(double value) { return to_text(value, 3); }

std::string words(double x, double y, const std::string& anchor, const std::string& text) {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor +
         "\" fill=\"#222\">" + xml_escaped(text) + "</text>\n";
}

/// Returns a bar with the colours from 0 to the largest value and labels at its ends.
std::string bar(const PartPicture& picture, double x, double y, double width) {
  constexpr int kSteps = 64;
  std::string out;
  for (int k = 0; k < kSteps; ++k) {
    const auto color = map_color((k + 0.5) / kSteps);
    const std::string hex = formatted("#%02x%02x%02x", color[0], color[1], color[2]);
    out += "<rect x=\"" + to_text(x + k * width / kSteps, 6) + "\" y=\"" + number(y) +
           "\" width=\"" + to_text(1.05 * width / kSteps, 6) + "\" height=\"12\" fill=\"" + hex +
           "\"/>\n";
  }
  return out + words(x, y + 28, "start", "0") +
         words(x + width, y + 28, "end",
               to_text(picture.upper, 3) + " " + picture.unit + " or more");
}

/// Returns a black circle with a white edge, which is visible on all colours.
std::string circle(const Vec2& at) {
  std::string out;
  for (const auto& [color, width] : {std::pair("#fff", 5), {"#000", 2}})
    out += "<circle cx=\"" + to_text(at.x(), 6) + "\" cy=\"" + to_text(at.y(), 6) +
           "\" r=\"8\" fill=\"none\" stroke=\"" + color + "\" stroke-width=\"" +
           std::to_string(width) + "\"/>\n";
  return out;
}

}  // namespace

std::string part_svg(const PartMesh& mesh, const PartPicture& picture) {
  const std::size_t n = mesh.points.size();
  if (picture.values.size() != n ||
      (!picture.displacement.empty() && picture.displacement.size() != 2 * n))
    throw Error::numerical("picture of a part: " + std::to_string(picture.values.size()) +
                           " values for " + std::to_string(n) + " nodes");
  const auto finite = [](std::span<const double> all) {
    return std::all_of(all.begin(), all.end(), [](double v) { return std::isfinite(v); });
  };
  if (!finite(picture.values) || !finite(picture.displacement) || !(picture.upper > 0))
    throw Error::numerical(
        "picture of a part: a value is not finite, or the upper limit of the colours is not "
        "positive");
  Painter painter(mesh, picture);
  const Pixels pixels = painter.paint();
  std::string marks;
  const double below = pixels.height + kTitle + 10;
  if (picture.marked)
    marks = circle(painter.pixel_of(*picture.marked) + Vec2(kSide, kTitle)) +
            circle({kSide + 10, below + 44}) + words(kSide + 26, below + 49, "start", picture.mark);
  const int title = static_cast<int>(kLetter * static_cast<double>(picture.title.size()));
  const int width = std::max({pixels.width, kWidth / 2, title}) + 2 * kSide,
            height = pixels.height + kTitle + kBar + (picture.marked ? kMark : 0);
  const std::string box = std::to_string(width) + " " + std::to_string(height);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" "
         "xmlns:xlink=\"http://www.w3.org/1999/xlink\" viewBox=\"0 0 " +
         box + "\" width=\"" + std::to_string(width) + "\" height=\"" + std::to_string(height) +
         "\" font-family=\"sans-serif\" font-size=\"14\">\n" +
         words(kSide, 20, "start", picture.title) + "<image x=\"" + std::to_string(kSide) +
         "\" y=\"" + std::to_string(kTitle) + "\" width=\"" + std::to_string(pixels.width) +
         "\" height=\"" + std::to_string(pixels.height) + "\" xlink:href=\"data:image/png;base64," +
         base64(png(pixels)) + "\"/>\n" + bar(picture, kSide, below, 0.4 * kWidth) + marks +
         "</svg>\n";
}

double clear_magnification(const PartMesh& mesh, std::span<const double> displacement) {
  double largest = 0;
  for (std::size_t k = 0; k + 1 < displacement.size(); k += 2)
    largest = std::max(largest, std::hypot(displacement[k], displacement[k + 1]));
  if (!(largest > 0)) return 1;
  const double most = kLargest * size_of(mesh).maxCoeff() / largest;
  const double power = std::pow(10, std::floor(std::log10(most)));
  for (const double step : {5.0, 2.0})
    if (step * power <= most) return step * power;
  return power;
}

}  // namespace flexmorph::io
