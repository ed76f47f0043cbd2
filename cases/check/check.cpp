#include "cases/check/check.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "cases/assembly/build.h"
#include "cases/check/check_cost.h"
#include "cases/check/check_modes.h"
#include "cases/check/plausibility.h"
#include "cases/check/ready.h"
#include "cases/check/static_nodes.h"
#include "cases/scene/design/goal.h"
#include "cases/scene/elements/row.h"
#include "cases/scene/heat/heat.h"
#include "cases/scene/joints/row.h"
#include "cases/scene/read.h"
#include "fem/dynamics/starts/rigid_motion.h"
#include "fem/solve/redundancy.h"
#include "geometry/text.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

std::string row(const std::string& what, const std::string& words) {
  return summary_row(what, words);
}

std::string millions(double operations) { return io::to_text(1e-6 * operations, 2); }

/// Returns the text about the quantities that the load factor multiplies; empty if it multiplies
/// the loads alone, which is the usual case.
std::string growing_text(const StaticAnalysis& analysis) {
  if (!analysis.temperatures_grow) return "";
  return analysis.loads_grow ? ", applied to loads and temperatures" : ", applied to temperatures";
}

std::string text_of(const Region& domain) {
  if (domain.outer.empty()) return "";
  const size_t n = domain.holes.size();
  return ", polygonal domain" + (n == 0   ? std::string()
                                 : n == 1 ? " with a hole"
                                          : " with " + std::to_string(n) + " holes");
}

/// Describes the time span of a motion, or the path of a static analysis.
void describe_course(const Scene& scene, std::ostringstream& out) {
  if (scene.statics) {
    const bool load = scene.statics->path == fem::StaticSettings::Path::load;
    out << row("static analysis", "nonlinear, load factor 0 to " + io::to_text(scene.statics->to) +
                                      (load ? " in " : " with arc-length steps, first step 1/") +
                                      std::to_string(scene.statics->steps) +
                                      (load ? " steps" : " of this range") +
                                      growing_text(*scene.statics));
    return;
  }
  const TimeSpan& time = scene.time;
  const std::string until = "0 to " + io::to_text(time.end) + " s, ";
  if (time.integrator == "minimal_coordinates") {
    out << row("time", until + "step " + io::to_text(time.step) +
                           " s, minimal_coordinates with shorter internal steps, tolerance " +
                           io::to_text(time.explicit_tolerance));
    return;
  }
  if (time.tolerance) {
    fem::AdaptiveStep adaptive;
    adaptive.largest = time.largest_step;
    out << row("time", until + "rho_inf " + io::to_text(time.rho_inf) +
                           ", adaptive steps, tolerance " + io::to_text(*time.tolerance) +
                           ", largest step " +
                           io::to_text(fem::StepControl(adaptive, time.end).largest()) + " s");
    return;
  }
  const std::string scheme = time.integrator == "energy_momentum"
                                 ? "energy_momentum, "
                                 : "rho_inf " + io::to_text(time.rho_inf) + ", ";
  out << row("time", until + "step " + io::to_text(time.step) + " s, " + scheme +
                         io::to_text(std::ceil(time.end / time.step - 1e-9)) + " steps");
}

std::string measure_text(const MeasureRequest& measure) {
  return joined(measure.quantities) + " of " + measure.body;
}

std::string load_text(const BodyLoad& load) {
  return std::string(load.row->words) + (load.edge.empty() ? "" : " '" + load.edge + "'") +
         (load.row->in_space ? ", follows the plate"
          : load.turns       ? ", turns with the body"
                             : "") +
         (load.law.varies() ? ", varies" : "");
}

