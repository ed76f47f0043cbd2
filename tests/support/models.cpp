#include "tests/support/models.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "fem/loads.h"
#include "fem/terms.h"
#include "tests/support/disturbance.h"

namespace flexmorph::testing {

using fem::MaterialLine;
using fem::Motion;

std::vector<MaterialLine> uniform_lines(double from, double to, int n) {
  std::vector<MaterialLine> out;
  for (int i = 0; i <= n; ++i) out.push_back({from + (to - from) * i / n, {}});
  return out;
}

MaterialLine swinging_line(double value, double amplitude, double angular_frequency) {
  return {value, [=](double t) {
            return Motion{value + amplitude * std::sin(angular_frequency * t),
                          amplitude * angular_frequency * std::cos(angular_frequency * t),
                          -amplitude * angular_frequency * angular_frequency *
                              std::sin(angular_frequency * t)};
          }};
}

AncfPlate swinging_plate(ShapeSet shapes, double t) {
  return {2,
          shapes,
          {swinging_line(0.1, 0.03, 2.1), {0.21, {}}, swinging_line(0.3, 0.02, 1.3), {0.45, {}}},
          {{-0.05, {}}, swinging_line(0.01, 0.02, 1.7), {0.07, {}}},
          t};
}

fem::ScaleFactors random_factors(unsigned seed) {
  fem::ScaleFactors out;
  out.grid = {0.02, -0.05, 0.43, 0.12, 11, 5};
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> factor(0.1, 1.0);
  out.stiffness.resize(out.grid.n_cells());
  out.mass.resize(out.grid.n_cells());
  for (int c = 0; c < out.grid.n_cells(); ++c) {
    out.stiffness[c] = factor(random);
    out.mass[c] = factor(random);
  }
  return out;
}

double integrate(const AncfPlate& plate, int e, const fem::ScaleFactors& factors,
                 fem::ScaleFactorKind kind, fem::Tabulate what,
                 const std::function<double(const fem::ShapeTable&)>& f) {
  const int i = e / plate.n_n(), j = e % plate.n_n();
  const double m1 = plate.line_m(i).value, m2 = plate.line_m(i + 1).value;
  const double n1 = plate.line_n(j).value, n2 = plate.line_n(j + 1).value;
  // Every cell line inside the element divides it into rectangles that are integrated separately.
  std::vector<double> cuts_m = {m1, m2}, cuts_n = {n1, n2};
  const bool weighted = kind != fem::ScaleFactorKind::none && !factors.uniform();
  const Grid& g = factors.grid;
  if (weighted) {
    for (int c = 0; c <= g.nx; ++c)
      if (const double x = g.x0 + c * g.dx(); x > m1 && x < m2) cuts_m.push_back(x);
    for (int c = 0; c <= g.ny; ++c)
      if (const double y = g.y0 + c * g.dy(); y > n1 && y < n2) cuts_n.push_back(y);
    std::sort(cuts_m.begin(), cuts_m.end());
    std::sort(cuts_n.begin(), cuts_n.end());
  }
  const auto cell = [](double at, double start, double size, int n) {
    return std::clamp(static_cast<int>(std::floor((at - start) / size)), 0, n - 1);
  };
  const fem::GaussRule& rule = fem::gauss(7);
  fem::ShapeTable t;
  double sum = 0;
  for (size_t a = 0; a + 1 < cuts_m.size(); ++a)
    for (size_t b = 0; b + 1 < cuts_n.size(); ++b) {
      const double dm = cuts_m[a + 1] - cuts_m[a], dn = cuts_n[b + 1] - cuts_n[b];
      double factor = 1;
      if (weighted) {
        const int c = g.cell(cell(cuts_m[a] + dm / 2, g.x0, g.dx(), g.nx),
                             cell(cuts_n[b] + dn / 2, g.y0, g.dy(), g.ny));
        factor = (kind == fem::ScaleFactorKind::mass ? factors.mass : factors.stiffness)[c];
      }
      for (size_t p = 0; p < 7; ++p)
        for (size_t r = 0; r < 7; ++r) {
          plate.at(e, (cuts_m[a] + dm * rule.points[p] - m1) / (m2 - m1),
                   (cuts_n[b] + dn * rule.points[r] - n1) / (n2 - n1), what, t);
          sum += factor * dm * dn * rule.weights[p] * rule.weights[r] * f(t);
        }
    }
  return sum;
}

MatrixXd random_shape(const AncfPlate& plate, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> part(-size, size);
  MatrixXd q = plate.reference();
  const double length = plate.scale(1);
  for (int k = 0; k < plate.n_vectors(); ++k)
    for (int c = 0; c < plate.dim(); ++c) q(k, c) += part(random) * length / plate.scale(k);
  return q;
}

SmoothMotion::SmoothMotion(VectorXd mean, const VectorXd& scale, unsigned seed)
    : mean_(std::move(mean)) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> part(-1, 1);
  const auto draw = [&](double low, double high) {
    VectorXd out(mean_.size());
    for (double& x : out) x = low + (high - low) * 0.5 * (1 + part(random));
    return out;
  };
  amplitude_ = draw(-0.2, 0.2).cwiseProduct(scale);
  angular_frequency_ = draw(1, 3);
  phase_ = draw(0, 6);
}

