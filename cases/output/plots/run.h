#pragma once

#include <optional>

#include "cases/output/run_folder.h"
#include "cases/results/motion_record.h"

/// Plots of a run as SVG.
namespace flexmorph::cases {

/// Compliance, volume and KKT residual against iterations: P Fig. 29.
std::string convergence_plot(const RunFolder::History& history);

/// Deflection of the tip of every body against time: P Fig. 23.
std::string deflection_plot(const MotionRecord& design, const std::optional<MotionRecord>& uniform);

std::string observed_plot(const MotionRecord& motion);

/// Displacements and strain energy against the load factor; along an arc the factor may go back.
std::string path_plot(const PathRecord& path);

std::string energy_plot(const Scene& scene, const MotionRecord& motion);

}  // namespace flexmorph::cases