/// Describes the material flow of a body and the mesh control that goes with it.
void describe_flow(const Body& body, double end, std::ostringstream& out) {
  const Flow& flow = *body.flow;
  const double shortest = body.shortest(end), longest = body.longest(end);
  out << row("", flow.motion
                     ? "drive '" + flow.length.drive +
                           "' moves material out of and into the hub, length " +
                           io::to_text(shortest, 6) + " to " + io::to_text(longest, 6) + " m"
                     : "material leaves the hub at " + io::to_text(flow.speed) + " m/s");
  const int n = body.elements[0], refreshed = body.elements[1] * (body.has_uniform_mesh() ? n : 1);
  const std::string mesh = body.has_uniform_mesh()
                               ? "mesh \"uniform\": " + std::to_string(n) +
                                     " elements along the body, " + io::to_text(shortest / n, 4) +
                                     " to " + io::to_text(longest / n, 4) + " m long"
                               : "mesh \"split\": lines of nodes are inserted and removed";
  out << row("", mesh + ", " + std::to_string(refreshed) + " elements updated per step");
}

void describe_body(const Body& body, double end, const Mechanism& mechanism,
                   std::ostringstream& out) {
  const fem::Body& built = mechanism.model.body(body.name);
  const int n = built.n_dofs();
  const std::string mesh = body.row->across
                               ? " " + body.shape + ", " + std::to_string(body.elements[0]) +
                                     " x " + std::to_string(body.elements[1])
                               : ", " + std::to_string(body.elements[0]);
  const ElementOperations each = body.row->operations(body, *built.element);
  out << row("body " + body.name,
             body.row->name + mesh + " elements, " + std::to_string(n) + " unknowns, about " +
                 millions(built.element->n_elements() * (each.force + each.tangent)) +
                 " Mflop per evaluation of force and tangent");
  out << row("", "terms: " + joined(body.terms));
  if (body.arc != 0)
    out << row("", "the undeformed shape is an arc of " + io::to_text(body.arc, 4) + " rad");
  if (body.heat) {
    out << row("heat of " + body.name, temperature_text(*body.heat) + ", expansion " +
                                           io::to_text(body.heat->expansion, 6) +
                                           " 1/K, thermal volume " +
                                           volume_name(body.heat->volume));
    out << row("", body.heat->force ? "thermal force Q_tk" : "no thermal force");
  }
  if (body.in_space())
    out << row("", "out-of-plane motion: positions have three components; bending at Gauss points");
  for (const BodyLine& line : body.lines)
    if (line.free)
      out << row("", "free material line " + std::to_string(line.index) +
                         ": its material coordinate is an unknown; elements are evaluated one by "
                         "one");
  if (body.flow) describe_flow(body, end, out);
}

std::string optimizer_text(const Scene& scene) {
  return scene.optimizer.name + ", at most " + std::to_string(scene.optimizer.max_iterations) +
         " iterations";
}

std::string thickness_text(const BodyDesign& d) {
  std::string out = "half-thickness of components at least " + io::to_text(d.min_thickness) + " m";
  if (d.widths.solid > 0)
    out += ", smallest feature of their union at least " + io::to_text(d.widths.solid) + " m";
  if (d.widths.gap > 0) out += ", smallest gap at least " + io::to_text(d.widths.gap) + " m";
  return out;
}

/// Returns the first discontinuities of a drive as text: ", discontinuities at 0.2, 0.5 s".
std::string discontinuities_of(const Drive& drive) {
  constexpr size_t kMaxListed = 5;
  std::string out;
  for (size_t i = 0; i < std::min(kMaxListed, drive.discontinuities.size()); ++i)
    out += (i == 0 ? ", discontinuities at " : ", ") + io::to_text(drive.discontinuities[i], 6);
  if (drive.discontinuities.size() > kMaxListed) out += ", ...";
  return out.empty() ? out : out + " s";
}

