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

/// [[design]], and what goes on around it.
namespace flexmorph::cases {

/// When the motion is turned into equivalent static loads, and what kind (fem/README.md, Equivalent
/// static loads).
struct Esl {
  double every = 0;  ///< a load at every multiple of it up to the end [s]
  mmc::ComplianceSettings settings;

  int count(double end) const;  ///< number of loads up to `end`
};

/// A designed body that nothing clamps: joints hold it at two points.
struct Link {
  std::array<Vec2, 2> pins{};  ///< material points, at nodes of the design mesh [m]
  /// Radii of the solid eyes around the pins, and of the bores in them; 0: none [m].
  std::array<double, 2> eyes{}, bores{};
  mmc::Support support = mmc::Support::pins;
};

/// The middle lines of its grid that a design is asked to be symmetric to.
struct WantedSymmetry {
  bool automatic = true;       ///< those that the scene and the start are symmetric to
  bool x = false;              ///< the middle line that is parallel to the y axis
  bool y = false;              ///< the middle line that is parallel to the x axis
  bool despite_loads = false;  ///< loads need not be symmetric

  bool operator==(const WantedSymmetry&) const = default;
};

/// The design of one body, on its design domain: the body at its longest.
struct BodyDesign {
  std::string body;
  std::optional<Link> link;             ///< absent where a hub or a rigid body carries its root
  Grid grid;                            ///< X from the root (0) to the free end, Y across [m]
  std::array<int, 2> components{1, 1};  ///< boxes of the initial layout, two components in each
  mmc::Goal goal;                       ///< volumes are fractions, solid regions included
  mmc::Goal motion_goal;                ///< of the motion itself, see Cycle::correct
  bool asks_motion = false;             ///< does the case name numbers of the motion?
  double min_thickness = 0;             ///< c_min: smallest half-thickness of a component [m]
  Widths widths;                        ///< smallest widths of the union [m]; 0: any
  double fillet_radius = 0;             ///< at inner corners of the part [m]; 0: none
  double half_length = 0;               ///< of the initial components [m]
  double half_thickness = 0;            ///< of the initial components [m]
  /// Half-widths of the Heaviside band, coarse to fine [cells]; of tdf = "paper" [-].
  std::vector<double> band;
  TdfSettings tdf;               ///< in metres, with the last, finest band
  double erosion = 0;            ///< depth of the eroded design in stage 2 [m]
  double stiffness_void = 1e-4;  ///< stiffness factor of the void in dynamics [-]
  double mass_void = 1e-3;       ///< mass factor of the void in dynamics [-]
  std::vector<Component> start;  ///< empty: boxes of two crossing components
  double jitter = 0;             ///< of the initial components, in parts of their sizes [-]
  int seed = 1;                  ///< of the jitter
  int starts = 1;                ///< this one, and others that are jittered
  WantedSymmetry symmetry;
  bool shares_mass = false;  ///< with the other designs that do: see mmc::SharedProblem
  /// Polygons; a cell belongs to a region that holds its centre [m].
  std::vector<std::vector<Vec2>> solid, empty;
  /// Outline of a part that is verified in place of the components [m]; absent: components.
  std::optional<std::vector<Region>> part;

  int n_components() const {
    return start.empty() ? 2 * components[0] * components[1] : static_cast<int>(start.size());
  }
  /// Settings at one band of the continuation, without erosion.
  TdfSettings at_band(size_t index) const;
};

struct Scene;

/// The plate that is designed; that of a static scene weighs nothing unless its domain has a
/// density.
mmc::Plate plate_of(const Scene& scene, const BodyDesign& design);

/// How far exported curves may be off the outlines of a design [m]: `output.tolerance`; where it is
/// not given, a 200th of `min_feature`, or of a cell a 100th where features may have any size.
double export_tolerance(const Scene& scene, const BodyDesign& design);

/// The measures of a motion that cycles are compared by.
enum class CycleMeasure { strain_energy, rms, peak_to_peak, mean };

struct Cycle {
  int max_cycles = 6;
  double tolerance = 0.01;  ///< cycles end when one improves the measure by less than this part
  double load_difference = mmc::LoadDifference::kLargest;  ///< see mmc::LoopSettings
  CycleMeasure compare_by = CycleMeasure::strain_energy;
  /// "BODY" of its tip, "BODY.NAME" of an observed point; empty with strain_energy.
  std::string compare_point;
  /// What follows the cycles of equivalent static loads: see mmc::correct_designs().
  mmc::CorrectionSettings correction;
  double cell = 0;      ///< of the motions that correct [m]; 0: the designs' own
  double step = 0;      ///< of them [s]
  int checkpoints = 0;  ///< see fem::GradientSettings
};

/// What the motion itself says of the final designs, see mmc::MotionCertificate.
struct Certify {
  double cell = 0;      ///< of its motion [m]; 0: the designs' own
  double step = 0;      ///< [s]
  int checkpoints = 0;  ///< see fem::GradientSettings
};

/// One more dynamic run of the final design on a finer mesh; the limits of flowing elements
/// shrink with the elements.
struct Verify {
  std::optional<std::array<int, 2>> mesh;  ///< elements along the length at the start, and across
  int refine = 1;                          ///< or so many times those of every body
  int cells = 0;    ///< or the cells of the designs, each in so many parts each way; 0: not these
  double step = 0;  ///< [s]

  std::string words() const;  ///< "20 x 4 elements"
};

}  // namespace flexmorph::cases
