#include "cases/results/body_measures.h"

#include <cmath>

#include "fem/dynamics/mesh_changes/moving_root.h"

namespace flexmorph::cases {
namespace {

constexpr int kDegree = 8;  // degree of the quadrature for strains: 5 Gauss points per direction

Vec2 location(const fem::Body& body, const fem::State& x, const Vec2& material) {
  return fem::point_position(body, x, material).head<2>();
}

/// Returns the signed distance of b from the line from a to c; it is positive on the left [m].
double left_of(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 along = (c - a).normalized(), d = b - a;
  return along.x() * d.y() - along.y() * d.x();
}

std::vector<fem::ShapeTable> gauss_points(const fem::Body& body) {
  std::vector<fem::ShapeTable> out(static_cast<size_t>(body.element->n_elements()));
  for (int e = 0; e < body.element->n_elements(); ++e)
    body.element->tabulate(e, kDegree, fem::Tabulate::gradient, {}, fem::ScaleFactorKind::none,
                           out[static_cast<size_t>(e)]);
  return out;
}

/// Returns the largest absolute entry of the strain (FᵀF/s² - 1)/2 at the Gauss points.
/// @param s  stretch that is removed from the deformation gradient F
double largest_strain(const fem::Body& body, const fem::State& x, double s,
                      const std::vector<fem::ShapeTable>& tables) {
  const fem::VectorRows unknowns = fem::rows_of(body, x.q) / s;
  double largest = 0;
  for (int e = 0; e < body.element->n_elements(); ++e) {
    const fem::ShapeTable& t = tables[static_cast<size_t>(e)];
    const MatrixXd q = unknowns(body.element->vectors(e), Eigen::all);
    const MatrixXd r_x = t.N_m * q, r_y = t.N_n * q;  // one row per Gauss point
    for (Eigen::Index g = 0; g < r_x.rows(); ++g)
      for (const double strain :
           {0.5 * (r_x.row(g).squaredNorm() - 1), 0.5 * (r_y.row(g).squaredNorm() - 1),
            0.5 * r_x.row(g).dot(r_y.row(g))})
        largest = std::max(largest, std::abs(strain));
  }
  return largest;
}

/// Returns the centre of mass X_c of the undeformed body [m] and ∫ ρ |X - X_c|² dV [kg m²].
std::pair<Vec2, double> second_moment(const fem::Body& body,
                                      const std::vector<fem::ShapeTable>& tables) {
  const MatrixXd reference = body.element->reference();
  const double per_area = body.section->density * body.section->thickness;
  double mass = 0, square = 0;
  Vec2 first(0, 0);
  for (int e = 0; e < body.element->n_elements(); ++e) {
    const auto vectors = body.element->vectors(e);
    const fem::ShapeTable& t = tables[static_cast<size_t>(e)];
    for (Eigen::Index g = 0; g < t.weight.size(); ++g) {
      Vec2 X(0, 0);
      for (size_t k = 0; k < vectors.size(); ++k)
        X += t.N(g, static_cast<Eigen::Index>(k)) * reference.row(vectors[k]).head<2>().transpose();
      const double m = per_area * t.weight[g];
      mass += m;
      first += m * X;
      square += m * X.squaredNorm();
    }
  }
  const Vec2 center = first / mass;
  return {center, square - mass * center.squaredNorm()};
}

}  // namespace

std::vector<ColumnInfo> BodyMeasures::columns(const Scene& scene) {
  std::vector<ColumnInfo> out;
  for (const MeasureRequest& measure : scene.measures)
    for (const std::string& quantity : measure.quantities)
      for (const MeasuredColumn& c : columns_of_quantity(quantity))
        out.push_back({measure.body + "." + c.name, c.unit, c.meaning, ColumnGroup::measured});
  return out;
}

BodyMeasures::BodyMeasures(const Scene& scene, const fem::Model& model, const fem::State& start) {
  for (const MeasureRequest& measure : scene.measures) {
    const Body& body = scene.body(measure.body);
    Measured m;
    m.measure = &measure;
    while (model.bodies()[m.body].name != body.name) ++m.body;
    const fem::Body& built = model.bodies()[m.body];
    const double y = body.low() + 0.5 * body.width;
    m.material = {Vec2(0, y), Vec2(0.5 * body.length, y), Vec2(body.length, y)};
    for (size_t i = 0; i < 3; ++i) m.start[i] = location(built, start, m.material[i]);
    m.sag = left_of(m.start[0], m.start[1], m.start[2]);
    const auto asks = [&](const char* quantity) {
      return std::find(measure.quantities.begin(), measure.quantities.end(), quantity) !=
             measure.quantities.end();
    };
    if (asks("max_elastic_strain") || asks("free_expansion")) m.tables = gauss_points(built);
    if (asks("free_expansion")) {
      const auto [center, polar] = second_moment(built, m.tables);
      m.arm = location(built, model.reference(), m.material[2]) - center;
      m.polar = polar;
    }
    bodies_.push_back(std::move(m));
  }
}

namespace {

/// A state of a measured body: its temperature rise, and the elongation αΔT that it causes.
struct HeatedState {
  const fem::Body& body;
  const fem::State& x;
  double rise, elongation;
};

/// Appends the values of a quantity to a row. The quantity free_expansion is appended elsewhere.
void append_quantity(const BodyMeasures::Measured& m, const std::string& quantity,
                     const HeatedState& at, std::vector<double>& row) {
  const fem::Body& body = at.body;
  const fem::State& x = at.x;
  if (quantity == "temperature") {
    row.push_back(at.rise);
  } else if (quantity == "max_elastic_strain") {
    row.push_back(largest_strain(body, x, 1 + at.elongation, m.tables));
  } else if (quantity == "midpoint_deflection") {
    row.push_back(left_of(location(body, x, m.material[0]), location(body, x, m.material[1]),
                          location(body, x, m.material[2])) -
                  m.sag);
  } else if (quantity == "end_displacements") {
    for (const size_t i : {0, 2}) {
      const Vec2 u = location(body, x, m.material[i]) - m.start[i];
      row.insert(row.end(), {u.x(), u.y()});
    }
  } else if (quantity == "end_velocity") {
    const Vec2 v = fem::point_motion(body, x, m.material[2]).velocity;
    row.insert(row.end(), {v.x(), v.y()});
  } else if (quantity == "end_slopes") {
    fem::ShapeTable t;
    const int e = body.element->locate(m.material[2], fem::Tabulate::gradient, t);
    const MatrixXd q = fem::rows_of(body, x.q)(body.element->vectors(e), Eigen::all);
    row.insert(row.end(), {(t.N_m * q).norm(), (t.N_n * q).norm()});
  }
}

}  // namespace

void BodyMeasures::append(const fem::Model& model, const fem::State& x, double heating,
                          std::vector<double>& row) const {
  const size_t first = row.size();
  for (const Measured& m : bodies_) {
    const fem::Body& body = model.bodies()[m.body];
    const fem::Motion rise = body.heat ? body.heat->temperature(x.t) : fem::Motion{0, 0, 0};
    const double elongation = body.heat ? body.heat->expansion * heating * rise.value : 0;
    for (const std::string& quantity : m.measure->quantities) {
      append_quantity(m, quantity, {body, x, heating * rise.value, elongation}, row);
      if (quantity != "free_expansion") continue;
      const double rate = body.heat->expansion * rise.rate;
      row.insert(row.end(),
                 {elongation * m.arm.x(), elongation * m.arm.y(), 0.5 * rate * rate * m.polar});
    }
  }
  for (size_t i = first; i < row.size(); ++i) row[i] += 0.0;  // converts -0 to 0
}

}  // namespace flexmorph::cases
