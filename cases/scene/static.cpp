#include <cmath>

#include "cases/scene/read.h"
#include "cases/scene/tables.h"
#include "geometry/components/outline.h"
#include "io/drawings/drawing.h"
#include "io/drawings/length_unit.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::any_number;
using io::between;
using io::Key;
using io::positive;
using io::Table;
using io::to_text;

constexpr const char* kAtRest = "on a [domain]";

const Key& kName = io::key("domain", "name")
                       .text("the name of a domain")
                       .otherwise("plate")
                       .says("What files call it.");
const Key& kSize = io::key("domain", "size")
                       .numbers(positive("a length, a height", "m"), 2, 2)
                       .otherwise_as("`polygon` or `outline` is given")
                       .says("Length and height of a rectangle that begins at the origin.");
const Key& kPolygon = io::key("domain", "polygon")
                          .numbers(any_number("x0, y0, x1, y1, ... of a polygon", "m"), 6)
                          .otherwise_as("`size` or `outline` is given")
                          .says("Or its corners: x0, y0, x1, y1, ...");
const Key& kOutline =
    io::key("domain", "outline")
        .text("a drawing")
        .otherwise_as("`size` or `polygon` is given")
        .says("Or a drawing, .dxf or .svg: one closed curve, and others in it that are its holes.");
const Key& kUnit = io::key("domain", "unit")
                       .word("a unit of length", io::length_unit_names())
                       .otherwise_as("as the drawing says")
                       .when("`outline` is given")
                       .says("The unit of the drawing's coordinates.");
const Key& kLayers = io::key("domain", "layers")
                         .texts("layers of a drawing")
                         .otherwise_as("all of them")
                         .when("`outline` is a .dxf file")
                         .says("The layers that the domain is drawn on.");
const Key& kThickness = io::key("domain", "thickness")
                            .number(positive("a thickness", "m"))
                            .otherwise(1.0)
                            .says("Of the plate.");
const Key& kYoungsModulus = io::key("domain", "youngs_modulus")
                                .number(positive("Young's modulus", "Pa"))
                                .otherwise(1.0)
                                .says("Young's modulus.");
const Key& kPoissonRatio = io::key("domain", "poisson_ratio")
                               .number(between("Poisson's ratio", "", 0, 0.5))
                               .otherwise(0.3)
                               .says("Poisson's ratio.");

const Key& kDensity = io::key("domain", "density")
                          .number(io::not_negative("a density", "kg/m^3"))
                          .otherwise(0.0)
                          .says("Of the material; 0: it has no mass to be limited.");

const Key& kEdge = io::shared_key({"support", "load.force"}, "edge")
                       .word("an edge", {"left", "right", "bottom", "top"})
                       .otherwise_as("`point`, `box` or `disc` is given")
                       .says("Where: an edge of the domain's bounding box.");
const Key& kPoint = io::shared_key({"support", "load.force"}, "point")
                        .numbers(any_number("coordinates", "m"), 2, 2)
                        .otherwise_as("`edge`, `box` or `disc` is given")
                        .says("Or a point.");
const Key& kBox = io::shared_key({"support", "load.force"}, "box")
                      .numbers(any_number("coordinates", "m"), 4, 4)
                      .otherwise_as("`edge`, `point` or `disc` is given")
                      .says("Or the nodes in a box: x0, y0, x1, y1.");
const Key& kDisc =
    io::shared_key({"support", "load.force"}, "disc")
        .numbers(any_number("x, y, radius of a disc", "m"), 3, 3)
        .otherwise_as("`edge`, `point` or `box` is given")
        .says("Or the rim of the bore that it matches to half a cell, else the nodes in it.");
const Key& kFix = io::key("support", "fix")
                      .words("a direction", {"x", "y"})
                      .says("The directions that are held.");
const Key& kLoadName = io::key("load", "name")
                           .text("the name of a load")
                           .otherwise_as("`load_` and its number")
                           .when(kAtRest)
                           .says("What tables call it.");
const Key& kWeight = io::key("load", "weight")
                         .number(positive("a weight"))
                         .otherwise(1.0)
                         .when(kAtRest)
                         .says("Of its compliance in the sum.");
const Key& kForces = io::key("load", "force")
                         .tables_of()
                         .when(kAtRest)
                         .says("The forces that act at the same time.");
