#include "fem/dynamics/balance.h"

#include <array>
#include <cmath>

#include "fem/eulerian_lines.h"

namespace flexmorph::fem {
namespace {

/// Numbers of Gauss points on a line across one element. 7 points are exact for the strain energy
/// (degree 12). With scale factors that are constant by cells, the weights are interpolatory, which
/// is exact up to the degree n - 1 for n points.
constexpr int kUniform = 7, kDesigned = 13;

/// The power of moving material lines in the elements of one body.
class LinePowers {
 public:
  LinePowers(const Body& body, const LineGrid& plate, const State& x)
      : body_(body),
        plate_(plate),
        x_(x),
        n_(body.factors.uniform() ? kUniform : kDesigned),
        what_(plate.dim() == 3 ? Tabulate::curvature_rates : Tabulate::gradient_rates) {}

  /// Returns the power of the energy that crosses the lines along n [W]: the energy that enters the
  /// body at its ends, and the difference of the densities on both sides of a driven line inside,
  /// where bending jumps. A free line inside contributes nothing, because motion and weight are
  /// continuous there and the forces on free lines contain the strain energy.
  double inflow() {
    for (int j = 0; j <= plate_.n_n(); ++j) check_still(j);
    double out = 0;
    const int last = plate_.n_m();
    for (int i = 0; i <= last; ++i) {
      const double rate = plate_.line_m(i).rate;
      const bool inside = i > 0 && i < last;
      if (rate == 0 || (inside && plate_.lines_m()[static_cast<size_t>(i)].free)) continue;
      for (int j = 0; j < plate_.n_n(); ++j) {
        if (i > 0) out += rate * on_line(i - 1, j, 1);
        if (i < last) out -= rate * on_line(i, j, 0);
      }
    }
    return out;
  }

  /// Returns the power of driven lines of elements that also have free lines [W]. The forces on
  /// these driven lines are computed like the forces on free lines.
  double beside_eulerian_lines() {
    double out = 0;
    for (int e = 0; e < plate_.n_elements(); ++e) {
      const auto free = plate_.free_sides(e);
      if (free.empty()) continue;
      const int i = e / plate_.n_n(), j = e % plate_.n_n();
      std::array<double, kSides> rate = {plate_.line_m(i).rate, plate_.line_m(i + 1).rate,
                                         plate_.line_n(j).rate, plate_.line_n(j + 1).rate};
      bool driven = false;
      for (size_t l = 0; l < kSides; ++l) {
        if (free[l] >= 0) rate[l] = 0;
        driven |= rate[l] != 0;
      }
      if (!driven) continue;
      gather(e);
      EulerianForce force = EulerianForce::Zero(local_.q.size() + kSides);
      for (const BodyTerm& term : body_.terms)
        term.with_eulerian_lines().add_eulerian_force(e, local_, force);
      for (int l = 0; l < kSides; ++l)
        out += rate[static_cast<size_t>(l)] * force[local_.q.size() + l];
    }
    return out;
  }

 private:
  /// @throws Error (input) if the n-line j moves and is driven or an edge of the body.
  void check_still(int j) const {
    const bool outer = j == 0 || j == plate_.n_n();
    const auto sides = plate_.free_sides(plate_.element(0, std::min(j, plate_.n_n() - 1)));
    const bool free = !sides.empty() && sides[kN1] >= 0;
    if (plate_.line_n(j).rate != 0 && (outer || !free))
      throw Error::input("body '" + body_.name +
                         "': the energy balance does not support moving material lines along m "
                         "that are driven or on an edge");
  }

  void gather(int e) {
    const auto vectors = plate_.vectors(e);
    const int dim = plate_.dim();
    const auto rows = [&](const VectorXd& all, LocalRows& out) {
      out.resize(static_cast<Eigen::Index>(vectors.size()), dim);
      for (Eigen::Index k = 0; k < out.rows(); ++k)
        out.row(k) = all.segment(body_.first_dof + dim * vectors[static_cast<size_t>(k)], dim);
    };
    rows(x_.q, local_.q);
    rows(x_.v, local_.v);
    rows(x_.a, local_.a);
  }

