#include <cmath>

#include "cases/scene/read.h"
#include "geometry/outline.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::any_number;
using io::between;
using io::not_negative;
using io::positive;
using io::Table;
using io::to_text;

Box bounds_of(const std::vector<Vec2>& polygon) {
  Box box{polygon.front(), polygon.front()};
  for (const Vec2& p : polygon) {
    box.lower = box.lower.cwiseMin(p);
    box.upper = box.upper.cwiseMax(p);
  }
  return box;
}

void read_shape(const Table& t, Domain& domain) {
  if (t.has("size") == t.has("polygon"))
    t.fail("a domain has either a `size` (length, height) or a `polygon`");
  if (t.has("size")) {
    const std::vector<double> size = t.numbers("size", positive("a length, a height", "m"), 2);
    domain.bounds = {{0, 0}, {size[0], size[1]}};
    return;
  }
  const std::vector<double> flat =
      t.numbers("polygon", any_number("x0, y0, x1, y1, ... of a polygon", "m"), 0);
  if (flat.size() < 6 || flat.size() % 2 != 0)
    t.fail("polygon", "three corners or more: x0, y0, x1, y1, x2, y2, ... [m]");
  for (size_t k = 0; k < flat.size(); k += 2) domain.polygon.emplace_back(flat[k], flat[k + 1]);
  domain.bounds = bounds_of(domain.polygon);
  if ((domain.bounds.upper - domain.bounds.lower).minCoeff() <= 0)
    t.fail("polygon", "a polygon has an area");
  try {
    unite(std::vector<std::vector<Vec2>>{domain.polygon}, domain.bounds);
  } catch (const Error&) {
    t.fail("polygon", "a polygon does not cross itself");
  }
}

/// Where something holds or pulls: an edge of the domain's bounding box, a point or a box.
Place read_place(const Table& t, const Domain& domain) {
  const int given = (t.has("edge") ? 1 : 0) + (t.has("point") ? 1 : 0) + (t.has("box") ? 1 : 0);
  if (given != 1) t.fail("a place is one of `edge`, `point`, `box`");
  const Box& b = domain.bounds;
  if (t.has("edge")) {
    const int side =
        t.choice<int>("edge", "an edge", {{"left", 0}, {"right", 1}, {"bottom", 2}, {"top", 3}});
    if (side == 0) return {Place::Kind::edge, {b.lower, {b.lower.x(), b.upper.y()}}};
    if (side == 1) return {Place::Kind::edge, {{b.upper.x(), b.lower.y()}, b.upper}};
    if (side == 2) return {Place::Kind::edge, {b.lower, {b.upper.x(), b.lower.y()}}};
    return {Place::Kind::edge, {{b.lower.x(), b.upper.y()}, b.upper}};
  }
  const bool is_point = t.has("point");
  const char* key = is_point ? "point" : "box";
  const std::vector<double> v = t.numbers(key, any_number("coordinates", "m"), is_point ? 2 : 4);
  const Box box = is_point ? Box{{v[0], v[1]}, {v[0], v[1]}} : Box{{v[0], v[1]}, {v[2], v[3]}};
  if (!is_point && (v[0] > v[2] || v[1] > v[3])) t.fail(key, "x0 <= x1 and y0 <= y1 [m]");
  if ((box.upper - b.lower).minCoeff() < 0 || (b.upper - box.lower).minCoeff() < 0)
    t.fail(key, "a place lies in the domain, [" + to_text(b.lower.x()) + ", " +
                    to_text(b.upper.x()) + "] x [" + to_text(b.lower.y()) + ", " +
                    to_text(b.upper.y()) + "] [m]");
  return {is_point ? Place::Kind::point : Place::Kind::box, box};
}

PlaneSupport read_support(const Table& t, const Domain& domain) {
  PlaneSupport support;
  support.place = read_place(t, domain);
  for (const std::string& axis :
       t.choices("fix", "a direction", std::vector<std::string>{"x", "y"}))
    (axis == "x" ? support.x : support.y) = true;
  return support;
}

LoadCase read_load(const Table& t, const Domain& domain) {
  LoadCase load;
  load.name =
      t.string("name", "the name of a load", "load_" + std::to_string(domain.loads.size() + 1));
  load.weight = t.number("weight", positive("a weight"), 1.0);
  for (const Table& f : t.tables("force")) {
    const std::vector<double> force = f.numbers("force", any_number("a force", "N"), 2);
    load.forces.push_back({read_place(f, domain), Vec2(force[0], force[1])});
    if (load.forces.back().force.norm() == 0) f.fail("force", "a force is not zero [N]");
  }
  if (load.forces.empty()) t.fail("a load has one or more [[load.force]]");
  return load;
}

}  // namespace

void read_static(const Table& root, Scene& scene) {
  for (const char* key :
       {"time", "body", "hub", "joint", "point_mass", "esl", "cycle", "verify", "gravity"})
    if (root.has(key))
      root.fail(key, "a scene with a [domain] rests: it has no '" + std::string(key) + "'");
  const Table t = root.table("domain");
  Domain domain;
  domain.name = t.string("name", "the name of a domain", "plate");
  read_shape(t, domain);
  domain.thickness = t.number("thickness", positive("a thickness", "m"), 1.0);
  domain.youngs_modulus = t.number("youngs_modulus", positive("Young's modulus", "Pa"), 1.0);
  domain.poisson_ratio = t.number("poisson_ratio", between("Poisson's ratio", "", 0, 0.5), 0.3);
  domain.density = t.number("density", not_negative("a density", "kg/m^3"), 0.0);
  for (const Table& s : root.tables("support")) domain.supports.push_back(read_support(s, domain));
  if (domain.supports.empty()) root.fail("support", "a plate at rest has one or more [[support]]");
  for (const Table& l : root.tables("load")) domain.loads.push_back(read_load(l, domain));
  if (domain.loads.empty()) root.fail("load", "a plate at rest has one or more [[load]]");
  scene.domain = std::move(domain);
}

}  // namespace flexmorph::cases
