#include "io/plots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "io/files.h"
#include "io/tables.h"

namespace flexmorph::io {
namespace {

// Colours of Okabe and Ito: colour-blind people can distinguish them, and they are dark enough for
// thin lines.
constexpr std::array<const char*, 7> kColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                "#b8860b", "#56b4e9", "#444444"};
constexpr const char* kDashed = "6 4";
/// Dashes of curves by which curves of equal colour differ.
constexpr std::array<const char*, 4> kDashes = {"", "10 3", "2 3", "10 3 2 3"};
constexpr double kLeft = 88, kRight = 22, kTop = 34, kBottom = 52, kLegendRow = 20;
/// Rows of a legend that belong to the height of a diagram; more rows make the page higher.
constexpr int kIncludedRows = 3;
constexpr double kLetter = 6.6;  // mean width of a letter at 12 px

std::string px(double value) { return to_text(std::round(value * 100) / 100); }

/// Returns the attributes of a position on a page, rounded to hundredths of a pixel.
std::string at(const char* x_name, double x, const char* y_name, double y) {
  return std::string(" ") + x_name + "=\"" + px(x) + "\" " + y_name + "=\"" + px(y) + "\"";
}

std::string text(double x, double y, const std::string& content, const std::string& style) {
  return "<text" + at("x", x, "y", y) + " " + style + ">" + content + "</text>\n";
}

/// The range and the ticks of one axis, and the transformation from data to pixels.
struct Scale {
  bool logarithmic = false;
  double lower = 0, upper = 1;  // limits of the data, or of their decimal logarithm
  double from = 0, to = 1;      // [px]
  std::vector<double> ticks, fine;

