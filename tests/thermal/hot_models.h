#pragma once

#include <string>

#include "fem/elements/ancf_beam.h"
#include "fem/elements/ancf_plate.h"
#include "fem/model/workspace.h"
#include "fem/terms.h"
#include "fem/thermal/heated.h"
#include "fem/thermal/temperature.h"
#include "fem/thermal/thermal_displacement.h"
#include "fem/thermal/thermal_force.h"
#include "tests/support/disturbance.h"
#include "tests/support/models.h"

/// Hot beams and plates for tests.
namespace flexmorph::testing {

/// Returns heat with α = 1, where `rise` is α ΔT with its rate.
inline fem::Heat heat_of(std::function<fem::Motion(double)> rise,
                         fem::ThermalVolume volume = fem::ThermalVolume::grown) {
  return {1, std::move(rise), volume};
}
inline fem::Heat constant_heat(double a, fem::ThermalVolume volume = fem::ThermalVolume::grown) {
  return heat_of([a](double) { return fem::Motion{a, 0, 0}; }, volume);
}

/// The free beam of T 11.1, heated by 200 K within half a second.
struct HotBeam {
  double length = 1, height = 0.1, expansion = 1e-4;
  int n = 1;
  std::string term = "gcm";
  fem::PlaneSection section{0.1, 7e8, 0.3, 7200};
  fem::TemperatureRise rise{fem::Profile::quartic, 200, 0, 0.5};
  fem::ThermalVolume volume = fem::ThermalVolume::grown;
  bool thermal_force = true;

  fem::Heat heat() const { return {expansion, fem::make_temperature(rise), volume}; }
  double mass() const { return section.density * section.thickness * height * length; }

  fem::Workspace model() const {
    const fem::PlaneSection section = disturbed(this->section);
    std::vector<std::unique_ptr<fem::Term>> terms;
    terms.push_back(fem::make_inertia(section));
    terms.push_back(fem::make_term(term, section));
    fem::Workspace out;
    fem::Body& body = out.add_body("beam", std::make_unique<fem::AncfBeam>(length, height, n),
                                   section, std::move(terms));
    fem::heat(body, heat());
    if (thermal_force)
      out.add_force_element(std::make_unique<fem::ThermalForce>(
          "thermal force", "beam", heat(), section.density * section.thickness));
    return out;
  }
};

/// Returns the unknowns of the first body as rows (n_vectors x dim).
inline MatrixXd rows_of_body(const fem::Model& model, const VectorXd& q) {
  const fem::Element& e = *model.bodies()[0].element;
  return Eigen::Map<const VectorRows>(q.data() + model.bodies()[0].first_dof, e.n_vectors(),
                                      e.dim());
}
inline VectorXd flat(const MatrixXd& rows) {
  const VectorRows by_rows = rows;
  return Eigen::Map<const VectorXd>(by_rows.data(), by_rows.size());
}

/// Returns the largest elastic strain over points of the first body of a model in the plane,
/// directly from ½ ((F/s)ᵀ(F/s) - 1).
inline double largest_strain(const fem::Model& model, const VectorXd& q, double s) {
  const fem::Element& element = *model.bodies()[0].element;
  const MatrixXd all = rows_of_body(model, q);
  fem::ShapeTable t;
  double out = 0;
  for (int e = 0; e < element.n_elements(); ++e) {
    element.tabulate(e, 8, fem::Tabulate::gradient, {}, fem::ScaleFactorKind::none, t);
    const MatrixXd local = rows_of_element(element, all, e);
    for (Eigen::Index p = 0; p < t.weight.size(); ++p) {
      const Eigen::RowVectorXd r_m = t.N_m.row(p) * local / s, r_n = t.N_n.row(p) * local / s;
      out = std::max({out, std::abs(0.5 * (r_m.squaredNorm() - 1)),
                      std::abs(0.5 * (r_n.squaredNorm() - 1)), std::abs(0.5 * r_m.dot(r_n))});
    }
  }
  return out;
}

/// Returns the angular momentum about the origin of the first body in the plane, ∫ ρb r × ṙ dA,
/// point by point.
inline double angular_momentum(const fem::Model& model, const fem::State& x) {
  const fem::Body& body = model.bodies()[0];
  const MatrixXd q = rows_of_body(model, x.q), v = rows_of_body(model, x.v);
  fem::ShapeTable t;
  double out = 0;
  for (int e = 0; e < body.element->n_elements(); ++e) {
    body.element->tabulate(e, 6, fem::Tabulate::position, {}, fem::ScaleFactorKind::none, t);
    const MatrixXd r = t.N * rows_of_element(*body.element, q, e),
                   r_t = t.N * rows_of_element(*body.element, v, e);
    for (Eigen::Index p = 0; p < t.weight.size(); ++p)
      out += body.section->density * body.section->thickness * t.weight[p] *
             (r(p, 0) * r_t(p, 1) - r(p, 1) * r_t(p, 0));
  }
  return out;
}

/// Returns heat whose stretch s rises and falls with a rate.
inline fem::Heat moving_heat() {
  return heat_of([](double t) {
    return fem::Motion{0.05 * std::sin(3 * t), 0.15 * std::cos(3 * t), -0.45 * std::sin(3 * t)};
  });
}

/// Returns a small body of three elements.
inline std::unique_ptr<fem::Element> element_in(fem::TermDomain location) {
  if (location == fem::TermDomain::beam) return std::make_unique<fem::AncfBeam>(0.6, 0.1, 3);
  return std::make_unique<fem::AncfPlate>(location == fem::TermDomain::plane ? 2 : 3, ShapeSet::h16,
                                          uniform_lines(0.1, 0.5, 3),
                                          uniform_lines(-0.02, 0.05, 1));
}

/// Returns a smooth state of all unknowns of an element away from the reference.
inline fem::Local state_of(const fem::Element& element, int e) {
  MatrixXd q = element.reference(), v = q;
  for (int k = 0; k < element.n_vectors(); ++k)
    for (int c = 0; c < element.dim(); ++c) {
      const double scale = element.scale(1) / element.scale(k);
      q(k, c) += 0.1 * scale * std::sin(3.0 * k + c);
      v(k, c) = scale * std::cos(2.0 * k + 3 * c);
    }
  const auto rows = [&](const MatrixXd& all) { return rows_of_element(element, all, e); };
  return {rows(q), rows(v), rows(0 * q)};
}

inline VectorXd force_of(const fem::Term& term, int e, const fem::Local& x) {
  fem::LocalRows f = fem::LocalRows::Zero(x.q.rows(), x.q.cols());
  term.add_force(e, x, f);
  return Eigen::Map<const VectorXd>(f.data(), f.size());
}

}  // namespace flexmorph::testing
