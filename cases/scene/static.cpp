#include <cmath>

#include "cases/scene/materials/material.h"
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

constexpr const char* kAtRest = "loads on a [domain]";

const Key& kName = io::key("domain", "name")
                       .text("the name of a domain")
                       .otherwise("plate")
                       .description("Name of the plate in file names.");
const Key& kSize =
    io::key("domain", "size")
        .numbers(positive("a length or a height", "m"), 2, 2)
        .otherwise_as("required unless `polygon` or `outline` is given")
        .description(
            "Length and height of a rectangular domain, whose lower left corner is the origin.");
const Key& kPolygon = io::key("domain", "polygon")
                          .numbers(any_number("x0, y0, x1, y1, ... of a polygon", "m"), 6)
                          .otherwise_as("required unless `size` or `outline` is given")
                          .description("Corners of a polygonal domain: x0, y0, x1, y1, ...");
const Key& kOutline = io::key("domain", "outline")
                          .text("a drawing")
                          .otherwise_as("required unless `size` or `polygon` is given")
                          .description(
                              "Drawing of the domain (.dxf, .svg): one closed curve, and closed "
                              "curves inside it as holes.");
const Key& kUnit = io::key("domain", "unit")
                       .word("a unit of length", io::length_unit_names())
                       .otherwise_as("the unit that the drawing states")
                       .when("`outline` is given")
                       .description("Unit of the coordinates of the drawing.");
const Key& kLayers =
    io::key("domain", "layers")
        .texts("layers of a drawing")
        .otherwise_as("all layers")
        .when("`outline` is a .dxf file")
        .description("Layers of the drawing that contain the outline of the domain.");
const Key& kMaterial = material_key("domain");
const Key& kThickness = io::key("domain", "thickness")
                            .number(positive("a thickness", "m"))
                            .otherwise(1.0)
                            .description("Thickness of the plate.");
const Key& kYoungsModulus = io::key("domain", "youngs_modulus")
                                .number(positive("Young's modulus", "Pa"))
                                .otherwise(1.0)
                                .description("Young's modulus of the plate.");
const Key& kPoissonRatio = io::key("domain", "poisson_ratio")
                               .number(between("Poisson's ratio", "", 0, 0.5))
                               .otherwise(0.3)
                               .description("Poisson's ratio of the plate.");

const Key& kDensity =
    io::key("domain", "density")
        .number(io::not_negative("a density", "kg/m^3"))
        .otherwise(0.0)
        .description("Density of the plate; with 0 its mass can be neither limited nor minimized.");

const Key& kEdge =
    io::shared_key({"support", "load.force"}, "edge")
        .word("an edge", {"left", "right", "bottom", "top"})
        .otherwise_as("required unless `point`, `box` or `disc` is given")
        .description("Supported or loaded nodes: an edge of the bounding box of the domain.");
const Key& kPoint = io::shared_key({"support", "load.force"}, "point")
                        .numbers(any_number("coordinates", "m"), 2, 2)
                        .otherwise_as("required unless `edge`, `box` or `disc` is given")
                        .description("Supported or loaded node: the nearest one to this point.");
const Key& kBox = io::shared_key({"support", "load.force"}, "box")
                      .numbers(any_number("coordinates", "m"), 4, 4)
                      .otherwise_as("required unless `edge`, `point` or `disc` is given")
                      .description("Supported or loaded nodes: those in a box x0, y0, x1, y1.");
const Key& kDisc =
    io::shared_key({"support", "load.force"}, "disc")
        .numbers(any_number("x, y, radius of a disc", "m"), 3, 3)
        .otherwise_as("required unless `edge`, `point` or `box` is given")
        .description(
            "Supported or loaded nodes: the rim of the bore at disc x, y, radius, else "
            "the nodes in the disc.");
const Key& kFix = io::key("support", "fix")
                      .words("a direction", {"x", "y"})
                      .description("Directions in which displacements are held at zero.");
const Key& kLoadName = io::key("load", "name")
                           .text("the name of a load")
                           .otherwise_as("`load_` and the number of the load")
                           .when(kAtRest)
                           .description("Name of the load case in tables.");
const Key& kWeight = io::key("load", "weight")
                         .number(positive("a weight"))
                         .otherwise(1.0)
                         .when(kAtRest)
                         .description("Weight of the compliance of this load case in the sum.");