  bool shows(double value) const { return std::isfinite(value) && (!logarithmic || value > 0); }
  bool holds(double value) const {
    return shows(value) && inner(value) >= lower - 1e-9 * (upper - lower) &&
           inner(value) <= upper + 1e-9 * (upper - lower);
  }
  double inner(double value) const { return logarithmic ? std::log10(value) : value; }
  double pixel(double value) const {
    return from + (inner(value) - lower) / (upper - lower) * (to - from);
  }
};

void widen(double value, const Scale& scale, double& lower, double& upper) {
  if (!scale.shows(value)) return;
  lower = std::min(lower, scale.inner(value));
  upper = std::max(upper, scale.inner(value));
}

/// Sets the ticks of a logarithmic axis: at decades, or at 1, 2, 5 times decades if there are few.
void set_log_ticks(Scale& s) {
  const int first = static_cast<int>(std::floor(s.lower)),
            last = static_cast<int>(std::ceil(s.upper));
  const int stride = std::max(1, (last - first) / 8);
  const auto inside = [&](double v) {
    return std::log10(v) >= s.lower - 1e-9 && std::log10(v) <= s.upper + 1e-9;
  };
  for (int e = first; e <= last; ++e) {
    const double decade = std::pow(10.0, e);
    for (int k = 1; k < 10; ++k) {
      const double value = k * decade;
      if (!inside(value)) continue;
      const bool few = s.upper - s.lower < 2.2;
      const bool is_tick =
          few ? (k == 1 || k == 2 || k == 5) : (k == 1 && (e - first) % stride == 0);
      if (is_tick)
        s.ticks.push_back(value);
      else if (stride == 1)
        s.fine.push_back(value);
    }
  }
}

Scale make_scale(const Axis& axis, const std::vector<Curve>& curves, bool is_x, double from,
                 double to) {
  Scale s;
  s.logarithmic = axis.logarithmic;
  s.from = from;
  s.to = to;
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;
  for (const Curve& c : curves)
    for (const double value : is_x ? c.x : c.y) widen(value, s, lower, upper);
  if (!(lower <= upper)) lower = 0, upper = 1;  // no data: the frame is empty
  if (axis.lower && s.shows(*axis.lower)) lower = s.inner(*axis.lower);
  if (axis.upper && s.shows(*axis.upper)) upper = s.inner(*axis.upper);
  // A constant also gets a range, which is larger than the round-off of its value.
  const double size = std::max(std::abs(lower), std::abs(upper));
  if (upper - lower <= 1e-12 * size || upper <= lower) {
    const double half = s.logarithmic ? 0.5 : (size > 0 ? 0.05 * size : 1);
    lower -= half;
    upper += half;
  } else if (!is_x) {
    const double margin = 0.05 * (upper - lower);
    if (!axis.lower) lower = !s.logarithmic && lower >= 0 && lower < margin ? 0 : lower - margin;
    if (!axis.upper) upper = upper + margin;
  }
  s.lower = lower;
  s.upper = upper;
  if (s.logarithmic) {
    set_log_ticks(s);
  } else {
    s.ticks = nice_ticks(lower, upper, static_cast<int>(std::abs(to - from) / (is_x ? 80 : 34)));
  }
  return s;
}

/// Returns the label of a tick, "0.05" or "1.2·10⁶": a decimal number if it is short, else with a
/// power of ten.
std::string tick_label(double value, const Scale& s) {
  const double largest =
      s.logarithmic ? std::abs(value) : std::max(std::abs(s.lower), std::abs(s.upper));
  const bool plain = largest < 1e5 && largest >= 1e-3;
  if (value == 0) return "0";
  if (plain) return to_text(value, 7);
  int exponent = static_cast<int>(std::floor(std::log10(largest) + 1e-9));
  const double factor = value / std::pow(10.0, exponent);
  const std::string power = "10<tspan dy=\"-5\" font-size=\"9\">" + to_text(exponent) + "</tspan>";
  const std::string digits = to_text(factor, 5);
  return s.logarithmic && digits == "1" ? power : digits + "\xC2\xB7" + power;
}

std::string grid_lines(const Scale& x, const Scale& y) {
  std::string out;
  const auto vertical = [&](double value, const char* color) {
    out += "<line" + at("x1", x.pixel(value), "y1", y.from) + at("x2", x.pixel(value), "y2", y.to) +
           " stroke=\"" + color + "\"/>\n";
  };
  const auto horizontal = [&](double value, const char* color) {
    out += "<line" + at("x1", x.from, "y1", y.pixel(value)) + at("x2", x.to, "y2", y.pixel(value)) +
           " stroke=\"" + color + "\"/>\n";
  };
  for (const double v : x.fine) vertical(v, "#f1f1f1");
  for (const double v : y.fine) horizontal(v, "#f1f1f1");
  for (const double v : x.ticks) vertical(v, "#dcdcdc");
  for (const double v : y.ticks) horizontal(v, "#dcdcdc");
  for (const double v : x.ticks)
    out += text(x.pixel(v), y.from + 18, tick_label(v, x), "text-anchor=\"middle\"");
  for (const double v : y.ticks)
    out += text(x.from - 8, y.pixel(v) + 4, tick_label(v, y), "text-anchor=\"end\"");
  return out;
}

std::string style_of(const Curve& curve, size_t index) {
  const size_t number = curve.color.value_or(index);
  const size_t repetition = curve.name.empty() ? 0 : number / kColors.size();
  const std::string dashes = curve.dashed ? kDashed : kDashes[repetition % kDashes.size()];
  return std::string(" stroke=\"") + kColors[number % kColors.size()] + "\" stroke-width=\"" +
         (curve.thin ? "0.6" : "1.7") + "\" fill=\"none\" stroke-linejoin=\"round\"" +
         (dashes.empty() ? "" : " stroke-dasharray=\"" + dashes + "\"");
}

std::string marker(double x, double y, const Curve& curve, size_t index) {
  return "<circle" + at("cx", x, "cy", y) + " r=\"3\" fill=\"" +
         kColors[curve.color.value_or(index) % kColors.size()] + "\"/>\n";
}

std::string line_svg(const Curve& curve, size_t index, const Scale& x, const Scale& y) {
  std::string path, last;
  bool pen_down = false;
  for (size_t i = 0; curve.line && i < std::min(curve.x.size(), curve.y.size()); ++i) {
    if (!x.shows(curve.x[i]) || !y.shows(curve.y[i])) {
      pen_down = false;
      continue;
    }
    const std::string point = px(x.pixel(curve.x[i])) + " " + px(y.pixel(curve.y[i]));
    if (!pen_down || point != last) path += (pen_down ? "L" : "M") + point;
    pen_down = true;
    last = point;
  }
  return path.empty() ? "" : "<path d=\"" + path + "\"" + style_of(curve, index) + "/>\n";
}

/// Returns the markers inside the frame; markers on its border are not cut.
std::string markers_svg(const Curve& curve, size_t index, const Scale& x, const Scale& y) {
  std::string out;
  for (size_t i = 0; curve.markers && i < std::min(curve.x.size(), curve.y.size()); ++i)
    if (x.holds(curve.x[i]) && y.holds(curve.y[i]))
      out += marker(x.pixel(curve.x[i]), y.pixel(curve.y[i]), curve, index);
  return out;
}

/// The names of the curves in rows above the frame: the position of each name, and the number of
/// rows.
struct Legend {
  struct Entry {
    size_t curve;
    double x;
    int row;
  };
  std::vector<Entry> entries;
  int rows = 0;
};

Legend lay_out_legend(const Panel& panel, double width) {
  Legend legend;
  double x = 0;
  for (size_t i = 0; i < panel.curves.size(); ++i) {
    if (panel.curves[i].name.empty()) continue;
    const double wide = 40 + kLetter * static_cast<double>(panel.curves[i].name.size());
    if (legend.rows == 0) legend.rows = 1;
    if (x > 0 && x + wide > width) {
      x = 0;
      ++legend.rows;
    }
    legend.entries.push_back({i, x, legend.rows - 1});
    x += wide + 12;
  }
  return legend;
}

std::string legend_svg(const Panel& panel, const Legend& legend, double left, double top) {
  std::string out;
  for (const Legend::Entry& entry : legend.entries) {
    const Curve& curve = panel.curves[entry.curve];
    const double x = left + entry.x, y = top + kLegendRow * (entry.row + 0.5);
    if (curve.line)
      out += "<path d=\"M" + px(x) + " " + px(y) + "h26\"" + style_of(curve, entry.curve) + "/>\n";
    if (curve.markers) out += marker(x + 13, y, curve, entry.curve);
    out += text(x + 33, y + 4, xml_escaped(curve.name), "");
  }
  return out;
}

/// Returns the height of a diagram with its legend [px].
double height_of(const Panel& panel, const Figure& figure) {
  const int rows = lay_out_legend(panel, figure.width - kRight - kLeft).rows;
  return figure.panel_height + kLegendRow * std::max(0, rows - kIncludedRows);
}

std::string panel_svg(const Panel& panel, double top, double width, double height) {
  const double left = kLeft, right = width - kRight;
  const Legend legend = lay_out_legend(panel, right - left);
  const double title_height = panel.title.empty() ? 10 : kTop;
  const double frame_top = top + title_height + kLegendRow * legend.rows + (legend.rows ? 4 : 0);
  const double frame_bottom = top + height - kBottom;
  const Scale x = make_scale(panel.x, panel.curves, true, left, right);
  const Scale y = make_scale(panel.y, panel.curves, false, frame_bottom, frame_top);

  std::string out;
  if (!panel.title.empty())
    out += text(left, top + 22, xml_escaped(panel.title), "font-size=\"14\" font-weight=\"bold\"");
  out += legend_svg(panel, legend, left, top + title_height);
  out += grid_lines(x, y);
  const std::string location =
      at("x", left, "y", frame_top) + at("width", right - left, "height", frame_bottom - frame_top);
  // A nested SVG element clips lines at the frame. A clip path would need a name, and names would
  // collide if several figures are in one report.
  out += "<svg" + location + " viewBox=\"" + px(left) + " " + px(frame_top) + " " +
         px(right - left) + " " + px(frame_bottom - frame_top) + "\">\n";
  for (size_t i = 0; i < panel.curves.size(); ++i) out += line_svg(panel.curves[i], i, x, y);
  out += "</svg>\n<rect" + location + " fill=\"none\" stroke=\"#666\"/>\n";
  for (size_t i = 0; i < panel.curves.size(); ++i) out += markers_svg(panel.curves[i], i, x, y);
  out += text(0.5 * (left + right), frame_bottom + 40, xml_escaped(panel.x.label),
              "text-anchor=\"middle\"");
  const double middle = 0.5 * (frame_top + frame_bottom);
  out += text(14, middle, xml_escaped(panel.y.label),
              "text-anchor=\"middle\" transform=\"rotate(-90 14 " + px(middle) + ")\"");
  return out;
}

}  // namespace

