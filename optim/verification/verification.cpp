#include "optim/verification/verification.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "fem/triangles/recovered_stress.h"
#include "fem/triangles/t6.h"
#include "geometry/cpu_time.h"
#include "optim/verification/loaded_mesh.h"

namespace flexmorph::verification {
namespace {

// Stresses are singular at corners whose material angle exceeds kReentrant [rad]. There the first
// triangles are smaller by the factor kAtCorners.
constexpr double kReentrant = 200 * std::numbers::pi / 180, kAtCorners = 0.25;
constexpr Eigen::Index kBlock = 16;  // number of loads whose stresses are stored at a time
// The energy error of a triangle decreases like h^6: the squared strain error like h^4, the area
// like h^2. One refinement reduces a side to no less than a quarter.
constexpr double kPower = 1. / 6, kMinCut = 0.25;

Box bounds_of(std::span<const Region> regions) {
  Box out{Vec2::Constant(INFINITY), Vec2::Constant(-INFINITY)};
  for (const Region& r : regions)
    for (const Vec2& p : r.outer) {
      out.lower = out.lower.cwiseMin(p);
      out.upper = out.upper.cwiseMax(p);
    }
  return out;
}

/// Results on one mesh.
struct MeshResult {
  VectorXd compliances, errors;         // for each row of LoadedMesh [J]
  VectorXd by_triangle;                 // weighted error of each triangle [J]
  double compliance = 0, error = 0;     // weighted sum or largest of all loads [J]
  std::vector<LargestStress> stresses;  // for each row of LoadedMesh
  std::vector<double> displacements;    // largest of all nodes, for each row [m]
  LargestStress largest;
  int largest_row = -1;
  int worst_row = 0;
  MatrixXd stress;             // for the worst row (3 x n_nodes)
  VectorXd displacement;       // for the worst row (2 n_nodes)
  LargestStress worst_stress;  // for the worst row
};

class OutlineVerifier {
 public:
  OutlineVerifier(std::span<const Region> regions, const fem::PlaneSection& section,
                  const Loads& loads, const VerificationSettings& settings)
      : section_(section),
        loads_(loads),
        settings_(settings),
        small_(1e-9 * (bounds_of(regions).upper - bounds_of(regions).lower).norm()),
        locations_(chosen_locations(loads, regions, small_)),
        mesher_(regions, LoadedMesh::lines_of(loads, regions, small_)),
        sizes_(bounds_of(regions), settings.size) {
    const double fine = kAtCorners * settings.size;
    for (const Vec2& p : reentrant_corners(regions, kReentrant)) sizes_.refine(p, fine, fine);
    out_.area = area(regions);
  }

  OutlineVerification run() {
    const double start = cpu_seconds();
    std::size_t before = 0;
    for (int k = 0; k < settings_.max_meshes; ++k) {
      mesher_.refine(sizes_);
      out_.mesh = mesher_.mesh();
      const std::size_t n = out_.mesh.triangles.size();
      if (n == before) break;  // no triangle was refined
      LoadedMesh mesh(out_.mesh, section_, loads_, locations_, small_);
      if (mesh.unsupported_load() >= 0) return unsupported(mesh);
      MeshResult now = analyse(mesh);
      double error = now.error;
      if (k > 0) {
        const double growth = static_cast<double>(n) / static_cast<double>(before) - 1;
        error = std::max(error, std::abs(now.compliance - out_.compliance) / growth);
      }
      keep(mesh, now, error, k + 1);
      before = n;
      out_.converged = k > 0 && out_.error <= settings_.tolerance;
      if (out_.converged || n > static_cast<std::size_t>(settings_.max_triangles)) break;
      if (settings_.keep_running && !settings_.keep_running()) break;
      refine(now, error);
    }
    out_.seconds = cpu_seconds() - start;
    return std::move(out_);
  }