/// Returns the number of entries of each kind, in the order of the case: "4 revolute, 4 weld".
template <class T, class Kind>
std::string kinds_of(const std::vector<T>& list, const Kind& kind) {
  std::vector<std::pair<std::string, int>> counts;
  for (const T& each : list) {
    const std::string name = kind(each);
    const auto found = std::find_if(counts.begin(), counts.end(),
                                    [&](const auto& count) { return count.first == name; });
    if (found == counts.end())
      counts.emplace_back(name, 1);
    else
      ++found->second;
  }
  std::string out;
  for (const auto& [name, n] : counts)
    out += (out.empty() ? "" : ", ") + std::to_string(n) + " " + name;
  return out;
}

std::string law_text(const Law& law) {
  return law.drive.empty() ? io::to_text(law.value, 6) : "'" + law.drive + "'";
}

void describe_mechanism(const Scene& scene, const fem::RigidKinematics& rigid,
                        std::ostringstream& out) {
  std::string names;
  double mass = 0;
  for (const RigidBody& body : scene.rigid_bodies) {
    names += (names.empty() ? "" : ", ") + body.name;
    mass += body.mass;
    for (const RigidBody::AddedMass& added : body.masses) mass += added.mass;
  }
  if (!scene.rigid_bodies.empty())
    out << row("rigid bodies", std::to_string(scene.rigid_bodies.size()) + " (" + names + "), " +
                                   std::to_string(4 * scene.rigid_bodies.size()) + " unknowns, " +
                                   io::to_text(mass, 6) + " kg");
  const fem::RigidMotion motion(rigid);
  const int before = fem::undriven_degrees_of_freedom(rigid), after = motion.degrees_of_freedom();
  out << row("degrees of freedom", "rigid mechanism: " + std::to_string(before) +
                                       " without the drives of joints and flows, " +
                                       std::to_string(after) + " with these drives");
  if (const std::vector<std::string> joints = fem::redundant_joints(motion.kinematics().model());
      !joints.empty())
    out << row("redundant joints", joined(joints) + "; their forces are not unique");
  if (!scene.trajectory) return;
  const TargetTrajectory& path = *scene.trajectory;
  std::string drives;
  for (const Drive& drive : scene.drives)
    if (drive.from_trajectory) drives += (drives.empty() ? "" : ", ") + drive.name;
  out << row("trajectory", "of " + path.body + ": x " + law_text(path.x) + ", y " +
                               law_text(path.y) + ", angle " + law_text(path.angle) +
                               "; drives computed from it: " + (drives.empty() ? "none" : drives));
}

std::string components_text(const BodyDesign& d) {
  const int components = d.n_components();
  return std::to_string(components) + " components, " +
         std::to_string(components * Component::kParameters) + " variables" +
         (d.starts > 1 ? ", best of " + std::to_string(d.starts) + " starts" : "");
}

/// Returns the line of a summary about the symmetry of a design; empty if it is not symmetric.
std::string symmetry_row(const mmc::Design& design) {
  const mmc::Symmetry& s = design.symmetry();
  if (!s.any()) return "";
  std::string lines;
  if (s.x) lines = "x = " + io::to_text(*s.x) + " m";
  if (s.y) lines += (s.x ? " and y = " : "y = ") + io::to_text(*s.y) + " m";
  return row("symmetry", "designs are symmetric about " + lines);
}

void describe_design(const Scene& scene, const mmc::BodyProblem& problem, const BodyDesign& d,
                     std::ostringstream& out) {
  const Grid& g = d.grid;
  const int n = 2 * g.nx * (g.ny + 1), loads = scene.esl->count(scene.time.end);
  // Nodes are in natural order from the free end, so that the bandwidth is ny + 2 nodes.
  const double factor = static_cast<double>(n) * (2 * g.ny + 5);
  out << row("design of " + d.body, components_text(d) + ", " + std::to_string(g.nx) + " x " +
                                        std::to_string(g.ny) + " cells, " + std::to_string(n) +
                                        " static unknowns");
  out << row("", std::to_string(loads) + " loads, " + limit_text(d.goal) +
                     (d.shares_mass ? " on average (the bodies share mass), " : ", ") +
                     thickness_text(d));
  out << symmetry_row(problem.design);
  out << row("", "matrix factor about " + io::to_text(8e-6 * factor, 3) +
                     " MB, loads and displacements " + io::to_text(8e-6 * 3.0 * n * loads, 3) +
                     " MB; about " + io::to_text(1e-9 * factor * (2 * g.ny + 5 + 3.0 * loads), 2) +
                     " Gflop per iteration");
}

