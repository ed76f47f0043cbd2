#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fem/element.h"
#include "geometry/components/outline.h"
#include "geometry/parts/closing.h"
#include "geometry/parts/feature.h"
#include "geometry/parts/part_mesh.h"
#include "geometry/parts/picture.h"
#include "optim/mmc/loads/compliance_evaluator.h"
#include "optim/mmc/problem/mmc_problem.h"

namespace flexmorph::mmc {

/// The design problem of one body, for all cycles of an optimization.
struct BodyProblem {
  std::string body;           ///< Name of the body.
  Grid grid;                  ///< Design mesh over the body at its greatest length.
  fem::PlaneSection section;  ///< Thickness and material.
  Design design;              ///< Design variables, with the start of the first cycle.

  /// Further starts of the first cycle, in addition to `design`.
  std::vector<Design> further_starts = {};
  /// Polygons of the solid and of the void passive regions [m].
  std::vector<std::vector<Vec2>> solid = {}, empty = {};
  /// Continuation of the band from coarse to fine; TdfSettings::erosion is not used.
  std::vector<TdfSettings> bands;
  double erosion = 0;     ///< Erosion depth of the eroded stage, see TdfSettings::erosion.
  Goal goal = {};         ///< Goal under equivalent static loads.
  Goal motion_goal = {};  ///< Goal on the motion itself.

  /// Scale factors of stiffness and mass of void in dynamics [-].
  double stiffness_void = 1e-4, mass_void = 1e-3;
  ComplianceSettings compliance = {};  ///< Definition, support and compression of the loads.
  Region domain = {};                  ///< Design domain [m]; without an outer ring the whole grid.

  /// Result of cells_outside() for the domain (n_cells); empty if all cells belong to it.
  std::vector<signed char> outside = {};

  /// Supported and loaded cells; empty for ends_of() the grid.
  std::vector<HeldOrLoaded> locations = {};
  std::vector<Segment> held = {};  ///< Lines of the border that support adjacent material.
  MinimumWidths widths = {};       ///< Minimum widths of the result [m]; 0: no limit.
  Fillets fillets = {};            ///< Fillets at the inner corners of the finished part.

  /// Holes of the domain that are filled by pins in motions and loads [m].
  std::vector<std::vector<Vec2>> bores = {};
  double export_tolerance = 0;  ///< Tolerance of exported curves [m]; 0: kOutlineTolerance cells.