std::vector<double> nice_ticks(double lower, double upper, int wanted) {
  const double rough = (upper - lower) / std::max(1, wanted);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double share = rough / power;
  const double step = power * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
  std::vector<double> ticks;
  // Ticks are multiples of the step, so that no round-off accumulates.
  const double first = std::ceil(lower / step - 1e-9), last = std::floor(upper / step + 1e-9);
  for (int i = 0; i <= static_cast<int>(last - first); ++i)
    ticks.push_back((first + i) * step + 0.0);  // + 0.0 turns -0 into 0
  return ticks;
}

std::string plot_svg(const Figure& figure) {
  const double head = figure.title.empty() ? 6 : 40;
  double height = head;
  for (const Panel& panel : figure.panels) height += height_of(panel, figure);
  const std::string size = px(figure.width) + " " + px(height);
  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + size +
                    "\" width=\"" + px(figure.width) + "\" height=\"" + px(height) +
                    "\" font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\" "
                    "font-size=\"12\" fill=\"#222\">\n<rect width=\"100%\" height=\"100%\" "
                    "fill=\"white\"/>\n";
  if (!figure.title.empty())
    out += text(kLeft, 28, xml_escaped(figure.title), "font-size=\"17\" font-weight=\"bold\"");
  double top = head;
  for (const Panel& panel : figure.panels) {
    out += panel_svg(panel, top, figure.width, height_of(panel, figure));
    top += height_of(panel, figure);
  }
  return out + "</svg>\n";
}

