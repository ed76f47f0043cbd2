#include "cases/scene/read.h"
#include "cases/scene/tables.h"

namespace flexmorph::cases {
namespace {

using io::Table;
using Path = fem::StaticSettings::Path;

enum class Grows { loads, temperatures, both };

constexpr int kMost = 1'000'000;

const io::Choice<Path> kPath(
    io::key("static", "path").otherwise("load").says("Steps of the load, or along the path's arc."),
    "a path", {{"load", Path::load}, {"arc_length", Path::arc_length}});
const io::Key& kTo = io::key("static", "to")
                         .number(io::any_number("a load factor"))
                         .otherwise(1.0)
                         .says("The load factor grows from 0 to here.");
const io::Key& kSteps = io::key("static", "steps")
                            .integer("a number of steps", 1, kMost)
                            .otherwise(StaticAnalysis().steps)
                            .says("Equal steps to there; along the arc: the first is one of them.");
const io::Key& kMaxSteps = io::key("static", "max_steps")
                               .integer("a number of steps", 1, kMost)
                               .otherwise_as("1000, or `steps` if that is more")
                               .says("Equilibria before the analysis gives up.");
const io::Key& kMaxIterations = io::key("static", "max_iterations")
                                    .integer("a number of iterations", 1, 1000)
                                    .otherwise(15)
                                    .says("Of Newton's method in a step.");
const io::Choice<Grows> kGrows(
    io::key("static", "grows")
        .otherwise_as("`loads` where there are any, or else `temperatures`")
        .says("What the load factor multiplies; the other is there from the start."),
    "what the load factor multiplies",
    {{"loads", Grows::loads}, {"temperatures", Grows::temperatures}, {"both", Grows::both}});

}  // namespace

StaticAnalysis read_analysis(const Table& t) {
  StaticAnalysis out;
  out.path = t.choice(kPath);
  out.to = t.number(kTo);
  if (out.to == 0) t.fail(kTo, "the load factor grows from 0 to another value");
  out.steps = t.integer(kSteps);
  out.max_steps = t.integer(kMaxSteps, std::max(1000, out.steps));
  if (out.max_steps < out.steps) t.fail(kMaxSteps, "at least static.steps");
  out.max_iterations = t.integer(kMaxIterations);
  return out;
}

void read_growing(const Table& root, Scene& scene) {
  const Table t = root.table(tables::kStatic);
  const bool loaded = !scene.loads.empty() || scene.gravity, hot = scene.has_heat();
  if (!loaded && !hot)
    root.fail(tables::kStatic,
              "nothing loads the bodies: gravity, a [[load]] or [body.heat] is missing");
  const Grows grows = t.choice(kGrows, std::optional(loaded ? Grows::loads : Grows::temperatures));
  StaticAnalysis& out = *scene.statics;
  out.loads_grow = grows != Grows::temperatures;
  out.temperatures_grow = grows != Grows::loads;
  if (out.loads_grow && !loaded) t.fail(kGrows, "there is no load and no gravity to grow");
  if (out.temperatures_grow && !hot) t.fail(kGrows, "no body has a temperature: [body.heat]");
}

}  // namespace flexmorph::cases
