#include <algorithm>
#include <cmath>

#include "cases/assembly/build.h"
#include "cases/assembly/static_conditions.h"
#include "geometry/picture.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

/// Nodes at a place, each with its share of a force spread evenly over the place.
struct PlaceNodes {
  std::vector<int> nodes;
  std::vector<double> shares;  // sum 1
  std::vector<int> cells;      // that can be material and touch these nodes
};

/// Finds the nodes of places. Only nodes that touch a cell that can be material count: cells
/// outside of the domain and those of void regions cannot.
class NodeFinder {
 public:
  NodeFinder(const Scene& scene, const Grid& grid, std::span<const signed char> outside)
      : scene_(scene), grid_(grid), outside_(outside.begin(), outside.end()) {
    outside_.resize(static_cast<size_t>(grid.n_cells()), 0);
    for (const BodyDesign& design : scene.designs)
      for (const std::vector<Vec2>& ring : design.empty)
        for (const int cell : cells_within(grid, {ring, {}}))
          outside_[static_cast<size_t>(cell)] = 1;
  }

  /// @param path  of the table with the place in the case, for messages
  /// @throws Error (input) when no node is there that can be material.
  PlaceNodes at(const Place& place, const std::string& path) const {
    const double small = 1e-6 * grid_.dx();
    Box box = place.box;
    if (place.kind == Place::Kind::point) box = nearest(box.lower);
    PlaceNodes out;
    for (int i = 0; i <= grid_.nx; ++i)
      for (int j = 0; j <= grid_.ny; ++j) {
        const Vec2 p = grid_.node_position(i, j);
        if (((box.lower - p).array() > small).any() || ((p - box.upper).array() > small).any())
          continue;
        const int cells = touch(i, j, out.cells);
        if (cells == 0) continue;
        out.nodes.push_back(grid_.node(i, j));
        // Along an edge a node carries the traction of the half cells beside it.
        out.shares.push_back(place.kind == Place::Kind::edge ? cells : 1.0);
      }
    if (out.nodes.empty())
      scene_.refuse(path + "." + key_of(place.kind),
                    "no material can be there: a place has a node of the domain, outside of void "
                    "regions; the cells are " +
                        io::to_text(grid_.dx()) + " m wide");
    double sum = 0;
    for (const double s : out.shares) sum += s;
    for (double& s : out.shares) s /= sum;
    return out;
  }

 private:
  Box nearest(const Vec2& point) const {
    const auto clamp = [](double v, int n) { return std::clamp(std::lround(v), 0L, long(n)); };
    const auto i = static_cast<int>(clamp((point.x() - grid_.x0) / grid_.dx(), grid_.nx));
    const auto j = static_cast<int>(clamp((point.y() - grid_.y0) / grid_.dy(), grid_.ny));
    const Vec2 p = grid_.node_position(i, j);
    return {p, p};
  }
  static const char* key_of(Place::Kind kind) {
    switch (kind) {
      case Place::Kind::edge:
        return "edge";
      case Place::Kind::point:
        return "point";
      case Place::Kind::box:
        break;
    }
    return "box";
  }
  /// Adds the cells around a node that can be material. @return their number
  int touch(int i, int j, std::vector<int>& cells) const {
    int count = 0;
    for (int ci = std::max(0, i - 1); ci <= std::min(grid_.nx - 1, i); ++ci)
      for (int cj = std::max(0, j - 1); cj <= std::min(grid_.ny - 1, j); ++cj) {
        const int cell = grid_.cell(ci, cj);
        if (outside_[static_cast<size_t>(cell)]) continue;
        cells.push_back(cell);
        ++count;
      }
    return count;
  }

  const Scene& scene_;
  const Grid& grid_;
  std::vector<signed char> outside_;  // 1: the cell cannot be material
};

/// Sum of the area fractions of the cells around a node [cells].
double material_around(const Grid& grid, int node, const VectorXd& fractions) {
  const int i = node / (grid.ny + 1), j = node % (grid.ny + 1);
  double out = 0;
  for (int ci = std::max(0, i - 1); ci <= std::min(grid.nx - 1, i); ++ci)
    for (int cj = std::max(0, j - 1); cj <= std::min(grid.ny - 1, j); ++cj)
      out += fractions[grid.cell(ci, cj)];
  return out;
}

