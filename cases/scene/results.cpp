#include <algorithm>

#include "cases/scene/joints/reading.h"
#include "cases/scene/measure.h"
#include "cases/scene/tables.h"

/// Readers of [[observe]] and [[measure]].
namespace flexmorph::cases {
namespace {

using io::Table;
const io::Key& kName =
    io::key("observe", "name")
        .text("the name of an observed point")
        .description("Name of the observed point. Its columns are `BODY.NAME_x` and so on.");
const io::Key& kBody =
    io::key("observe", "body").name_of("a body").description("Body of the observed point.");
const io::Key& kPoint = io::key("observe", "point")
                            .numbers(io::any_number("a material coordinate", "m"), 2, 2)
                            .otherwise_as("required unless `at` is given")
                            .description("Material point that is observed.");
const io::Key& kAt =
    io::key("observe", "at")
        .word("a location", {"free_end"})
        .otherwise_as("required unless `point` is given")
        .description("Location of the observed point: the middle of the free end.");

const io::Key& kMeasured =
    io::key("measure", "body").name_of("a body").description("Body that is measured.");
const io::Key& kQuantities =
    io::key("measure", "quantities")
        .words("a measured quantity", measured_quantities)
        .description("Quantities that are written as columns `BODY.QUANTITY`.");

Observe read_observe(const Table& t, const Scene& scene) {
  Observe out;
  out.name = read_word(t, kName);
  out.body = read_flexible(t, kBody, scene);
  const Body& body = scene.body(out.body);
  if (t.has(kPoint) == t.has(kAt))
    t.fail("an observed point needs either a `point` or at = \"free_end\"");
  if (t.has(kPoint)) {
    out.point = read_point(t, kPoint, body, scene.time.end);
  } else {
    t.choice(kAt);
    out.point = {body.longest(scene.time.end), body.low() + 0.5 * body.width};
  }
  for (const Observe& other : scene.observed)
    if (other.name == out.name && other.body == out.body)
      t.fail(kName, "there is another point '" + out.name + "' of '" + out.body + "'");
  return out;
}

}  // namespace

void read_observed(const Table& root, Scene& scene) {
  for (const Table& t : root.tables(tables::kObserve))
    scene.observed.push_back(read_observe(t, scene));
}

void read_measures(const Table& root, Scene& scene) {
  for (const Table& t : root.tables(tables::kMeasure)) {
    MeasureRequest out;
    out.body = read_flexible(t, kMeasured, scene);
    out.quantities = t.choices(kQuantities);
    const Body& body = scene.body(out.body);
    for (const MeasureRequest& other : scene.measures)
      if (other.body == out.body) t.fail(kMeasured, "'" + out.body + "' is measured already");
    for (const std::string& quantity : out.quantities)
      if (const std::string why = refusal_of_measure(scene, body, quantity); !why.empty())
        t.fail(kQuantities, "\"" + quantity + "\": " + why);
    scene.measures.push_back(std::move(out));
  }
}

}  // namespace flexmorph::cases