void describe_static(const PreparedCase& prepared, std::ostringstream& out,
                     const Machine& machine) {
  const Scene& scene = prepared.scene();
  const Domain& domain = *scene.domain;
  const mmc::BodyProblem& problem = prepared.design_problems().front();
  std::unique_ptr<mmc::ComplianceEvaluator> loads;
  if (problem.grid.n_cells() <= kMaxBuiltCells) loads = build_static_loads(scene, problem);
  const BodyDesign& d = scene.designs.front();
  const Grid& g = d.grid;
  out << row("plate " + domain.name, "static, " + std::to_string(g.nx) + " x " +
                                         std::to_string(g.ny) + " cells" + text_of(domain.shape));
  out << drawing_text(domain);
  out << row("supports", std::to_string(domain.supports.size()));
  out << row("loads", std::to_string(domain.loads.size()) +
                          (loads ? ", solved with " + std::to_string(loads->n_right_hand_sides()) +
                                       " right-hand sides"
                                 : ""));
  out << static_nodes_text(scene, problem);
  out << row("design", components_text(d) + "; " + goal_text(d.goal));
  out << row("", thickness_text(d));
  out << symmetry_row(problem.design);
  out << row("optimizer", optimizer_text(scene));
  out << numbers_text(scene, nullptr, machine);
  out << "\nabsent (not built, no cost)\n";
  out << row("motion", "no bodies, no joints, no time, no equivalent static loads");
  if (domain.loads.size() == 1) out << row("load compression", "there is one load");
  if (!scene.output.vtk) out << row("VTK files", "none");
}

void describe_operations(const Scene& scene, const Mechanism& mechanism, std::ostringstream& out) {
  if (scene.time.integrator == "minimal_coordinates") return;
  const StepOperations each = step_operations(scene, mechanism);
  std::string parts = "forces " + millions(each.forces);
  if (each.tangents > 0) parts += ", tangents " + millions(each.tangents);
  parts += ", sparse solver " + millions(each.solver);
  if (each.flow > 0) parts += ", flow of material " + millions(each.flow);
  out << row("operations", "about " + millions(each.total()) + " million per step: " + parts);
}

void describe_absent(const Scene& scene, std::ostringstream& out) {
  if (!scene.in_space())
    out << row("out-of-plane", "positions have two components; no bending term");
  if (!scene.has_heat()) out << row("heat", "no thermal term");
  if (!scene.has_eulerian_lines())
    out << row("free material lines", "no material coordinate is an unknown");
  if (scene.statics)
    out << row("motion", "no time, no inertia, no integrator");
  else
    out << row("static analysis", "no path of equilibria");
  if (!scene.statics && !scene.time.tolerance)
    out << row("adaptive steps", "no error estimate, no dense output");
  if (scene.loads.empty()) out << row("loads", "none");
  if (std::none_of(scene.bodies.begin(), scene.bodies.end(),
                   [](const Body& b) { return b.flow.has_value(); }))
    out << row("material flow", "no shape function changes with time");
  if (scene.rigid_bodies.empty()) out << row("rigid bodies", "none");
  if (scene.is_mechanism() && scene.springs.empty()) out << row("springs", "none");
  if (!scene.gravity) out << row("gravity", "none");
  if (scene.designs.empty())
    out << row("design", "full material; no equivalent static loads, no optimizer");
  if (!scene.verify) out << row("verification", "no motion on a finer mesh");
  if (scene.observed.empty()) out << row("observed points", "none");
  if (scene.measures.empty()) out << row("measured", "no quantities of bodies");
  if (!scene.output.vtk) out << row("VTK files", "none");
  if (scene.output.vtk && scene.output.motion_every == 0)
    out << row("VTK files", "none of the motion");
  if (!scene.output.plots) out << row("plots", "none");
}

}  // namespace