const Key& kForce = io::key("load.force", "force")
                        .numbers(any_number("a force", "N"), 2, 2)
                        .otherwise_as("`moment` is given")
                        .says("In all, spread evenly over the place.");
const Key& kMoment = io::key("load.force", "moment")
                         .number(any_number("a moment", "N m"))
                         .otherwise(0.0)
                         .says("Counterclockwise, of forces around the middle of the place.");
const Key& kBearing =
    io::key("load.force", "bearing")
        .boolean()
        .otherwise(false)
        .when("`disc` is given")
        .says(
            "A pin presses on the half of a bore before it: pressure as the cosine of the angle.");

Region read_outline(const Table& t) {
  io::DrawingSettings settings;
  if (t.has(kUnit)) settings.unit = io::find_length_unit(t.choice(kUnit))->metres;
  if (t.has(kLayers)) settings.layers = t.strings(kLayers);
  const std::string path = t.path_of(kOutline);
  try {
    return region_of(io::read_drawing(path, settings));
  } catch (const Error& error) {
    const std::string what = error.what();
    t.fail(kOutline, what.starts_with(path) ? what : path + ": " + what);
  }
}

void read_shape(const Table& t, Domain& domain) {
  if (t.has(kSize) + t.has(kPolygon) + t.has(kOutline) != 1)
    t.fail("a domain has either a `size` (length, height) or a `polygon` or an `outline`");
  for (const Key* key : {&kUnit, &kLayers})
    if (t.has(*key) && !t.has(kOutline)) t.fail(*key, "only an `outline` has it");
  if (t.has(kSize)) {
    const std::vector<double> size = t.numbers(kSize);
    domain.bounds = {{0, 0}, {size[0], size[1]}};
    return;
  }
  domain.shape = t.has(kOutline) ? read_outline(t) : Region{read_polygon(t, kPolygon), {}};
  domain.bounds = bounds_of(domain.shape.outer);
}

/// Reads the location of a support or a force: an edge of the bounding box of the domain, a point,
/// a box or a disc.
Place read_place(const Table& t, const Domain& domain) {
  const int given = t.has(kEdge) + t.has(kPoint) + t.has(kBox) + t.has(kDisc);
  if (given != 1) t.fail("a place is one of `edge`, `point`, `box`, `disc`");
  const Box& b = domain.bounds;
  if (t.has(kEdge)) {
    const std::string side = t.choice(kEdge);
    if (side == "left") return {Place::Kind::edge, {b.lower, {b.lower.x(), b.upper.y()}}, {}};
    if (side == "right") return {Place::Kind::edge, {{b.upper.x(), b.lower.y()}, b.upper}, {}};
    if (side == "bottom") return {Place::Kind::edge, {b.lower, {b.upper.x(), b.lower.y()}}, {}};
    return {Place::Kind::edge, {{b.lower.x(), b.upper.y()}, b.upper}, {}};
  }
  Place place;
  const Key& key = t.has(kPoint) ? kPoint : t.has(kDisc) ? kDisc : kBox;
  const std::vector<double> v = t.numbers(key);
  const Vec2 first(v[0], v[1]);
  if (t.has(kPoint)) {
    place = {Place::Kind::point, {first, first}, {}};
  } else if (t.has(kDisc)) {
    if (v[2] <= 0) t.fail(key, "a radius is positive, in the order x, y, radius [m]");
    const Vec2 half(v[2], v[2]);
    place = {Place::Kind::disc, {first - half, first + half}, {first, v[2]}};
  } else {
    place = {Place::Kind::box, {first, {v[2], v[3]}}, {}};
    if (v[0] > v[2] || v[1] > v[3]) t.fail(key, "x0 <= x1 and y0 <= y1 [m]");
  }
  const Box& box = place.box;
  if ((box.upper - b.lower).minCoeff() < 0 || (b.upper - box.lower).minCoeff() < 0)
    t.fail(key, "a place lies in the domain, [" + to_text(b.lower.x()) + ", " +
                    to_text(b.upper.x()) + "] x [" + to_text(b.lower.y()) + ", " +
                    to_text(b.upper.y()) + "] [m]");
  return place;
}

