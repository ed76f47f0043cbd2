#include <dl_creationadapter.h>
#include <dl_dxf.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <sstream>
#include <utility>

#include "io/drawings/drawing.h"
#include "io/drawings/length_unit.h"

/// Reader for DXF files. It uses dxflib, which returns entities unchanged, with the unit of the
/// file.
namespace flexmorph::io::drawing {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;
constexpr const char* kDimension = "DIMENSION";

/// Returns a side of a polyline: a line, or an arc of the angle 4 atan(bulge), which lies to the
/// left of the side if the bulge is negative.
Curve side(const Vec2& a, const Vec2& b, double bulge) {
  if (bulge == 0 || a == b) return line(a, b);
  const Vec2 half = 0.5 * (b - a), left(-half.y(), half.x());
  const Vec2 center = a + half + left * (1 - bulge * bulge) / (2 * bulge);
  const Vec2 radius = a - center, across(-radius.y(), radius.x());
  Curve curve = arc(center, radius, across, 0, 4 * std::atan(bulge));
  // Neighbouring sides must meet exactly.
  curve.at = [a, b, round = std::move(curve.at)](double t) {
    return t == 0 ? a : t == 1 ? b : round(t);
  };
  return curve;
}

/// Returns the words of a name in small letters. Other bytes than those of ASCII count as letters.
std::vector<std::string> split_name(const std::string& name) {
  std::vector<std::string> out(1);
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte > 127 || std::isalpha(byte))
      out.back() += static_cast<char>(byte > 127 ? byte : std::tolower(byte));
    else if (!out.back().empty())
      out.emplace_back();
  }
  return out;
}

class Reader : public DL_CreationAdapter {
 public:
  explicit Reader(const std::vector<std::string>& layers) : layers_(layers) {}

  Drawing take() {
    finish();
    for (const auto& [layer, count] : unread_)
      for (int k = 0; k < count; ++k) {
        const std::string on =
            " on the layer '" + layer + "' of dimensions or texts (`layers` does not name it)";
        drawing_.ignored.add("curve" + on, "curves" + on);
      }
    for (const std::string& layer : layers_)
      if (!known_.contains(layer))
        throw Error::input("the layer '" + layer + "' contains no curves");
    return std::move(drawing_);
  }

  /// Returns the names of the layers on which something is drawn.
  const std::set<std::string>& known() const { return known_; }

  void setVariableInt(const std::string& key, int value, int) override {
    const LengthUnit* unit = find_length_unit(value);
    if (key == "$INSUNITS" && unit != nullptr) drawing_.unit = unit->metres;
  }

  // The contents of a block are drawn where the block is inserted.
  void addBlock(const DL_BlockData&) override { in_block_ = true; }
  void endBlock() override { in_block_ = false; }
  void addInsert(const DL_InsertData&) override {
    refuse("INSERT: blocks are not supported; explode them in the CAD program");
  }
  void addSpline(const DL_SplineData& d) override {
    finish();
    in_spline_ = wanted();
    if (in_spline_ && d.nControl == 0)
      throw Error::input("SPLINE: it has only fit points, but control points are needed");
    spline_.degree = d.degree;
    closed_ = (d.flags & 1) != 0;
  }
  void addKnot(const DL_KnotData& d) override {
    if (in_spline_) spline_.knots.push_back(d.k);
  }
  void addControlPoint(const DL_ControlPointData& d) override {
    if (!in_spline_) return;
    spline_.points.emplace_back(d.x, d.y);
    spline_.weights.push_back(d.w);
    count();
  }

  void addLine(const DL_LineData& d) override { add({line({d.x1, d.y1}, {d.x2, d.y2})}, false); }
  void addArc(const DL_ArcData& d) override {
    double to = d.angle2;
    while (to <= d.angle1 && std::isfinite(d.angle1 - to)) to += 360;
    const double r = d.radius;
    add({arc({d.cx, d.cy}, {r, 0}, {0, r}, d.angle1 * kDegree, to * kDegree)}, false);
  }
  void addCircle(const DL_CircleData& d) override {
    add({arc({d.cx, d.cy}, {d.radius, 0}, {0, d.radius}, 0, 2 * kPi)}, true);
  }
  void addEllipse(const DL_EllipseData& d) override {
    double to = d.angle2;
    while (to <= d.angle1 && std::isfinite(d.angle1 - to)) to += 2 * kPi;
    const Vec2 major(d.mx, d.my), minor(-d.ratio * d.my, d.ratio * d.mx);
    add({arc({d.cx, d.cy}, major, minor, d.angle1, to)}, to - d.angle1 > 2 * kPi - 1e-9);
  }
  void addPolyline(const DL_PolylineData& d) override {
    finish();
    polyline_ = wanted();
    closed_ = (d.flags & 1) != 0;
  }
  void addVertex(const DL_VertexData& d) override {
    if (!polyline_) return;
    vertices_.push_back(d);
    count();
  }
  void endEntity() override { finish(); }
  void endSequence() override { finish(); }

