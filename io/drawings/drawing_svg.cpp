#include <2geom/affine.h>
#include <2geom/path.h>
#include <2geom/pathvector.h>
#include <2geom/svg-path-parser.h>
#include <2geom/transforms.h>
#include <libxml/parser.h>
#include <libxml/tree.h>

#include <charconv>
#include <cmath>
#include <memory>
#include <numbers>

#include "io/drawings/drawing.h"
#include "io/drawings/length_unit.h"
#include "io/files.h"

/// Reader for SVG files: libxml2 parses the tree, lib2geom (of Inkscape) the paths in it.
namespace flexmorph::io::drawing {
namespace {

std::string name_of(const xmlNode* node) { return reinterpret_cast<const char*>(node->name); }

std::optional<std::string> attribute(xmlNode* node, const char* name) {
  const std::unique_ptr<xmlChar, void (*)(void*)> value(
      xmlGetNoNsProp(node, reinterpret_cast<const xmlChar*>(name)), [](void* p) { xmlFree(p); });
  if (!value) return {};
  return reinterpret_cast<const char*>(value.get());
}

/// Returns numbers that are separated by spaces or commas, up to the end of the text or to a
/// character that belongs to no number, which is an error.
std::vector<double> numbers(std::string_view text) {
  std::vector<double> out;
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(" ,\t\r\n+"), text.size()));
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc()) break;
    out.push_back(value);
    text.remove_prefix(static_cast<size_t>(end - text.data()));
  }
  if (!text.empty()) throw Error::input("'" + std::string(text) + "' is not a number");
  return out;
}

/// A length: its number, and the unit that follows it.
struct Length {
  double value = 0;
  std::string unit;
};
Length length(const std::string& text) {
  Length out;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out.value);
  if (error != std::errc()) throw Error::input("'" + text + "' is not a length");
  out.unit.assign(end, text.data() + text.size());
  return out;
}

double number(xmlNode* node, const char* name, double otherwise = 0) {
  const auto text = attribute(node, name);
  if (!text) return otherwise;
  const Length l = length(*text);
  if (!l.unit.empty() && l.unit != "px")
    throw Error::input(name_of(node) + " with " + name + " = '" + *text +
                       "': the sizes of shapes must have no unit, or the unit px");
  return l.value;
}

Geom::Affine one_transform(const std::string& name, const std::vector<double>& v) {
  const auto has = [&](std::initializer_list<size_t> counts) {
    return std::find(counts.begin(), counts.end(), v.size()) != counts.end();
  };
  if (name == "matrix" && has({6})) return {v[0], v[1], v[2], v[3], v[4], v[5]};
  if (name == "translate" && has({1, 2})) return Geom::Translate(v[0], v.size() > 1 ? v[1] : 0);
  if (name == "scale" && has({1, 2})) return Geom::Scale(v[0], v.size() > 1 ? v[1] : v[0]);
  if (name == "skewX" && has({1})) return {1, 0, std::tan(v[0] * std::numbers::pi / 180), 1, 0, 0};
  if (name == "skewY" && has({1})) return {1, std::tan(v[0] * std::numbers::pi / 180), 0, 1, 0, 0};
  if (name == "rotate" && has({1, 3})) {
    const Geom::Rotate turn = Geom::Rotate::from_degrees(v[0]);
    if (v.size() == 1) return turn;
    return Geom::Translate(-v[1], -v[2]) * turn * Geom::Translate(v[1], v[2]);
  }
  throw Error::input("transform '" + name + "' of " + to_text(static_cast<int>(v.size())) +
                     " numbers is not supported");
}

/// Returns the transformation of the attribute `transform`; the last one in the list is applied
/// first.
Geom::Affine transform(const std::string& text) {
  Geom::Affine out;
  for (size_t at = 0; at < text.size();) {
    at = text.find_first_not_of(" ,\t\r\n", at);
    if (at == std::string::npos) break;
    const size_t open = text.find('(', at), close = text.find(')', at);
    if (open == std::string::npos || close == std::string::npos || close < open)
      throw Error::input("transform = '" + text + "' is not supported");
    std::string name = text.substr(at, open - at);
    name.erase(name.find_last_not_of(" \t\r\n") + 1);
    out = one_transform(name, numbers(text.substr(open + 1, close - open - 1))) * out;
    at = close + 1;
  }
  return out;
}

class Reader {
 public:
  /// Creates a reader.
  /// @param page  transformation from the page to the drawing
  explicit Reader(const Geom::Affine& page) : page_(page) {}

  void read(xmlNode* element, const Geom::Affine& above) {
    for (xmlNode* node = element->children; node != nullptr; node = node->next) {
      if (node->type != XML_ELEMENT_NODE) continue;
      const auto own = attribute(node, "transform");
      const Geom::Affine all = own ? transform(*own) * above : above;
      const std::string name = name_of(node);
      if (name == "g" || name == "a") {
        if (++depth_ > kMaxNesting)
          throw Error::input("groups are nested more than 100 levels deep");
        read(node, all);
        --depth_;
      } else if (name == "use" || name == "svg") {
        throw Error::input(
            name + ": copies and nested svg elements are not supported; convert them to paths");
      } else {
        add(node, name, all * page_);
      }
    }
  }
  Drawing take() { return std::move(drawing_); }

 private:
  static constexpr int kMaxNesting = 100;

