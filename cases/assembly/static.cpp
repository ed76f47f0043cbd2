#include <algorithm>
#include <cmath>
#include <numbers>

#include "cases/assembly/build.h"
#include "cases/assembly/static_conditions.h"
#include "geometry/parts/picture.h"
#include "io/files.h"
#include "optim/verification/force_spread.h"

namespace flexmorph::cases {
namespace {

/// Nodes at a location, each with its fraction of a force that is uniformly distributed over the
/// location.
struct RegionNodes {
  std::vector<int> nodes;
  std::vector<double> shares;  // fractions with the sum 1
  std::vector<int> cells;      // cells that can be material and touch these nodes
};

/// Returns the angle of the rim that belongs to each point: half of the angles to both neighbours,
/// of which none counts more than `widest` [rad].
std::vector<double> sectors(const std::vector<Vec2>& rim, const Vec2& center, double widest) {
  std::vector<std::pair<double, size_t>> angles;
  for (size_t k = 0; k < rim.size(); ++k)
    angles.emplace_back(std::atan2(rim[k].y() - center.y(), rim[k].x() - center.x()), k);
  std::sort(angles.begin(), angles.end());
  std::vector<double> out(rim.size(), 0);
  for (size_t k = 0; k < angles.size(); ++k) {
    const auto& [angle, index] = angles[k];
    const auto& [next, next_index] = angles[(k + 1) % angles.size()];
    const double turn = k + 1 < angles.size() ? 0 : 2 * std::numbers::pi;
    const double half = 0.5 * std::min(widest, next + turn - angle);
    out[index] += half;
    out[next_index] += half;
  }
  return out;
}

/// Finds the nodes of supported and loaded locations. A node counts only if it touches a cell that
/// can be material; cells outside of the domain and cells of void regions cannot.
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

  /// Returns the nodes of a location.
  /// @param path  path of the table with the location in the case, for messages
  /// @throws Error (input) when no node of the location can be material.
  RegionNodes at(const NodeRegion& location, const std::string& path) const {
    const double small = 1e-6 * grid_.dx();
    Box box = location.box;
    if (location.kind == NodeRegion::Kind::point) box = nearest(box.lower);
    const bool is_disc = location.kind == NodeRegion::Kind::disc;
    if (const std::vector<Vec2>* bore = is_disc ? bore_of(scene_, location.disc, grid_) : nullptr)
      return at_rim(*bore, path);
    RegionNodes out;
    for (int i = 0; i <= grid_.nx; ++i)
      for (int j = 0; j <= grid_.ny; ++j) {
        const Vec2 p = grid_.node_position(i, j);
        if (((box.lower - p).array() > small).any() || ((p - box.upper).array() > small).any())
          continue;
        if (is_disc && (p - location.disc.center).norm() > location.disc.radius + small) continue;
        const int cells = touch(i, j, out.cells);
        if (cells == 0) continue;
        out.nodes.push_back(grid_.node(i, j));
        // On an edge a node carries the traction of half of each adjacent cell.
        out.shares.push_back(location.kind == NodeRegion::Kind::edge ? cells : 1.0);
      }
    return whole(std::move(out), path + "." + key_of(location.kind));
  }