PlaneForce read_force(const Table& t, const Domain& domain) {
  PlaneForce out;
  out.place = read_place(t, domain);
  out.moment = t.number(kMoment);
  if (t.has(kForce)) {
    const std::vector<double> force = t.numbers(kForce);
    out.force = {force[0], force[1]};
  }
  if (out.force.norm() == 0 && out.moment == 0)
    t.has(kForce) ? t.fail(kForce, "a force is not zero [N]")
                  : t.fail("a [[load.force]] has a `force` [N] or a `moment` [N m]");
  if (out.moment != 0 && out.place.kind == Place::Kind::point)
    t.fail(kMoment, "a moment acts on an `edge`, a `box` or a `disc`: a point has no lever");
  out.bearing = t.boolean(kBearing);
  if (out.bearing && out.place.kind != Place::Kind::disc)
    t.fail(kBearing, "a pin bears on the rim of a `disc`");
  if (out.bearing && out.force.norm() == 0) t.fail(kBearing, "a pin presses with a `force` [N]");
  return out;
}

PlaneSupport read_support(const Table& t, const Domain& domain) {
  PlaneSupport support;
  support.place = read_place(t, domain);
  for (const std::string& axis : t.choices(kFix)) (axis == "x" ? support.x : support.y) = true;
  return support;
}

LoadCase read_load(const Table& t, const Domain& domain) {
  LoadCase load;
  load.name = t.string(kLoadName, "load_" + std::to_string(domain.loads.size() + 1));
  for (const LoadCase& other : domain.loads)
    if (other.name == load.name) {
      // A default name may be taken, too.
      const std::string taken = "there is another load '" + load.name + "'";
      t.has(kLoadName) ? t.fail(kLoadName, taken) : t.fail(taken);
    }
  load.weight = t.number(kWeight);
  for (const Table& f : t.tables(kForces)) load.forces.push_back(read_force(f, domain));
  if (load.forces.empty()) t.fail("a load has one or more [[load.force]]");
  return load;
}

/// Reads gravity. The weight acts in every load case; if there is none, it becomes a load case.
void read_weight(const Table& root, Domain& domain, Scene& scene) {
  scene.gravity_laws = read_load_laws(root, tables::kGravity.counted(2), scene);
  if (scene.gravity_law().varies())
    root.fail(tables::kGravity, "the gravity of a plate at rest is two numbers [m/s^2]");
  scene.gravity = scene.gravity_law().now();
  if (domain.density == 0)
    root.fail(tables::kGravity, "a plate without a density has no weight: domain.density [kg/m^3]");
  if (domain.loads.empty() && !scene.gravity->isZero(0)) {
    domain.loads.emplace_back();
    domain.loads.back().name = "weight";
  }
}

}  // namespace

std::vector<std::string> overrides_of_outline(const Table& root) {
  if (!root.has(tables::kDomain)) return {};
  const Table t = root.table(tables::kDomain);
  if (!t.has(kOutline) || !t.is_string(kOutline)) return {};
  return {"domain.outline='" + t.absolute(kOutline) + "'"};
}

void read_static(const Table& root, Scene& scene) {
  for (const Key* key :
       {&tables::kTime, &tables::kBody, &tables::kHub, &tables::kJoint, &tables::kPointMass,
        &tables::kEsl, &tables::kCycle, &tables::kVerify, &tables::kCertificate})
    if (root.has(*key))
      root.fail(*key, "a scene with a [domain] rests: it has no '" + key->name + "'");
  const Table t = root.table(tables::kDomain);
  Domain domain;
  domain.name = read_word(t, kName);
  read_shape(t, domain);
  domain.thickness = t.number(kThickness);
  domain.youngs_modulus = t.number(kYoungsModulus);
  domain.poisson_ratio = t.number(kPoissonRatio);
  domain.density = t.number(kDensity);
  for (const Table& s : root.tables(tables::kSupport))
    domain.supports.push_back(read_support(s, domain));
  if (domain.supports.empty())
    root.fail(tables::kSupport, "a plate at rest has one or more [[support]]");
  for (const Table& l : root.tables(tables::kLoad)) domain.loads.push_back(read_load(l, domain));
  if (root.has(tables::kGravity)) read_weight(root, domain, scene);
  if (domain.loads.empty())
    root.fail(tables::kLoad, "a plate at rest has one or more [[load]], or `gravity`");
  scene.domain = std::move(domain);
}

}  // namespace flexmorph::cases