const Key& kForces = io::key("load", "force")
                         .tables_of()
                         .when(kAtRest)
                         .description("Forces that act together in this load case.");
const Key& kForce = io::key("load.force", "force")
                        .numbers(any_number("a force", "N"), 2, 2)
                        .otherwise_as("required unless `moment` is given")
                        .description("Resultant force, spread evenly over the location.");
const Key& kMoment =
    io::key("load.force", "moment")
        .number(any_number("a moment", "N m"))
        .otherwise(0.0)
        .description("Moment about the middle of the location, positive counterclockwise.");
const Key& kBearing = io::key("load.force", "bearing")
                          .boolean()
                          .otherwise(false)
                          .when("`disc` is given")
                          .description(
                              "True if a pin presses on half of the bore, with a pressure like the "
                              "cosine of the angle.");

/// Reads the drawing of a domain, and appends notes about what it ignores.
Region read_outline(const Table& t, std::vector<std::string>& notes) {
  io::DrawingSettings settings;
  if (t.has(kUnit)) settings.unit = io::find_length_unit(t.choice(kUnit))->metres;
  if (t.has(kLayers)) settings.layers = t.strings(kLayers);
  const std::string path = t.path_of(kOutline);
  try {
    io::DrawnOutlines drawn = io::read_drawing(path, settings);
    notes.insert(notes.end(), drawn.notes.begin(), drawn.notes.end());
    return region_of(std::move(drawn.rings));
  } catch (const Error& error) {
    const std::string what = error.what();
    t.fail(kOutline, what.starts_with(path) ? what : path + ": " + what);
  }
}

void read_shape(const Table& t, Domain& domain, std::vector<std::string>& notes) {
  if (t.has(kSize) + t.has(kPolygon) + t.has(kOutline) != 1)
    t.fail("a domain needs exactly one of `size` (length, height), `polygon` and `outline`");
  for (const Key* key : {&kUnit, &kLayers})
    if (t.has(*key) && !t.has(kOutline)) t.fail(*key, "this key needs an `outline`");
  if (t.has(kSize)) {
    const std::vector<double> size = t.numbers(kSize);
    domain.bounds = {{0, 0}, {size[0], size[1]}};
    return;
  }
  domain.shape = t.has(kOutline) ? read_outline(t, notes) : Region{read_polygon(t, kPolygon), {}};
  domain.is_drawn = t.has(kOutline);
  domain.bounds = bounds_of(domain.shape.outer);
}

/// Reads the location of a support or a force: an edge of the bounding box of the domain, a point,
/// a box or a disc.
NodeRegion read_location(const Table& t, const Domain& domain) {
  const int given = t.has(kEdge) + t.has(kPoint) + t.has(kBox) + t.has(kDisc);
  if (given != 1) t.fail("a location needs exactly one of `edge`, `point`, `box` and `disc`");
  const Box& b = domain.bounds;
  if (t.has(kEdge)) {
    const std::string side = t.choice(kEdge);
    if (side == "left") return {NodeRegion::Kind::edge, {b.lower, {b.lower.x(), b.upper.y()}}, {}};
    if (side == "right") return {NodeRegion::Kind::edge, {{b.upper.x(), b.lower.y()}, b.upper}, {}};
    if (side == "bottom")
      return {NodeRegion::Kind::edge, {b.lower, {b.upper.x(), b.lower.y()}}, {}};
    return {NodeRegion::Kind::edge, {{b.lower.x(), b.upper.y()}, b.upper}, {}};
  }
  NodeRegion location;
  const Key& key = t.has(kPoint) ? kPoint : t.has(kDisc) ? kDisc : kBox;
  const std::vector<double> v = t.numbers(key);
  const Vec2 first(v[0], v[1]);
  if (t.has(kPoint)) {
    location = {NodeRegion::Kind::point, {first, first}, {}};
  } else if (t.has(kDisc)) {
    if (v[2] <= 0) t.fail(key, "a disc is x, y, radius with a positive radius [m]");
    const Vec2 half(v[2], v[2]);
    location = {NodeRegion::Kind::disc, {first - half, first + half}, {first, v[2]}};
  } else {
    location = {NodeRegion::Kind::box, {first, {v[2], v[3]}}, {}};
    if (v[0] > v[2] || v[1] > v[3])
      t.fail(key, "a box is x0, y0, x1, y1 with x0 <= x1 and y0 <= y1 [m]");
  }
  const Box& box = location.box;
  if ((box.upper - b.lower).minCoeff() < 0 || (b.upper - box.lower).minCoeff() < 0)
    t.fail(key, "a location lies in the domain, [" + to_text(b.lower.x()) + ", " +
                    to_text(b.upper.x()) + "] x [" + to_text(b.lower.y()) + ", " +
                    to_text(b.upper.y()) + "] [m]");
  return location;
}

