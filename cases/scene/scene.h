#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cases/scene/accuracy.h"
#include "fem/heat.h"
#include "fem/joint.h"
#include "fem/solve/statics.h"
#include "geometry/component.h"
#include "geometry/grid.h"
#include "geometry/tdf.h"
#include "io/case_file.h"
#include "optim/mmc/mmc_problem.h"
#include "optim/mmc/responses.h"
#include "optim/optimizer.h"

/// What a case file says, as plain data. Nobody else reads the case file; what a case does not
/// list is absent here too (empty lists, empty optionals), not zero.
namespace flexmorph::cases {

/// How a driven scene starts (fem/README.md, Starts).
enum class Start {
  prestretched,  ///< velocity of the rigid, extending body, in equilibrium in the turning frame
  rigid,         ///< the same velocity, unstrained: sets off axial ringing
  hub_at_rest    ///< smooth spin-up of the hub from rest
};

struct TimeSpan {
  double end = 1;      ///< [s], from 0
  double step = 1e-3;  ///< [s]; not of adaptive steps
  /// Steps that adapt to this tolerance (fem::AdaptiveStep); absent: equal ones.
  std::optional<double> tolerance;
  double largest_step = 0;                       ///< of adaptive steps [s]; 0: the default
  std::string integrator = "generalized_alpha";  ///< see fem::make_integrator()
  double explicit_tolerance = 1e-8;              ///< of the steps of `minimal_coordinates`
  double rho_inf = 0.8;  ///< spectral radius of generalized-alpha at infinite frequency, 0..1
  Start start = Start::prestretched;
  double spin_up = 0;  ///< duration of the spin-up [s], 0 unless `hub_at_rest`
};

/// Nonlinear statics of the bodies, in place of a motion.
struct StaticAnalysis {
  fem::StaticSettings::Path path = fem::StaticSettings::Path::load;
  double to = 1;            ///< load factor at the end, from 0
  int steps = 10;           ///< equal steps to there; arc_length: the first step is one of them
  int max_steps = 1000;     ///< equilibria before the analysis gives up
  int max_iterations = 15;  ///< of Newton's method in a step
  /// What the load factor multiplies; the other one is there as it is from the start.
  bool loads_grow = true, temperatures_grow = false;
};

/// A motion: the name of a drive, or where there is none a constant.
struct Law {
  std::string drive;
  double value = 0;
};

/// A place on a body, or on the ground.
struct Anchor {
  std::string body;   ///< empty: the ground
  Vec2 point{0, 0};   ///< in the axes of a rigid body or the ground; material point of a plate [m]
  double angle = 0;   ///< of its first axis in those axes [rad]
  bool given = true;  ///< false: where the other anchor of the joint is at the start