 private:
  /// Returns the nodes between cells in the bore and cells that can be material, each with its
  /// fraction of the rim.
  RegionNodes at_rim(const std::vector<Vec2>& bore, const std::string& path) const {
    std::vector<signed char> in_bore(static_cast<size_t>(grid_.n_cells()), 0);
    for (const int cell : cells_within(grid_, {bore, {}})) in_bore[static_cast<size_t>(cell)] = 1;
    RegionNodes out;
    std::vector<Vec2> rim;
    const Disc disc = disc_like(bore);
    const double reach = disc.radius + 2 * grid_.dx();
    for (int i = 0; i <= grid_.nx; ++i)
      for (int j = 0; j <= grid_.ny; ++j) {
        const Vec2 p = grid_.node_position(i, j);
        if ((p - disc.center).norm() > reach || !touches(i, j, in_bore)) continue;
        if (touch(i, j, out.cells) == 0) continue;
        out.nodes.push_back(grid_.node(i, j));
        rim.push_back(p);
      }
    out.shares = sectors(rim, disc.center, 4 * grid_.dx() / disc.radius);
    return whole(std::move(out), path + ".disc");
  }
  /// Scales the fractions of the nodes to the sum 1.
  /// @throws Error (input) if there is no node
  RegionNodes whole(RegionNodes out, const std::string& key) const {
    if (out.nodes.empty())
      scene_.refuse(key,
                    "no material can be there: a location contains a node of the domain outside of "
                    "void regions; the cells are " +
                        io::to_text(grid_.dx()) + " m wide");
    double sum = 0;
    for (const double s : out.shares) sum += s;
    for (double& s : out.shares) s /= sum;
    return out;
  }
  bool touches(int i, int j, const std::vector<signed char>& cells) const {
    for (int ci = std::max(0, i - 1); ci <= std::min(grid_.nx - 1, i); ++ci)
      for (int cj = std::max(0, j - 1); cj <= std::min(grid_.ny - 1, j); ++cj)
        if (cells[static_cast<size_t>(grid_.cell(ci, cj))]) return true;
    return false;
  }
  Box nearest(const Vec2& point) const {
    const auto clamp = [](double v, int n) { return std::clamp(std::lround(v), 0L, long(n)); };
    const auto i = static_cast<int>(clamp((point.x() - grid_.x0) / grid_.dx(), grid_.nx));
    const auto j = static_cast<int>(clamp((point.y() - grid_.y0) / grid_.dy(), grid_.ny));
    const Vec2 p = grid_.node_position(i, j);
    return {p, p};
  }
  static const char* key_of(NodeRegion::Kind kind) {
    switch (kind) {
      case NodeRegion::Kind::edge:
        return "edge";
      case NodeRegion::Kind::point:
        return "point";
      case NodeRegion::Kind::disc:
        return "disc";
      case NodeRegion::Kind::box:
        break;
    }
    return "box";
  }
  /// Adds the cells around a node that can be material.
  /// @returns the number of these cells
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

/// Returns the sum of the area fractions of the cells around a node [cells].
double material_around(const Grid& grid, int node, const VectorXd& fractions) {
  const int i = node / (grid.ny + 1), j = node % (grid.ny + 1);
  double out = 0;
  for (int ci = std::max(0, i - 1); ci <= std::min(grid.nx - 1, i); ++ci)
    for (int cj = std::max(0, j - 1); cj <= std::min(grid.ny - 1, j); ++cj)
      out += fractions[grid.cell(ci, cj)];
  return out;
}

/// Returns the forces at the nodes of a location [N].
/// @param path  path of the table of the force in the case, for messages
/// @throws Error (input) where the nodes cannot carry the force
std::vector<Vec2> forces_at(const Scene& scene, const Grid& grid, const PlaneForce& force,
                            const RegionNodes& location, const std::string& path) {
  if (force.bearing && bore_of(scene, force.location.disc, grid) == nullptr)
    scene.refuse(
        path + ".bearing",
        "a pin needs a bore, but no hole and no void region has this centre and this radius "
        "within half a cell, " +
            io::to_text(0.5 * grid.dx()) + " m");
  std::vector<Vec2> points;
  for (const int node : location.nodes)
    points.push_back(grid.node_position(node / (grid.ny + 1), node % (grid.ny + 1)));
  std::vector<Vec2> out =
      verification::spread({force.force, force.moment, force.bearing, force.location.disc.center},
                           points, location.shares);
  if (out.empty())
    scene.refuse(
        path + (force.moment != 0 ? ".moment" : ".bearing"),
        "the nodes at this location cannot carry it: a moment needs two nodes, and a pin needs "
        "nodes on the half of the rim to which its force points; the cells are " +
            io::to_text(grid.dx()) + " m wide");
  return out;
}

std::string support_path(size_t support) { return "support." + std::to_string(support); }

std::string force_path(size_t load, size_t force) {
  return "load." + std::to_string(load) + ".force." + std::to_string(force);
}

}  // namespace

const std::vector<Vec2>* bore_of(const Scene& scene, const Disc& disc, const Grid& grid) {
  const double half_cell = 0.5 * grid.dx();
  for (const std::vector<Vec2>& hole : scene.domain->shape.holes)
    if (matches(hole, disc, half_cell)) return &hole;
  for (const BodyDesign& design : scene.designs)
    for (const std::vector<Vec2>& region : design.empty)
      if (matches(region, disc, half_cell)) return &region;
  return nullptr;
}

Vec2 weight_of(const Scene& scene) {
  return scene.gravity ? Vec2(*scene.gravity) : Vec2(Vec2::Zero());
}

std::vector<HeldOrLoaded> static_locations(const Scene& scene, const Grid& grid,
                                           std::span<const signed char> outside) {
  const NodeFinder find(scene, grid, outside);
  std::vector<HeldOrLoaded> locations;
  const Domain& domain = *scene.domain;
  for (size_t s = 0; s < domain.supports.size(); ++s)
    locations.push_back({"support " + std::to_string(s + 1), true,
                         find.at(domain.supports[s].location, support_path(s)).cells});
  for (size_t l = 0; l < domain.loads.size(); ++l)
    for (size_t f = 0; f < domain.loads[l].forces.size(); ++f)
      locations.push_back({"load '" + domain.loads[l].name + "'", false,
                           find.at(domain.loads[l].forces[f].location, force_path(l, f)).cells});
  return locations;
}

std::vector<LocatedNodes> located_nodes(const Scene& scene, const Grid& grid,
                                        std::span<const signed char> outside) {
  const NodeFinder find(scene, grid, outside);
  std::vector<LocatedNodes> out;
  const auto add = [&](const std::string& what, const NodeRegion& region, const std::string& path) {
    std::vector<Vec2> points;
    for (const int node : find.at(region, path).nodes)
      points.push_back(grid.node_position(node / (grid.ny + 1), node % (grid.ny + 1)));
    out.push_back({what, static_cast<int>(points.size()), bounds_of(points)});
  };
  const Domain& domain = *scene.domain;
  for (size_t s = 0; s < domain.supports.size(); ++s)
    add("support " + std::to_string(s + 1), domain.supports[s].location, support_path(s));
  for (size_t l = 0; l < domain.loads.size(); ++l)
    for (size_t f = 0; f < domain.loads[l].forces.size(); ++f)
      add("load '" + domain.loads[l].name + "'", domain.loads[l].forces[f].location,
          force_path(l, f));
  return out;
}

std::vector<LoadOnVoid> loads_on_void(const Scene& scene, const mmc::BodyProblem& problem,
                                      const VectorXd& fractions) {
  constexpr double kMinMaterial = 0.5;  // least material around a loaded node [cells]
  const Domain& domain = *scene.domain;
  const NodeFinder find(scene, problem.grid, problem.outside);
  std::vector<LoadOnVoid> out;
  for (size_t l = 0; l < domain.loads.size(); ++l) {
    LoadOnVoid found{domain.loads[l].name, 0};
    for (size_t f = 0; f < domain.loads[l].forces.size(); ++f) {
      const RegionNodes location = find.at(domain.loads[l].forces[f].location, force_path(l, f));
      const std::vector<Vec2> forces =
          forces_at(scene, problem.grid, domain.loads[l].forces[f], location, force_path(l, f));
      double on_void = 0, all = 0;
      for (size_t k = 0; k < location.nodes.size(); ++k) {
        all += forces[k].norm();
        if (material_around(problem.grid, location.nodes[k], fractions) < kMinMaterial)
          on_void += forces[k].norm();
      }
      found.part = std::max(found.part, on_void / all);
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
    for (const int node : find.at(support.location, support_path(s)).nodes) {
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
      const RegionNodes location = find.at(force.location, force_path(l, f));
      const std::vector<Vec2> forces = forces_at(scene, grid, force, location, force_path(l, f));
      for (size_t k = 0; k < location.nodes.size(); ++k)
        load.forces.push_back({location.nodes[k], forces[k]});
    }
  }
  return out;
}

std::unique_ptr<mmc::ComplianceEvaluator> build_static_loads(const Scene& scene,
                                                             const mmc::BodyProblem& problem) {
  const StaticConditions conditions = static_conditions(scene, problem.grid, problem.outside);
  // Responses with one value per load need the solution of every load, therefore no compression.
  const std::vector<const mmc::ResponseRow*> rows = mmc::rows_of(problem.goal);
  const bool compress = std::none_of(rows.begin(), rows.end(),
                                     [](const mmc::ResponseRow* row) { return row->per_load; });
  return std::make_unique<mmc::ComplianceEvaluator>(mmc::plate_of(problem), conditions.held,
                                                    conditions.loads, compress, weight_of(scene));
}

}  // namespace flexmorph::cases
