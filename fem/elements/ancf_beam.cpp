#include "fem/elements/ancf_beam.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/text.h"

namespace flexmorph::fem {
namespace {

constexpr int kPerNode = 3;
using Row6 = std::array<double, 6>;

/// Returns the shape functions T (A.2) and (A.11) for ξ = x/l and y = l η.
Row6 shapes(double xi, double y, double l) {
  return {1 + xi * xi * (2 * xi - 3), l * xi * (1 + xi * (xi - 2)), y * (1 - xi),
          xi * xi * (3 - 2 * xi),     l * xi * xi * (xi - 1),       y * xi};
}
Row6 shapes_x(double xi, double y, double l) {
  const double bulge = 6 / l * xi * (1 - xi);
  return {-bulge, 1 + xi * (3 * xi - 4), -y / l, bulge, xi * (3 * xi - 2), y / l};
}
Row6 shapes_y(double xi) { return {0, 0, 1 - xi, 0, 0, xi}; }

}  // namespace

std::vector<double> uniform_nodes(double length, int n_elements) {
  if (!(length > 0) || !std::isfinite(length) || n_elements < 1)
    throw Error::input(
        formatted("ancf_beam: length = %g m and number of elements = %d: the length is positive, "
                  "and there is "
                  "at least one element",
                  length, n_elements));
  std::vector<double> x;
  for (int i = 0; i <= n_elements; ++i) x.push_back(length * i / n_elements);
  return x;
}

std::vector<BeamNode> curve_reference(const std::function<CentreLine(double)>& curve,
                                      const std::vector<double>& x) {
  std::vector<BeamNode> out;
  for (const double at : x) {
    const CentreLine c = curve(at);
    const double length = c.tangent.norm();
    if (!(length > 0))
      throw Error::input(formatted(
          "ancf_beam: the tangent of the centre line at x = %g m has the length %g; it is positive",
          at, length));
    const Vec2 normal = Vec2(-c.tangent.y(), c.tangent.x()) / length;
    out.push_back({c.point, c.tangent, c.height_ratio * normal});
  }
  return out;
}

std::vector<BeamNode> arc_reference(double length, double angle, int n_elements) {
  return curve_reference(
      [&](double x) {
        const double turn = angle * x / length;
        // With a = turn, (sin a, 1 - cos a)/a = chord (cos a/2, sin a/2), which is valid for a
        // straight beam (a = 0), too.
        const double chord = turn == 0 ? 1 : std::sin(turn / 2) / (turn / 2);
        const Vec2 middle(std::cos(turn / 2), std::sin(turn / 2));
        return CentreLine{x * chord * middle, Vec2(std::cos(turn), std::sin(turn)), 1};
      },
      uniform_nodes(length, n_elements));
}

AncfBeam::AncfBeam(double length, double height, int n_elements)
    : AncfBeam(uniform_nodes(length, n_elements), height) {}

AncfBeam::AncfBeam(std::vector<double> x, double height, std::vector<BeamNode> reference)
    : Element(Kind<AncfBeam>{}, {.dim = 2,
                                 .n_shapes = 2 * kPerNode,
                                 .n_elements = static_cast<int>(x.size()) - 1,
                                 .n_vectors = kPerNode * static_cast<int>(x.size())}),
      x_(std::move(x)),
      height_(height),
      straight_(reference.empty()) {
  if (!(height > 0) || !std::isfinite(height))
    throw Error::input(formatted("ancf_beam: height = %g m: a height is positive", height));
  if (x_.size() < 2)
    throw Error::input("ancf_beam: a beam has at least two nodes, not " +
                       std::to_string(x_.size()));
  for (size_t i = 0; i < x_.size(); ++i)
    if (!std::isfinite(x_[i]) || (i > 0 && !(x_[i] > x_[i - 1])))
      throw Error::input(
          formatted("ancf_beam: node %zu is at x = %g m: the coordinates of the nodes are finite "
                    "and increase along the beam",
                    i + 1, x_[i]));
  if (straight_)
    for (const double at : x_) reference.push_back({Vec2(at, 0), Vec2(1, 0), Vec2(0, 1)});
  if (reference.size() != x_.size())
    throw Error::input("ancf_beam: " + std::to_string(reference.size()) +
                       " nodes are given for the reference configuration, but " +
                       std::to_string(x_.size()) + " coordinates");
  reference_.resize(n_vectors(), 2);
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(x_.size()); ++i) {
    const BeamNode& node = reference[static_cast<size_t>(i)];
    reference_.row(kPerNode * i) = node.r;
    reference_.row(kPerNode * i + 1) = node.r_x;
    reference_.row(kPerNode * i + 2) = node.r_y;
  }
  if (!reference_.allFinite())
    throw Error::input("ancf_beam: a number of the reference configuration is not finite");
  for (int e = 0; e < n_elements(); ++e)
    for (int k = 0; k < n_shapes(); ++k) vectors_.push_back(kPerNode * e + k);
  if (!straight_) check_reference();
}

/// It suffices to check both faces, because det J_o is linear in y.
void AncfBeam::check_reference() const {
  std::vector<double> along = {0, 1};
  for (const int n : {2, 3, 4, 5, 6, 7})
    along.insert(along.end(), gauss(n).points.begin(), gauss(n).points.end());
  ShapeTable table;
  resize(1, Tabulate::position, table);
  for (int e = 0; e < n_elements(); ++e)
    for (const double xi : along)
      for (const double side : {-0.5, 0.5}) {
        fill(e, xi, side * height_, 0, table);
        if (!(table.weight[0] > 0))
          throw Error::input("ancf_beam: the reference configuration is folded at x = " +
                             std::to_string(table.material[0].x()) +
                             " m, y = " + std::to_string(table.material[0].y()) +
                             " m: det J_o = " + std::to_string(table.weight[0]));
      }
}

