#include "fem/dynamics/mesh_changes/mesh_map.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace flexmorph::fem {
namespace {

const LineGrid& lines_of(const Body& body) {
  const auto* lines = dynamic_cast<const LineGrid*>(body.element.get());
  if (!lines) throw Error::input("body '" + body.name + "' has no material lines that can move");
  return *lines;
}

}  // namespace

double inserted_line(const LineGrid& lines, double cell) {
  const double first = lines.line_m(1).value;
  return cell > 0 ? first - cell : 0.5 * (lines.line_m(0).value + first);
}

MeshMap::MeshMap(const Body& body, MeshChange change, int n_dofs, double cell) : n_before_(n_dofs) {
  const LineGrid& plate = lines_of(body);
  dim_ = plate.dim();
  per_node_ = plate.per_node();
  const int column = dim_ * per_node_ * (plate.n_n() + 1);  // unknowns of one column of nodes
  at_ = body.first_dof + column;
  if (change == MeshChange::removal) {
    removed_ = column;
    return;
  }
  added_ = column;
  const double root = plate.line_m(0).value;
  const double s = (inserted_line(plate, cell) - root) / (plate.line_m(1).value - root);
  for (int j = 0; j <= plate.n_n(); ++j)
    nodes_.push_back(
        make_node(body, plate, plate.element(0, std::max(0, j - 1)), s, j == 0 ? 0.0 : 1.0));
}

MeshMap::Node MeshMap::make_node(const Body& body, const LineGrid& plate, int e, double s,
                                 double u) const {
  // The field is a cubic along m and along n. Therefore its values at four points in each direction
  // determine it and its derivatives.
  static const Eigen::Vector4d points(0.0, 0.3, 0.7, 1.0);
  Eigen::Matrix4d vandermonde;
  for (int i = 0; i < 4; ++i)
    vandermonde.row(i) << 1, points[i], points[i] * points[i], std::pow(points[i], 3);
  const Eigen::Matrix4d inverse = vandermonde.inverse();
  const auto basis = [&](double at, double length) {
    Eigen::Matrix<double, 2, 4> out;  // weights of value and derivative at the four points
    out.row(0) = Eigen::RowVector4d(1, at, at * at, at * at * at) * inverse;
    out.row(1) = Eigen::RowVector4d(0, 1, 2 * at, 3 * at * at) * inverse / length;
    return out;
  };
  const int i = e / plate.n_n(), j = e % plate.n_n();
  Node out;
  out.along = basis(s, plate.line_m(i + 1).value - plate.line_m(i).value);
  out.across = basis(u, plate.line_n(j + 1).value - plate.line_n(j).value);
  for (const int k : plate.vectors(e)) out.dofs.push_back(body.first_dof + dim_ * k);
  ShapeTable t;
  for (int p = 0; p < 4; ++p)
    for (int r = 0; r < 4; ++r) {
      plate.at(e, points[p], points[r], Tabulate::position_rates, t);
      out.tables[static_cast<size_t>(4 * p + r)] = {t.N, t.N_t, t.N_tt};
    }
  return out;
}

MatrixXd MeshMap::rows_of(const Node& node, const VectorXd& all) const {
  MatrixXd out(static_cast<Eigen::Index>(node.dofs.size()), dim_);
  for (Eigen::Index k = 0; k < out.rows(); ++k)
    out.row(k) = all.segment(node.dofs[static_cast<size_t>(k)], dim_);
  return out;
}

MatrixXd MeshMap::sample(const Node& node, const MatrixXd& rows, size_t rates) {
  MatrixXd out = MatrixXd::Zero(4, rows.cols());
  for (int p = 0; p < 4; ++p)
    for (int r = 0; r < 4; ++r) {
      const MatrixXd& n = node.tables[static_cast<size_t>(4 * p + r)][rates];
      if (n.size() == 0) continue;
      const Eigen::RowVectorXd value = n * rows;
      out.row(0) += node.along(0, p) * node.across(0, r) * value;
      out.row(1) += node.along(1, p) * node.across(0, r) * value;
      out.row(2) += node.along(0, p) * node.across(1, r) * value;
      out.row(3) += node.along(1, p) * node.across(1, r) * value;
    }
  return out;
}

