#include "optim/verification/loaded_mesh.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "fem/triangles/t6.h"
#include "optim/verification/force_spread.h"

namespace flexmorph::verification {
namespace {

/// Does a side of the outline run along the line?
bool runs_along(const Segment& line, std::span<const Region> regions, double small) {
  const double length = (line.b - line.a).norm();
  const Vec2 along = (line.b - line.a) / length;
  const auto looks = [&](const std::vector<Vec2>& ring) {
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
    return looks(r.outer) || std::any_of(r.holes.begin(), r.holes.end(), looks);
  });
}

/// Collects what of a mesh lies at a location.
class Collector {
 public:
  explicit Collector(const PartMesh& mesh) : share_(mesh.points.size(), 0.0) {}

  void add(int node, double share) {
    if (share_[static_cast<std::size_t>(node)] == 0) nodes_.push_back(node);
    share_[static_cast<std::size_t>(node)] += share;
  }
  /// Material that takes part, before unsupported pieces are known: all of it.
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
  omit_unsupported_pieces();
  find_edge();
  if (unsupported_load_ < 0) find_balance();
  if (unsupported_load_ < 0)
    plate_ = std::make_unique<fem::TrianglePlate>(
        mesh_, section_,
        fem::TrianglePlateSupports{held_, clamp_lines_, small_, omitted_, springs_});
}

/// Clamps from the largest x on.
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
    std::fill(seen.begin(), seen.end(), 0);  // sides between two triangles count once
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto& n = mesh_.triangles[t];
      if (!location.area.empty()) {
        const auto [a, b, c] = mesh_.corners(t);
        if (!contains({location.area, {}}, (a + b + c) / 3)) continue;
        // Corners have no share of a force over an area, but they are there.
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

/// Balanced forces have no reactions: what is held only says which of the displacements that differ
/// by a rigid motion is meant. One node of each pin is held, without a statical indeterminacy.
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

/// Do supports, or clamps, keep the piece from moving as a whole?
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
  for (const double x : clamp_lines_)  // it sticks out of it, and does not reach back to it
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

void LoadedMesh::omit_unsupported_pieces() {
  std::vector<char> unsupported(static_cast<std::size_t>(mesh_.n_pieces), 0);
  for (int piece = 0; piece < mesh_.n_pieces; ++piece)
    unsupported[static_cast<std::size_t>(piece)] = !is_held(piece);
  n_omitted_pieces_ = static_cast<int>(std::count(unsupported.begin(), unsupported.end(), 1));
  std::vector<char> carries(mesh_.points.size(), 0);
  omitted_.resize(mesh_.triangles.size());
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    omitted_[t] = static_cast<signed char>(unsupported[static_cast<std::size_t>(mesh_.piece[t])]);
    if (omitted_[t] != 0) continue;
    for (const int node : mesh_.triangles[t]) carries[static_cast<std::size_t>(node)] = 1;
  }
  // Forces go to what carries them.
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

/// Nodes and their forces [N]; nothing where the material there cannot carry the force.
std::vector<std::pair<int, Vec2>> LoadedMesh::forces_at_nodes(const Force& force) const {
  const auto& at = at_locations_[static_cast<std::size_t>(force.location)].shares;
  std::vector<Vec2> points;
  std::vector<double> shares;
  for (const auto& [node, share] : at) {
    points.push_back(mesh_.point(node));
    shares.push_back(share);
  }
  const std::vector<Vec2> forces =
      spread({force.force, force.moment, force.bearing, force.center}, points, shares);
  std::vector<std::pair<int, Vec2>> out;
  for (std::size_t k = 0; k < forces.size(); ++k) out.emplace_back(at[k].first, forces[k]);
  return out;
}

/// Springs k Δy between neighbours on the edge. Straight in x, however it is turned: of elongations
/// Δx - s Δy, s the slope from the first node to the last one, the part with s is a spring of
/// negative stiffness between these two.
void LoadedMesh::find_edge() {
  if (!loads_.held_edge) return;
  std::vector<char> carries(mesh_.points.size(), 0);
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
    for (const int node : mesh_.triangles[t])
      if (omitted_[t] == 0) carries[static_cast<std::size_t>(node)] = 1;
  for (std::size_t k = 0; k < mesh_.points.size(); ++k)
    if (carries[k] && std::abs(mesh_.points[k].x() - loads_.held_edge->x) <= small_)
      edge_.push_back(static_cast<int>(k));
  std::sort(edge_.begin(), edge_.end(),
            [&](int a, int b) { return mesh_.point(a).y() < mesh_.point(b).y(); });
  if (edge_.size() < 2) return edge_.clear();
  const double stiffness = loads_.held_edge->stiffness;
  const auto height = [&](int a, int b) { return mesh_.point(b).y() - mesh_.point(a).y(); };
  for (std::size_t k = 1; k < edge_.size(); ++k)
    for (const int c : {0, 1})
      springs_.push_back({edge_[k - 1], edge_[k], c, stiffness / height(edge_[k - 1], edge_[k])});
  springs_.push_back(
      {edge_.front(), edge_.back(), 0, -stiffness / height(edge_.front(), edge_.back())});
}

double LoadedMesh::held_end_stretch(std::size_t row) const {
  return edge_.empty() ? 0 : loads_.loads[static_cast<std::size_t>(order_[row])].held_end_stretch;
}

/// Elongations across are Δw + g_e Δy.
VectorXd LoadedMesh::edge_energies(const MatrixXd& u) const {
  VectorXd out = VectorXd::Zero(u.rows());
  const auto difference = [&](int a, int b, int c) -> VectorXd {
    const int at_a = plate_->row(a, c), at_b = plate_->row(b, c);
    VectorXd d = VectorXd::Zero(u.rows());
    if (at_b >= 0) d += u.col(at_b);
    if (at_a >= 0) d -= u.col(at_a);
    return d;
  };
  for (const fem::NodeSpring& s : springs_)
    out += s.stiffness * difference(s.a, s.b, s.component).cwiseAbs2();
  if (edge_.empty()) return out;
  const VectorXd across = difference(edge_.front(), edge_.back(), 1);
  const double height = mesh_.point(edge_.back()).y() - mesh_.point(edge_.front()).y();
  for (Eigen::Index l = 0; l < u.rows(); ++l) {
    const double g = held_end_stretch(static_cast<std::size_t>(l));
    out[l] += loads_.held_edge->stiffness * g * (2 * across[l] + g * height);
  }
  return out;
}

/// -ρ a of all material that takes part, for these rows: (n x 2 n_nodes).
void LoadedMesh::add_inertia(std::span<const int> rows, MatrixXd& at_nodes) const {
  const Grid& g = loads_.grid;
  const auto n = static_cast<Eigen::Index>(rows.size());
  MatrixXd acceleration = MatrixXd::Zero(n, 2 * g.n_nodes());
  bool any = false;
  for (Eigen::Index l = 0; l < n; ++l) {
    const int load = order_[static_cast<std::size_t>(rows[static_cast<std::size_t>(l)])];
    const VectorXd* a = loads_.loads[static_cast<std::size_t>(load)].acceleration;
    if (a == nullptr) continue;
    acceleration.row(l) = a->transpose();
    any = true;
  }
  if (!any) return;
  MatrixXd here(n, 2);
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    if (omitted_[t] != 0) continue;
    const fem::T6 element(mesh_.corners(t));
    const double mass = section_.density * section_.thickness * element.area();
    for (const fem::WeightedPoint& w : fem::six_points()) {
      const Vec2 p = element.place(w.at);
      const double x = std::clamp((p.x() - g.x0) / g.dx(), 0.0, double(g.nx)),
                   y = std::clamp((p.y() - g.y0) / g.dy(), 0.0, double(g.ny));
      const int i = std::min(static_cast<int>(x), g.nx - 1),
                j = std::min(static_cast<int>(y), g.ny - 1);
      const double u = x - i, v = y - j;
      here.setZero();
      for (int k = 0; k < 4; ++k) {
        const double share = (k % 2 ? u : 1 - u) * (k / 2 ? v : 1 - v);
        here += share * acceleration.middleCols(2 * g.node(i + k % 2, j + k / 2), 2);
      }
      const Eigen::Matrix<double, 6, 1> shapes = fem::t6_shapes(w.at);
      for (int k = 0; k < 6; ++k)
        at_nodes.middleCols(2 * mesh_.triangles[t][static_cast<std::size_t>(k)], 2) -=
            w.weight * mass * shapes[k] * here;
    }
  }
}

VectorXd LoadedMesh::nodal_forces(int row) const {
  MatrixXd out = MatrixXd::Zero(1, 2 * static_cast<Eigen::Index>(mesh_.points.size()));
  add_inertia(std::span<const int>(&row, 1), out);
  const Load& load = loads_.loads[static_cast<std::size_t>(order_[static_cast<std::size_t>(row)])];
  for (const Force& f : load.forces)
    for (const auto& [node, at_node] : forces_at_nodes(f))
      out.middleCols(2 * node, 2) += at_node.transpose();
  VectorXd forces = out.row(0).transpose();
  if (balance_) balance_->apply(forces);
  return forces;
}

MatrixXd LoadedMesh::prescribed() const {
  if (std::all_of(loads_.loads.begin(), loads_.loads.end(),
                  [](const Load& l) { return l.held_stretch == 0; }))
    return {};
  MatrixXd out = MatrixXd::Zero(static_cast<Eigen::Index>(order_.size()),
                                2 * static_cast<Eigen::Index>(mesh_.points.size()));
  for (std::size_t l = 0; l < order_.size(); ++l) {
    const Load& load = loads_.loads[static_cast<std::size_t>(order_[l])];
    for (std::size_t k = 0; load.clamp && k < mesh_.points.size(); ++k)
      if (std::abs(mesh_.points[k].x() - *load.clamp) <= small_)
        out(static_cast<Eigen::Index>(l), 2 * static_cast<Eigen::Index>(k) + 1) =
            -load.held_stretch * mesh_.points[k].y();
  }
  return out;
}

MatrixXd LoadedMesh::forces() const {
  constexpr std::size_t kBlock = 16;  // forces at all nodes are there for so many loads at a time
  const auto n = order_.size();
  MatrixXd out = MatrixXd::Zero(static_cast<Eigen::Index>(n), plate_->n_unknowns());
  if (balance_) {
    for (std::size_t l = 0; l < n; ++l) {
      const VectorXd at_nodes = nodal_forces(static_cast<int>(l));
      for (Eigen::Index k = 0; k < at_nodes.size(); ++k)
        if (const int row = plate_->row(static_cast<int>(k / 2), static_cast<int>(k % 2)); row >= 0)
          out(static_cast<Eigen::Index>(l), row) = at_nodes[k];
    }
    return out;
  }
  const MatrixXd given = prescribed();
  for (std::size_t first = 0; first < n; first += kBlock) {
    std::vector<int> rows;
    for (std::size_t l = first; l < std::min(n, first + kBlock); ++l)
      rows.push_back(static_cast<int>(l));
    const auto m = static_cast<Eigen::Index>(rows.size()), from = static_cast<Eigen::Index>(first);
    MatrixXd at_nodes = MatrixXd::Zero(m, 2 * static_cast<Eigen::Index>(mesh_.points.size()));
    add_inertia(rows, at_nodes);
    for (Eigen::Index k = 0; k < at_nodes.cols(); ++k) {
      const int row = plate_->row(static_cast<int>(k / 2), static_cast<int>(k % 2));
      if (row >= 0) out.block(from, row, m, 1) = at_nodes.col(k);
    }
  }
  for (std::size_t l = 0; l < n; ++l)
    for (const Force& f : loads_.loads[static_cast<std::size_t>(order_[l])].forces)
      for (const auto& [node, at_node] : forces_at_nodes(f))
        for (int c = 0; c < 2; ++c)
          if (const int row = plate_->row(node, c); row >= 0)
            out(static_cast<Eigen::Index>(l), row) += at_node[c];
  for (std::size_t l = 0; l < n; ++l) {
    const double g = held_end_stretch(l);
    if (g == 0) continue;
    const double force = loads_.held_edge->stiffness * g;
    out(static_cast<Eigen::Index>(l), plate_->row(edge_.front(), 1)) += force;
    out(static_cast<Eigen::Index>(l), plate_->row(edge_.back(), 1)) -= force;
  }
  if (given.size() == 0) return out;
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    if (omitted_[t] != 0) continue;
    MatrixXd local(given.rows(), 12);
    for (int a = 0; a < 12; ++a)
      local.col(a) = given.col(2 * mesh_.triangles[t][static_cast<std::size_t>(a / 2)] + a % 2);
    if (local.isZero(0)) continue;
    // Behind its clamp a load has no unknowns: what is added there is ignored.
    const MatrixXd back = local * fem::T6(mesh_.corners(t)).stiffness(section_);
    for (int a = 0; a < 12; ++a)
      if (const int row = plate_->row(mesh_.triangles[t][static_cast<std::size_t>(a / 2)], a % 2);
          row >= 0)
        out.col(row) -= back.col(a);
  }
  return out;
}

std::vector<fem::HeldUnknown> LoadedMesh::held(int row) const {
  std::vector<fem::HeldUnknown> out = held_;
  if (clamp_lines_.empty()) return out;
  const int clamp = clamps_[static_cast<std::size_t>(row)];
  for (int node = 0; node < static_cast<int>(mesh_.points.size()); ++node)
    if (plate_->first_clamp(node) > clamp)
      for (int c = 0; c < 2; ++c) out.push_back({node, c});
  return out;
}

}  // namespace flexmorph::verification
