#include <algorithm>
#include <cmath>

#include "cases/scene/design/keys.h"
#include "cases/scene/read.h"
#include "geometry/parts/picture.h"
#include "io/files.h"
#include "optim/mmc/problem/body_problem.h"

/// Designed bodies that are not welded at their roots: links between two pins.
namespace flexmorph::cases {
namespace {

using io::Table;
using mmc::Support;

const io::Choice<Support> kSupport(io::key("design", "support")
                                       .otherwise("pins")
                                       .when("joints hold the body at two points")
                                       .description("Balance of the loads of a link: reactions at "
                                                    "its pins, or its own inertia (`floating`)."),
                                   "a support of a link",
                                   {{"pins", Support::pins}, {"floating", Support::floating}});

const io::Key& kEyes =
    io::key("design", "eye_radius")
        .numbers(io::positive("the radius of an eye", "m"), 2, 2)
        .otherwise_as("no eyes")
        .when("joints hold the body at two points")
        .description("Radii of the solid eyes around the pins of the first and the second joint.");
const io::Key& kBores =
    io::key("design", "bore_radius")
        .numbers(io::positive("the radius of a bore", "m"), 2, 2)
        .otherwise_as("no bores")
        .when("joints hold the body at two points")
        .description("Radii of the bores in the eyes; pins fill the bores in motions and loads.");

/// Radius around a pin within which cells must be solid, by their centres [cells].
constexpr double kSolidReach = 1.5;

std::string words(const Vec2& point) {
  return "(" + io::to_text(point.x()) + ", " + io::to_text(point.y()) + ")";
}

/// Returns a coordinate [m] without the round-off of its computation, rounded to 1e-12 m.
double decimal(double x) { return std::round(x * 1e12) / 1e12 + 0.0; }

}  // namespace

namespace design_keys {
const io::Key& kLinkSupport = kSupport;
}

Link read_link(const Table& t, const io::Key& key, const Body& body, const Scene& scene) {
  const std::string needs =
      "a designed body is welded to a hub or a rigid body at its root, or joints hold it at two "
      "points: see [[joint]]";
  std::vector<Vec2> points;
  for (const Joint& joint : scene.joints) {
    if (joint.body == body.name && (joint.holds_frame() || joint.holds_edges())) t.fail(key, needs);
    const auto point = joint.point_on(body.name);
    if (!point) continue;
    if (joint.joins_edges()) t.fail(key, needs);
    const auto is_here = [&](const Vec2& p) { return (p - *point).norm() < 1e-9 * body.length; };
    if (std::none_of(points.begin(), points.end(), is_here)) points.push_back(*point);
  }
  if (points.size() != 2)
    t.fail(key,
           needs + (points.empty() ? ""
                                   : "; '" + body.name + "' is held at this number of points: " +
                                         std::to_string(points.size())));
  if (body.heat) t.fail(key, "a designed link between two pins has no [body.heat]");
  return {.pins = {points[0], points[1]}, .support = t.choice(kSupport)};
}

void check_joint_points(const Table& t, const io::Key& key, const Scene& scene,
                        const BodyDesign& design) {
  const Grid& g = design.grid;
  for (const Joint& joint : scene.joints) {
    const auto point = joint.point_on(design.body);
    if (!point) continue;
    const double column = (point->x() - g.x0) / g.dx(), row = (point->y() - g.y0) / g.dy();
    if (is_whole(column) && is_whole(row)) continue;
    t.fail(key, "joint '" + joint.name +
                    "' must hold the designed body at a node of its design mesh; it holds it at " +
                    words(*point) + " [m], and the nearest node is at " +
                    words({decimal(g.x0 + std::round(column) * g.dx()),
                           decimal(g.y0 + std::round(row) * g.dy())}) +
                    " [m]");
  }
}

void check_pins_solid(const Table& t, const BodyDesign& design) {
  if (!design.link) return;
  const Grid& g = design.grid;
  const double reach = kSolidReach * std::max(g.dx(), g.dy());
  for (const Vec2& pin : design.link->pins)
    for (int i = 0; i < g.nx; ++i)
      for (int j = 0; j < g.ny; ++j) {
        const Vec2 center = g.cell_center(i, j);
        const auto holds = [&](const std::vector<Vec2>& ring) {
          return contains({ring, {}}, center);
        };
        if ((center - pin).norm() < reach &&
            std::none_of(design.solid.begin(), design.solid.end(), holds))
          t.fail("the pin of '" + design.body + "' at " + words(pin) +
                 " needs solid material: [[design.solid]] with disc = [" + io::to_text(pin.x()) +
                 ", " + io::to_text(pin.y()) + ", " + io::to_text(2 * std::max(g.dx(), g.dy())) +
                 "] or larger, or `eye_radius`");
      }
}

void read_eyes(const Table& t, BodyDesign& design) {
  if (!design.link) {
    for (const io::Key* key : {&kEyes, &kBores})
      if (t.has(*key)) t.fail(*key, "only a link, which joints hold at two points, has eyes");
    return;
  }
  if (t.has(kBores) && !t.has(kEyes))
    t.fail(kBores, "a bore needs an eye: `eye_radius` is missing");
  if (!t.has(kEyes)) return;
  const Grid& g = design.grid;
  const std::vector<double> eyes = t.numbers(kEyes),
                            bores = t.has(kBores) ? t.numbers(kBores) : std::vector<double>(2, 0);
  for (size_t k = 0; k < 2; ++k) {
    const Vec2& pin = design.link->pins[k];
    const double largest = std::min(
        {pin.x() - g.x0, g.x0 + g.width - pin.x(), pin.y() - g.y0, g.y0 + g.height - pin.y()});
    if (eyes[k] > largest * (1 + 1e-9))
      t.fail(kEyes, "the eye around the pin at " + words(pin) +
                        " must lie in the plate: its radius is at most " + io::to_text(largest) +
                        " m");
    const double wall = std::max(design.widths.solid, std::min(g.dx(), g.dy()));
    if (bores[k] > 0 && eyes[k] - bores[k] < wall * (1 - 1e-9))
      t.fail(kBores, "the wall of an eye is at least " + io::to_text(wall) +
                         " m thick (`min_feature`): the radius of the bore is at most " +
                         io::to_text(eyes[k] - wall) + " m in an eye with the radius " +
                         io::to_text(eyes[k]) + " m");
    design.link->eyes[k] = eyes[k];
    design.link->bores[k] = bores[k];
    design.solid.push_back(circle_within(pin, eyes[k], mmc::kOutlineTolerance * g.dx()));
  }
}

}  // namespace flexmorph::cases