  void add(xmlNode* node, const std::string& name, const Geom::Affine& all) {
    const auto at = [&](double x, double y) {
      const Geom::Point p = Geom::Point(x, y) * all;
      return Vec2(p.x(), p.y());
    };
    if (name == "path") {
      add_path(attribute(node, "d").value_or(""), all);
    } else if (name == "polygon" || name == "polyline") {
      const std::vector<double> v = numbers(attribute(node, "points").value_or(""));
      std::vector<Vec2> corners;
      for (size_t k = 0; k + 1 < v.size(); k += 2) corners.push_back(at(v[k], v[k + 1]));
      add_corners(corners, name == "polygon");
    } else if (name == "rect") {
      if (number(node, "rx") != 0 || number(node, "ry") != 0)
        throw Error::input(
            "rect: round corners are not supported; convert the rectangle to a path");
      const double x = number(node, "x"), y = number(node, "y"), w = number(node, "width"),
                   h = number(node, "height");
      add_corners({at(x, y), at(x + w, y), at(x + w, y + h), at(x, y + h)}, true);
    } else if (name == "circle" || name == "ellipse") {
      const bool round = name == "circle";
      const double x = number(node, "cx"), y = number(node, "cy"),
                   rx = number(node, round ? "r" : "rx"), ry = number(node, round ? "r" : "ry");
      const Vec2 center = at(x, y);
      const Curve all_around =
          arc(center, at(x + rx, y) - center, at(x, y + ry) - center, 0, 2 * std::numbers::pi);
      put({{all_around}, true});
    } else if (name == "line") {
      add_corners(
          {at(number(node, "x1"), number(node, "y1")), at(number(node, "x2"), number(node, "y2"))},
          false);
    }
  }

  void add_corners(const std::vector<Vec2>& corners, bool closed) {
    Path path;
    path.closed = closed;
    for (size_t k = 0; k + (closed ? 0 : 1) < corners.size(); ++k)
      path.curves.push_back(line(corners[k], corners[(k + 1) % corners.size()]));
    put(std::move(path));
  }

  void add_path(const std::string& d, const Geom::Affine& all) {
    Geom::PathVector paths;
    try {
      paths = Geom::parse_svg_path(d.c_str());
    } catch (const std::exception& error) {
      throw Error::input("path: " + std::string(error.what()));
    }
    for (const Geom::Path& p : paths* all) {
      Path path;
      path.closed = p.closed();
      const auto end = p.closed() ? p.end_closed() : p.end_open();
      for (auto c = p.begin(); c != end; ++c) {
        const std::shared_ptr<Geom::Curve> curve(c->duplicate());
        path.curves.push_back({[curve](double t) {
                                 const Geom::Point q = curve->pointAt(t);
                                 return Vec2(q.x(), q.y());
                               },
                               curve->isLineSegment()});
      }
      put(std::move(path));
    }
  }

  void put(Path path) {
    if (path.curves.empty()) return;
    n_ += path.curves.size();
    if (n_ > kMaxCurves)
      throw Error::input("it contains more than " + std::to_string(kMaxCurves) + " lines and arcs");
    drawing_.paths.push_back(std::move(path));
  }

  Geom::Affine page_;
  Drawing drawing_;
  size_t n_ = 0;
  int depth_ = 0;
};

/// The page in its own units, and the length of one unit [m] if the attribute `width` gives it.
struct Page {
  double x = 0, y = 0, width = 0, height = 0;
  std::optional<double> unit = {};
};

Page page_of(xmlNode* svg) {
  Page page;
  const auto width = attribute(svg, "width"), height = attribute(svg, "height"),
             box = attribute(svg, "viewBox");
  const Length w = width ? length(*width) : Length{0, "%"};
  if (box) {
    const std::vector<double> v = numbers(*box);
    if (v.size() != 4 || !(v[2] > 0 && v[3] > 0))
      throw Error::input("viewBox = '" + *box +
                         "': it must contain x, y, and the positive width and height of the page");
    page = {v[0], v[1], v[2], v[3], {}};
  } else {
    page.width = w.value;
    page.height = height ? length(*height).value : 0;
  }
  constexpr double kPoint = kInch.metres / 72, kPixel = kInch.metres / 96;
  const LengthUnit* known = find_length_unit(w.unit);
  const double metres = w.unit == "pt"   ? kPoint
                        : w.unit == "pc" ? 12 * kPoint
                        : known          ? known->metres
                                         : 0;
  // Without a view box the units of the page are px.
  if (metres > 0) page.unit = box ? w.value * metres / page.width : kPixel;
  if (metres > 0 && !box) page.height *= metres / kPixel;
  return page;
}

}  // namespace

Drawing read_svg(const std::string& text) {
  constexpr size_t kMaxBytes = 1u << 30;
  if (text.size() > kMaxBytes) throw Error::input("the file is larger than 1 GB");
  const std::unique_ptr<xmlDoc, void (*)(xmlDoc*)> document(
      xmlReadMemory(text.data(), static_cast<int>(text.size()), nullptr, nullptr,
                    XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING),
      xmlFreeDoc);
  if (!document) {
    const xmlError* error = xmlGetLastError();
    throw Error::input("this is not an XML file" +
                       (error != nullptr ? ": line " + std::to_string(error->line) : ""));
  }
  xmlNode* svg = xmlDocGetRootElement(document.get());
  if (svg == nullptr || name_of(svg) != "svg") throw Error::input("this is not an SVG file");
  const Page page = page_of(svg);
  // On the page y points downwards.
  Reader reader(Geom::Affine(1, 0, 0, -1, -page.x, page.y + page.height));
  reader.read(svg, Geom::Affine());
  Drawing out = reader.take();
  out.unit = page.unit;
  return out;
}

}  // namespace flexmorph::io::drawing
