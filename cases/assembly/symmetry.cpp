#include <algorithm>
#include <set>
#include <utility>

#include "cases/assembly/static_conditions.h"
#include "geometry/picture.h"

namespace flexmorph::cases {
namespace {

/// Round-off of places and forces [-].
constexpr double kSame = 1e-9;

/// The image of a grid in one of its middle lines.
struct GridImage {
  const Grid& grid;
  bool in_x;  // the line is vertical

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
    return (of_cells(cells) - cells).cwiseAbs().maxCoeff() <= kSame;
  }
};

/// How full the cells are of polygons.
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

/// Tells whether every load's image is one of them, or the opposite of one.
/// @param opposites  whether opposite loads are as good: weight that acts with them makes them
/// others
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
    const double small = kSame * wanted.cwiseAbs().maxCoeff();
    return std::any_of(loads.begin(), loads.end(), [&](const mmc::LoadCase& other) {
      const VectorXd found = nodal(other, false);
      return std::abs(other.weight - load.weight) <= kSame * load.weight &&
             ((found - wanted).cwiseAbs().maxCoeff() <= small ||
              (opposites && (found + wanted).cwiseAbs().maxCoeff() <= small));
    });
  });
}

}  // namespace

mmc::Symmetry symmetry_of(const Scene& scene, const BodyDesign& design,
                          std::span<const signed char> outside) {
  if (!scene.domain) return {};
  const Grid& g = design.grid;
  const StaticConditions conditions = static_conditions(scene, g, outside);
  const Vec2 weight = weight_of(scene);
  std::vector<VectorXd> areas = {covered(g, design.solid), covered(g, design.empty)};
  if (!scene.domain->shape.outer.empty())
    for (const std::vector<Vec2>& ring : rings_of(scene.domain->shape))
      areas.push_back(covered(g, {ring}));
  VectorXd whole = areas.front();  // rings of a drawing may be one another's images
  for (size_t k = 2; k < areas.size(); ++k) whole += areas[k];
  const auto symmetric = [&](bool in_x) {
    const GridImage image{g, in_x};
    if (weight[in_x ? 0 : 1] != 0) return false;
    return image.keeps(areas[0]) && image.keeps(areas[1]) && image.keeps(whole) &&
           keeps_held(image, conditions.held) &&
           keeps_loads(image, conditions.loads, weight == Vec2::Zero());
  };
  mmc::Symmetry out;
  if (symmetric(true)) out.x = g.x0 + 0.5 * g.width;
  if (symmetric(false)) out.y = g.y0 + 0.5 * g.height;
  return out;
}

}  // namespace flexmorph::cases