  bool on_ground() const { return body.empty(); }
};

/// A rigid body in the plane; its axes lie at `position`, turned by `angle`, at the start.
struct RigidBody {
  std::string name;
  double mass = 0;                         ///< [kg]
  double inertia = 0;                      ///< about the centre of mass [kg m^2]
  Vec2 center{0, 0};                       ///< of mass, in the axes of the body [m]
  Vec2 size{0, 0};                         ///< of the rectangle around it that is drawn [m]
  Vec2 position{0, 0}, velocity{0, 0};     ///< [m], [m/s]; where joints leave them free
  double angle = 0, angular_velocity = 0;  ///< [rad], [rad/s]
};

/// Spring and damper between two anchors: along the line between them, or between their axes.
struct Spring {
  std::string name;
  bool torsion = false;
  Anchor a, b;
  double stiffness = 0, damping = 0;  ///< [N/m], [N s/m]; torsion: [N m/rad], [N m s/rad]
  double rest = 0;                    ///< length [m] or angle [rad] without force
};

/// The path of a rigid body that drives with from = "trajectory" follow from.
struct Trajectory {
  std::string body;
  Law x, y, angle;  ///< of the body's point and axis
};

/// A function of time that a case gives a name.
struct Drive {
  std::string name;
  std::string words;  ///< as the case says it: the formula, or where the table comes from
  /// Beyond the run's time it goes on as the parabola of value, rate and acceleration at its end.
  std::function<fem::Motion(double)> motion;
  bool from_trajectory = false;  ///< what the trajectory's body needs of it (follow_trajectory())
};

/// A driven hub: turns about its position at a constant rate, or as drives say.
struct Hub {
  std::string name;
  Vec2 position{0, 0};          ///< at the start [m]
  double angle = 0;             ///< at the start [rad]
  double angular_velocity = 0;  ///< [rad/s], 0 where a drive turns the hub
  Law turn;                     ///< the drive of the angle, if any
  std::array<Law, 2> path;      ///< the drives of the position, both or none
};

/// Material that leaves the hub, and when node lines come and go (fem/README.md, Insertion and
/// removal).
struct Flow {
  double speed = 0;  ///< rate at which material leaves the hub [m/s]; negative: enters it
  Law length;        ///< or the drive of the length outside of the hub; `speed` is 0 then
  std::function<fem::Motion(double)> motion;  ///< that drive; empty: constant speed
  double longest = 0, shortest = 0;           ///< with that drive: over the run [m]
  double max_length = 0;  ///< a longer boundary element is split in the middle [m]
  double min_length = 0;  ///< a shorter one is merged with its neighbour [m]
};

/// An m-line of a body's mesh that is not where an even mesh has it, or is free to move through the
/// material.
struct BodyLine {
  int index = 0;  ///< 0 is the root
  bool free = false;
  std::optional<double> at;  ///< material coordinate at the start [m]
  /// Of a free root line: limits of the element next to it, as those of a Flow; none by default.
  double max_length = std::numeric_limits<double>::infinity(), min_length = 0;
  bool has_limits() const { return std::isfinite(max_length); }
};

/// Uniform heat of a body: what it is warmer than without stress.
struct BodyHeat {
  double expansion = 0;          ///< [1/K]
  Law rise;                      ///< [K]: in the end, or at all times where a drive says it
  std::string profile;           ///< of the rise in time; empty: constant, or a drive
  double start = 0, settle = 0;  ///< the rise begins, and how long it takes [s]
  fem::ThermalVolume volume = fem::ThermalVolume::grown;
  bool force = false;  ///< the thermal force Q_tk acts
};

/// A plate or a beam. Material coordinates: X from the root to the free end; Y across,
/// -width/2..width/2 in the plane and 0..width in space.
struct Body {
  std::string name;
  std::string element;             ///< row of the table of elements
  std::string shape;               ///< shape set: "h16", "h12"
  std::string space;               ///< "plane" or "space": two or three components
  std::vector<std::string> terms;  ///< rows of the table of terms
  double length = 0;               ///< at the start [m]
  /// Across the axis, and across the surface [m]. Of a beam (in the case: `height` and `width`): in
  /// the plane of the motion, and across it.
  double width = 0, thickness = 0;
  double density = 0;                 ///< [kg/m^3]
  double youngs_modulus = 0;          ///< [Pa]
  double poisson_ratio = 0;           ///< [-]
  int bending_points = 5;             ///< Gauss points of the bending per element and direction
  std::array<int, 2> elements{1, 1};  ///< along the length at the start, across the width
  std::optional<Flow> flow;           ///< absent: no material flows
  std::vector<BodyLine> lines;        ///< by index
  std::optional<Vec2> position;       ///< of the middle of the root at the start, where given [m]
  double angle = 0;                   ///< of its axis, with `position` [rad]
  double arc = 0;  ///< angle that the axis of an undeformed beam turns by, an arc of a circle [rad]
  std::optional<BodyHeat> heat;  ///< absent: cold

  bool is_beam() const { return element == "ancf_beam"; }
  double length_at(double time) const;
  fem::Motion length_motion(double time) const;
  double longest(double end) const;   ///< in [0, end], the time of the run
  double shortest(double end) const;  ///< likewise
  bool in_space() const { return space == "space"; }
  int dim() const { return in_space() ? 3 : 2; }
  double low() const { return in_space() ? 0 : -0.5 * width; }  ///< where Y begins [m]
  bool has(const std::string& term) const {
    return std::find(terms.begin(), terms.end(), term) != terms.end();
  }
  bool has_free_lines() const {
    return std::any_of(lines.begin(), lines.end(), [](const BodyLine& l) { return l.free; });
  }
  /// Do lines of nodes come and go?
  bool mesh_changes() const { return flow || (!lines.empty() && lines.front().has_limits()); }
  /// Material coordinates of the m-lines at the start, the first at `root` [m].
  std::vector<double> start_lines(double root, int count) const;
};

/// A row of the table of joints, and what it needs:
///
/// weld        edge ("root" or "line 3") in the hub `to`, or edge ("free_end", too) on the rigid
///             body b; without an edge: axes of the rigid bodies a and b
/// revolute    points a and b are one
/// slider      point b slides along the first axis of a, axes are parallel
/// angle_drive, distance, point_drive   see fem/body_joints.h, by the laws
/// sleeve      edge in a frame at rest at `position`, `angle`: material slides through a free line
/// pin         the material point keeps `components` of its position at the start
/// clamp, support, symmetry    `edges` of a body in space, see fem::clamped_edge()
/// line_drive  the free line moves through the material at `speed`, or stands where `at` says
struct Joint {
  std::string type, body;
  std::string name;    ///< as messages and tables say it
  bool named = false;  ///< by the case: its forces are in the table of the motion
  Anchor a, b;         ///< of joints between bodies
  std::vector<Law> laws;
  std::string edge;
  std::string to;
  fem::WeldMode mode = fem::WeldMode::edge;
  Vec2 position{0, 0};  ///< [m]
  double angle = 0;     ///< [rad]
  Vec2 point{0, 0};     ///< material [m]
  std::vector<int> components;
  std::vector<std::string> edges;
  int line = 0;      ///< of line_drive; of weld and sleeve the line of their edge
  double speed = 0;  ///< [m/s]
  Law at;            ///< the drive of a line, if any

