#include "optim/verification/loaded_mesh.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "fem/triangles/t6.h"

namespace flexmorph::verification {
namespace {

/// Tells whether a side of the outline runs along the line.
bool runs_along(const Segment& line, std::span<const Region> regions, double small) {
  const double length = (line.b - line.a).norm();
  const Vec2 along = (line.b - line.a) / length;
  const auto analyses = [&](const std::vector<Vec2>& ring) {
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vec2 u = ring[k] - line.a, v = ring[(k + 1) % ring.size()] - line.a;
      const auto off = [&](const Vec2& p) {
        return std::abs(along.x() * p.y() - along.y() * p.x());
      };
      if (off(u) > small || off(v) > small) continue;
      const double from = std::max(0.0, std::min(along.dot(u), along.dot(v)));
      const double to = std::min(length, std::max(along.dot(u), along.dot(v)));
      if (to - from > 10 * small) return true;
    }
    return false;
  };
  return std::any_of(regions.begin(), regions.end(), [&](const Region& r) {
    return analyses(r.outer) || std::any_of(r.holes.begin(), r.holes.end(), analyses);
  });
}

/// Collects the nodes of a mesh at a location.
class Collector {
 public:
  explicit Collector(const PartMesh& mesh) : share_(mesh.points.size(), 0.0) {}

  void add(int node, double share) {
    if (share_[static_cast<std::size_t>(node)] == 0) nodes_.push_back(node);
    share_[static_cast<std::size_t>(node)] += share;
  }
  /// Returns the collected nodes with shares of sum 1, and clears the collection.
  LocationNodes take() {
    LocationNodes out;
    double sum = 0;
    std::sort(nodes_.begin(), nodes_.end());
    nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
    for (const int node : nodes_) sum += share_[static_cast<std::size_t>(node)];
    for (const int node : nodes_) {
      out.shares.emplace_back(node, share_[static_cast<std::size_t>(node)] / sum);
      share_[static_cast<std::size_t>(node)] = 0;
    }
    nodes_.clear();
    return out;
  }

 private:
  std::vector<double> share_;
  std::vector<int> nodes_;
};

}  // namespace

std::vector<Location> chosen_locations(const Loads& loads, std::span<const Region> regions,
                                       double small) {
  std::vector<Location> out = loads.locations;
  for (Location& p : out) {
    if (p.area.empty()) continue;
    const bool on_lines = std::any_of(p.lines.begin(), p.lines.end(), [&](const Segment& s) {
      return runs_along(s, regions, small);
    });
    if (on_lines)
      p.area.clear();
    else
      p.lines.clear();
  }
  return out;
}

std::vector<Segment> LoadedMesh::lines_of(const Loads& loads, std::span<const Region> regions,
                                          double small) {
  std::vector<Segment> out;
  for (const Location& p : chosen_locations(loads, regions, small)) {
    out.insert(out.end(), p.lines.begin(), p.lines.end());
    for (std::size_t k = 0; k < p.area.size(); ++k)
      out.push_back({p.area[k], p.area[(k + 1) % p.area.size()]});
  }
  double lowest = INFINITY, highest = -INFINITY;
  for (const Region& r : regions)
    for (const Vec2& p : r.outer) {
      lowest = std::min(lowest, p.y());
      highest = std::max(highest, p.y());
    }
  const double beyond = 0.1 * (highest - lowest);
  std::vector<double> clamps;
  for (const Load& l : loads.loads)
    if (l.clamp) clamps.push_back(*l.clamp);
  std::sort(clamps.begin(), clamps.end());
  clamps.erase(std::unique(clamps.begin(), clamps.end()), clamps.end());
  for (const double x : clamps) out.push_back({{x, lowest - beyond}, {x, highest + beyond}});
  return out;
}

LoadedMesh::LoadedMesh(const PartMesh& mesh, const fem::PlaneSection& section, const Loads& loads,
                       std::span<const Location> locations, double small)
    : mesh_(mesh), section_(section), loads_(loads), locations_(locations), small_(small) {
  sort_loads();
  find_locations();
  hold_at_pins();
  omit_unsupported_regions();
  find_edge();
  if (unsupported_load_ < 0) find_balance();
  if (unsupported_load_ < 0)
    plate_ = std::make_unique<fem::TrianglePlate>(
        mesh_, section_,
        fem::TrianglePlateSupports{held_, clamp_lines_, small_, omitted_, springs_});
}

