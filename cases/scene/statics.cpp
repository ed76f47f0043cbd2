#include "cases/scene/read.h"
#include "cases/scene/tables.h"

namespace flexmorph::cases {
namespace {

using io::Table;
using Path = fem::StaticSettings::Path;

enum class Grows { loads, temperatures, both };

constexpr int kMaxCount = 1'000'000;

const io::Choice<Path> kPath(io::key("static", "path")
                                 .otherwise("load")
                                 .description("Method: steps of the load factor (`load`), or of "
                                              "the arc length of the equilibrium path."),
                             "a path method",
                             {{"load", Path::load}, {"arc_length", Path::arc_length}});
const io::Key& kTo = io::key("static", "to")
                         .number(io::any_number("a load factor"))
                         .otherwise(1.0)
                         .description("Load factor at the end of the path, which begins at 0.");
const io::Key& kSteps = io::key("static", "steps")
                            .integer("a number of steps", 1, kMaxCount)
                            .otherwise(StaticAnalysis().steps)
                            .description(
                                "Number of equal steps to `to`; with `arc_length` it only sets the "
                                "length of the first step.");
const io::Key& kMaxPathSteps =
    io::key("static", "max_steps")
        .integer("a number of steps", 1, kMaxCount)
        .otherwise_as("1000, or `steps` if `steps` is larger")
        .description("Largest number of equilibria; the analysis fails if it needs more.");
const io::Key& kMaxIterations = io::key("static", "max_iterations")
                                    .integer("a number of iterations", 1, 1000)
                                    .otherwise(15)
                                    .description("Largest number of Newton iterations in a step.");
const io::Choice<Grows> kGrows(
    io::key("static", "grows")
        .otherwise_as("`loads` if there are loads or gravity, else `temperatures`")
        .description(
            "Quantities that the load factor multiplies. The others act in full from the start."),
    "a quantity that the load factor multiplies",
    {{"loads", Grows::loads}, {"temperatures", Grows::temperatures}, {"both", Grows::both}});

}  // namespace

StaticAnalysis read_analysis(const Table& t) {
  StaticAnalysis out;
  out.path = t.choice(kPath);
  out.to = t.number(kTo);
  if (out.to == 0) t.fail(kTo, "a load factor at the end of the path is not 0");
  out.steps = t.integer(kSteps);
  out.max_steps = t.integer(kMaxPathSteps, std::max(1000, out.steps));
  if (out.max_steps < out.steps)
    t.fail(kMaxPathSteps,
           "a largest number of steps is at least static.steps = " + std::to_string(out.steps));
  out.max_iterations = t.integer(kMaxIterations);
  return out;
}

void read_growing(const Table& root, Scene& scene) {
  const Table t = root.table(tables::kStatic);
  const bool loaded = !scene.loads.empty() || scene.gravity, hot = scene.has_heat();
  if (!loaded && !hot)
    root.fail(tables::kStatic,
              "the bodies have no load: the case needs gravity, a [[load]] or [body.heat]");
  const Grows grows = t.choice(kGrows, std::optional(loaded ? Grows::loads : Grows::temperatures));
  StaticAnalysis& out = *scene.statics;
  out.loads_grow = grows != Grows::temperatures;
  out.temperatures_grow = grows != Grows::loads;
  if (out.loads_grow && !loaded)
    t.fail(kGrows, "the case has no load and no gravity that the load factor could multiply");
  if (out.temperatures_grow && !hot)
    t.fail(kGrows, "no body has a temperature rise, which [body.heat] defines");
}

}  // namespace flexmorph::cases
