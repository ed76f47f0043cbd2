#include "fem/dynamics/integrators/integrator.h"

#include <map>
#include <ranges>

#include "fem/dynamics/integrators/energy_momentum.h"
#include "fem/dynamics/integrators/generalized_alpha.h"
#include "fem/dynamics/integrators/minimal_coordinates.h"
#include "geometry/text.h"

namespace flexmorph::fem {

void archive(Archive& memory, State& x) { memory(x.t, x.q, x.v, x.a, x.lambda, x.turned); }

namespace {

using Maker = std::unique_ptr<Integrator> (*)(Workspace&, const IntegratorSettings&);

const std::map<std::string, Maker>& table() {
  static const std::map<std::string, Maker> kIntegrators = {
      {"generalized_alpha",
       [](Workspace& model, const IntegratorSettings& s) -> std::unique_ptr<Integrator> {
         return std::make_unique<GeneralizedAlpha>(model, s.alpha);
       }},
      {"energy_momentum",
       [](Workspace& model, const IntegratorSettings& s) -> std::unique_ptr<Integrator> {
         return std::make_unique<EnergyMomentum>(model, s.energy_momentum);
       }},
      {"minimal_coordinates",
       [](Workspace& model, const IntegratorSettings& s) -> std::unique_ptr<Integrator> {
         return std::make_unique<MinimalCoordinates>(model, s.minimal_coordinates);
       }}};
  return kIntegrators;
}

}  // namespace

TriedStep Integrator::try_step(State&, double, double) {
  throw Error::input(
      "adaptive steps need integrator \"generalized_alpha\", because this integrator does not "
      "estimate its local error");
}

double Integrator::first_step(const State&, double, double longest) { return longest; }

std::unique_ptr<Integrator> make_integrator(Workspace& model, const IntegratorSettings& settings) {
  const auto row = table().find(settings.name);
  if (row == table().end())
    throw Error::input(
        "integrator '" + settings.name +
        "' is unknown; the available integrators are: " + joined(std::views::keys(table())));
  return row->second(model, settings);
}

}  // namespace flexmorph::fem
