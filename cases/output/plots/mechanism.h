#pragma once

#include <optional>

#include "cases/results/motion_record.h"
#include "cases/scene/scene.h"

/// Plots of a mechanism as SVG; empty where there is nothing to show.
namespace flexmorph::cases {

/// The drives that follow from the trajectory (without one: all that something uses) against time,
/// lengths and angles apart: P Fig. 25.
std::string inputs_plot(const Scene& scene);

/// How far the trajectory's body is from its path, against time: P Fig. 31.
std::string error_plot(const Scene& scene, const MotionRecord& design,
                       const std::optional<MotionRecord>& uniform);

/// The mechanism at a few moments: P Fig. 30.
std::string moments_plot(const MotionRecord& motion);

/// Forces, moments and powers of named joints against time.
std::string joint_forces_plot(const Scene& scene, const MotionRecord& motion);

}  // namespace flexmorph::cases
