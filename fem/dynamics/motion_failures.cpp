#include "fem/dynamics/motion_failures.h"

#include "geometry/text.h"

namespace flexmorph::fem {

Error collapsed(double t, int step, double ratio) {
  return Error::numerical(
      formatted("motion: the material has collapsed at t = %.6g s, step %d: smallest area ratio "
                "|r_m x r_n| = %.2e. It is too soft for its loads or too hot, or time.step is too "
                "long for what changes in it: then a smaller one helps.",
                t, step, ratio));
}

Error gained_energy(const MotionSettings& settings, double t, int step, double defect,
                    const EnergyGain& gain, bool has_joints) {
  constexpr double kWeaklyDamped = 0.98;  // rho_inf; above, multipliers may alternate
  std::string remedy = "A smaller time.step";
  if (settings.integrator == "generalized_alpha") {
    if (settings.alpha.rho_inf > kWeaklyDamped && has_joints)
      remedy += ", or a smaller time.rho_inf where joint forces alternate from step to step,";
    remedy += " helps; time.integrator = \"energy_momentum\" keeps the energy exactly";
  } else {
    remedy += " helps";
  }
  const std::string text = formatted(
      "motion: no drive brings energy in, but by t = %.6g s, step %d, the energy has grown by "
      "%.3g J, %.0f %% of the largest (by more than 10 %% from t = %.6g s on): the "
      "steps do not follow the motion. ",
      t, step, defect, 100 * gain.part, gain.time);
  return Error::numerical(text + remedy + ".");
}

}  // namespace flexmorph::fem