std::string check_case(const std::string& name, std::span<const std::string> overrides,
                       bool explain) {
  const ReadyCase ready = ready_case(name, overrides);
  return explain ? ready.file.explained() : check_text(ready.prepared);
}

std::string check_text(const PreparedCase& prepared) {
  const Scene& scene = prepared.scene();
  const Machine machine = this_machine(scene.output.directory);
  std::ostringstream out;
  out << scene.name << ": " << scene.title << "\n\nactive\n";
  if (scene.domain) {
    describe_static(prepared, out, machine);
    return out.str();
  }
  const fem::RigidKinematics* rigid = prepared.rigid();
  const Mechanism& mechanism = prepared.mechanism();
  describe_course(scene, out);
  if (!mechanism.start_text.empty()) out << row("start", mechanism.start_text);
  if (!mechanism.assembly_text.empty()) out << row("positions", mechanism.assembly_text);
  for (const Drive& drive : scene.drives) {
    const std::array<double, 2> range = range_of(drive.motion, scene.time.end);
    out << row("drive " + drive.name, drive.words + ", from " + io::to_text(range[0], 6) + " to " +
                                          io::to_text(range[1], 6) + discontinuities_of(drive));
  }
  for (const Body& body : scene.bodies) describe_body(body, scene.time.end, mechanism, out);
  if (rigid) describe_mechanism(scene, *rigid, out);
  out << row("joints", std::to_string(scene.joints.size()) + ", " +
                           std::to_string(mechanism.model.n_constraints()) + " constraint rows" +
                           (scene.joints.empty() ? "" : ": ") +
                           kinds_of(scene.joints, [](const Joint& j) { return j.row->name; }));
  if (!scene.springs.empty())
    out << row("springs", std::to_string(scene.springs.size()) + ": " +
                              kinds_of(scene.springs, [](const Spring& s) { return s.row->name; }));
  if (!scene.point_masses.empty())
    out << row("point masses", std::to_string(scene.point_masses.size()));
  for (const BodyLoad& load : scene.loads) out << row("load on " + load.body, load_text(load));
  if (scene.gravity) out << row("gravity", scene.gravity_law().varies() ? "varies" : "constant");
  if (!scene.observed.empty()) out << row("observed points", std::to_string(scene.observed.size()));
  for (const MeasureRequest& measure : scene.measures)
    out << row("measured", measure_text(measure));
  for (size_t k = 0; k < scene.designs.size(); ++k)
    describe_design(scene, prepared.design_problems()[k], scene.designs[k], out);
  if (!scene.designs.empty())
    out << row("optimizer", optimizer_text(scene) + ", at most " +
                                std::to_string(scene.cycle.max_cycles) +
                                (scene.cycle.max_cycles == 1 ? " cycle" : " cycles"));
  if (scene.verify)
    out << row("verification",
               (scene.verifies_on_cells() && scene.cycle.max_cycles > 1
                    ? "motions with the designs of all cycles and uniform material, "
                    : "motions with the design and uniform material, ") +
                   scene.verify->words() +
                   (scene.time.tolerance && scene.verify->step == scene.time.step
                        ? ", adaptive steps"
                        : ", step " + io::to_text(scene.verify->step) + " s"));
  describe_operations(scene, mechanism, out);
  out << natural_frequencies_text(prepared);
  out << numbers_text(scene, &mechanism, machine);
  out << "\nabsent (not built, no cost)\n";
  describe_absent(scene, out);
  return out.str();
}

}  // namespace flexmorph::cases
