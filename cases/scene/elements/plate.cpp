#include <algorithm>

#include "cases/scene/body_keys.h"
#include "cases/scene/elements/row.h"
#include "cases/scene/joints/reading.h"
#include "fem/elements/ancf_plate.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using namespace body_keys;
using io::Key;
using io::positive;
using io::Table;
using io::to_text;

constexpr int kMaxElements = 100'000;

const std::vector<std::string>& plate_shapes() {
  static const std::vector<std::string> kNames{"h16", "h12", "q4"};
  return kNames;
}

const io::Key& kShape = io::key("body", "shape")
                            .word("a shape set", plate_shapes)
                            .otherwise("h16")
                            .when("plates")
                            .description(
                                "Shape functions; `h12` lacks mixed slopes and is too stiff in "
                                "twist; `q4`: bilinear cells.");
const io::Key& kSpace =
    io::key("body", "space")
        .word("a space", {"plane", "space"})
        .otherwise("plane")
        .description(
            "Space of the plate: positions have two components (`plane`) or three (`space`).");
const io::Key& kWidth = io::key("body", "width")
                            .number(positive("a width", "m"))
                            .when("plates")
                            .description("Width of the plate, across its length.");
const io::Key& kElements =
    io::key("body", "elements")
        .integers("a number of elements", 1, kMaxElements, 2, 2)
        .when("plates")
        .description("Number of elements along the length at the start, and across.");

/// Reads the model of the material reservoir, its location and the length of the stored material.
void read_reservoir(const Table& t, Flow& flow) {
  const std::string stored = t.choice(flow_keys::kReservoir);
  flow.reservoir = stored == "coil"  ? Reservoir::coil
                   : stored == "rod" ? Reservoir::rod
                                     : Reservoir::none;
  for (const Key* key : {&flow_keys::kReservoirAt, &flow_keys::kReservoirLength})
    if (flow.reservoir == Reservoir::none && t.has(*key))
      t.fail(*key, "this key needs reservoir = \"coil\" or \"rod\"");
  if (t.has(flow_keys::kReservoirAt)) {
    const std::vector<double> at = t.numbers(flow_keys::kReservoirAt);
    flow.reservoir_at = Vec2(at[0], at[1]);
  }
  if (t.has(flow_keys::kReservoirLength))
    flow.reservoir_length = t.number(flow_keys::kReservoirLength);
}

Flow read_flow(const Table& t, const Scene& scene, bool on_cells) {
  Flow flow;
  if (t.has(flow_keys::kLength)) {
    if (t.has(flow_keys::kSpeed))
      t.fail(flow_keys::kSpeed, "a material flow has either a `speed` or a drive `length`");
    flow.length.drive = t.choice(flow_keys::kLength, names_of(scene.drives));
  } else {
    flow.speed = t.number(flow_keys::kSpeed);
  }
  read_reservoir(t, flow);
  flow.uniform = t.has(flow_keys::kMesh) && t.choice(flow_keys::kMesh) == "uniform";
  if (on_cells) {
    if (flow.uniform)
      t.fail(flow_keys::kMesh,
             "cells (shape \"q4\") keep their locations in the design, therefore their mesh cannot "
             "be \"uniform\"");
    for (const Key* limit : {&flow_keys::kMaxLength, &flow_keys::kMinLength})
      if (t.has(*limit))
        t.fail(*limit, "cells (shape \"q4\") have no limits of the element length");
    return flow;
  }
  // choose_mesh() determines the values that are not given.
  if (t.has(flow_keys::kMaxLength)) flow.max_length = t.number(flow_keys::kMaxLength);
  if (t.has(flow_keys::kMinLength)) flow.min_length = t.number(flow_keys::kMinLength, 0.0);
  return flow;
}

/// Reads all keys of a plate except `flow` and `line`.
void read_sheet(const Table& t, const Scene& scene, bool has_density, Body& body) {
  body.shape = t.choice(kShape);
  body.space = t.choice(kSpace);
  if (!scene.bodies.empty() && scene.bodies.front().space != body.space)
    t.fail(kSpace, "all bodies of a scene are in the plane, or all are in space");
  if (body.on_cells() && body.in_space())
    t.fail(kShape,
           "cells (\"q4\") are in the plane, because they have no bending out of the plane");
  if (scene.is_mechanism() && body.in_space())
    t.fail(kSpace, "in a scene with rigid bodies or welds between bodies, plates are in the plane");
  read_terms(t, scene, body);
  // A drive of the length determines the initial length, too.
  const bool driven = t.has(kFlow) && t.table(kFlow).has(flow_keys::kLength);
  body.length = t.number(kLength, driven ? std::optional<double>(0) : std::nullopt);
  body.width = t.number(kWidth);
  body.thickness = t.number(kThickness);
  read_material(t, has_density, body);
  const std::vector<int> elements = t.integers(kElements);
  body.elements = {elements[0], elements[1]};
  if (1.0 * elements[0] * elements[1] > kMaxElements)
    t.fail(kElements, "a plate has at most " + to_text(kMaxElements) + " elements");
  if (!body.on_cells()) return;
  for (const std::string& term : body.terms)
    if (!fem::term_row(term).on_cells)
      t.fail(kTerms, "\"" + term + "\" is not implemented for cells (shape \"q4\")");
}

