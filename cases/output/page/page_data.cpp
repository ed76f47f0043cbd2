#include "cases/output/page/page_data.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "io/files.h"

namespace flexmorph::cases {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kPlaceUnit = 1e-8;  // of the size of the picture of a motion, and of a radian
constexpr double kOutlineUnit = 1e-5, kParameterUnit = 1e-4;  // of the size of the design domain
constexpr double kOutlineTolerance = 1e-3;                    // of the size of the design domain
constexpr size_t kMaxPathFrames = 151;
constexpr size_t kMaxCurvePoints = 2000;  // of a curve

/// Returns numbers as multiples of a unit.
Json multiples(std::span<const double> values, double unit) {
  Json out = Json::array();
  for (const double value : values) out.push_back(std::llround(value / unit));
  return out;
}

/// Returns poses (x, y, angle) as multiples of a unit of length and of kPlaceUnit radians.
Json pose_multiples(std::span<const double> poses, double unit) {
  Json out = Json::array();
  for (size_t i = 0; i < poses.size(); ++i)
    out.push_back(std::llround(poses[i] / (i % 3 == 2 ? kPlaceUnit : unit)));
  return out;
}

double size_of(const Box& box) { return (box.upper - box.lower).maxCoeff(); }

Json box_data(const Box& box) {
  return {box.lower.x(), box.lower.y(), box.upper.x(), box.upper.y()};
}

/// Returns a number with `digits` significant digits.
double rounded(double value, int digits) {
  const std::string text = io::to_text(value, digits);
  double out = value;
  std::from_chars(text.data(), text.data() + text.size(), out);
  return out;
}

Json number_data(double value) { return std::isfinite(value) ? Json(rounded(value, 6)) : Json(); }

/// Returns the box around everything that moves.
Box box_of(const Animation& animation) {
  Box out{{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
  const auto add = [&](double x, double y) {
    out.lower = out.lower.cwiseMin(Vec2(x, y));
    out.upper = out.upper.cwiseMax(Vec2(x, y));
  };
  for (const AnimatedBody& body : animation.bodies) {
    for (size_t k = 0; k + 1 < body.points.size(); k += 2) add(body.points[k], body.points[k + 1]);
    for (size_t f = 0; f + 2 < body.poses.size(); f += 3) {
      const double x = body.poses[f], y = body.poses[f + 1];
      const double c = std::cos(body.poses[f + 2]), s = std::sin(body.poses[f + 2]);
      if (body.kind != AnimatedBody::Kind::grid) add(x - body.width, y - body.width);
      if (body.kind != AnimatedBody::Kind::grid) add(x + body.width, y + body.width);
      if (body.kind == AnimatedBody::Kind::rigid)
        for (const std::vector<double>* corners : {&body.shape, &body.anchors})
          for (size_t k = 0; k + 1 < corners->size(); k += 2)
            add(x + c * (*corners)[k] - s * (*corners)[k + 1],
                y + s * (*corners)[k] + c * (*corners)[k + 1]);
    }
  }
  for (const AnimatedMark& mark : animation.marks)
    for (size_t f = 0; f + 2 < mark.at.size(); f += 3) add(mark.at[f], mark.at[f + 1]);
  for (const AnimatedSpring& spring : animation.springs)
    for (size_t k = 0; k + 1 < spring.ends.size(); k += 2) add(spring.ends[k], spring.ends[k + 1]);
  return out;
}

/// Returns the frames that the page has: all of a motion, and of a long path equally spaced ones
/// with the first and the last one.
std::vector<size_t> shown_frames(const Animation& animation) {
  const size_t n = animation.time.size();
  const size_t most = animation.factor.empty() ? n : std::min(n, kMaxPathFrames);
  std::vector<size_t> out;
  for (size_t k = 0; k < most; ++k) out.push_back(most > 1 ? k * (n - 1) / (most - 1) : 0);
  return out;
}

/// Returns the values of the shown frames, `width` values per frame.
std::vector<double> chosen(const std::vector<double>& all, const std::vector<size_t>& frames,
                           size_t width) {
  std::vector<double> out;
  for (const size_t f : frames)
    for (size_t k = f * width; k < std::min(all.size(), (f + 1) * width); ++k)
      out.push_back(all[k]);
  return out;
}

const char* kind_of(const AnimatedBody& body) {
  switch (body.kind) {
    case AnimatedBody::Kind::grid:
      return "grid";
    case AnimatedBody::Kind::rigid:
      return "rigid";
    case AnimatedBody::Kind::hub:
      return "hub";
    default:
      return "mass";
  }
}

Json polygon_data(const std::vector<Vec2>& ring, double unit) {
  Json out = Json::array();
  for (const Vec2& p : ring)
    for (int c = 0; c < 2; ++c) out.push_back(std::llround(p[c] / unit));
  return out;
}

/// Returns the points of a curve that are drawn: all, or the extreme values of short intervals.
std::vector<size_t> shown_points(const io::Curve& curve) {
  const size_t n = std::min(curve.x.size(), curve.y.size());
  const size_t stride = std::max<size_t>(1, (2 * n + kMaxCurvePoints - 1) / kMaxCurvePoints);
  std::vector<size_t> out;
  if (n <= kMaxCurvePoints) {
    for (size_t i = 0; i < n; ++i) out.push_back(i);
    return out;
  }
  for (size_t begin = 0; begin < n; begin += stride) {
    const auto from = curve.y.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto to = curve.y.begin() + static_cast<std::ptrdiff_t>(std::min(begin + stride, n));
    const auto [low, high] = std::minmax_element(from, to);
    const auto a = static_cast<size_t>(std::min(low, high) - curve.y.begin()),
               b = static_cast<size_t>(std::max(low, high) - curve.y.begin());
    out.push_back(a);
    if (b != a) out.push_back(b);
  }
  return out;
}

Json curve_data(const io::Curve& curve) {
  Json out = {{"name", curve.name}, {"x", Json::array()}, {"y", Json::array()}};
  for (const size_t i : shown_points(curve)) {
    out["x"].push_back(number_data(curve.x[i]));
    out["y"].push_back(number_data(curve.y[i]));
  }
  if (!curve.line) out["line"] = false;
  if (curve.markers) out["markers"] = true;
  if (curve.dashed) out["dashed"] = true;
  if (curve.thin) out["thin"] = true;
  if (curve.color) out["color"] = *curve.color;
  return out;
}

Json axis_data(const io::Axis& axis) {
  Json out = {{"label", axis.label}};
  if (axis.logarithmic) out["logarithmic"] = true;
  return out;
}

}  // namespace

Json animation_data(const Animation& animation) {
  const Box box = box_of(animation);
  const double unit = kPlaceUnit * size_of(box);
  Json out = {{"unit", unit}, {"angle_unit", kPlaceUnit}, {"box", box_data(box)}};
  const size_t n_frames = animation.time.size();
  const std::vector<size_t> shown = shown_frames(animation);
  out["time"] = chosen(animation.time, shown, 1);
  if (!animation.factor.empty()) out["factor"] = chosen(animation.factor, shown, 1);
  for (const AnimatedBody& body : animation.bodies) {
    Json& each = out["bodies"].emplace_back();
    each = {{"name", body.name}, {"kind", kind_of(body)}, {"width", body.width}};
    each["poses"] = pose_multiples(chosen(body.poses, shown, 3), unit);
    if (!body.shape.empty()) each["shape"] = multiples(body.shape, unit);
    if (!body.anchors.empty()) each["anchors"] = multiples(body.anchors, unit);
    if (body.kind != AnimatedBody::Kind::grid) continue;
    each["along"] = body.along;
    each["across"] = body.across;
    each["largest"] = body.largest;
    each["roots"] = multiples(chosen(body.roots, shown, 1), unit);
    const size_t n = body.points.size() / n_frames;
    for (const size_t f : shown) {
      each["points"].push_back(multiples(std::span(body.points).subspan(f * n, n), unit));
      if (!body.rigid.empty())
        each["rigid"].push_back(multiples(std::span(body.rigid).subspan(f * n, n), unit));
    }
  }
  for (const AnimatedMark& mark : animation.marks)
    out["marks"].push_back({{"name", mark.name},
                            {"type", mark.type},
                            {"ground", mark.ground},
                            {"driven", mark.driven},
                            {"at", pose_multiples(chosen(mark.at, shown, 3), unit)}});
  for (const AnimatedSpring& spring : animation.springs)
    out["springs"].push_back({{"name", spring.name},
                              {"type", spring.type},
                              {"ends", multiples(chosen(spring.ends, shown, 4), unit)}});
  return out;
}

Json static_loads_data(const Grid& g, std::span<const StaticLoad> loads) {
  constexpr int kIntervals = 24;
  const auto lines = [](int cells, int intervals) {
    std::vector<int> out;
    for (int k = 0; k <= intervals; ++k) out.push_back(k * cells / intervals);
    return out;
  };
  const int n = std::min(kIntervals, std::max(g.nx, g.ny)), longest = std::max(g.nx, g.ny);
  const std::vector<int> along = lines(g.nx, std::max(1, g.nx * n / longest)),
                         across = lines(g.ny, std::max(1, g.ny * n / longest));
  Json out = Json::object();
  for (const StaticLoad& load : loads) {
    if (load.displacement.size() == 0) continue;
    const double largest = load.displacement.lpNorm<Eigen::Infinity>(), unit = 1e-4 * largest;
    Json& each = out["loads"].emplace_back();
    each = {{"name", load.name}, {"unit", unit}, {"displacement", Json::array()}};
    for (const int i : along)
      for (const int j : across)
        for (int c = 0; c < 2; ++c)
          each["displacement"].push_back(
              unit > 0 ? std::llround(load.displacement[2 * g.node(i, j) + c] / unit) : 0);
  }
  if (out.empty()) return out;
  for (const int i : along) out["x"].push_back(g.x0 + i * g.dx());
  for (const int j : across) out["y"].push_back(g.y0 + j * g.dy());
  return out;
}

std::vector<Vec2> thinned(const std::vector<Vec2>& ring, double tolerance) {
  std::vector<Vec2> out = {ring.front()};
  size_t kept = 0;
  for (size_t next = 2; next < ring.size(); ++next) {
    const Vec2 chord = ring[next] - ring[kept];
    const double length = std::max(chord.norm(), 1e-300);
    bool is_straight = true;
    for (size_t k = kept + 1; k < next && is_straight; ++k) {
      const Vec2 d = ring[k] - ring[kept];
      is_straight = std::abs(chord.x() * d.y() - chord.y() * d.x()) <= tolerance * length;
    }
    if (is_straight) continue;
    kept = next - 1;
    out.push_back(ring[kept]);
  }
  out.push_back(ring.back());
  return out;
}

Json outline_data(std::span<const Region> outline, const Box& frame) {
  const double unit = kOutlineUnit * size_of(frame);
  Json out = {{"unit", unit}, {"box", box_data(frame)}, {"rings", Json::array()}};
  for (const Region& region : outline)
    for (const std::vector<Vec2>& ring : rings_of(region))
      if (!ring.empty())
        out["rings"].push_back(
            polygon_data(thinned(ring, kOutlineTolerance * size_of(frame)), unit));
  return out;
}

Json history_data(const RunFolder::History& history, const Box& frame) {
  const double unit = kParameterUnit * size_of(frame);
  Json out = {{"body", history.body}, {"unit", unit}, {"box", box_data(frame)}};
  out["angle_unit"] = kParameterUnit;
  out["min_half_thickness"] = history.min_half_thickness;
  for (const auto& [name, polygons] :
       {std::pair{"solid", &history.solid}, {"empty", &history.empty}})
    for (const std::vector<Vec2>& polygon : *polygons)
      out[name].push_back(polygon_data(polygon, unit));
  for (const auto& [name, values] : {std::pair{"compliance", &history.compliance},
                                     {"volume", &history.volume},
                                     {"kkt", &history.kkt}})
    for (const double value : *values) out[name].push_back(number_data(value));
  std::vector<long long> last;
  for (const std::vector<float>& parameters : history.components) {
    std::vector<long long> now;
    for (size_t i = 0; i < parameters.size(); ++i) {
      const bool is_angle = i % Component::kParameters == 3;
      now.push_back(std::llround(double(parameters[i]) / (is_angle ? kParameterUnit : unit)));
    }
    Json entry = Json::array();
    const bool whole = now.size() != last.size();
    if (!now.empty()) entry.push_back(whole ? 1 : 0);
    for (size_t i = 0; i < now.size(); ++i) entry.push_back(whole ? now[i] : now[i] - last[i]);
    out["components"].push_back(std::move(entry));
    last = std::move(now);
  }
  return out;
}

Json figure_data(const io::Figure& figure) {
  Json out = {{"title", figure.title}, {"panels", Json::array()}};
  for (const io::Panel& panel : figure.panels) {
    Json each = {{"title", panel.title}, {"x", axis_data(panel.x)}, {"y", axis_data(panel.y)}};
    for (const io::Curve& curve : panel.curves) each["curves"].push_back(curve_data(curve));
    out["panels"].push_back(std::move(each));
  }
  return out;
}

}  // namespace flexmorph::cases