 private:
  MeshResult analyse(LoadedMesh& mesh) const;
  void update_largest_stress(const LoadedMesh& mesh, const fem::RecoveredStress::Outcome& found,
                             Eigen::Index first, const std::vector<char>& counts,
                             MeshResult& out) const;
  std::vector<char> away_from_locations(const LoadedMesh& mesh) const;
  LargestStress largest_of(const LoadedMesh& mesh, int row, const MatrixXd& stress,
                           const std::vector<char>& counts) const;
  void keep(const LoadedMesh& mesh, MeshResult& now, double error, int meshes);
  void refine(const MeshResult& now, double error);
  OutlineVerification unsupported(const LoadedMesh& mesh);

  fem::PlaneSection section_;
  const Loads& loads_;
  VerificationSettings settings_;
  double small_;
  std::vector<Location> locations_;
  PartMesher mesher_;
  SizeField sizes_;
  OutlineVerification out_;
};

/// Tells whether a point lies in a polygon or nearer to its border than the reach.
bool is_near(const std::vector<Vec2>& area, const Vec2& at, double reach) {
  if (area.empty()) return false;
  if (contains({area, {}}, at)) return true;
  for (std::size_t k = 0; k < area.size(); ++k)
    if (distance(Segment{area[k], area[(k + 1) % area.size()]}, at) <= reach) return true;
  return false;
}

/// Returns 1 for nodes away from all locations, 0 for nodes whose stress depends on how a force or
/// a support is applied (n_nodes).
std::vector<char> OutlineVerifier::away_from_locations(const LoadedMesh& mesh) const {
  const PartMesh& m = mesh.plate().mesh();
  std::vector<char> out(m.points.size(), 1);
  for (std::size_t k = 0; k < m.points.size(); ++k)
    for (const Location& p : locations_) {
      const Vec2& at = m.points[k];
      const bool on_line = std::any_of(p.lines.begin(), p.lines.end(), [&](const Segment& s) {
        return distance(s, at) <= settings_.reach;
      });
      if (on_line || is_near(p.area, at, settings_.reach)) out[k] = 0;
    }
  return out;
}

void OutlineVerifier::update_largest_stress(const LoadedMesh& mesh,
                                            const fem::RecoveredStress::Outcome& found,
                                            Eigen::Index first, const std::vector<char>& counts,
                                            MeshResult& out) const {
  for (Eigen::Index l = 0; l < found.energies.size(); ++l) {
    const int row = static_cast<int>(first + l);
    const LargestStress of_load =
        largest_of(mesh, row, found.averaged.middleRows(3 * l, 3), counts);
    out.stresses.push_back(of_load);
    if (!(of_load.value > out.largest.value)) continue;
    out.largest = of_load;
    out.largest_row = row;
  }
}

LargestStress OutlineVerifier::largest_of(const LoadedMesh& mesh, int row, const MatrixXd& stress,
                                          const std::vector<char>& counts) const {
  const PartMesh& m = mesh.plate().mesh();
  const int load = mesh.order()[static_cast<std::size_t>(row)];
  const std::optional<double>& clamp = loads_.loads[static_cast<std::size_t>(load)].clamp;
  LargestStress out;
  for (std::size_t k = 0; k < m.points.size(); ++k) {
    const double x = m.points[k].x();
    if (!counts[k] || (clamp && x < *clamp + settings_.reach)) continue;
    if (loads_.held_edge && x > loads_.held_edge->x - settings_.reach) continue;
    const double value = fem::von_mises(stress.col(static_cast<Eigen::Index>(k)));
    if (value > out.value) out = {value, m.points[k]};
  }
  return out;
}

/// Returns the displacements of all nodes (2 n_nodes) from the unknowns; held ones are zero.
VectorXd displacement_of(LoadedMesh& mesh, const VectorXd& unknowns) {
  VectorXd out = VectorXd::Zero(2 * static_cast<Eigen::Index>(mesh.plate().mesh().points.size()));
  for (int k = 0; k < out.size(); ++k)
    if (const int row = mesh.plate().row(k / 2, k % 2); row >= 0) out[k] = unknowns[row];
  return out;
}

MeshResult OutlineVerifier::analyse(LoadedMesh& mesh) const {
  mesh.plate().factorize();
  MatrixXd u = mesh.forces();
  mesh.plate().solve(u, mesh.clamps());
  const MatrixXd given = mesh.prescribed();
  const fem::RecoveredStress recovery(mesh.plate());
  const std::vector<char> counts = away_from_locations(mesh);
  const VectorXd edge = mesh.edge_energies(u);
  const Eigen::Index n = u.rows();
  MeshResult out;
  out.compliances = out.errors = VectorXd::Zero(n);
  out.by_triangle = VectorXd::Zero(static_cast<Eigen::Index>(mesh.plate().mesh().triangles.size()));
  for (Eigen::Index first = 0; first < n; first += kBlock) {
    const Eigen::Index count = std::min(kBlock, n - first);
    const std::span<const int> clamps =
        std::span<const int>(mesh.clamps())
            .subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count));
    MatrixXd some;
    if (given.size() > 0) some = given.middleRows(first, count);
    const fem::RecoveredStress::Outcome found =
        recovery.evaluate(u.middleRows(first, count), clamps, some);
    update_largest_stress(mesh, found, first, counts, out);
    for (Eigen::Index l = 0; l < count; ++l) {
      const int load = mesh.order()[static_cast<std::size_t>(first + l)];
      const double compliance = found.energies[l] + edge[first + l];
      out.compliances[first + l] = compliance;
      out.errors[first + l] = found.errors[l];
      const double weight = loads_.worst ? 1 : loads_.loads[static_cast<std::size_t>(load)].weight;
      out.by_triangle += weight * found.by_triangle.row(l).transpose();
      if (!loads_.worst) {
        out.compliance += weight * compliance;
        out.error += weight * found.errors[l];
      }
      if (first + l > 0 && !(compliance > out.compliances[out.worst_row])) continue;
      out.worst_row = static_cast<int>(first + l);
      out.stress = found.averaged.middleRows(3 * l, 3);
    }
  }
  if (loads_.worst) {
    out.compliance = out.compliances[out.worst_row];
    out.error = out.errors[out.worst_row];
  }
  for (Eigen::Index row = 0; row < n; ++row) {
    VectorXd at_nodes = displacement_of(mesh, u.row(row));
    if (given.size() > 0) at_nodes += given.row(row).transpose();
    out.displacements.push_back(
        at_nodes.reshaped(2, at_nodes.size() / 2).colwise().norm().maxCoeff());
    if (row == out.worst_row) out.displacement = std::move(at_nodes);
  }
  out.worst_stress = largest_of(mesh, out.worst_row, out.stress, counts);
  if (!std::isfinite(out.compliance) || !std::isfinite(out.error))
    throw Error::numerical("verification: the compliance is not finite");
  return out;
}