VectorXd SmoothMotion::wave(double t, int derivative) const {
  VectorXd out(mean_.size());
  for (Eigen::Index i = 0; i < out.size(); ++i)
    out[i] = amplitude_[i] * std::pow(angular_frequency_[i], derivative) *
             std::sin(angular_frequency_[i] * t + phase_[i] + derivative * std::numbers::pi / 2);
  return out;
}

VectorXd SmoothMotion::q(double t) const { return mean_ + wave(t, 0); }
VectorXd SmoothMotion::v(double t) const { return wave(t, 1); }
VectorXd SmoothMotion::a(double t) const { return wave(t, 2); }

fem::State SmoothMotion::state(double t) const {
  fem::State x;
  x.t = t;
  x.q = q(t);
  x.v = v(t);
  x.a = a(t);
  return x;
}

fem::LocalRows rows_of_element(const fem::Element& element, const MatrixXd& all, int e) {
  const auto vectors = element.vectors(e);
  fem::LocalRows out(static_cast<Eigen::Index>(vectors.size()), element.dim());
  for (size_t k = 0; k < vectors.size(); ++k)
    out.row(static_cast<Eigen::Index>(k)) = all.row(vectors[k]);
  return out;
}

Scene make_scene(const RotatingPlate& p) {
  const double root = p.whole() - p.length;
  std::vector<MaterialLine> m = uniform_lines(root, p.whole(), p.nx);
  if (p.speed != 0)
    m[0].drive = [root, speed = p.speed](double t) { return Motion{root - speed * t, -speed, 0}; };
  const fem::PlaneSection section = disturbed(p.section);
  std::vector<std::unique_ptr<fem::Term>> terms;
  terms.push_back(fem::make_inertia(section));
  terms.push_back(fem::make_membrane(section));
  if (p.tip_mass > 0) terms.push_back(fem::make_point_mass(p.tip_mass, p.tip(), p.gravity));
  if (p.gravity.size() > 0) terms.push_back(fem::make_gravity(section, p.gravity));

  Scene scene;
  fem::Body& body = scene.model.add_body(
      "plate",
      std::make_unique<AncfPlate>(2, p.shapes, std::move(m),
                                  uniform_lines(-p.width() / 2, p.width() / 2, p.ny)),
      section, std::move(terms));
  const fem::FrameDrive hub = [omega = p.omega](double t) {
    fem::FrameMotion frame;
    frame.angle = omega * t;
    frame.angle_rate = omega;
    return frame;
  };
  scene.model.add_joint(fem::make_weld("root", "plate", "root", hub, p.weld));
  if (!p.factors.uniform()) scene.model.set_factors(body, p.factors);
  // P 4.2: 0.1 and 0.05 m for 0.05 m elements. With a smaller lower limit, splitting and merging do
  // not alternate.
  const double size = p.length / p.nx;
  if (p.shapes == ShapeSet::q4)
    scene.moving_roots.push_back({"plate", hub, 1.3 * size, 0.25 * size, 0, 0, size});
  else
    scene.moving_roots.push_back({"plate", hub, 2 * size, 0.6 * size});
  return scene;
}

Vec2 in_hub(const RotatingPlate& p, const fem::Model& model, const fem::State& x,
            const Vec2& material) {
  const Vec2 r = fem::point_motion(model.body("plate"), x, material).position;
  const double c = std::cos(p.omega * x.t), s = std::sin(p.omega * x.t);
  return {c * r.x() + s * r.y(), -s * r.x() + c * r.y()};
}

fem::ScaleFactors chequered(const RotatingPlate& p) {
  fem::ScaleFactors out;
  out.grid = {
      0, -p.width() / 2, p.whole(), p.width(), static_cast<int>(std::lround(p.whole() / 0.0025)),
      40};
  out.stiffness.resize(out.grid.n_cells());
  for (int i = 0; i < out.grid.nx; ++i)
    for (int j = 0; j < out.grid.ny; ++j)
      out.stiffness[out.grid.cell(i, j)] = (i / 6 + j / 6) % 2 ? 1 : 0.3;
  out.mass = out.stiffness;
  return out;
}

}  // namespace flexmorph::testing
