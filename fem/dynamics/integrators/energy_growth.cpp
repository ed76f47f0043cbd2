#include "fem/dynamics/integrators/energy_growth.h"

namespace flexmorph::fem {
namespace {

/// Round-off of energies relative to their summands, sufficient for 1e5 steps.
constexpr double kRoundOff = 1e-9;

}  // namespace

void EnergyGrowth::begin(const Energies& e, double round_off) {
  watched_ = true;
  potential_ = e.potential;
  largest_ = std::max({e.kinetic, e.strain, kRoundOff * std::abs(e.potential), round_off});
  gain_ = {};
}

void EnergyGrowth::see(double t, const Energies& e, const Powers& p, double energy_error) {
  watched_ = watched_ && p.drive == 0 && p.feed == 0 && p.inflow == 0 && p.heat == 0;
  if (!watched_) return;
  largest_ = std::max({largest_, e.kinetic, e.strain, std::abs(e.potential - potential_),
                       kRoundOff * std::abs(e.potential)});
  if (!(largest_ > 0)) return;
  gain_.part = std::max(gain_.part, energy_error / largest_);
  if (gain_.time == 0 && gain_.part > kNoticed) gain_.time = t;
}

}  // namespace flexmorph::fem
