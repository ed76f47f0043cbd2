#include "cases/results/parts/part_checks.h"

#include <algorithm>
#include <cmath>

#include "cases/assembly/build.h"
#include "geometry/parts/part_mesh.h"
#include "io/files.h"
#include "optim/mmc/cycles/design_verification.h"
#include "optim/mmc/problem/finished_part.h"

namespace flexmorph::cases {
namespace {

using Ring = std::vector<Vec2>;

constexpr double kMissing = 0.01;  ///< Fraction of a solid region that may be missing [-].

std::string point_text(const Vec2& p) {
  return "(" + io::to_text(p.x(), 4) + ", " + io::to_text(p.y(), 4) + ")";
}

/// Returns the area of the part within a ring [m²].
double area_within(const mmc::BodyProblem& problem, const Ring& ring) {
  double out = 0;
  for (const Region& piece : *problem.part) out += area(unite({&ring, 1}, piece, {}));
  return out;
}

/// Returns the area within a ring where material is allowed [m²].
double allowed_within(const mmc::BodyProblem& problem, const Ring& ring) {
  return area(unite({&ring, 1}, mmc::domain_of(problem), problem.empty));
}

/// Adds the solid regions that lack material. All add_...() functions add the location only; the
/// caller completes the sentence.
void add_solid(const mmc::BodyProblem& problem, std::vector<std::string>& out) {
  for (const Ring& ring : problem.solid) {
    const double allowed = allowed_within(problem, ring);
    const double missing = allowed > 0 ? 1 - area_within(problem, ring) / allowed : 0;
    if (missing <= kMissing) continue;
    const Box box = bounds_of(ring);
    out.push_back("in " + io::to_text(100 * missing, 3) + " % of the solid region from " +
                  point_text(box.lower) + " to " + point_text(box.upper) + " m");
  }
}

/// Returns the length of the boundary of the part that lies on a line [m].
double length_on(const mmc::BodyProblem& problem, const Segment& line) {
  const double small = 1e-6 * problem.grid.dx();
  double out = 0;
  for (const Region& piece : *problem.part)
    for (const Ring& ring : rings_of(piece))
      for (size_t k = 0; k < ring.size(); ++k) {
        const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
        if (distance(line, a) < small && distance(line, b) < small) out += (b - a).norm();
      }
  return out;
}

void add_held(const mmc::BodyProblem& problem, std::vector<std::string>& out) {
  for (const Segment& line : problem.held)
    if (length_on(problem, line) <= 1e-6 * (line.b - line.a).norm())
      out.push_back("on the supported line from " + point_text(line.a) + " to " +
                    point_text(line.b) + " m");
}

/// Adds the supports and loads whose cells contain no material of the part.
void add_locations(const mmc::BodyProblem& problem, std::vector<std::string>& out) {
  const VectorXd fractions = mmc::part_fractions(problem, {});
  const std::vector<HeldOrLoaded> ends =
      problem.locations.empty() ? ends_of(problem.grid) : problem.locations;
  for (const HeldOrLoaded& location : ends)
    if (std::none_of(location.cells.begin(), location.cells.end(),
                     [&](int cell) { return fractions[cell] > 0; }))
      out.push_back("at " + location.name);
}

/// Returns the points of a moving body at which joints, masses or loads act, with their names.
std::vector<std::pair<std::string, Vec2>> attached_points(const Scene& scene,
                                                          const std::string& body) {
  std::vector<std::pair<std::string, Vec2>> out;
  if (scene.domain) return out;
  for (const fem::AttachedJoint& joint : attached_joints(scene, body))
    out.emplace_back("joint '" + joint.name + "'", joint.material);
  for (const fem::AttachedMass& mass : attached_masses(scene, body))
    out.emplace_back("a point mass", mass.material);
  for (const BodyLoad& load : scene.loads)
    if (load.body == body && load.row->at_point) out.emplace_back("a load", load.point);
  return out;
}

/// Adds the points that have no material in the cells around them, although material is
/// allowed there.
void add_points(const Scene& scene, const mmc::BodyProblem& problem,
                std::vector<std::string>& out) {
  const double reach = mmc::point_reach(problem);
  for (const auto& [name, at] : attached_points(scene, problem.body)) {
    const Vec2 half(reach, reach);
    const Ring square = corners_of({at - half, at + half});
    if (allowed_within(problem, square) > 0 && !(area_within(problem, square) > 0))
      out.push_back("at " + name + " at " + point_text(at) + " m");
  }
}

}  // namespace

std::vector<std::string> missing_material(const Scene& scene, const mmc::BodyProblem& problem) {
  std::vector<std::string> out;
  if (!problem.part) return out;
  add_solid(problem, out);
  add_held(problem, out);
  add_locations(problem, out);
  add_points(scene, problem, out);
  for (std::string& words : out)
    words = "The part of body '" + problem.body + "' has no material " + words + ".";
  return out;
}

std::vector<std::string> motion_notes(const Scene& scene) {
  if (std::none_of(scene.designs.begin(), scene.designs.end(),
                   [](const BodyDesign& d) { return d.part; }))
    return {};
  if (scene.domain) return {"A static plate has no motion. All its results are static"};
  if (scene.verifies_on_cells()) return {};
  const std::string instead =
      ". Stress and deflection are static results under the loads of the motion on the mesh of the "
      "case";
  if (scene.has_heat()) return {"A case with heat has no motion on the design mesh" + instead};
  if (scene.in_space()) return {"A case in space has no motion on the design mesh" + instead};
  return {"The case has no motion on the design mesh" +
          (scene.verify ? ", because [verify] uses " + scene.verify->words() : std::string()) +
          instead};
}

}  // namespace flexmorph::cases
