#pragma once

#include <optional>

#include "cases/output/run_folder.h"
#include "cases/results/motion_record.h"
#include "cases/results/verified_outline.h"
#include "io/plots.h"

/// Plots of a run as SVG; empty where there is nothing to show.
namespace flexmorph::cases {

/// Compliance, volume and KKT residual against iterations: P Fig. 29.
std::string convergence_plot(const RunFolder::History& history);

/// Deflection of the tip of every body against time: P Fig. 23.
std::string deflection_plot(const MotionRecord& design, const std::optional<MotionRecord>& uniform);

/// Draws the coordinates of observed points against time.
std::string observed_plot(const MotionRecord& motion);

/// Displacements and strain energy against the load factor; along an arc the factor may go back.
std::string path_plot(const PathRecord& path);

/// Draws the energies of the model against time.
std::string energy_plot(const Scene& scene, const MotionRecord& motion);

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

/// Adds panels of the measured columns of a table over x: temperature, lengths of the position
/// gradients, displacements, velocities, strains, deflections; T Figs. 4 to 10 and 14.
void add_measured(const std::vector<double>& x, const std::string& x_label, const Series& table,
                  io::Figure& figure);

/// Draws the measured columns of a motion over time, with the kinetic energy of the model beside
/// those of free bodies: T Fig. 12. Empty without measured columns.
std::string measured_plot(const MotionRecord& motion);

/// Draws a verified design under its worst load as SVG: displaced, in the colours of the von Mises
/// stress. Empty where there is no verification, or an infinite compliance.
std::string stress_plot(const VerifiedOutline& outline);

}  // namespace flexmorph::cases