  void addText(const DL_TextData&) override { ignore("TEXT"); }
  void addMText(const DL_MTextData&) override { ignore("MTEXT"); }
  void addArcAlignedText(const DL_ArcAlignedTextData&) override { ignore("ARCALIGNEDTEXT"); }
  void addAttribute(const DL_AttributeData&) override { ignore("ATTRIB"); }
  void addLeader(const DL_LeaderData&) override { ignore("LEADER"); }
  void addHatch(const DL_HatchData&) override { ignore("HATCH"); }
  void addPoint(const DL_PointData&) override { ignore("POINT"); }
  void addSolid(const DL_SolidData&) override { ignore("SOLID"); }
  void addTrace(const DL_TraceData&) override { ignore("TRACE"); }
  void addImage(const DL_ImageData&) override { ignore("IMAGE"); }
  void addXLine(const DL_XLineData&) override { ignore("XLINE"); }
  void addRay(const DL_RayData&) override { ignore("RAY"); }
  void addDimAlign(const DL_DimensionData&, const DL_DimAlignedData&) override {
    ignore(kDimension);
  }
  void addDimLinear(const DL_DimensionData&, const DL_DimLinearData&) override {
    ignore(kDimension);
  }
  void addDimRadial(const DL_DimensionData&, const DL_DimRadialData&) override {
    ignore(kDimension);
  }
  void addDimDiametric(const DL_DimensionData&, const DL_DimDiametricData&) override {
    ignore(kDimension);
  }
  void addDimAngular(const DL_DimensionData&, const DL_DimAngular2LData&) override {
    ignore(kDimension);
  }
  void addDimAngular3P(const DL_DimensionData&, const DL_DimAngular3PData&) override {
    ignore(kDimension);
  }
  void addDimOrdinate(const DL_DimensionData&, const DL_DimOrdinateData&) override {
    ignore(kDimension);
  }

 private:
  bool wanted() {
    if (in_block_) return false;
    const std::string layer = getAttributes().getLayer();
    known_.insert(layer);
    if (layers_.empty() && is_annotation_layer(layer)) {
      ++unread_[layer];
      return false;
    }
    return is_read(layer);
  }
  bool is_read(const std::string& layer) const {
    return layers_.empty() || std::find(layers_.begin(), layers_.end(), layer) != layers_.end();
  }
  /// Counts an entity that is no curve.
  void ignore(const std::string& name) {
    finish();
    const std::string layer = getAttributes().getLayer();
    if (!in_block_ && is_read(layer)) drawing_.ignored.add(name + " entity", name + " entities");
  }
  void refuse(const std::string& what) {
    if (wanted()) throw Error::input(what);
  }
  void count() {
    if (++n_ > kMaxCurves)
      throw Error::input("it contains more than " + std::to_string(kMaxCurves) + " lines and arcs");
  }
  void add(std::vector<Curve> curves, bool closed) {
    finish();
    if (!wanted()) return;
    count();
    drawing_.paths.push_back({std::move(curves), closed});
  }
  /// Adds the spline or polyline whose points have been read.
  void finish() {
    if (in_spline_) {
      in_spline_ = false;
      drawing_.paths.push_back({spline(std::exchange(spline_, {})), closed_});
    }
    if (!polyline_) return;
    polyline_ = false;
    Path path;
    path.closed = closed_;
    const size_t n = vertices_.size();
    for (size_t k = 0; k < (closed_ ? n : n - std::min<size_t>(n, 1)); ++k) {
      const DL_VertexData &a = vertices_[k], &b = vertices_[(k + 1) % n];
      path.curves.push_back(side({a.x, a.y}, {b.x, b.y}, a.bulge));
    }
    vertices_.clear();
    if (!path.curves.empty()) drawing_.paths.push_back(std::move(path));
  }

  const std::vector<std::string>& layers_;
  Drawing drawing_;
  std::set<std::string> known_;
  std::map<std::string, int> unread_;  // curves on layers of dimensions and texts
  bool in_block_ = false, polyline_ = false, in_spline_ = false, closed_ = false;
  Spline spline_;
  std::vector<DL_VertexData> vertices_;
  size_t n_ = 0;
};

void read(const std::string& text, Reader& reader) {
  if (text.find("ENTITIES") == std::string::npos) throw Error::input("this is not a DXF file");
  std::istringstream in(text);
  DL_Dxf dxf;
  dxf.in(in, &reader);
}

}  // namespace

Drawing read_dxf(const std::string& text, const std::vector<std::string>& layers) {
  Reader reader(layers);
  read(text, reader);
  return reader.take();
}

std::vector<std::string> dxf_layers(const std::string& text) {
  // no layer has this name, therefore unsupported entities cause no error
  const std::vector<std::string> none = {""};
  Reader reader(none);
  read(text, reader);
  return {reader.known().begin(), reader.known().end()};
}

}  // namespace flexmorph::io::drawing

namespace flexmorph::io {

bool is_annotation_layer(const std::string& layer) {
  static const std::set<std::string> kWords = {
      "dim",    "dims",      "dimension",  "dimensions",      "dimensioning", "text",  "texts",
      "mtext",  "anno",      "annotation", "annotations",     "note",         "notes", "label",
      "labels", "defpoints", "bemassung",  "bema\xc3\x9fung", "beschriftung", "cotes", "cotas"};
  const std::vector<std::string> words = drawing::split_name(layer);
  return std::any_of(words.begin(), words.end(),
                     [](const std::string& word) { return kWords.contains(word); });
}

}  // namespace flexmorph::io
