#include "fem/dynamics/growth.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace flexmorph::fem {

const LineGrid& grid_of(const Body& body) {
  const auto* lines = dynamic_cast<const LineGrid*>(body.element.get());
  if (!lines) throw Error::input("body '" + body.name + "' has no material lines to move");
  return *lines;
}

VectorRows rows_of(const Body& body, const VectorXd& all) {
  return Eigen::Map<const VectorRows>(all.data() + body.first_dof, body.element->n_vectors(),
                                      body.element->dim());
}

namespace {

/// Rows of the unknowns of one element.
MatrixXd local_rows(const Body& body, const VectorXd& all, int e) {
  const auto vectors = body.element->vectors(e);
  const int dim = body.element->dim();
  MatrixXd out(static_cast<Eigen::Index>(vectors.size()), dim);
  for (Eigen::Index k = 0; k < out.rows(); ++k)
    out.row(k) = all.segment(body.first_dof + dim * vectors[static_cast<size_t>(k)], dim);
  return out;
}

}  // namespace

PointMotion point_motion(const Body& body, const State& x, const Vec2& material) {
  ShapeTable t;
  const int e = body.element->locate(material, Tabulate::position_rates, t);
  const MatrixXd q = local_rows(body, x.q, e), v = local_rows(body, x.v, e),
                 a = local_rows(body, x.a, e);
  PointMotion out;
  const auto plane = [](const MatrixXd& row) { return Vec2(row(0, 0), row(0, 1)); };
  out.position = plane(t.N * q);
  out.velocity = plane(t.N * v);
  out.acceleration = plane(t.N * a);
  if (t.N_t.size() > 0) {
    out.velocity += plane(t.N_t * q);
    out.acceleration += plane(2 * t.N_t * v + t.N_tt * q);
  }
  return out;
}

Vec3 point_position(const Body& body, const State& x, const Vec2& material) {
  ShapeTable t;
  const int e = body.element->locate(material, Tabulate::position, t);
  Vec3 out = Vec3::Zero();
  out.head(body.element->dim()) = (t.N * local_rows(body, x.q, e)).transpose();
  return out;
}

NextChange next_change(const Body& body, const Growth& growth, double t, double end, double step) {
  const LineGrid& plate = grid_of(body);
  const MaterialLine &root = plate.lines_m()[0], &first = plate.lines_m()[1];
  const NextChange never{std::numeric_limits<double>::infinity(), MeshChange::insertion};
  if (!root.drive) return never;
  const auto length = [&](double at) {
    return (first.drive ? first.drive(at).value : first.value) - root.drive(at).value;
  };
  const bool may_merge =
      plate.n_m() > 1 && !first.drive &&
      growth.min_length + plate.lines_m()[2].value - first.value < 0.9 * growth.max_length;
  // Positive once the limit is passed.
  const auto passed = [&](double at) {
    const double above = length(at) - growth.max_length;
    return may_merge ? std::max(above, growth.min_length - length(at)) : above;
  };
  // A millionth of a millionth of the limit: an event that falls on t itself has been executed.
  const double tiny = 1e-12 * growth.max_length;
  double low = t;
  while (low < end) {
    const double high = std::min(end, low + step);
    if (passed(high) >= -tiny) {
      double a = low, b = high;
      for (int k = 0; k < 200 && b - a > 1e-15 * std::max(1.0, b) && passed(b) > 0; ++k) {
        const double mid = 0.5 * (a + b);
        (passed(mid) >= 0 ? b : a) = mid;
      }
      return {b, length(b) > 0.5 * growth.max_length ? MeshChange::insertion : MeshChange::removal};
    }
    low = high;
  }
  return never;
}

std::optional<MeshChange> change_due(const Body& body, const Growth& growth) {
  const LineGrid& plate = grid_of(body);
  if (growth.line != 0 || !plate.lines_m()[0].free) return {};
  const double length = plate.line_m(1).value - plate.line_m(0).value;
  if (length > growth.max_length) return MeshChange::insertion;
  const bool may_merge = plate.n_m() > 1 && !plate.lines_m()[1].free && !plate.lines_m()[1].drive &&
                         plate.line_m(2).value - plate.line_m(0).value < 0.9 * growth.max_length;
  if (length < growth.min_length && may_merge) return MeshChange::removal;
  return {};
}

namespace {

/// Values of position-like rows and their material derivatives at a point of element e, in the
/// order of a node's unknowns: f, f_m, f_n, f_mn.
struct NodeSampler {
  const LineGrid& plate;
  int e;
  double s, u;