void OutlineVerifier::keep(const LoadedMesh& mesh, MeshResult& now, double error, int meshes) {
  const auto n = static_cast<std::size_t>(now.compliances.size());
  out_.compliance = now.compliance;
  out_.error = error / now.compliance;
  out_.compliances.assign(n, 0);
  out_.largest_displacements.assign(n, 0);
  out_.largest_stresses.assign(n, {});
  for (std::size_t row = 0; row < n; ++row) {
    const auto load = static_cast<std::size_t>(mesh.order()[row]);
    out_.compliances[load] = now.compliances[static_cast<Eigen::Index>(row)];
    out_.largest_displacements[load] = now.displacements[row];
    out_.largest_stresses[load] = now.stresses[row];
  }
  out_.largest_stress = now.largest.value;
  out_.largest_at = now.largest.at;
  out_.largest_load =
      now.largest_row < 0 ? -1 : mesh.order()[static_cast<std::size_t>(now.largest_row)];
  out_.n_connected_regions = out_.mesh.n_connected_regions;
  out_.n_omitted_regions = mesh.n_omitted_regions();
  out_.meshes = meshes;
  out_.omitted_triangles = mesh.omitted();
  out_.stress = std::move(now.stress);
  out_.displacement = std::move(now.displacement);
  out_.shown_stress = now.worst_stress;
  const int worst = mesh.order()[static_cast<std::size_t>(now.worst_row)];
  out_.shown_load = loads_.loads[static_cast<std::size_t>(worst)].name;
  out_.mesh_loads.clear();
  const bool clamped = std::any_of(loads_.loads.begin(), loads_.loads.end(),
                                   [](const Load& l) { return l.clamp.has_value(); });
  for (std::size_t row = 0; row < n && !loads_.held_edge; ++row) {
    if (clamped && static_cast<int>(row) != now.worst_row) continue;
    MeshLoad& each = out_.mesh_loads.emplace_back();
    each.load = mesh.order()[row];
    each.name = loads_.loads[static_cast<std::size_t>(each.load)].name;
    each.compliance = now.compliances[static_cast<Eigen::Index>(row)];
    each.held = mesh.held(static_cast<int>(row));
    const MatrixXd given = mesh.prescribed();
    for (const fem::HeldUnknown& h : each.held)
      each.prescribed.push_back(
          given.size() > 0 ? given(static_cast<Eigen::Index>(row), 2 * h.node + h.component) : 0.0);
    const VectorXd forces = mesh.nodal_forces(static_cast<int>(row));
    for (Eigen::Index k = 0; k < forces.size(); k += 2)
      if (forces[k] != 0 || forces[k + 1] != 0)
        each.forces.push_back({static_cast<int>(k / 2), forces.segment<2>(k)});
  }
  // The worst load comes first, because out_.stress belongs to it.
  std::stable_sort(
      out_.mesh_loads.begin(), out_.mesh_loads.end(),
      [&](const MeshLoad& a, const MeshLoad& b) { return (a.load == worst) > (b.load == worst); });
}