/// Sorts the loads by their clamps, from the largest x to the smallest.
void LoadedMesh::sort_loads() {
  const auto n = loads_.loads.size();
  order_.resize(n);
  std::iota(order_.begin(), order_.end(), 0);
  const auto x_of = [&](int l) {
    return loads_.loads[static_cast<std::size_t>(l)].clamp.value_or(INFINITY);
  };
  std::stable_sort(order_.begin(), order_.end(), [&](int a, int b) { return x_of(a) > x_of(b); });
  for (const int l : order_) {
    if (!loads_.loads[static_cast<std::size_t>(l)].clamp) {
      clamps_.push_back(0);
      continue;
    }
    if (clamp_lines_.empty() || clamp_lines_.back() != x_of(l)) clamp_lines_.push_back(x_of(l));
    clamps_.push_back(static_cast<int>(clamp_lines_.size()) - 1);
  }
}

void LoadedMesh::find_locations() {
  Collector all(mesh_);
  std::vector<char> seen(mesh_.points.size());
  for (const Location& location : locations_) {
    std::fill(seen.begin(), seen.end(), 0);  // a side between two triangles counts once
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto& n = mesh_.triangles[t];
      if (!location.area.empty()) {
        const auto [a, b, c] = mesh_.corners(t);
        if (!contains({location.area, {}}, (a + b + c) / 3)) continue;
        // Corners have no share of a uniform force on an area, but they belong to the location.
        for (std::size_t k = 0; k < 6; ++k)
          all.add(n[k], k < 3 ? 0 : fem::T6(mesh_.corners(t)).area() / 3);
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const int a = n[k], b = n[(k + 1) % 3], middle = n[3 + k];
        if (seen[static_cast<std::size_t>(middle)]) continue;
        const Vec2 &at_a = mesh_.point(a), &at_b = mesh_.point(b);
        if (std::none_of(location.lines.begin(), location.lines.end(), [&](const Segment& s) {
              return distance(s, at_a) <= small_ && distance(s, at_b) <= small_ &&
                     distance(s, mesh_.point(middle)) <= small_;
            }))
          continue;
        seen[static_cast<std::size_t>(middle)] = 1;
        const double length = (at_b - at_a).norm();
        all.add(a, length / 6);
        all.add(b, length / 6);
        all.add(middle, 4 * length / 6);
      }
    }
    at_locations_.push_back(all.take());
  }
  for (const Support& s : loads_.supports)
    for (const auto& [node, share] : at_locations_[static_cast<std::size_t>(s.location)].shares) {
      if (s.x) held_.push_back({node, 0});
      if (s.y) held_.push_back({node, 1});
    }
}

/// Holds one node of each pin, in a statically determinate way. Balanced forces cause no reactions;
/// the held nodes only select one of the displacements that differ by a rigid motion.
void LoadedMesh::hold_at_pins() {
  if (!loads_.balance) return;
  const auto& pins = loads_.balance->pins;
  const auto& first = at_locations_[static_cast<std::size_t>(pins[0].location)].shares;
  const auto& second = at_locations_[static_cast<std::size_t>(pins[1].location)].shares;
  if (first.empty() || second.empty()) return;
  const Vec2 line = pins[1].center - pins[0].center;
  held_.push_back({first.front().first, 0});
  held_.push_back({first.front().first, 1});
  held_.push_back({second.front().first, std::abs(line.x()) >= std::abs(line.y()) ? 1 : 0});
}

void LoadedMesh::find_balance() {
  if (!loads_.balance) return;
  if (!loads_.balance->floating) {
    std::array<PinNodes, 2> pins;
    for (std::size_t k = 0; k < 2; ++k) {
      const Pin& pin = loads_.balance->pins[k];
      pins[k] = {at_locations_[static_cast<std::size_t>(pin.location)].shares, pin};
    }
    balance_.emplace(mesh_, std::move(pins));
    return;
  }
  MatrixXd inertia = MatrixXd::Zero(2 * static_cast<Eigen::Index>(mesh_.points.size()), 3);
  const MatrixXd rigid = PartBalance::rigid_motions(mesh_);
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    if (omitted_[t] != 0) continue;
    const fem::T6 element(mesh_.corners(t));
    const double mass = section_.density * section_.thickness * element.area();
    for (const fem::WeightedPoint& w : fem::six_points()) {
      const Eigen::Matrix<double, 6, 1> shapes = fem::t6_shapes(w.at);
      Eigen::Matrix<double, 2, 3> here = Eigen::Matrix<double, 2, 3>::Zero();
      for (int k = 0; k < 6; ++k)
        here +=
            shapes[k] * rigid.middleRows<2>(2 * mesh_.triangles[t][static_cast<std::size_t>(k)]);
      for (int k = 0; k < 6; ++k)
        inertia.middleRows<2>(2 * mesh_.triangles[t][static_cast<std::size_t>(k)]) +=
            w.weight * mass * shapes[k] * here;
    }
  }
  balance_.emplace(mesh_, inertia);
}