void MeshMap::add_transposed(const Node& node, const MatrixXd& fresh, size_t rates, double factor,
                             VectorXd& out) const {
  for (int p = 0; p < 4; ++p)
    for (int r = 0; r < 4; ++r) {
      const MatrixXd& n = node.tables[static_cast<size_t>(4 * p + r)][rates];
      if (n.size() == 0) continue;
      const Eigen::RowVectorXd value =
          node.across(0, r) * (node.along(0, p) * fresh.row(0) + node.along(1, p) * fresh.row(1)) +
          node.across(1, r) * (node.along(0, p) * fresh.row(2) + node.along(1, p) * fresh.row(3));
      for (size_t k = 0; k < node.dofs.size(); ++k)
        out.segment(node.dofs[k], dim_) +=
            factor * n(0, static_cast<Eigen::Index>(k)) * value.transpose();
    }
}

VectorXd MeshMap::transfer(const VectorXd& all, const std::vector<MatrixXd>& fresh) const {
  VectorXd out(n_after());
  out.head(at_) = all.head(at_);
  int to = at_;
  for (const MatrixXd& rows : fresh)
    for (int k = 0; k < per_node_; ++k, to += dim_) out.segment(to, dim_) = rows.row(k);
  const int rest = n_before_ - at_ - removed_;
  out.tail(rest) = all.tail(rest);
  return out;
}

std::vector<MatrixXd> MeshMap::taken(const VectorXd& after) const {
  std::vector<MatrixXd> out;
  int from = at_;
  for (size_t j = 0; j < nodes_.size(); ++j) {
    MatrixXd& rows = out.emplace_back(MatrixXd::Zero(4, dim_));
    for (int k = 0; k < per_node_; ++k, from += dim_) rows.row(k) = after.segment(from, dim_);
  }
  return out;
}

VectorXd MeshMap::kept(const VectorXd& after) const {
  VectorXd out = VectorXd::Zero(n_before_);
  out.head(at_) = after.head(at_);
  const int rest = n_before_ - at_ - removed_;
  out.tail(rest) = after.tail(rest);
  return out;
}

MeshMap::Vectors MeshMap::apply(const Vectors& before) const {
  std::vector<MatrixXd> q, v;
  for (const Node& node : nodes_) {
    const MatrixXd of_q = rows_of(node, before.q), of_v = rows_of(node, before.v);
    q.push_back(sample(node, of_q, 0));
    v.push_back(sample(node, of_v, 0) + sample(node, of_q, 1));
  }
  return {transfer(before.q, q), transfer(before.v, v), acceleration(before.q, before.v, before.a)};
}

VectorXd MeshMap::acceleration(const VectorXd& q, const VectorXd& v, const VectorXd& a) const {
  std::vector<MatrixXd> fresh;
  for (const Node& node : nodes_) {
    const MatrixXd flow = 2 * sample(node, rows_of(node, v), 1) + sample(node, rows_of(node, q), 2);
    fresh.push_back(sample(node, rows_of(node, a), 0) + flow);
  }
  return transfer(a, fresh);
}

MeshMap::Vectors MeshMap::apply_transposed(const Vectors& after) const {
  Vectors out{kept(after.q), kept(after.v), kept(after.a)};
  const std::vector<MatrixXd> q = taken(after.q), v = taken(after.v), a = taken(after.a);
  for (size_t j = 0; j < nodes_.size(); ++j) {
    const Node& node = nodes_[j];
    add_transposed(node, q[j], 0, 1, out.q);
    add_transposed(node, v[j], 1, 1, out.q);
    add_transposed(node, a[j], 2, 1, out.q);
    add_transposed(node, v[j], 0, 1, out.v);
    add_transposed(node, a[j], 1, 2, out.v);
    add_transposed(node, a[j], 0, 1, out.a);
  }
  return out;
}

void MeshMap::carry(State& x) const {
  Vectors after = apply({x.q, x.v, x.a});
  x.q = std::move(after.q);
  x.v = std::move(after.v);
  x.a = std::move(after.a);
}

}  // namespace flexmorph::fem