  /// Is an edge of a plate in a hub, in a sleeve or on a rigid body?
  bool holds_frame() const { return (type == "weld" && !body.empty()) || type == "sleeve"; }
  bool on_rigid_body() const { return holds_frame() && !b.on_ground(); }
  bool between_bodies() const { return !holds_frame() && (!a.on_ground() || !b.on_ground()); }
  bool holds_edges() const { return type == "clamp" || type == "support" || type == "symmetry"; }
};

/// A load on a body: a row of this table,
///
/// point        `force` [N] at a material point      edge         `force` [N/m] along an edge
/// surface      `force` [N/m^2]                      pressure     `size` [N/m^2], follows
/// edge_moment  `size` [N] per length of an edge, follows
struct BodyLoad {
  std::string type, body;
  std::string edge;
  Vec2 point{0, 0};  ///< material [m]
  VectorXd force;    ///< (dim)
  double size = 0;
};

/// Quantities of a body that are results, see BodyMeasures.
struct Measure {
  std::string body;
  std::vector<std::string> quantities;
};

/// A material point whose position is a result.
struct Observe {
  std::string name, body;
  Vec2 point{0, 0};  ///< material [m]
};

struct PointMass {
  std::string body;
  std::string at;   ///< "free_end": the middle of that edge
  double mass = 0;  ///< [kg]
};

/// Where a plate at rest is held or pulled.
struct Place {
  enum class Kind { edge, point, box };
  Kind kind = Kind::point;
  Box box;  ///< an edge is a box without width [m]
};

struct PlaneSupport {
  Place place;
  bool x = false, y = false;  ///< held directions
};

struct PlaneForce {
  Place place;
  Vec2 force{0, 0};  ///< in all, spread evenly over the place [N]
};

/// Forces that act at the same time.
struct LoadCase {
  std::string name;
  double weight = 1;
  std::vector<PlaneForce> forces;
};

/// A plate at rest: what a static scene has instead of bodies that move.
struct Domain {
  std::string name;
  Box bounds;                 ///< of the design mesh [m]
  std::vector<Vec2> polygon;  ///< the domain within; empty: all of it
  double thickness = 1;       ///< [m]
  double youngs_modulus = 1;  ///< [Pa]
  double poisson_ratio = 0.3;
  std::vector<PlaneSupport> supports;
  std::vector<LoadCase> loads;
};

/// When the motion is turned into equivalent static loads, and what kind (fem/README.md, Equivalent
/// static loads).
struct Esl {
  double every = 0;  ///< a load at every multiple of it up to the end [s]
  mmc::ComplianceSettings settings;

  int count(double end) const;  ///< number of loads up to `end`
};

/// The design of one body, on its design domain: the body at its longest.
struct BodyDesign {
  std::string body;
  Grid grid;                            ///< X from the root (0) to the free end, Y across [m]
  std::array<int, 2> components{1, 1};  ///< boxes of the initial layout, two components in each
  mmc::Goal goal;                       ///< volumes are fractions, solid regions included
  double min_thickness = 0;             ///< c_min: smallest half-thickness of a component [m]
  double min_feature = 0;               ///< smallest solid feature of the union [m], 0: as it comes
  double half_length = 0;               ///< of the initial components [m]
  double half_thickness = 0;            ///< of the initial components [m]
  /// Half-widths of the Heaviside band, coarse to fine [cells]; of tdf = "paper" [-].
  std::vector<double> band;
  TdfSettings tdf;                ///< in metres, with the band of the last, finest stage
  double stiffness_void = 1e-4;   ///< stiffness factor of the void in dynamics [-]
  double mass_void = 1e-3;        ///< mass factor of the void in dynamics [-]
  std::vector<Component> start;   ///< empty: boxes of two crossing components
  double jitter = 0;              ///< of the initial components, in parts of their sizes [-]
  int seed = 1;                   ///< of the jitter
  int drop_every = 25;            ///< iterations between looks for dead components, 0: none
  bool refill = false;            ///< long components are split in place of dropped ones
  bool shares_mass = false;       ///< with the other designs that do: see mmc::SharedProblem
  std::vector<Box> solid, empty;  ///< a cell belongs to a region that holds its centre [m]

