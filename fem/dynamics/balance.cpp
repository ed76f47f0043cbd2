#include "fem/dynamics/balance.h"

#include <cmath>

namespace flexmorph::fem {
namespace {

/// Energy per reference area at a point of the root line, times the factors of the cell that lies
/// outside of it [J/m²].
double energy_density(const Body& body, const State& x, int e, double u, const VectorXd& gravity) {
  const LineGrid& plate = grid_of(body);
  ShapeTable t;
  plate.at(e, 0, u, Tabulate::gradient_rates, t);
  const auto vectors = plate.vectors(e);
  MatrixXd q(t.N.cols(), plate.dim()), v(t.N.cols(), plate.dim());
  for (Eigen::Index k = 0; k < q.rows(); ++k) {
    const int at = body.first_dof + plate.dim() * vectors[static_cast<size_t>(k)];
    q.row(k) = x.q.segment(at, plate.dim());
    v.row(k) = x.v.segment(at, plate.dim());
  }
  const Eigen::RowVectorXd r_m = t.N_m * q, r_n = t.N_n * q, velocity = t.N * v + t.N_t * q;
  const Vec3 strain(0.5 * (r_m.squaredNorm() - 1), 0.5 * (r_n.squaredNorm() - 1), r_m.dot(r_n));
  double stiffness = 1, mass = 1;
  if (!body.factors.uniform()) {
    const Grid& g = body.factors.grid;
    const auto index = [](double at, double start, double cell, int n) {
      return std::clamp(static_cast<int>(std::floor((at - start) / cell + 1e-9)), 0, n - 1);
    };
    const int cell = g.cell(index(t.material[0].x(), g.x0, g.dx(), g.nx),
                            index(t.material[0].y(), g.y0, g.dy(), g.ny));
    stiffness = body.factors.stiffness[cell];
    mass = body.factors.mass[cell];
  }
  const PlaneSection& s = body.section;
  double out = 0.5 * stiffness * s.thickness * strain.dot(s.elasticity() * strain) +
               0.5 * mass * s.thickness * s.density * velocity.squaredNorm();
  if (gravity.size() > 0) out -= mass * s.thickness * s.density * (t.N * q * gravity)(0);
  return out;
}

}  // namespace

Powers powers(const Model& model, std::span<const Growth> growths, const State& x,
              const VectorXd& gravity) {
  Powers out;
  Constraints c;
  model.constraints(x, c);
  out.drive = x.lambda.dot(c.rate);
  out.feed = model.flow_power(x);
  for (const Growth& growth : growths) {
    const Body& body = model.body(growth.body);
    const LineGrid& plate = grid_of(body);
    const double rate = plate.line_m(0).rate;
    if (rate == 0) continue;
    // Strain energy along the edge is of degree 12; a stepwise factor needs more points.
    const GaussRule& rule = gauss(body.factors.uniform() ? 7 : 16);
    for (int j = 0; j < plate.n_n(); ++j) {
      const double width = plate.line_n(j + 1).value - plate.line_n(j).value;
      for (size_t g = 0; g < rule.points.size(); ++g)
        out.inflow -= rate * width * rule.weights[g] *
                      energy_density(body, x, plate.element(0, j), rule.points[g], gravity);
    }
  }
  return out;
}

}  // namespace flexmorph::fem
