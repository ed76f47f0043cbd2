#include "io/surfaces.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "geometry/base.h"
#include "io/files.h"
#include "io/sheet.h"

namespace flexmorph::io {
namespace {

constexpr double kAzimuth = -55 * std::numbers::pi / 180, kElevation = 25 * std::numbers::pi / 180;
constexpr double kWidth = 1000;  // width of a picture in units of its view box

std::string tenths(double value) { return to_text(std::round(10 * value) / 10); }

Vec3 seen(const double* p) { return seen_from_above({p[0], p[1], p[2]}); }

/// The view of all snapshots, so that they can be compared.
struct View {
  double left = INFINITY, right = -INFINITY, low = INFINITY, high = -INFINITY, largest = 0;

  void take(const SurfaceFrame& frame) {
    for (size_t k = 0; k + 2 < frame.mesh.points.size(); k += 3) {
      const Vec3 at = seen(frame.mesh.points.data() + k);
      left = std::min(left, at[0]);
      right = std::max(right, at[0]);
      low = std::min(low, at[1]);
      high = std::max(high, at[1]);
    }
    for (const double v : frame.values) largest = std::max(largest, v);
  }
  double size() const { return std::max({right - left, high - low, 1e-12}); }
};

/// Returns a colour from dark blue over orange to light yellow.
std::string colour(double share) {
  const double s = std::clamp(share, 0.0, 1.0);
  const double stops[3][3] = {{38, 70, 150}, {225, 120, 60}, {255, 240, 170}};
  const int k = s < 0.5 ? 0 : 1;
  const double t = 2 * s - k;
  char out[8];
  const auto mix = [&](int c) {
    return static_cast<int>(std::lround((1 - t) * stops[k][c] + t * stops[k + 1][c]));
  };
  std::snprintf(out, sizeof out, "#%02x%02x%02x", mix(0), mix(1), mix(2));
  return out;
}

std::string picture(const SurfaceFrame& frame, const View& view) {
  struct Quad {
    double depth;
    size_t number;
  };
  std::vector<Quad> order;
  for (size_t q = 0; q < frame.mesh.quads.size(); ++q) {
    double depth = 0;
    for (const int corner : frame.mesh.quads[q]) depth += seen(&frame.mesh.points[3 * corner])[2];
    order.push_back({depth, q});
  }
  // Far quadrilaterals are drawn first, so that near ones cover them.
  std::stable_sort(order.begin(), order.end(),
                   [](const Quad& a, const Quad& b) { return a.depth < b.depth; });
  const double scale = 0.96 * kWidth / view.size();
  const double height = scale * (view.high - view.low) + 0.04 * kWidth;
  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + to_text(kWidth) +
                    " " + to_text(std::round(height)) + "\">\n";
  for (const Quad& quad : order) {
    out += "<polygon points=\"";
    for (const int corner : frame.mesh.quads[quad.number]) {
      const Vec3 at = seen(&frame.mesh.points[3 * corner]);
      out += tenths(scale * (at[0] - view.left) + 0.02 * kWidth) + "," +
             tenths(scale * (view.high - at[1]) + 0.02 * kWidth) + " ";
    }
    const double share = view.largest > 0 ? std::sqrt(frame.values[quad.number] / view.largest) : 0;
    out += "\" fill=\"" + colour(share) + "\" stroke=\"#222\" stroke-width=\"0.5\"/>\n";
  }
  return out + "</svg>\n";
}

}  // namespace

Vec3 seen_from_above(const Vec3& p) {
  const double along = std::cos(kAzimuth) * p[0] + std::sin(kAzimuth) * p[1];
  return {-std::sin(kAzimuth) * p[0] + std::cos(kAzimuth) * p[1],
          -std::sin(kElevation) * along + std::cos(kElevation) * p[2],
          std::cos(kElevation) * along + std::sin(kElevation) * p[2]};
}

std::string surfaces_svg(const std::string& title, const std::vector<SurfaceFrame>& frames,
                         int columns) {
  if (frames.empty()) throw Error::input("surfaces: there is no frame");
  View view;
  for (const SurfaceFrame& frame : frames) {
    if (frame.mesh.dimension != 3)
      throw Error::input("surfaces: the mesh of a frame is not three-dimensional");
    view.take(frame);
  }
  std::vector<SheetEntry> entries;
  for (const SurfaceFrame& frame : frames) entries.push_back({frame.title, {picture(frame, view)}});
  return contact_sheet(title, entries, columns);
}

}  // namespace flexmorph::io