void read_mesh(const Table& t, Body& body) {
  body.lines = read_lines(t, body);
  for (const std::string& term : body.terms)
    if (body.has_eulerian_lines() && (!fem::term_row(term).eulerian_lines || body.on_cells()))
      t.fail(kTerms, "\"" + term + "\" is not implemented for free material lines ([[body.line]])");
}

void read_plate(const Table& t, const Scene& scene, bool has_density, Body& body) {
  read_sheet(t, scene, has_density, body);
  refuse_flow(t);
  read_mesh(t, body);
}

void read_flowing_plate(const Table& t, const Scene& scene, bool has_density, Body& body) {
  read_sheet(t, scene, has_density, body);
  body.flow = read_flow(t.table(kFlow), scene, body.on_cells());
  if (scene.statics) t.fail(kElement, "a [static] analysis has no material flow");
  read_mesh(t, body);
}

/// Returns the lines of cells from the free end to a root that lies between them. The element at
/// the root is at least a quarter of a cell long.
std::vector<double> cell_lines(double root, double longest, double cell) {
  std::vector<double> out;
  for (int k = 0; longest - k * cell > root + kShortestCell * cell; ++k)
    out.push_back(longest - k * cell);
  out.push_back(root);
  std::reverse(out.begin(), out.end());
  return out;
}

/// Returns the material coordinate p = p_end - share L(t) of a line whose distance from the free
/// end is a constant fraction of the length L(t). Line i of a uniform mesh of n elements has the
/// fraction 1 - i/n; the root of every mesh has the fraction 1.
std::function<fem::Motion(double)> line_drive(const Body& body, double end, double share) {
  if (body.flow->motion)
    return [end, share, length = body.flow->motion](double t) {
      const fem::Motion x = length(t);
      return fem::Motion{end - share * x.value, -share * x.rate, -share * x.acceleration};
    };
  return [=, length = share * body.length, speed = share * body.flow->speed](double t) {
    return fem::Motion{end - length - speed * t, -speed, 0};
  };
}

std::unique_ptr<fem::Element> make_plate(const Body& body, double end,
                                         const std::array<int, 2>& count) {
  const double longest = body.longest(end);
  std::vector<fem::MaterialLine> m, n;
  const double root = longest - body.length;
  const bool among_cells = body.on_cells() && body.flow;
  const double cell = body.cell_length() * body.elements[0] / count[0];
  for (const double at :
       among_cells ? cell_lines(root, longest, cell) : body.start_lines(root, count[0]))
    m.push_back({at, {}});
  for (const BodyLine& line : body.lines) m[static_cast<size_t>(line.index)].free = line.free;
  if (body.flow)
    for (int i = 0; i < (body.has_uniform_mesh() ? count[0] : 1); ++i)
      m[static_cast<size_t>(i)].drive = line_drive(body, longest, 1 - 1.0 * i / count[0]);
  for (int j = 0; j <= count[1]; ++j) n.push_back({body.low() + body.width * j / count[1], {}});
  using Shapes = fem::AncfPlate::ShapeSet;
  const Shapes shapes = body.shape == "h12"  ? Shapes::h12
                        : body.shape == "q4" ? Shapes::q4
                                             : Shapes::h16;
  return std::make_unique<fem::AncfPlate>(body.dim(), shapes, std::move(m), std::move(n));
}

/// Estimates the operations of the Gram form, with n_p pairs of vectors in four classes and
/// products and sums for d directions, and of the Gauss points of bending, if there are any.
ElementOperations operations(const Body& body, const fem::Element& element) {
  const double n = element.n_shapes(), d = element.dim(), pairs = 0.5 * n * (n + 1);
  const double line = body.number("bending_points"), points = line * line;
  ElementOperations out;
  out.force = 2 * n * n * d * (body.flow ? 3 : 1);  // inertia
  out.force += 0.5 * pairs * pairs + 2 * pairs * d + 2 * n * n * d;
  // Sum factorization over m, then over n, and back: 3 derivatives, 5 vectors
  // (fem/terms/bending_kernels.h).
  out.force += n * (line * 2 * 2 * 3 * d + points * (2 * 2 * 5 * d / 4 + 10));
  out.tangent = n * d * (n * pairs + n * n * d) + 2 * points * n * d * n * d;
  return out;
}

fem::WeldMode read_weld(const Table& joint) { return read_mode(joint, fem::WeldMode::edge); }

}  // namespace

extern const ElementRow kAncfPlate, kAleAncfPlate;
const ElementRow kAncfPlate = {.name = "ancf_plate",
                               .sentence = "A plate without material flow.",
                               .read = read_plate,
                               .read_weld = read_weld,
                               .make = make_plate,
                               .operations = operations};

const ElementRow kAleAncfPlate = {.name = "ale_ancf_plate",
                                  .sentence = "A plate with material flow through its root.",
                                  .read = read_flowing_plate,
                                  .read_weld = read_weld,
                                  .make = make_plate,
                                  .operations = operations};

}  // namespace flexmorph::cases