std::string support_path(size_t support) { return "support." + std::to_string(support); }

std::string force_path(size_t load, size_t force) {
  return "load." + std::to_string(load) + ".force." + std::to_string(force);
}

}  // namespace

Vec2 weight_of(const Scene& scene) {
  return scene.gravity ? Vec2(*scene.gravity) : Vec2(Vec2::Zero());
}

std::vector<HeldOrLoaded> static_places(const Scene& scene, const Grid& grid,
                                        std::span<const signed char> outside) {
  const NodeFinder find(scene, grid, outside);
  std::vector<HeldOrLoaded> places;
  const Domain& domain = *scene.domain;
  for (size_t s = 0; s < domain.supports.size(); ++s)
    places.push_back({"support " + std::to_string(s + 1), true,
                      find.at(domain.supports[s].place, support_path(s)).cells});
  for (size_t l = 0; l < domain.loads.size(); ++l)
    for (size_t f = 0; f < domain.loads[l].forces.size(); ++f)
      places.push_back({"load '" + domain.loads[l].name + "'", false,
                        find.at(domain.loads[l].forces[f].place, force_path(l, f)).cells});
  return places;
}

std::vector<LoadOnVoid> loads_on_void(const Scene& scene, const mmc::BodyProblem& problem,
                                      const VectorXd& fractions) {
  constexpr double kLeastMaterial = 0.5;  // cells around a node that carries a force
  const Domain& domain = *scene.domain;
  const NodeFinder find(scene, problem.grid, problem.outside);
  std::vector<LoadOnVoid> out;
  for (size_t l = 0; l < domain.loads.size(); ++l) {
    LoadOnVoid found{domain.loads[l].name, 0};
    for (size_t f = 0; f < domain.loads[l].forces.size(); ++f) {
      const PlaceNodes place = find.at(domain.loads[l].forces[f].place, force_path(l, f));
      double on_void = 0;
      for (size_t k = 0; k < place.nodes.size(); ++k)
        if (material_around(problem.grid, place.nodes[k], fractions) < kLeastMaterial)
          on_void += place.shares[k];
      found.part = std::max(found.part, on_void);
    }
    if (found.part > 0) out.push_back(found);
  }
  return out;
}

StaticConditions static_conditions(const Scene& scene, const Grid& grid,
                                   std::span<const signed char> outside) {
  const Domain& domain = *scene.domain;
  const NodeFinder find(scene, grid, outside);
  StaticConditions out;
  for (size_t s = 0; s < domain.supports.size(); ++s) {
    const PlaneSupport& support = domain.supports[s];
    for (const int node : find.at(support.place, support_path(s)).nodes) {
      if (support.x) out.held.push_back({node, 0});
      if (support.y) out.held.push_back({node, 1});
    }
  }
  for (size_t l = 0; l < domain.loads.size(); ++l) {
    mmc::LoadCase& load = out.loads.emplace_back();
    load.name = domain.loads[l].name;
    load.weight = domain.loads[l].weight;
    for (size_t f = 0; f < domain.loads[l].forces.size(); ++f) {
      const PlaneForce& force = domain.loads[l].forces[f];
      const PlaceNodes place = find.at(force.place, force_path(l, f));
      for (size_t k = 0; k < place.nodes.size(); ++k)
        load.forces.push_back({place.nodes[k], place.shares[k] * force.force});
    }
  }
  return out;
}

std::unique_ptr<mmc::ComplianceEvaluator> build_static_loads(const Scene& scene,
                                                             const mmc::BodyProblem& problem) {
  const StaticConditions conditions = static_conditions(scene, problem.grid, problem.outside);
  // Rows with a value per load solve every load as it is.
  const std::vector<const mmc::ResponseRow*> rows = mmc::rows_of(problem.goal);
  const bool compress = std::none_of(rows.begin(), rows.end(),
                                     [](const mmc::ResponseRow* row) { return row->per_load; });
  return std::make_unique<mmc::ComplianceEvaluator>(mmc::plate_of(problem), conditions.held,
                                                    conditions.loads, compress, weight_of(scene));
}

}  // namespace flexmorph::cases
