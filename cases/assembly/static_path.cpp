#include "cases/assembly/static_path.h"

namespace flexmorph::cases {

fem::StaticSettings static_settings(const StaticAnalysis& analysis) {
  fem::StaticSettings out;
  out.path = analysis.path;
  out.to = analysis.to;
  out.first_step = 1.0 / analysis.steps;
  out.largest_step = out.first_step;
  out.max_steps = analysis.max_steps;
  out.max_iterations = analysis.max_iterations;
  return out;
}

void begin_static_path(const Scene& scene, fem::Workspace& model, fem::State& x) {
  const StaticAnalysis& analysis = *scene.statics;
  model.scale_loads(0);
  if (!scene.has_heat()) return;
  const bool loads = !analysis.loads_grow && (!scene.loads.empty() || scene.gravity),
             temperatures = !analysis.temperatures_grow;
  if (loads || temperatures) {
    model.choose_scaled(loads, temperatures);
    fem::StaticSettings settings = static_settings(analysis);
    settings.path = fem::StaticSettings::Path::load;
    settings.to = 1;
    fem::solve_static(model, x, settings, {});
  }
  model.choose_scaled(analysis.loads_grow, analysis.temperatures_grow);
}

}  // namespace flexmorph::cases
