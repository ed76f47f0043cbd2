#pragma once

#include <optional>

#include "cases/output/run_folder.h"
#include "cases/results/motion_record.h"
#include "cases/results/parts/verified_outline.h"
#include "io/plots.h"

/// Plots of a run. A function returns a figure without panels, or an empty text, where there is
/// nothing to show.
namespace flexmorph::cases {

/// Draws compliance, volume and KKT residual against iterations: P Fig. 29.
io::Figure convergence_plot(const RunFolder::History& history);

/// Draws the deflection of the tip of every body against time: P Fig. 23.
io::Figure deflection_plot(const MotionRecord& design, const std::optional<MotionRecord>& uniform);

/// Draws the coordinates of observed points against time.
io::Figure observed_plot(const MotionRecord& motion);

/// Draws displacements and strain energy against the load factor, which may decrease along an
/// arc-length path.
io::Figure path_plot(const PathRecord& path);

/// Draws the energies of the model against time.
io::Figure energy_plot(const Scene& scene, const MotionRecord& motion);

/// Draws the drives that follow from the trajectory (without a trajectory: all drives that are
/// used) against time, with separate panels for lengths and angles: P Fig. 25.
io::Figure inputs_plot(const Scene& scene);

/// Draws the error of the rigid body that follows the trajectory against time: P Fig. 31.
io::Figure error_plot(const Scene& scene, const MotionRecord& design,
                      const std::optional<MotionRecord>& uniform);

/// Draws snapshots of the mechanism at a few times: P Fig. 30.
std::string snapshot_plot(const MotionRecord& motion);

/// Draws forces, moments and powers of named joints against time.
io::Figure joint_forces_plot(const Scene& scene, const MotionRecord& motion);

/// Adds panels of the measured columns of a table over x: temperature, lengths of the position
/// gradients, displacements, velocities, strains, deflections; T Figs. 4 to 10 and 14.
void add_measured(const std::vector<double>& x, const std::string& x_label, const Series& table,
                  io::Figure& figure);

/// Draws the measured columns of a motion over time, with the kinetic energy of the model beside
/// the closed-form energies of free bodies: T Fig. 12. Returns no panels without measured
/// columns.
io::Figure measured_plot(const MotionRecord& motion);

/// Draws a verified design under its worst load: the deformed outline, coloured by the von Mises
/// stress. Returns an empty text without a verification, or for an infinite compliance.
std::string stress_plot(const VerifiedOutline& outline);

}  // namespace flexmorph::cases
