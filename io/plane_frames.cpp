#include "io/plane_frames.h"

#include <algorithm>
#include <cmath>

#include "io/files.h"
#include "io/plots.h"
#include "io/sheet.h"

namespace flexmorph::io {
namespace {

constexpr double kWidth = 1000, kMargin = 30, kFoot = 60;  // in units of the view box
constexpr double kFinest = 2.5;  // smallest width of a drawn cell, in units of the view box
constexpr int kLevels = 8;

/// Returns a length in units of the view box, rounded to tenths, because less is not visible.
std::string tenths(double value) { return to_text(std::round(10 * value) / 10); }

/// The view of all snapshots, so that they can be compared.
struct View {
  Vec2 low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};

  void take(const Vec2& p) {
    if (!p.allFinite()) throw Error::input("plane frames: a point is not finite");
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  void take(const PlaneFrame& frame) {
    for (const PlanePlate& plate : frame.plates)
      for (size_t k = 0; k + 1 < plate.points.size(); k += 2)
        take({plate.points[k], plate.points[k + 1]});
    for (const std::vector<Vec2>& outline : frame.outlines)
      for (const Vec2& p : outline) take(p);
  }
  double scale() const {
    // The height is limited to the largest width.
    return (kWidth - 2 * kMargin) / std::max({high.x() - low.x(), high.y() - low.y(), 1e-12});
  }
  double height() const { return scale() * (high.y() - low.y()) + 2 * kMargin + kFoot; }

  void add(const Vec2& p, std::string& path) const {
    const double left = 0.5 * (kWidth - scale() * (high.x() - low.x()));
    path += tenths(left + scale() * (p.x() - low.x())) + " " +
            tenths(kMargin + scale() * (high.y() - p.y()));
  }
};

/// Returns the grey of a level between white and dark grey.
std::string grey(int level) {
  const std::string value = to_text(255 - (255 - 45) * level / kLevels);
  return "rgb(" + value + "," + value + "," + value + ")";
}

/// A plate whose cells are merged to a visible size.
class CoarsePlate {
 public:
  CoarsePlate(const PlanePlate& plate, double scale) : plate_(plate) {
    const int across = plate.n_across;
    along_ = across > 0 ? static_cast<int>(plate.points.size()) / (2 * (across + 1)) - 1 : 0;
    if (along_ < 1 || plate.density.size() != static_cast<size_t>(along_ * across) ||
        plate.points.size() != 2 * static_cast<size_t>((along_ + 1) * (across + 1)))
      throw Error::input(
          "pictures of planar plates: the numbers of points and cells of a plate do not match");
    stride_i_ = stride(scale * (point(1, 0) - point(0, 0)).norm());
    stride_j_ = stride(scale * (point(0, 1) - point(0, 0)).norm());
  }

  /// Returns the path that fills the cells of one level; each run of cells along the plate is a
  /// closed line.
  std::string runs(int level, const View& view) const {
    std::string path;
    for (int j = 0; j < plate_.n_across; j += stride_j_) {
      const int top = std::min(j + stride_j_, plate_.n_across);
      for (int i = 0; i < along_;) {
        int end = i;
        while (end < along_ && level_of(end, j) == level) end = std::min(end + stride_i_, along_);
        if (end > i) add_strip(i, end, j, top, view, path);
        i = std::max(end, std::min(i + stride_i_, along_));
      }
    }
    return path;
  }
  std::string border(const View& view) const {
    std::string path;
    add_strip(0, along_, 0, plate_.n_across, view, path);
    return path;
  }

