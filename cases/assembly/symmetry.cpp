#include <algorithm>
#include <set>
#include <utility>

#include "cases/assembly/static_conditions.h"
#include "fem/dynamics/esl.h"
#include "geometry/parts/picture.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

/// Relative tolerance for round-off of positions and forces [-].
constexpr double kLengthTolerance = 1e-9;

/// The reflection of a grid in one of its middle lines.
struct GridImage {
  const Grid& grid;
  bool in_x;  // true if the line is vertical

  int node(int k) const {
    const int i = k / (grid.ny + 1), j = k % (grid.ny + 1);
    return in_x ? grid.node(grid.nx - i, j) : grid.node(i, grid.ny - j);
  }
  VectorXd of_cells(const VectorXd& v) const {
    VectorXd out(v.size());
    for (int i = 0; i < grid.nx; ++i)
      for (int j = 0; j < grid.ny; ++j)
        out[in_x ? grid.cell(grid.nx - 1 - i, j) : grid.cell(i, grid.ny - 1 - j)] =
            v[grid.cell(i, j)];
    return out;
  }
  bool keeps(const VectorXd& cells) const {
    return (of_cells(cells) - cells).cwiseAbs().maxCoeff() <= kLengthTolerance;
  }
};

/// Returns the area fractions of polygons in the cells (n_cells).
VectorXd covered(const Grid& grid, const std::vector<std::vector<Vec2>>& polygons) {
  return area_fractions(grid, {}, grid.dx(), polygons, {});
}

bool keeps_held(const GridImage& image, const std::vector<fem::HeldUnknown>& held) {
  std::set<std::pair<int, int>> all, images;
  for (const fem::HeldUnknown& h : held) {
    all.emplace(h.node, h.component);
    images.emplace(image.node(h.node), h.component);
  }
  return all == images;
}

/// Returns true if the mirror image of every load is one of the loads, or the opposite of one.
/// @param opposites  true if opposite loads are permitted. They are equivalent only without weight,
///                   because weight acts together with the loads
bool keeps_loads(const GridImage& image, const std::vector<mmc::LoadCase>& loads, bool opposites) {
  const auto nodal = [&](const mmc::LoadCase& load, bool mirrored) {
    VectorXd out = VectorXd::Zero(2 * image.grid.n_nodes());
    for (const fem::NodalForce& f : load.forces) {
      const int node = mirrored ? image.node(f.node) : f.node;
      Vec2 force = f.force;
      if (mirrored) force[image.in_x ? 0 : 1] *= -1;
      out.segment<2>(2 * node) += force;
    }
    return out;
  };
  return std::all_of(loads.begin(), loads.end(), [&](const mmc::LoadCase& load) {
    const VectorXd wanted = nodal(load, true);
    const double small = kLengthTolerance * wanted.cwiseAbs().maxCoeff();
    return std::any_of(loads.begin(), loads.end(), [&](const mmc::LoadCase& other) {
      const VectorXd found = nodal(other, false);
      return std::abs(other.weight - load.weight) <= kLengthTolerance * load.weight &&
             ((found - wanted).cwiseAbs().maxCoeff() <= small ||
              (opposites && (found + wanted).cwiseAbs().maxCoeff() <= small));
    });
  });
}

constexpr const char* kDespiteLoads = "; symmetry_despite_loads = true enforces the symmetry";

/// Tests for the symmetry of a design problem to the middle lines of its grid, before optimization.
class Symmetries {
 public:
  Symmetries(const Scene& scene, const BodyDesign& design, std::span<const signed char> outside,
             const std::vector<Component>& start)
      : scene_(scene), design_(design), start_(start) {
    if (scene.domain) conditions_ = static_conditions(scene, design.grid, outside);
  }

