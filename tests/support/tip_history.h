#pragma once

#include "fem/dynamics/motion.h"
#include "tests/support/models.h"

namespace flexmorph::testing {

/// Deflection of the tip of a rotating plate at n equidistant times up to the end [m], from the
/// start `rigid`, and the step counts of the motion.
struct PlateHistory {
  VectorXd deflection;  ///< Deflection at the n times (n).
  fem::StepCounts counts;
  fem::State final;
};

inline PlateHistory tip_history(const RotatingPlate& p, double end, int n, double step = 1e-3) {
  Scene scene = make_scene(p);
  fem::MotionSettings settings;
  settings.start = fem::Start::rigid;
  settings.end = end;
  settings.step = step;
  for (int k = 1; k <= n; ++k) settings.stops.push_back(end * k / n);
  PlateHistory out;
  out.deflection.resize(n);
  Eigen::Index k = 0;
  const fem::MotionResult result =
      fem::integrate(scene.model, scene.moving_roots, settings, [&](const fem::MotionStep& s) {
        if (s.stop && s.x.t > 0 && k < n)
          out.deflection[k++] = in_hub(p, s.model, s.x, p.tip()).y();
      });
  out.counts = result.counts;
  out.final = result.final;
  return out;
}

/// Returns the root mean square of the difference relative to the largest expected value.
inline double rms_apart(const VectorXd& found, const VectorXd& expected) {
  return (found - expected).norm() / std::sqrt(static_cast<double>(expected.size())) /
         expected.cwiseAbs().maxCoeff();
}

}  // namespace flexmorph::testing
