#include "cases/scene/mesh_rule.h"

#include <algorithm>
#include <cmath>

#include "cases/scene/body_keys.h"
#include "cases/scene/joints/row.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::Key;
using io::Table;
using io::to_text;

/// Returns the key that determines the length of the body.
const Key& length_key(const Flow& flow) {
  return flow.motion ? flow_keys::kLength : flow_keys::kSpeed;
}

/// Returns the number of elements of a uniform mesh, so that none is longer than max_length when
/// the body is longest.
int uniform_elements(const Body& body, double end) {
  if (!(body.flow->max_length > 0)) return body.elements[0];
  const double needed = std::ceil(body.longest(end) / body.flow->max_length - 1e-9);
  return static_cast<int>(std::max<double>(body.elements[0], std::min(needed, 1e6)));
}

/// Returns true if a uniform mesh keeps the limits, and if part of the body is always outside of
/// the hub.
bool can_be_uniform(const Body& body, double end) {
  return body.shortest(end) > 0 &&
         body.shortest(end) / uniform_elements(body, end) >= body.flow->min_length * (1 - 1e-9);
}

void set_uniform_mesh(const Table& t, Body& body, double end) {
  constexpr int kMaxElements = 100'000;
  const double shortest = body.shortest(end);
  if (!(shortest > 0))
    t.fail(length_key(*body.flow),
           "the length of the body outside of the hub is positive, but it is " +
               to_text(shortest, 4) + " m " +
               (body.flow->motion ? "when the body is shortest" : "at time.end"));
  const int count = uniform_elements(body, end);
  if (count > kMaxElements / body.elements[1])
    t.fail(flow_keys::kMaxLength,
           "a uniform mesh with this limit has more than " + to_text(kMaxElements) + " elements");
  if (!can_be_uniform(body, end))
    t.fail(flow_keys::kMinLength,
           "the " + std::to_string(count) + " elements of a uniform mesh are " +
               to_text(shortest / count, 4) +
               " m long when the body is shortest, which is less than min_length; use fewer "
               "elements, a smaller min_length, a larger max_length, or mesh = \"split\" [m]");
  body.elements[0] = count;
}

/// Sets the limits of the boundary element. They must not lead to alternating splits and merges:
/// the two halves of an element that was just split must not be short enough to be merged again,
/// and a merged element must not be long enough to be split.
void set_split_mesh(const Table& t, Body& body, double end) {
  Flow& flow = *body.flow;
  if (!t.has(flow_keys::kMaxLength))
    t.fail(
        "`max_length` is missing: mesh = \"split\" needs it, mesh = \"uniform\" does not; the "
        "length "
        "of the body changes from " +
        to_text(body.shortest(end), 4) + " to " + to_text(body.longest(end), 4) + " m");
  flow.min_length = t.number(flow_keys::kMinLength, 0.3 * flow.max_length);
  const double element = body.length / body.elements[0];
  const double shortest = body.shortest(end);
  if (element > flow.max_length * (1 + 1e-9))
    t.fail(flow_keys::kMaxLength, "the elements are " + to_text(element, 4) +
                                      " m long at the start, which is more than max_length; use "
                                      "more elements or a larger max_length [m]");
  const Key& min_key = t.has(flow_keys::kMinLength) ? flow_keys::kMinLength : flow_keys::kMaxLength;
  if (element < flow.min_length * (1 - 1e-9))
    t.fail(min_key, "the elements are " + to_text(element, 4) +
                        " m long at the start, shorter than min_length = " +
                        to_text(flow.min_length, 4) + " m, and would be merged immediately");
  // Elements of the initial mesh are merged only if the body becomes shorter than at the start.
  const double neighbour = shortest < body.length * (1 - 1e-12)
                               ? std::max(element, 0.5 * flow.max_length)
                               : 0.5 * flow.max_length;
  if (flow.min_length + neighbour > 0.9 * flow.max_length * (1 + 1e-9))
    t.fail(min_key, "min_length plus the length of the neighbouring element, " +
                        to_text(neighbour, 4) +
                        " m, is at most 0.9 max_length; otherwise elements are split and merged "
                        "again and again");
  if (shortest < flow.min_length)
    t.fail(length_key(flow), "the length of the body is at least min_length, but it is " +
                                 to_text(shortest, 4) + " m " +
                                 (flow.motion ? "when the body is shortest" : "at time.end"));
}

/// Returns true if a load, a spring, a joint or a mass acts on a body elsewhere than at its welded
/// edges. Terms and markers at such a location do not support elements whose lines move.
bool is_held_inside(const Scene& scene, const std::string& body) {
  const auto at = [&](const Anchor& anchor) { return anchor.body == body; };
  return std::ranges::any_of(scene.loads, [&](const BodyLoad& l) { return l.body == body; }) ||
         std::ranges::any_of(scene.springs, [&](const Spring& s) { return at(s.a) || at(s.b); }) ||
         std::ranges::any_of(scene.joints,
                             [&](const Joint& j) {
                               return at(j.a) || at(j.b) || (j.body == body && j.row->holds_point);
                             }) ||
         std::ranges::any_of(scene.point_masses,
                             [&](const PointMass& m) { return m.body == body && !m.at_end; });
}

}  // namespace

void choose_mesh(const Table& body_table, const Scene& scene, Body& body) {
  constexpr double kLargestChange = 4;
  if (body.on_cells()) return;  // cells keep their locations in the design
  const Table t = body_table.table(body_keys::kFlow);
  const double end = scene.time.end;
  if (!t.has(flow_keys::kMesh)) {
    body.flow->uniform = body.longest(end) < kLargestChange * body.shortest(end) &&
                         can_be_uniform(body, end) && !is_held_inside(scene, body.name);
    t.record(flow_keys::kMesh, body.flow->uniform ? "uniform" : "split");
  }
  if (body.flow->uniform)
    set_uniform_mesh(t, body, end);
  else
    set_split_mesh(t, body, end);
}

}  // namespace flexmorph::cases
