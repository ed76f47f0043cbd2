#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "geometry/components/component.h"
#include "geometry/components/outline.h"
#include "geometry/components/tdf.h"
#include "geometry/grid.h"
#include "geometry/parts/feature.h"
#include "optim/mmc/cycles/corrected_cycles.h"
#include "optim/mmc/cycles/load_difference.h"
#include "optim/mmc/loads/compliance_evaluator.h"
#include "optim/mmc/problem/goal.h"

/// The designs of a case, [[design]], and the settings that belong to them: [esl], [cycle],
/// [verify], [certificate].
namespace flexmorph::cases {

/// Settings of the equivalent static loads that replace the motion in the design problem
/// (fem/README.md, Equivalent static loads).
struct Esl {
  double every = 0;  ///< Time between loads; a load is taken at every multiple up to the end [s].
  mmc::ComplianceSettings settings;  ///< Definition of the loads and support of the plate.

  /// Returns the number of loads up to the time `end` [s].
  int count(double end) const;
};

/// A designed body that is not welded at its root: joints hold it at two points.
struct Link {
  std::array<Vec2, 2> pins{};  ///< Material points of the joints, at nodes of the design mesh [m].

  /// Radii of the solid eyes around the pins, and of the bores in the eyes [m]; 0: none.
  std::array<double, 2> eyes{}, bores{};

  mmc::Support support = mmc::Support::pins;  ///< Reactions or inertia that balance the loads.
};

/// The symmetry that a case requests for a design, about middle lines of the grid.
struct WantedSymmetry {
  bool automatic = true;       ///< True: symmetric as far as the scene and the initial layout are.
  bool x = false;              ///< True: mirrored at the middle line parallel to the y axis.
  bool y = false;              ///< True: mirrored at the middle line parallel to the x axis.
  bool despite_loads = false;  ///< True if the loads need not be symmetric.

  /// Returns true if all settings are equal.
  bool operator==(const WantedSymmetry&) const = default;
};

/// The design of one body. The design domain is the body at its longest.
struct BodyDesign {
  std::string body;                     ///< Name of the designed body, or of the [domain].
  std::optional<Link> link;             ///< Pins of a link; absent if the root is welded.
  Grid grid;                            ///< Design mesh: X from the root (0), Y across [m].
  std::array<int, 2> components{1, 1};  ///< Boxes of two components each, along and across.

  /// Objective and limits of the design for loads. Volumes are fractions that include solid
  /// regions.
  mmc::Goal goal;
  /// Objective and limits of the motion itself, see Cycle::correction.
  mmc::Goal motion_goal;

  bool asks_motion = false;   ///< True if the case names responses of the motion itself.
  double min_thickness = 0;   ///< Lower bound c_min of the half-thickness of components [m].
  MinimumWidths widths;       ///< Smallest widths of material and gaps of the union [m]; 0: any.
  double fillet_radius = 0;   ///< Radius of fillets at inner corners of the part [m]; 0: none.
  double half_length = 0;     ///< Half-length of the initial components [m].
  double half_thickness = 0;  ///< Half-thickness of the initial components [m].

  /// Half-widths of the Heaviside band from coarse to fine, in cells; of tdf = "paper" [-].
  std::vector<double> band;

  TdfSettings tdf;               ///< Topology description function with the finest band [m].
  double erosion = 0;            ///< Depth of the erosion in stage 2 [m]; of tdf = "paper" [-].
  double stiffness_void = 1e-4;  ///< Stiffness scale factor of the void in motions [-].
  double mass_void = 1e-3;       ///< Mass scale factor of the void in motions [-].
  std::vector<Component> start;  ///< Initial components; empty: two crossing ones in every box.
  double jitter = 0;  ///< Random change of the initial components, relative to their size [-].
  int seed = 1;       ///< Seed of the random numbers of the jitter.
  int starts = 1;     ///< Number of initial layouts: this one, and further jittered ones.
  WantedSymmetry symmetry;   ///< Requested symmetry.
  bool shares_mass = false;  ///< True if designs share one budget of mass (mmc::SharedProblem).

  /// Solid and void regions as polygons [m]; a cell belongs to a region that contains its centre.
  std::vector<std::vector<Vec2>> solid, empty;
  /// Outline of a part that is verified in place of the components [m]; absent: the components.
  std::optional<std::vector<Region>> part;

  /// Returns the number of initial components.
  int n_components() const {
    return start.empty() ? 2 * components[0] * components[1] : static_cast<int>(start.size());
  }
  /// Returns the settings of the topology description function with one band of the continuation.
  /// The band is in metres, except of tdf = "paper".
  TdfSettings at_band(size_t index) const;
};

struct Scene;

/// Returns the plate of a design. The plate of a static scene has no weight unless its domain has a
/// density.
mmc::Plate plate_of(const Scene& scene, const BodyDesign& design);

/// Returns the allowed deviation of exported curves from the outlines of a design [m]:
/// `output.tolerance`. If it is not given, it is 1/200 of `min_feature`, or 1/100 of a cell where
/// features may have any width.
double export_tolerance(const Scene& scene, const BodyDesign& design);

/// Measure of a motion by which cycles are compared: strain energy over time, or the deflection of
/// a point as its root mean square, its peak-to-peak value or its mean.
enum class CycleMeasure { strain_energy, rms, peak_to_peak, mean };

/// The cycles of motion, equivalent static loads and design: [cycle].
struct Cycle {
  int max_cycles = 6;       ///< Limit of the number of cycles.
  double tolerance = 0.01;  ///< Cycles end when one improves the measure by a smaller fraction [-].

  /// Cycles end when loads differ by a smaller fraction, see mmc::LoopSettings [-].
  double load_difference = mmc::LoadDifference::kLargest;

  CycleMeasure compare_by = CycleMeasure::strain_energy;  ///< Measure that compares cycles.

  /// Point of the deflection: "BODY" for its tip, "BODY.NAME" for an observed point; empty with
  /// strain_energy.
  std::string compare_point;

  /// Correction of the designs after the cycles of equivalent static loads, see
  /// mmc::correct_designs().
  mmc::CorrectionSettings correction;

  double cell = 0;      ///< Cell of the motions of the correction [m]; 0: cells of the designs.
  double step = 0;      ///< Time step of the motions of the correction [s].
  int checkpoints = 0;  ///< Number of checkpoints, see fem::GradientSettings.
};

/// Settings of the optimality certificate of the final designs, see mmc::OptimalityCertificate:
/// [certificate].
struct Certify {
  double cell = 0;      ///< Cell of its motion [m]; 0: cells of the designs.
  double step = 0;      ///< Time step of its motion [s].
  int checkpoints = 0;  ///< Number of checkpoints, see fem::GradientSettings.
};

/// One more dynamic run of the final design, on a finer mesh or on the cells of the designs:
/// [verify]. Limits of the element length at moving roots are scaled with the elements. Exactly one
/// of `mesh`, `refine` and `cells` is used.
struct Verify {
  std::optional<std::array<int, 2>> mesh;  ///< Elements along the length at the start, and across.
  int refine = 1;   ///< Refinement factor of all elements in each direction; used without `mesh`.
  int cells = 0;    ///< Elements per cell of the designs in each direction; 0: not on cells.
  double step = 0;  ///< Time step [s].

  /// Returns a text about the mesh, such as "20 x 4 elements".
  std::string words() const;
};

}  // namespace flexmorph::cases