  int n_components() const {
    return start.empty() ? 2 * components[0] * components[1] : static_cast<int>(start.size());
  }
  /// Settings of one stage of the continuation.
  TdfSettings stage(size_t index) const;
};

struct Cycle {
  int max_cycles = 1;
  double tolerance = 0.01;  ///< stop when the objective changes by less between cycles [-]
};

/// One more dynamic run of the final design on a finer mesh; the limits of flowing elements
/// shrink with the elements.
struct Verify {
  std::optional<std::array<int, 2>> mesh;  ///< elements along the length at the start, and across
  int refine = 1;                          ///< or so many times those of every body
  double step = 0;                         ///< [s]

  std::string words() const;  ///< "20 x 4 elements"
};

struct Output {
  std::string directory;    ///< empty: chosen by the command line
  int design_every = 1;     ///< design iterations between VTK files, 0: none
  double motion_every = 0;  ///< time between VTK files of the motion [s], 0: none
  int sharp_every = 25;     ///< iterations between sharp evaluations, 0: the final design only
  bool vtk = true, plots = true;
};

/// A number the run must reproduce: value with a tolerance, or bounds.
struct Expectation {
  std::optional<double> value, at_least, at_most;
  double tolerance = 0;  ///< absolute, around `value`
  std::string place;     ///< file and line, for messages

  bool holds(double found) const;
};

struct Scene {
  std::string name;  ///< of the case file, without folder and ending
  std::string title;
  std::optional<Domain> domain;  ///< a static scene: nothing moves, all that follows is absent
  TimeSpan time;
  std::optional<StaticAnalysis> statics;  ///< bodies at rest under growing loads: no time
  std::optional<VectorXd> gravity;        ///< (dim) [m/s^2]
  std::vector<Drive> drives;
  std::vector<Hub> hubs;
  std::vector<RigidBody> rigid_bodies;
  std::vector<Body> bodies;
  std::vector<Joint> joints;
  std::vector<Spring> springs;
  std::optional<Trajectory> trajectory;
  std::vector<PointMass> point_masses;
  std::vector<BodyLoad> loads;
  std::vector<Observe> observed;
  std::vector<Measure> measures;
  std::optional<Esl> esl;           ///< always there when bodies that move are designed
  std::vector<BodyDesign> designs;  ///< one per designed body
  optim::Settings optimizer;
  Cycle cycle;
  std::optional<Verify> verify;
  Output output;
  std::optional<Accuracy> accuracy;           ///< for the command of that name; no run needs it
  std::map<std::string, Expectation> expect;  ///< by name of the result

  const Body& body(const std::string& name) const;  ///< name resolves: checked when read
  /// A law in time; drives that follow from a trajectory: after follow_trajectory().
  std::function<fem::Motion(double)> motion_of(const Law& law) const;
  bool follows_trajectory(const Law& law) const;
  bool is_mechanism() const { return !rigid_bodies.empty(); }
  bool in_space() const { return !bodies.empty() && bodies.front().in_space(); }  ///< all, or none
  bool has_free_lines() const;
  bool has_heat() const;
};

/// The rows of the tables a scene may name.
struct Vocabulary {
  std::vector<std::string> elements{"ancf_plate", "ale_ancf_plate", "ancf_beam"};
  std::vector<std::string> shapes{"h16", "h12"};
  std::vector<std::string> terms{"inertia", "membrane"};  ///< in the plane
  std::vector<std::string> beam_terms{"inertia", "gcm", "ecm"};
  std::vector<std::string> space_terms{"inertia", "membrane", "membrane_assumed", "bending"};
  std::vector<std::string> joints{"weld",    "sleeve",      "pin",        "clamp",
                                  "support", "symmetry",    "line_drive", "revolute",
                                  "slider",  "angle_drive", "distance",   "point_drive"};
  std::vector<std::string> optimizers = optim::optimizer_names();
};

/// Fills the drives that follow from the trajectory of a scene read as far as its joints: a job for
/// those who know mechanisms (build/trajectory.h); here it is only asked.
using Follow = std::function<void(Scene&)>;

/// Reads and checks a case: types, ranges, names, and what must fit together. Keys nobody knows
/// are errors.
/// @throws Error (input) located in the file, see io::Table.
Scene read_scene(const io::CaseFile& file, const Follow& follow, const Vocabulary& words = {});

}  // namespace flexmorph::cases
