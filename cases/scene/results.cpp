#include <algorithm>

#include "cases/scene/joints/reading.h"
#include "cases/scene/measure.h"

/// [[observe]] and [[measure]].
namespace flexmorph::cases {
namespace {

using io::Table;
using Words = std::vector<std::string>;

Observe read_observe(const Table& t, const Scene& scene) {
  Observe out;
  out.name = read_word(t, "the name of an observed point");
  out.body = t.choice("body", "a body", names_of(scene.bodies));
  const Body& body = scene.body(out.body);
  if (t.has("point") == t.has("at"))
    t.fail("an observed point has either a `point` or `at` = \"free_end\"");
  if (t.has("point")) {
    out.point = read_point(t, body, scene.time.end);
  } else {
    t.choice("at", "a place", Words{"free_end"});
    out.point = {body.longest(scene.time.end), body.low() + 0.5 * body.width};
  }
  for (const Observe& other : scene.observed)
    if (other.name == out.name && other.body == out.body)
      t.fail("name", "there is another '" + out.name + "' of '" + out.body + "'");
  return out;
}

}  // namespace

void read_observed(const Table& root, Scene& scene) {
  for (const Table& t : root.tables("observe")) scene.observed.push_back(read_observe(t, scene));
}

void read_measures(const Table& root, Scene& scene) {
  for (const Table& t : root.tables("measure")) {
    Measure out;
    out.body = t.choice("body", "a body", names_of(scene.bodies));
    out.quantities = t.choices("quantities", "a measured quantity", measured_quantities());
    const Body& body = scene.body(out.body);
    for (const Measure& other : scene.measures)
      if (other.body == out.body) t.fail("body", "'" + out.body + "' is measured already");
    for (const std::string& quantity : out.quantities)
      if (const std::string why = refusal_of_measure(scene, body, quantity); !why.empty())
        t.fail("quantities", "\"" + quantity + "\": " + why);
    scene.measures.push_back(std::move(out));
  }
}

}  // namespace flexmorph::cases