  mmc::Symmetry line(bool in_x) const {
    const Grid& g = design_.grid;
    mmc::Symmetry out;
    if (in_x)
      out.x = g.x0 + 0.5 * g.width;
    else
      out.y = g.y0 + 0.5 * g.height;
    return out;
  }
  /// Returns a text that names the first input that is not symmetric; empty if all are symmetric.
  std::string obstacle(bool in_x, bool despite_loads) const {
    const GridImage image{design_.grid, in_x};
    if (!keeps_domain(image)) return "the domain is not symmetric " + about(in_x);
    for (const auto* polygons : {&design_.solid, &design_.empty})
      if (!image.keeps(covered(design_.grid, *polygons)))
        return std::string(polygons == &design_.solid ? "the solid" : "the void") +
               " regions are not symmetric " + about(in_x);
    if (!keeps_supports(image)) return "the supports are not symmetric " + about(in_x);
    if (!despite_loads && !scene_.domain)
      return "the loads of a motion are not known before the motion, so that their symmetry " +
             about(in_x) + " cannot be tested" + kDespiteLoads;
    if (!despite_loads && !keeps_static_loads(image))
      return "the loads are not symmetric " + about(in_x) +
             ": the mirror image of every load case must be a load case with an equal weight "
             "factor, and gravity must act along the line" +
             kDespiteLoads;
    if (!mmc::is_symmetric(start_, line(in_x)))
      return "the components of the initial design are not symmetric " + about(in_x);
    return "";
  }

 private:
  /// Returns the line of symmetry as text: "about the line x = 1 m".
  std::string about(bool in_x) const {
    const mmc::Symmetry at = line(in_x);
    return "about the line " + (in_x ? "x = " + io::to_text(*at.x) : "y = " + io::to_text(*at.y)) +
           " m";
  }
  bool keeps_domain(const GridImage& image) const {
    if (!scene_.domain || scene_.domain->shape.outer.empty()) return true;
    // The sum over all rings is compared, because rings may be mirror images of each other.
    VectorXd sum = VectorXd::Zero(image.grid.n_cells());
    for (const std::vector<Vec2>& ring : rings_of(scene_.domain->shape))
      sum += covered(image.grid, {ring});
    return image.keeps(sum);
  }
  /// Returns true if the supports are symmetric. A moving plate is clamped at its root on the left;
  /// a link is held by its two pins.
  bool keeps_supports(const GridImage& image) const {
    if (scene_.domain) return keeps_held(image, conditions_.held);
    if (!design_.link) return !image.in_x;
    const auto [a, b] = design_.link->pins;
    const int first = fem::node_at(image.grid, a), second = fem::node_at(image.grid, b);
    return image.node(first) == second ||
           (image.node(first) == first && image.node(second) == second);
  }
  bool keeps_static_loads(const GridImage& image) const {
    const Vec2 weight = weight_of(scene_);
    return weight[image.in_x ? 0 : 1] == 0 &&
           keeps_loads(image, conditions_.loads, weight == Vec2::Zero());
  }

  const Scene& scene_;
  const BodyDesign& design_;
  const std::vector<Component>& start_;
  StaticConditions conditions_;
};

}  // namespace

mmc::Symmetry symmetry_of(const Scene& scene, const BodyDesign& design,
                          std::span<const signed char> outside,
                          const std::vector<Component>& start) {
  const WantedSymmetry& wanted = design.symmetry;
  mmc::Symmetry out;
  if (wanted.automatic ? !scene.domain : !wanted.x && !wanted.y) return out;
  const Symmetries symmetries(scene, design, outside, start);
  for (const bool in_x : {true, false}) {
    if (!wanted.automatic && !(in_x ? wanted.x : wanted.y)) continue;
    const std::string obstacle = symmetries.obstacle(in_x, wanted.despite_loads);
    const mmc::Symmetry line = symmetries.line(in_x);
    if (!obstacle.empty() && !wanted.automatic)
      scene.refuse("design." + std::to_string(&design - scene.designs.data()) + ".symmetry",
                   obstacle);
    if (obstacle.empty()) (in_x ? out.x : out.y) = in_x ? line.x : line.y;
  }
  return out;
}

}  // namespace flexmorph::cases