std::string outline_svg(std::span<const Region> regions, const Box& frame, int digits) {
  const Vec2 size = frame.upper - frame.lower;
  const auto number = [&](double x) { return digits > 0 ? to_text(x, digits) : to_text(x); };
  const auto ring = [&](const std::vector<Vec2>& points) {
    std::string path;
    for (size_t i = 0; i < points.size(); ++i) {
      path += i ? "L" : "M";
      path += number(points[i].x()) + " " + number(points[i].y());
    }
    return path + "Z";
  };
  std::string path;
  for (const Region& region : regions) {
    path += ring(region.outer);
    for (const std::vector<Vec2>& hole : region.holes) path += ring(hole);
  }
  const double line = 0.002 * size.maxCoeff();
  // In SVG y points downwards, therefore the group is mirrored about the middle of the frame.
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"" + to_text(frame.lower.x()) + " " +
         to_text(frame.lower.y()) + " " + to_text(size.x()) + " " + to_text(size.y()) +
         "\" width=\"" + to_text(1000 * size.x(), 9) + "mm\" height=\"" +
         to_text(1000 * size.y(), 9) + "mm\">\n<g transform=\"matrix(1 0 0 -1 0 " +
         to_text(frame.lower.y() + frame.upper.y()) + ")\">\n<rect x=\"" +
         to_text(frame.lower.x()) + "\" y=\"" + to_text(frame.lower.y()) + "\" width=\"" +
         to_text(size.x()) + "\" height=\"" + to_text(size.y()) +
         "\" fill=\"white\" stroke=\"#666\" stroke-width=\"" + to_text(line, 3) +
         "\"/>\n<path fill-rule=\"evenodd\" fill=\"#3b528b\" d=\"" + path + "\"/>\n</g>\n</svg>\n";
}

}  // namespace flexmorph::io
