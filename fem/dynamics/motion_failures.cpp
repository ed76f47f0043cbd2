#include "fem/dynamics/motion_failures.h"

#include "geometry/text.h"

namespace flexmorph::fem {

Error collapsed(double t, int step, double ratio) {
  return Error::numerical(
      formatted("motion: the material has collapsed at t = %.6g s, step %d: smallest area ratio "
                "|r_m x r_n| = %.2e. The material is too soft for its loads or too hot, or "
                "time.step is too long; then reduce it.",
                t, step, ratio));
}

Error gained_energy(const MotionSettings& settings, double t, int step, double energy_error,
                    const EnergyGain& gain, bool has_joints) {
  constexpr double kWeaklyDamped = 0.98;  // rho_inf; above, multipliers may alternate
  std::string remedy = "Reduce time.step";
  if (settings.integrator == "generalized_alpha") {
    if (settings.alpha.rho_inf > kWeaklyDamped && has_joints)
      remedy += ", or reduce time.rho_inf if joint forces alternate from step to step";
    remedy += "; time.integrator = \"energy_momentum\" conserves the energy exactly";
  }
  const std::string text = formatted(
      "motion: the energy has grown by %.3g J until t = %.6g s, step %d, although no drive "
      "supplies energy. This is %.0f %% of the largest energy, and more than 10 %% since t = %.6g "
      "s. The time steps are too long for the motion. ",
      energy_error, t, step, 100 * gain.part, gain.time);
  return Error::numerical(text + remedy + ".");
}

}  // namespace flexmorph::fem
