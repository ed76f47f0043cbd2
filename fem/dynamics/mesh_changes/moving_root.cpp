#include "fem/dynamics/mesh_changes/moving_root.h"

#include <cmath>
#include <limits>

namespace flexmorph::fem {

const LineGrid& grid_of(const Body& body) {
  const auto* lines = dynamic_cast<const LineGrid*>(body.element.get());
  if (!lines) throw Error::input("body '" + body.name + "' has no material lines that can move");
  return *lines;
}

VectorRows rows_of(const Body& body, const VectorXd& all) {
  return Eigen::Map<const VectorRows>(all.data() + body.first_dof, body.element->n_vectors(),
                                      body.element->dim());
}

namespace {

/// Returns the entries of the unknowns of element e, one vector unknown per row.
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

NextChange next_change(const Body& body, const MovingRoot& growth, double t, double end,
                       double step) {
  const LineGrid& plate = grid_of(body);
  const MaterialLine &root = plate.lines_m()[0], &first = plate.lines_m()[1];
  const NextChange never{std::numeric_limits<double>::infinity(), MeshChange::insertion};
  if (!root.drive || std::isinf(growth.max_length)) return never;
  const auto length = [&](double at) {
    return (first.drive ? first.drive(at).value : first.value) - root.drive(at).value;
  };
  const bool may_merge =
      plate.n_m() > 1 && !first.drive &&
      growth.min_length + plate.lines_m()[2].value - first.value < growth.merged_below();
  // Positive after the limit was passed.
  const auto passed = [&](double at) {
    const double above = length(at) - growth.max_length;
    return may_merge ? std::max(above, growth.min_length - length(at)) : above;
  };
  // A limit that is reached to within this length counts as reached.
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

std::optional<MeshChange> change_due(const Body& body, const MovingRoot& growth) {
  const LineGrid& plate = grid_of(body);
  if (growth.line != 0 || !plate.lines_m()[0].free) return {};
  const double length = plate.line_m(1).value - plate.line_m(0).value;
  if (length > growth.max_length) return MeshChange::insertion;
  const bool may_merge = plate.n_m() > 1 && !plate.lines_m()[1].free && !plate.lines_m()[1].drive &&
                         plate.line_m(2).value - plate.line_m(0).value < growth.merged_below();
  if (length < growth.min_length && may_merge) return MeshChange::removal;
  return {};
}

MeshMap change_mesh(Workspace& model, Body& body, MeshChange change, State& x, double cell) {
  model.prepare(x);
  MeshMap map(body, change, model.n_dofs(), cell);
  const LineGrid& old = grid_of(body);
  std::unique_ptr<LineGrid> next = change == MeshChange::insertion
                                       ? old.with_line(0, inserted_line(old, cell))
                                       : old.without_line(1);
  model.set_element(body, std::move(next));
  map.carry(x);
  model.prepare(x);
  return map;
}

}  // namespace flexmorph::fem