PlaneForce read_force(const Table& t, const Domain& domain) {
  PlaneForce out;
  out.location = read_location(t, domain);
  out.moment = t.number(kMoment);
  if (t.has(kForce)) {
    const std::vector<double> force = t.numbers(kForce);
    out.force = {force[0], force[1]};
  }
  if (out.force.norm() == 0 && out.moment == 0)
    t.has(kForce) ? t.fail(kForce, "a force is not zero [N]")
                  : t.fail("a [[load.force]] needs a `force` [N] or a `moment` [N m]");
  if (out.moment != 0 && out.location.kind == NodeRegion::Kind::point)
    t.fail(kMoment, "a moment acts on an `edge`, a `box` or a `disc`, not on a point");
  out.bearing = t.boolean(kBearing);
  if (out.bearing && out.location.kind != NodeRegion::Kind::disc)
    t.fail(kBearing, "a bearing load needs a `disc`");
  if (out.bearing && out.force.norm() == 0) t.fail(kBearing, "a bearing load needs a `force` [N]");
  return out;
}

PlaneSupport read_support(const Table& t, const Domain& domain) {
  PlaneSupport support;
  support.location = read_location(t, domain);
  for (const std::string& axis : t.choices(kFix)) (axis == "x" ? support.x : support.y) = true;
  return support;
}

StaticLoadCase read_load(const Table& t, const Domain& domain) {
  StaticLoadCase load;
  load.name = t.string(kLoadName, "load_" + std::to_string(domain.loads.size() + 1));
  for (const StaticLoadCase& other : domain.loads)
    if (other.name == load.name) {
      // A default name may be taken, too.
      const std::string taken = "there is another load '" + load.name + "'";
      t.has(kLoadName) ? t.fail(kLoadName, taken) : t.fail(taken);
    }
  load.weight = t.number(kWeight);
  for (const Table& f : t.tables(kForces)) load.forces.push_back(read_force(f, domain));
  if (load.forces.empty()) t.fail("a load needs one or more [[load.force]]");
  return load;
}

/// Reads gravity. The weight acts in every load case; if there is none, it becomes a load case.
void read_weight(const Table& root, Domain& domain, Scene& scene) {
  scene.gravity_laws = read_load_laws(root, tables::kGravity.counted(2), scene);
  if (scene.gravity_law().varies())
    root.fail(tables::kGravity, "the gravity of a static plate is two constant numbers [m/s^2]");
  scene.gravity = scene.gravity_law().now();
  if (domain.density == 0)
    root.fail(tables::kGravity,
              "gravity needs a density of the plate: set domain.density [kg/m^3]");
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
      root.fail(*key, "a scene with a [domain] is static and has no '" + key->name + "'");
  const Table t = root.table(tables::kDomain);
  Domain domain;
  domain.name = read_word(t, kName);
  read_shape(t, domain, scene.notes);
  domain.thickness = t.number(kThickness);
  std::optional<double> youngs_modulus, poisson_ratio, density;
  if (t.has(kMaterial)) {
    const Material& material = *find_material(t.choice(kMaterial));
    youngs_modulus = material.youngs_modulus;
    poisson_ratio = material.poisson_ratio;
    density = material.density;
  }
  domain.youngs_modulus = t.number(kYoungsModulus, youngs_modulus);
  domain.poisson_ratio = t.number(kPoissonRatio, poisson_ratio);
  domain.density = t.number(kDensity, density);
  for (const Table& s : root.tables(tables::kSupport))
    domain.supports.push_back(read_support(s, domain));
  if (domain.supports.empty())
    root.fail(tables::kSupport, "a static plate needs one or more [[support]]");
  for (const Table& l : root.tables(tables::kLoad)) domain.loads.push_back(read_load(l, domain));
  if (root.has(tables::kGravity)) read_weight(root, domain, scene);
  if (domain.loads.empty())
    root.fail(tables::kLoad, "a static plate needs one or more [[load]], or `gravity`");
  scene.domain = std::move(domain);
}

}  // namespace flexmorph::cases
