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

/// The design problem of one body, over all cycles.
struct BodyProblem {
  std::string body;
  Grid grid;  ///< design mesh over the body at its longest
  fem::PlaneSection section;
  Design design;
  std::vector<Design> further_starts = {};                ///< of the first cycle, besides `design`
  std::vector<std::vector<Vec2>> solid = {}, empty = {};  ///< passive regions: polygons
  std::vector<TdfSettings>
      bands;              ///< continuation of the band, coarse to fine; erosion is not used
  double erosion = 0;     ///< of the eroded stage, see TdfSettings::erosion
  Goal goal = {};         ///< of equivalent static loads
  Goal motion_goal = {};  ///< of the motion itself
  double stiffness_void = 1e-4, mass_void = 1e-3;  ///< in dynamics
  ComplianceSettings compliance = {};
  Region domain = {};                     ///< without an outer ring: the whole grid
  std::vector<signed char> outside = {};  ///< cells_outside() of it; empty: none
  std::vector<HeldOrLoaded> places = {};  ///< empty: ends_of() the grid
  std::vector<Segment> held = {};         ///< lines of the border that hold what touches them
  Widths widths = {};                     ///< smallest widths of the result; 0: any
  Fillets fillets = {};                   ///< at the inner corners of the part
  /// Holes of the domain that pins fill in motions and loads.
  std::vector<std::vector<Vec2>> bores = {};
  double export_tolerance = 0;  ///< of exported curves [m]; 0: kOutlineTolerance cells
  /// Its mass comes from one budget for all bodies that say so: what each is allowed, together.
  bool shares_mass = false;
  /// Outline of a part that stands in place of the components [m]: crisp numbers and motions are
  /// those of this outline, without solid and void regions. Absent: the components are the design.
  std::optional<std::vector<Region>> part = {};
};

/// What is designed, without its design.
Plate plate_of(const BodyProblem& problem);
/// ρ c A: the mass of the body when its whole domain is full [kg].
double full_mass_of(const BodyProblem& problem);

/// Chain of factors of the problem's cells.
Ersatz ersatz_of(const BodyProblem& problem);
/// Area fractions of true material (n_cells), 0 outside of the domain.
VectorXd fractions_of(const BodyProblem& problem, std::span<const Component> components);
/// Sets the fractions of cells outside of the domain to 0.
/// @param outside  BodyProblem::outside
void leave_out(const std::vector<signed char>& outside, VectorXd& fractions);
/// The same from those of other components, which differ by `changed` ones only: the work is
/// proportional to their extent along x.
void update_fractions(const BodyProblem& problem, std::span<const Component> components,
                      std::span<const Component> changed, VectorXd& fractions);

/// How far the sides of measured and written outlines may be off the true ones [cells].
constexpr double kOutlineTolerance = 0.01;

/// The domain with its holes [m].
Region domain_of(const BodyProblem& problem);
/// Returns the rings of the domain, of the solid regions and of the voids, which no design moves.
std::vector<std::vector<Vec2>> fixed_rings(const BodyProblem& problem);
/// Exact union of the components and the solid regions, less the voids, clipped to the domain.
/// @param tolerance  how far sides may be off the true outlines [m]
/// @param further    polygons that are in the union as well
/// @throws Error (numerical) from unite().
std::vector<Region> regions_of(const BodyProblem& problem, std::span<const Component> components,
                               double tolerance, std::span<const std::vector<Vec2>> further = {});

/// Narrow places of such a union, gaps to what holds it among them, less those that passive regions
/// and holes of the domain make by themselves: no design can change them.
std::vector<NarrowPlace> narrow_places_of(const BodyProblem& problem,
                                          std::span<const Region> regions, double limit);
Features features_of(const BodyProblem& problem, std::span<const Region> regions);

/// What hangs together in such a union, exactly: a slit far below a cell is a slit. Pieces that
/// share a vertex only stay apart.
Connectivity connectivity_of(const BodyProblem& problem, std::span<const Region> regions);

/// Returns the compliance that designs are compared by, which is that of compliance_row() [J].
double design_compliance(const BodyProblem& problem, ComplianceEvaluator& loads,
                         const CellFactors& factors);

/// Largest values of further_rows() of a goal, by key_of().
using Figures = std::map<std::string, double>;
Figures further_values(const BodyProblem& problem, std::span<const Component> components,
                       ComplianceEvaluator& loads, const CellFactors& factors);

/// Values of the responses that limits of the goal bound and that fall with material, by key_of(),
/// when all of the domain that may be material is: under loads that do not depend on the design, no
/// design has less. Empty where no limit bounds such a response.
Figures full_values(const BodyProblem& problem, ComplianceEvaluator& loads);

/// A design without blur: what its outlines enclose.
struct SharpDesign {
  VectorXd fractions;     ///< of true material per cell (n_cells)
  double compliance = 0;  ///< of the same loads: weighted sum, or the largest
  double volume = 0;
  Figures further;
  Connectivity connectivity;
  std::optional<Features>
      features;                 ///< see features_of(); absent when the outlines cannot be united
  int widened = 0;              ///< narrow places that were widened, see FinishedPart
  double seconds_outlines = 0;  ///< CPU seconds of the union, its pieces and widths
};
SharpDesign sharp_design(const BodyProblem& problem, std::span<const Component> components,
                         ComplianceEvaluator& loads);

/// Factors of the body for dynamics: the sharp picture with the void factors of dynamics.
fem::Factors dynamic_factors(const BodyProblem& problem, std::span<const Component> components);

}  // namespace flexmorph::mmc