 private:
  static int stride(double size) {
    return std::max(1, static_cast<int>(std::lround(kFinest / std::max(size, 1e-3))));
  }
  Vec2 point(int i, int j) const {
    const auto k = 2 * static_cast<size_t>(i * (plate_.n_across + 1) + j);
    return {plate_.points[k], plate_.points[k + 1]};
  }
  int level_of(int i, int j) const {
    double sum = 0;
    int n = 0;
    for (int a = i; a < std::min(i + stride_i_, along_); ++a)
      for (int b = j; b < std::min(j + stride_j_, plate_.n_across); ++b, ++n)
        sum += plate_.density[static_cast<size_t>(a * plate_.n_across + b)];
    if (!std::isfinite(sum)) throw Error::input("plane frames: a density is not finite");
    return static_cast<int>(std::lround(kLevels * std::clamp(sum / n, 0.0, 1.0)));
  }
  void add_strip(int from, int to, int low, int high, const View& view, std::string& path) const {
    const char* next = "M";
    const auto add = [&](int i, int j) {
      path += next;
      view.add(point(i, j), path);
      next = "L";
    };
    // As many points as are needed for a smooth curve.
    const int stride = std::max(stride_i_, along_ / 40);
    for (int i = from; i < to; i += stride) add(i, low);
    for (int j = low; j < high; j += stride_j_) add(to, j);
    for (int i = to; i > from; i -= stride) add(i, high);
    for (int j = high; j > low; j -= stride_j_) add(from, j);
    path += "Z";
  }

  const PlanePlate& plate_;
  int along_ = 0, stride_i_ = 1, stride_j_ = 1;
};

/// Returns a scale bar of 1, 2 or 5 times a power of ten metres in the lower left corner.
std::string scale_bar(const View& view) {
  const double length = nice_ticks(0, kWidth / view.scale(), 6).at(1);
  const double y = view.height() - 0.5 * kFoot, right = kMargin + view.scale() * length;
  return "<path d=\"M" + tenths(kMargin) + " " + tenths(y + 4) + "v-8v4H" + tenths(right) +
         "v-4v8\" fill=\"none\" stroke=\"#222\" stroke-width=\"1.5\"/>\n<text x=\"" +
         tenths(right + 10) + "\" y=\"" + tenths(y + 8) + "\">" + to_text(length, 3) +
         " m</text>\n";
}

std::string picture(const PlaneFrame& frame, const View& view) {
  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + tenths(kWidth) +
                    " " + tenths(view.height()) + "\" font-size=\"26\">\n";
  for (const PlanePlate& each : frame.plates) {
    const CoarsePlate plate(each, view.scale());
    for (int level = 1; level <= kLevels; ++level)
      if (const std::string path = plate.runs(level, view); !path.empty())
        // The stroke closes the seams between neighbouring cells.
        out += "<path d=\"" + path + "\" fill=\"" + grey(level) + "\" stroke=\"" + grey(level) +
               "\" stroke-width=\"0.4\"/>\n";
    out += "<path d=\"" + plate.border(view) + "\" fill=\"none\" stroke=\"#888\"/>\n";
  }
  for (const std::vector<Vec2>& outline : frame.outlines) {
    std::string path;
    for (const Vec2& p : outline) {
      path += path.empty() ? "M" : "L";
      view.add(p, path);
    }
    out += "<path d=\"" + path +
           "Z\" fill=\"#0072b2\" fill-opacity=\"0.12\" stroke=\"#0072b2\" stroke-width=\"2.5\"/>\n";
  }
  return out + scale_bar(view) + "</svg>\n";
}

}  // namespace

std::string plane_frames_svg(const std::string& title, const std::vector<PlaneFrame>& frames,
                             int columns) {
  if (frames.empty()) throw Error::input("plane frames: there is no frame");
  View view;
  for (const PlaneFrame& frame : frames) view.take(frame);
  if (!(view.low.x() <= view.high.x()))
    throw Error::input("plane frames: there is nothing to draw");
  std::vector<SheetEntry> entries;
  for (const PlaneFrame& frame : frames) entries.push_back({frame.title, {picture(frame, view)}});
  return contact_sheet(title, entries, columns);
}

}  // namespace flexmorph::io