  /// Returns the energy per length along m [J/m] at the side s = 0 or 1 of element (i, j).
  double on_line(int i, int j, double s) {
    const int e = plate_.element(i, j);
    gather(e);
    line_.resize(static_cast<size_t>(n_));
    for (size_t g = 0; g < line_.size(); ++g) plate_.at(e, s, gauss(n_).points[g], what_, line_[g]);
    energy_.set_zero(n_);
    for (const BodyTerm& term : body_.terms)
      if (term.flow) term.flow->add_line_energy(line_, local_, energy_);
    // The forces on the lines of an element with free lines are the gradient of its strain energy
    // including the limits of integration (EulerianElastic). Therefore its strain energy does not
    // flow in.
    if (!plate_.free_sides(e).empty()) energy_.stiffness.setZero();
    const double width = plate_.line_n(j + 1).value - plate_.line_n(j).value;
    const Eigen::Map<const VectorXd> weights(gauss(n_).weights.data(), n_);
    double out = weights.dot(energy_.none);
    if (body_.factors.uniform())
      out += weights.dot(energy_.stiffness) + weights.dot(energy_.mass);
    else
      out += designed(j);
    return width * out;
  }

  /// Returns the energies times the scale factors of the cells along the line, each integrated
  /// exactly. The power jumps when the line passes from one column of cells to the next; there the
  /// mean of both columns is taken. Then two steps that meet at this time have errors of half the
  /// jump with opposite signs, so that the order of the integration is preserved.
  double designed(int j) const {
    const Grid& grid = body_.factors.grid;
    const auto index = [](double at, double start, double cell, int n) {
      return std::clamp(static_cast<int>(std::floor((at - start) / cell)), 0, n - 1);
    };
    const double low = plate_.line_n(j).value, width = plate_.line_n(j + 1).value - low;
    const double x = line_[0].material[0].x();
    const double near = 1e-9 * grid.dx();
    const int before = index(x - near, grid.x0, grid.dx(), grid.nx),
              behind = index(x + near, grid.x0, grid.dx(), grid.nx);
    double out = 0;
    for (int row = 0; row < grid.ny; ++row) {
      const double from = row == 0 ? 0 : (grid.y0 + row * grid.dy() - low) / width,
                   to = row == grid.ny - 1 ? 1 : (grid.y0 + (row + 1) * grid.dy() - low) / width;
      if (to <= 0 || from >= 1) continue;
      const VectorXd weights = lagrange_integrals(n_, std::max(0.0, from), std::min(1.0, to));
      const double stiffness = weights.dot(energy_.stiffness), mass = weights.dot(energy_.mass);
      for (const int column : {before, behind}) {
        const int cell = grid.cell(column, row);
        out += 0.5 * (body_.factors.stiffness[cell] * stiffness + body_.factors.mass[cell] * mass);
      }
    }
    return out;
  }

  const Body& body_;
  const LineGrid& plate_;
  const State& x_;
  int n_;
  Tabulate what_;
  Local local_;
  std::vector<ShapeTable> line_;
  LineEnergy energy_;
};

}  // namespace

Powers powers(Workspace& model, const State& x) {
  model.prepare(x);
  Powers out;
  Constraints c;
  model.constraints(x, c);
  out.drive = x.lambda.dot(c.rate);
  out.feed = model.flow_power(x);
  out.force_elements = model.force_element_power(x) + model.load_power(x);
  out.heat = model.heat_power(x);
  out.loss = model.dissipation(x);
  for (const Body& body : model.bodies()) {
    const auto* plate = dynamic_cast<const LineGrid*>(body.element.get());
    if (!plate) continue;
    LinePowers lines(body, *plate, x);
    out.inflow += lines.inflow();
    out.feed += lines.beside_eulerian_lines();
  }
  return out;
}

}  // namespace flexmorph::fem
