#include "cases/scene/read.h"

namespace flexmorph::cases {

using io::any_number;
using io::Table;

StaticAnalysis read_analysis(const Table& t) {
  using Path = fem::StaticSettings::Path;
  constexpr int kMost = 1'000'000;
  StaticAnalysis out;
  out.path = t.choice<Path>("path", "a path",
                            {{"load", Path::load}, {"arc_length", Path::arc_length}}, Path::load);
  out.to = t.number("to", any_number("a load factor"), 1.0);
  if (out.to == 0) t.fail("to", "the load factor grows from 0 to another value");
  out.steps = t.integer("steps", "a number of steps", 1, kMost, out.steps);
  out.max_steps = t.integer("max_steps", "a number of steps", 1, kMost, std::max(1000, out.steps));
  if (out.max_steps < out.steps) t.fail("max_steps", "at least static.steps");
  out.max_iterations = t.integer("max_iterations", "a number of iterations", 1, 1000, 15);
  return out;
}

void read_growing(const Table& root, Scene& scene) {
  enum class Grows { loads, temperatures, both };
  const Table t = root.table("static");
  const bool loaded = !scene.loads.empty() || scene.gravity, hot = scene.has_heat();
  if (!loaded && !hot)
    root.fail("static", "nothing loads the bodies: gravity, a [[load]] or [body.heat] is missing");
  const Grows grows = t.choice<Grows>(
      "grows", "what the load factor multiplies",
      {{"loads", Grows::loads}, {"temperatures", Grows::temperatures}, {"both", Grows::both}},
      loaded ? Grows::loads : Grows::temperatures);
  StaticAnalysis& out = *scene.statics;
  out.loads_grow = grows != Grows::temperatures;
  out.temperatures_grow = grows != Grows::loads;
  if (out.loads_grow && !loaded) t.fail("grows", "there is no load and no gravity to grow");
  if (out.temperatures_grow && !hot) t.fail("grows", "no body has a temperature: [body.heat]");
}

}  // namespace flexmorph::cases