  /// True if the mass limit of the body is part of one budget, which is the sum over all bodies
  /// with this flag.
  bool shares_mass = false;
  /// Outline of a drawn part that replaces the components [m]: crisp numbers and motions are
  /// computed from it, without solid and void regions. Absent if the components are the design.
  std::optional<std::vector<Region>> part = {};
};

/// Returns the plate that is designed, without its design.
Plate plate_of(const BodyProblem& problem);
/// Returns the mass ρ c A of the body when its whole domain is full [kg].
double full_mass_of(const BodyProblem& problem);
/// Returns the mass of a part whose material fills a fraction of the domain [kg]. Pins in bores do
/// not belong to the part.
/// @param volume  volume fraction in the domain, whose bores are holes [-]
double part_mass_of(const BodyProblem& problem, double volume);

/// Returns the map from nodal Heaviside values to scale factors of the cells.
Ersatz ersatz_of(const BodyProblem& problem);
/// Returns the area fractions of the union of components and passive regions by area_fractions()
/// (n_cells); they are 0 outside of the domain.
VectorXd fractions_of(const BodyProblem& problem, std::span<const Component> components);
/// Sets the fractions of cells outside of the domain to 0.
/// @param outside  BodyProblem::outside
void leave_out(const std::vector<signed char>& outside, VectorXd& fractions);
/// Updates the area fractions of a design in which some components have changed. The work is
/// proportional to the extent of these components along x.
/// @param components  all components after the change
/// @param changed     the changed components, before and after the change
/// @param fractions   area fractions before the change (n_cells); receives those of `components`
void update_fractions(const BodyProblem& problem, std::span<const Component> components,
                      std::span<const Component> changed, VectorXd& fractions);

/// Largest distance of the sides of analysed and exported outlines from the exact outlines [cells].
constexpr double kOutlineTolerance = 0.01;

/// Returns the domain with its holes [m].
Region domain_of(const BodyProblem& problem);
/// Returns the rings of the domain, of the solid regions and of the void regions [m]. No design
/// moves them.
std::vector<std::vector<Vec2>> fixed_rings(const BodyProblem& problem);
/// Returns the exact union of the components and the solid regions without the void regions,
/// clipped to the domain.
/// @param tolerance  largest distance of the sides from the exact outlines [m]
/// @param further    additional polygons of the union
/// @throws Error (numerical) from unite().
std::vector<Region> regions_of(const BodyProblem& problem, std::span<const Component> components,
                               double tolerance, std::span<const std::vector<Vec2>> further = {});

/// Returns the locations where material or void of a union of regions is narrower than a limit,
/// narrowest first. Gaps between material and lines that support it (BodyProblem::held) are
/// included. Locations that result from passive regions and holes of the domain alone are left out,
/// because no design can change them.
/// @param limit  upper bound of the widths that are returned [m]
std::vector<LengthScaleViolation> length_scale_violations_of(const BodyProblem& problem,
                                                             std::span<const Region> regions,
                                                             double limit);
/// Returns the smallest widths of material and void of a union of regions, with the exceptions of
/// length_scale_violations_of().
Features features_of(const BodyProblem& problem, std::span<const Region> regions);

/// Returns the smallest width of material below the required one at the locations that
/// length_scale_violations_of() leaves out; nothing if there are none [m].
std::optional<double> given_width_of(const BodyProblem& problem, std::span<const Region> regions);

/// Returns how regions connect supports and loads. The result is exact: a slit far narrower than a
/// cell separates regions. Regions that share only a vertex are not connected.
Connectivity connectivity_of(const BodyProblem& problem, std::span<const Region> regions);

/// Returns the compliance by which designs are compared, which is that of compliance_row() [J].
double design_compliance(const BodyProblem& problem, ComplianceEvaluator& loads,
                         const CellScaleFactors& factors);

/// Largest values of responses by their key_of().
using Figures = std::map<std::string, double>;
/// Returns the largest values of the responses further_rows() of the goal.
Figures further_values(const BodyProblem& problem, std::span<const Component> components,
                       ComplianceEvaluator& loads, const CellScaleFactors& factors);

/// Returns the values of limited responses with Limit::wants_material() for the full design, in
/// which all cells that can be material are material. Under loads that do not depend on the design
/// no design has smaller values. The result is empty where no limit bounds such a response.
Figures full_values(const BodyProblem& problem, ComplianceEvaluator& loads);

/// The crisp (0-1) design that the outlines enclose, with its responses and widths.
struct CrispDesign {
  VectorXd fractions;         ///< Area fractions of the finished part (n_cells) [-].
  double compliance = 0;      ///< Compliance design_compliance() under the loads [J].
  double volume = 0;          ///< Volume fraction in the domain [-].
  Figures further;            ///< Values of the responses further_rows() of the goal.
  Connectivity connectivity;  ///< Connections of the loads to the supports.

  /// Smallest widths, see features_of(); absent when the outlines cannot be united.
  std::optional<Features> features;

  /// Smallest width of material that solid regions or borders of the domain determine, where it is
  /// below BodyProblem::widths; features do not contain it, because no design can change it [m].
  std::optional<double> given_width;
  int widened = 0;              ///< FinishedPart::widened of the finished part.
  double seconds_outlines = 0;  ///< CPU seconds of the union, its connectivity and its widths.
};
/// Returns the crisp design of components with its responses under the loads.
CrispDesign crisp_design(const BodyProblem& problem, std::span<const Component> components,
                         ComplianceEvaluator& loads);

/// Returns the scale factors of the body for dynamics: those of the finished part, with the scale
/// factors of void in dynamics.
fem::ScaleFactors dynamic_factors(const BodyProblem& problem,
                                  std::span<const Component> components);

}  // namespace flexmorph::mmc