double AncfBeam::length(int e) const {
  return x_[static_cast<size_t>(e + 1)] - x_[static_cast<size_t>(e)];
}

std::span<const int> AncfBeam::vectors(int e) const {
  return {vectors_.data() + static_cast<size_t>(e) * 6, 6};
}

double AncfBeam::scale(int k) const {
  switch (k % kPerNode) {
    case 0:
      return 1;
    case 1:
      return length(std::min(k / kPerNode, n_elements() - 1));
    default:
      return height_;
  }
}

std::vector<NodeVectors> AncfBeam::nodes() const {
  std::vector<NodeVectors> out;
  for (size_t i = 0; i < x_.size(); ++i) {
    const int first = kPerNode * static_cast<int>(i);
    out.push_back({first, first + 1, first + 2, -1, Vec2(x_[i], 0), false});
  }
  return out;
}

std::vector<NodeVectors> AncfBeam::edge(const std::string& name) const {
  int line = -1;
  if (name == "root")
    line = 0;
  else if (name == "free_end")
    line = n_elements();
  else if (std::sscanf(name.c_str(), "line %d", &line) != 1 || line < 0 || line > n_elements())
    throw Error::input("edge '" + name +
                       "': a beam has the edges 'root', 'free_end' and 'line 0' to 'line " +
                       std::to_string(n_elements()) + "'");
  return {nodes()[static_cast<size_t>(line)]};
}

void AncfBeam::resize(Eigen::Index n_points, Tabulate what, ShapeTable& out) const {
  if (what == Tabulate::curvature || what == Tabulate::curvature_rates)
    throw Error::input(
        "a beam has no second derivatives: bending terms are only available for plates");
  const bool gradient = what == Tabulate::gradient || what == Tabulate::gradient_rates;
  out.weight.resize(n_points);
  out.material.resize(static_cast<size_t>(n_points));
  out.N.resize(n_points, n_shapes());
  for (MatrixXd* table : {&out.N_m, &out.N_n})
    table->resize(gradient ? n_points : 0, gradient ? n_shapes() : 0);
  for (MatrixXd* table : {&out.N_t, &out.N_tt, &out.N_mt, &out.N_nt, &out.N_mm, &out.N_nn,
                          &out.N_mn, &out.N_mmt, &out.N_nnt, &out.N_mnt})
    table->resize(0, 0);
}

void AncfBeam::fill(int e, double xi, double y, Eigen::Index p, ShapeTable& out) const {
  const double l = length(e);
  const Row6 s = shapes(xi, y, l), s_x = shapes_x(xi, y, l), s_y = shapes_y(xi);
  // J_o = (X_x X_y); J_o⁻ᵀ (s_x, s_y) by Cramer's rule.
  Vec2 X_x(1, 0), X_y(0, 1);
  double det = 1;
  if (!straight_) {
    X_x.setZero();
    X_y.setZero();
    for (size_t k = 0; k < 6; ++k) {
      const auto X = reference_.row(kPerNode * e + static_cast<Eigen::Index>(k));
      X_x += s_x[k] * X;
      X_y += s_y[k] * X;
    }
    det = X_x.x() * X_y.y() - X_x.y() * X_y.x();
  }
  out.weight[p] = det;
  out.material[static_cast<size_t>(p)] = {x_[static_cast<size_t>(e)] + xi * l, y};
  for (size_t k = 0; k < 6; ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    out.N(p, column) = s[k];
    if (out.N_m.size() == 0) continue;
    out.N_m(p, column) = (X_y.y() * s_x[k] - X_x.y() * s_y[k]) / det;
    out.N_n(p, column) = (X_x.x() * s_y[k] - X_y.x() * s_x[k]) / det;
  }
}

void AncfBeam::tabulate(int e, int degree, Tabulate what, const ScaleFactors& factors,
                        ScaleFactorKind kind, ShapeTable& out) const {
  if (kind != ScaleFactorKind::none && !factors.uniform())
    throw Error::input(
        "a beam has uniform material: it does not support scale factors of a design");
  // det J_o has degree 3 along the beam and degree 1 across it.
  const int n_along = degree / 2 + (straight_ ? 1 : 3),
            n_across = std::min(degree / 2 + 1, 3) + (straight_ ? 0 : 1);
  const GaussRule &along = gauss(n_along), &across = gauss(n_across);
  resize(n_along * n_across, what, out);
  Eigen::Index p = 0;
  for (size_t g = 0; g < along.points.size(); ++g)
    for (size_t h = 0; h < across.points.size(); ++h, ++p) {
      fill(e, along.points[g], (across.points[h] - 0.5) * height_, p, out);
      out.weight[p] *= length(e) * height_ * along.weights[g] * across.weights[h];
    }
}

int AncfBeam::locate(const Vec2& material, Tabulate what, ShapeTable& out) const {
  constexpr double kSlack = 1e-9;  // relative to the element; material coordinates are rounded
  const auto end = std::lower_bound(x_.begin() + 1, x_.end() - 1, material.x());
  const auto e = static_cast<int>(end - x_.begin()) - 1;
  const double xi = (material.x() - x_[static_cast<size_t>(e)]) / length(e),
               u = material.y() / height_;
  if (!(xi >= -kSlack && xi <= 1 + kSlack && std::abs(u) <= 0.5 + kSlack))
    throw Error::input("material point (" + std::to_string(material.x()) + ", " +
                       std::to_string(material.y()) + ") m lies outside the beam");
  resize(1, what, out);
  fill(e, std::clamp(xi, 0.0, 1.0), std::clamp(u, -0.5, 0.5) * height_, 0, out);
  out.weight[0] = 1;
  return e;
}

}  // namespace flexmorph::fem