  /// Σ_k shape_k rows_k for value and derivatives; `rates` 0: N, 1: Ṅ, 2: N̈.
  MatrixXd sample(const MatrixXd& rows, int rates) const;
};

MatrixXd NodeSampler::sample(const MatrixXd& rows, int rates) const {
  // Derivatives along m by fitting: the field along m is a cubic in s, along n likewise; sampled at
  // the four Chebyshev-like points it is known, and so are its derivatives.
  static const Eigen::Vector4d points(0.0, 0.3, 0.7, 1.0);
  Eigen::Matrix4d vandermonde;
  for (int i = 0; i < 4; ++i)
    vandermonde.row(i) << 1, points[i], points[i] * points[i], std::pow(points[i], 3);
  const Eigen::Matrix4d inverse = vandermonde.inverse();
  const auto basis = [&](double at, double length) {
    Eigen::Matrix<double, 2, 4> out;  // value and derivative weights on the four samples
    out.row(0) = Eigen::RowVector4d(1, at, at * at, at * at * at) * inverse;
    out.row(1) = Eigen::RowVector4d(0, 1, 2 * at, 3 * at * at) * inverse / length;
    return out;
  };
  const int i = e / plate.n_n(), j = e % plate.n_n();
  const Eigen::Matrix<double, 2, 4> along =
      basis(s, plate.line_m(i + 1).value - plate.line_m(i).value);
  const Eigen::Matrix<double, 2, 4> across =
      basis(u, plate.line_n(j + 1).value - plate.line_n(j).value);

  MatrixXd out = MatrixXd::Zero(4, rows.cols());
  ShapeTable t;
  for (int p = 0; p < 4; ++p)
    for (int r = 0; r < 4; ++r) {
      plate.at(e, points[p], points[r], Tabulate::position_rates, t);
      const MatrixXd& n = rates == 0 ? t.N : rates == 1 ? t.N_t : t.N_tt;
      if (n.size() == 0) continue;
      const Eigen::RowVectorXd value = n * rows;
      out.row(0) += along(0, p) * across(0, r) * value;
      out.row(1) += along(1, p) * across(0, r) * value;
      out.row(2) += along(0, p) * across(1, r) * value;
      out.row(3) += along(1, p) * across(1, r) * value;
    }
  return out;
}

struct NodeState {
  MatrixXd q, v, a, alpha;  // (4 x dim): value and derivatives by m, n, mn
};

NodeState sample_node(const Body& body, const LineGrid& plate, const State& x, int e, double s,
                      double u) {
  const NodeSampler at{plate, e, s, u};
  const MatrixXd q = local_rows(body, x.q, e), v = local_rows(body, x.v, e);
  NodeState out;
  out.q = at.sample(q, 0);
  out.v = at.sample(v, 0) + at.sample(q, 1);
  const MatrixXd flow = 2 * at.sample(v, 1) + at.sample(q, 2);
  out.a = at.sample(local_rows(body, x.a, e), 0) + flow;
  out.alpha = at.sample(local_rows(body, x.alpha, e), 0) + flow;
  return out;
}

}  // namespace

void change_mesh(Model& model, Body& body, MeshChange change, State& x) {
  body.element->move_to(x.t);
  const std::unique_ptr<LineGrid> mesh = grid_of(body).copy();
  const LineGrid& old = *mesh;
  const int rows = (old.n_n() + 1) * old.per_node();  // vector unknowns of one column of nodes
  const int dim = old.dim();
  std::vector<NodeState> fresh;
  std::unique_ptr<LineGrid> next;
  if (change == MeshChange::insertion) {
    for (int j = 0; j <= old.n_n(); ++j)
      fresh.push_back(
          sample_node(body, old, x, old.element(0, std::max(0, j - 1)), 0.5, j == 0 ? 0.0 : 1.0));
    next = old.with_line(0, 0.5 * (old.line_m(0).value + old.line_m(1).value));
  } else {
    next = old.without_line(1);
  }

  const auto carry = [&](VectorXd& all, MatrixXd NodeState::*field) {
    const int first = body.first_dof, before = dim * rows;
    const int skip = change == MeshChange::removal ? dim * rows : 0;
    const int add = change == MeshChange::insertion ? dim * rows : 0;
    VectorXd out(all.size() - skip + add);
    out.head(first + before) = all.head(first + before);
    if (add > 0)
      for (int j = 0; j <= old.n_n(); ++j)
        for (int k = 0; k < old.per_node(); ++k)
          out.segment(first + before + dim * (j * old.per_node() + k), dim) =
              (fresh[static_cast<size_t>(j)].*field).row(k);
    const auto rest = all.size() - first - before - skip;
    out.tail(rest) = all.tail(rest);
    all = std::move(out);
  };
  carry(x.q, &NodeState::q);
  carry(x.v, &NodeState::v);
  carry(x.a, &NodeState::a);
  carry(x.alpha, &NodeState::alpha);
  model.set_element(body, std::move(next));
  model.prepare(x);
}

}  // namespace flexmorph::fem