/// Requests smaller triangles where the error is large, so that all triangles get an equal fraction
/// of the allowed error.
void OutlineVerifier::refine(const MeshResult& now, double error) {
  const double wanted =
      std::min(0.5 * settings_.tolerance * now.compliance, 0.25 * std::max(now.error, 0.1 * error));
  const double part = wanted / static_cast<double>(out_.mesh.triangles.size());
  for (std::size_t t = 0; t < out_.mesh.triangles.size(); ++t) {
    const double own = now.by_triangle[static_cast<Eigen::Index>(t)];
    if (!(own > part)) continue;
    const auto [a, b, c] = out_.mesh.corners(t);
    const double side = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    // The requested size is at most 0.9 of the side, because a side of the allowed size is not
    // split.
    const double size = side * std::clamp(std::pow(part / own, kPower), kMinCut, 0.9);
    sizes_.refine((a + b + c) / 3, 0.5 * side, size);
  }
}

OutlineVerification OutlineVerifier::unsupported(const LoadedMesh& mesh) {
  out_.compliance = INFINITY;
  out_.unsupported_load = loads_.loads[static_cast<std::size_t>(mesh.unsupported_load())].name;
  out_.converged = true;
  out_.n_connected_regions = out_.mesh.n_connected_regions;
  out_.n_omitted_regions = mesh.n_omitted_regions();
  out_.omitted_triangles = mesh.omitted();
  return std::move(out_);
}

}  // namespace

OutlineVerification verify_outline(std::span<const Region> regions,
                                   const fem::PlaneSection& section, const Loads& loads,
                                   const VerificationSettings& settings) {
  if (loads.loads.empty()) throw Error::input("verification: there are no loads");
  if (regions.empty()) throw Error::numerical("verification: there is no material");
  return OutlineVerifier(regions, section, loads, settings).run();
}

}  // namespace flexmorph::verification