/// Tells whether supports or clamps prevent all rigid motions of a connected region.
bool LoadedMesh::is_held(int piece) const {
  std::vector<char> own(mesh_.points.size(), 0);
  double first = INFINITY, last = -INFINITY;  // x
  Vec2 middle = Vec2::Zero();
  int n = 0;
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    if (mesh_.piece[t] != piece) continue;
    for (const int node : mesh_.triangles[t]) {
      own[static_cast<std::size_t>(node)] = 1;
      first = std::min(first, mesh_.point(node).x());
      last = std::max(last, mesh_.point(node).x());
    }
    for (const Vec2& p : mesh_.corners(t)) {
      middle += p;
      ++n;
    }
  }
  middle /= n;
  for (const double x : clamp_lines_)  // the region lies entirely in front of this clamp
    if (last > x + small_ && first > x + small_) return false;
  if (!clamp_lines_.empty()) return true;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  const double size = std::max(last - first, small_);
  for (const fem::HeldUnknown& h : held_) {
    if (!own[static_cast<std::size_t>(h.node)]) continue;
    const Vec2 at = (mesh_.point(h.node) - middle) / size;
    const Vec3 row = h.component == 0 ? Vec3(1, 0, -at.y()) : Vec3(0, 1, at.x());
    sum += row * row.transpose();
  }
  const Vec3 values = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sum).eigenvalues();
  return values[0] > 1e-12 * values[2];
}

void LoadedMesh::omit_unsupported_regions() {
  std::vector<char> unsupported(static_cast<std::size_t>(mesh_.n_connected_regions), 0);
  for (int piece = 0; piece < mesh_.n_connected_regions; ++piece)
    unsupported[static_cast<std::size_t>(piece)] = !is_held(piece);
  n_omitted_regions_ = static_cast<int>(std::count(unsupported.begin(), unsupported.end(), 1));
  std::vector<char> carries(mesh_.points.size(), 0);
  omitted_.resize(mesh_.triangles.size());
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    omitted_[t] = static_cast<signed char>(unsupported[static_cast<std::size_t>(mesh_.piece[t])]);
    if (omitted_[t] != 0) continue;
    for (const int node : mesh_.triangles[t]) carries[static_cast<std::size_t>(node)] = 1;
  }
  // Forces are distributed over the supported material only.
  for (LocationNodes& location : at_locations_) {
    std::erase_if(location.shares,
                  [&](const auto& each) { return !carries[static_cast<std::size_t>(each.first)]; });
    for (const auto& [node, share] : location.shares) location.held += share;
    for (auto& [node, share] : location.shares) share /= location.held > 0 ? location.held : 1;
  }
  std::erase_if(
      held_, [&](const fem::HeldUnknown& h) { return !carries[static_cast<std::size_t>(h.node)]; });
  if (std::none_of(carries.begin(), carries.end(), [](char c) { return c != 0; }))
    unsupported_load_ = 0;
  if (loads_.balance)
    for (const Pin& pin : loads_.balance->pins)
      if (at_locations_[static_cast<std::size_t>(pin.location)].held < 0.5) unsupported_load_ = 0;
  for (std::size_t l = 0; l < loads_.loads.size() && unsupported_load_ < 0; ++l)
    for (const Force& f : loads_.loads[l].forces)
      if ((f.force != Vec2::Zero() || f.moment != 0) &&
          (at_locations_[static_cast<std::size_t>(f.location)].held < 0.5 ||
           forces_at_nodes(f).empty()))
        unsupported_load_ = static_cast<int>(l);
}

}  // namespace flexmorph::verification
