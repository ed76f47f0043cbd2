#include "cases/results/part_checks.h"

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

std::string point_words(const Vec2& p) {
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

void add_solid(const mmc::BodyProblem& problem, std::vector<std::string>& out) {
  for (const Ring& ring : problem.solid) {
    const double allowed = allowed_within(problem, ring);
    const double missing = allowed > 0 ? 1 - area_within(problem, ring) / allowed : 0;
    if (missing <= kMissing) continue;
    const Box box = bounds_of(ring);
    out.push_back(io::to_text(100 * missing, 3) + " % of the solid region from " +
                  point_words(box.lower) + " to " + point_words(box.upper) + " m has no material");
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
      out.push_back("no material reaches the line from " + point_words(line.a) + " to " +
                    point_words(line.b) + " m, which is held");
}

/// Adds messages on supports and loads whose cells contain no material of the part.
void add_places(const mmc::BodyProblem& problem, std::vector<std::string>& out) {
  const VectorXd fractions = mmc::part_fractions(problem, {});
  const std::vector<HeldOrLoaded> ends =
      problem.places.empty() ? ends_of(problem.grid) : problem.places;
  for (const HeldOrLoaded& place : ends)
    if (std::none_of(place.cells.begin(), place.cells.end(),
                     [&](int cell) { return fractions[cell] > 0; }))
      out.push_back("no material is at " + place.name);
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

/// Adds messages on points that have no material in the cells around them, although material is
/// allowed there.
void add_points(const Scene& scene, const mmc::BodyProblem& problem,
                std::vector<std::string>& out) {
  const double reach = mmc::point_reach(problem);
  for (const auto& [name, at] : attached_points(scene, problem.body)) {
    const Vec2 half(reach, reach);
    const Ring square = corners_of({at - half, at + half});
    if (allowed_within(problem, square) > 0 && !(area_within(problem, square) > 0))
      out.push_back("no material is at " + name + " at " + point_words(at) + " m");
  }
}

}  // namespace

std::vector<std::string> missing_material(const Scene& scene, const mmc::BodyProblem& problem) {
  std::vector<std::string> out;
  if (!problem.part) return out;
  add_solid(problem, out);
  add_held(problem, out);
  add_places(problem, out);
  add_points(scene, problem, out);
  for (std::string& words : out) words = "body '" + problem.body + "', its part: " + words;
  return out;
}

std::vector<std::string> motion_notes(const Scene& scene) {
  if (std::none_of(scene.designs.begin(), scene.designs.end(),
                   [](const BodyDesign& d) { return d.part; }))
    return {};
  if (scene.domain) return {"a plate at rest has no motion: its numbers are static"};
  if (scene.judges_on_cells()) return {};
  const std::string instead =
      "stress and deflection are static, under the loads of the motion on the elements of the case";
  if (scene.has_heat()) return {"heat has no motion on cells: " + instead};
  if (scene.in_space()) return {"space has no motion on cells: " + instead};
  return {"the case has no motion on cells" +
          (scene.verify ? ", but one on " + scene.verify->words() : std::string()) + ": " +
          instead};
}

}  // namespace flexmorph::cases
