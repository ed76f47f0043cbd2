// Shows equilibria of supported hot bodies along a path of temperatures: a partial clamp leaves a
// beam free of stress, a full clamp tapers it over a boundary layer of known length, supported bars
// and plates push with the force of the closed form, and unsupported plates expand without stress
// on any mesh, in the plane and in space.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "fem/solve/statics.h"
#include "fem/terms.h"
#include "tests/thermal/hot_models.h"

namespace flexmorph::fem {
namespace {

using testing::rows_of_body;
using testing::ShapeSet;

const PlaneSection kStrongSection{0.1, 7e8, 0.3, 7200};

struct Equilibrium {
  Workspace model;
  State x;
  StaticResult result;
  double held = 0;  ///< Strain energy at the cold size.
};

Equilibrium solve(std::unique_ptr<Element> element, const PlaneSection& section,
                  const std::vector<std::string>& names, std::vector<Held> held, const Heat& hot,
                  StaticSettings settings = {}) {
  Equilibrium out;
  std::vector<std::unique_ptr<Term>> terms;
  for (const std::string& name : names) terms.push_back(make_term(name, section));
  Body& body = out.model.add_body("body", std::move(element), section, std::move(terms));
  heat(body, hot);
  out.model.add_joint(make_hold("hold", "body", std::move(held)));
  out.model.prepare(0.0);
  out.x = out.model.reference();
  out.held = out.model.energies(out.x).strain;
  out.result = solve_static(out.model, out.x, settings);
  return out;
}

const HoldLocation kRoot = HoldLocation::at({0, 0});

std::vector<Held> partial_clamp() {
  return {{kRoot, NodeVector::r, {0, 1}}, {kRoot, NodeVector::r_m, {1}}};
}
std::vector<Held> full_clamp() {
  return {{kRoot, NodeVector::r, {0, 1}},
          {kRoot, NodeVector::r_m, {0, 1}},
          {kRoot, NodeVector::r_n, {0, 1}}};
}

// T 3.1: supports for position and rotation of a section cause no strain.
TEST(ClampedBeam, PartiallyIsFreeOfStress) {
  for (const char* term : {"gcm", "ecm", "gcm_full", "ecm_full"})
    for (const auto path : {StaticSettings::Path::load, StaticSettings::Path::arc_length})
      for (const double a : {0.02, 0.6}) {
        StaticSettings settings;
        settings.path = path;
        auto e = solve(std::make_unique<AncfBeam>(1, 0.1, 4), kStrongSection, {term},
                       partial_clamp(), testing::constant_heat(a), settings);
        EXPECT_TRUE(e.result.completed);
        EXPECT_LT(e.model.energies(e.x).strain, 1e-20 * e.held);
        EXPECT_LT(testing::largest_strain(e.model, e.x.q, 1 + a), 1e-12 * a);
        EXPECT_LT(e.x.lambda.cwiseAbs().maxCoeff(), 1e-12 * 7e8 * 0.01 * a);
        const MatrixXd q = rows_of_body(e.model, e.x.q);
        EXPECT_NEAR(q(12, 0), 1 + a, 1e-12);
        std::cout << "  " << term << ", a = " << a << ": " << e.result.steps << " steps, "
                  << e.result.iterations << " iterations, strain "
                  << testing::largest_strain(e.model, e.x.q, 1 + a) << '\n';
      }
}

// Near the clamp r_y = (0, w(x)) with w(0) = 1. For small δ = w - s the energy is ½ ∫ (E h δ² + G
// h³/12 δ'²) (σ₁₁ = 0), so that δ decays over h √(G/(12 E)), 0.0179 m here. It is fitted from one
// to four such lengths.
TEST(ClampedBeam, FullyIsTaperedOverABoundaryLayer) {
  const double h = 0.1, a = 1e-3, length = h * std::sqrt(1 / (12 * 2 * 1.3));
  for (const char* term : {"gcm", "ecm", "gcm_full", "ecm_full"}) {
    std::vector<double> nodes;
    for (int i = 0; i < 60; ++i) nodes.push_back(length * i / 8);
    for (int i = 0; i <= 4; ++i) nodes.push_back(nodes[59] + (1 - nodes[59]) * (i + 1) / 5);
    auto e = solve(std::make_unique<AncfBeam>(nodes, h), kStrongSection, {term}, full_clamp(),
                   testing::constant_heat(a));
    const MatrixXd q = rows_of_body(e.model, e.x.q);
    EXPECT_EQ(q(2, 1), 1);
    double sx = 0, sy = 0, sxx = 0, sxy = 0, n = 0;
    for (int i = 8; i <= 32; ++i) {
      const double x = nodes[static_cast<size_t>(i)], y = std::log(1 + a - q(3 * i + 2, 1));
      sx += x;
      sy += y;
      sxx += x * x;
      sxy += x * y;
      n += 1;
    }
    const double fitted = -(n * sxx - sx * sx) / (n * sxy - sx * sy);
    std::cout << "  " << term << ": boundary layer " << fitted << " m, closed form " << length
              << " m\n";
    EXPECT_NEAR(fitted, length, 0.1 * length);
    // Far from the clamp there is no strain. Long elements begin seven lengths from the clamp,
    // where e⁻⁷ of it remains; each reduces it further.
    EXPECT_NEAR(q(3 * 64 + 2, 1), 1 + a, 1e-5 * a);
  }
}

// ε₁₁ = ½ (s⁻² - 1), S₁₁ = E ε₁₁ (the sides are free). With the volume sᵖ the force is N = sᵖ⁻² A
// S₁₁, the derivative of the energy by the length.
TEST(HeldBar, PushesWithTheForceOfTheClosedForm) {
  const double a = 0.02, s = 1 + a;
  for (const auto volume :
       {ThermalVolume::grown, ThermalVolume::grown_plane, ThermalVolume::reference})
    for (const char* term : {"gcm", "ecm", "gcm_full", "ecm_full"})
      for (const int n : {1, 3}) {
        const HoldLocation end = HoldLocation::at({0.25, 0});
        const Heat hot = testing::constant_heat(a, volume);
        auto e = solve(std::make_unique<AncfBeam>(0.25, 0.1, n), kStrongSection, {term},
                       {{kRoot, NodeVector::r, {0, 1}}, {end, NodeVector::r, {0, 1}}}, hot);
        const double strain = 0.5 * (1 / (s * s) - 1),
                     force = std::pow(s, hot.volume_exponent() - 2) * 0.01 * 7e8 * strain;
        const VectorXd pull = e.model.joint_force(0, e.x);
        const Eigen::Index last = 6 * n;  // x of the last node
        EXPECT_NEAR(pull[last], force, 1e-10 * std::abs(force));
        EXPECT_NEAR(pull[0], -force, 1e-10 * std::abs(force));
        // Across the bar: F₂₂²/s² - 1 = -ν (s⁻² - 1).
        EXPECT_NEAR(rows_of_body(e.model, e.x.q)(2, 1), s * std::sqrt(1 - 2 * 0.3 * strain), 1e-11);
      }
}

struct PlateCase {
  int dim;
  ShapeSet shapes;
  std::vector<double> m, n;
};
void PrintTo(const PlateCase& c, std::ostream* out) {
  *out << c.dim << (c.shapes == ShapeSet::h12 ? "d_h12 " : "d_h16 ") << c.m.size() - 1 << " x "
       << c.n.size() - 1;
}
class HotPlate : public ::testing::TestWithParam<PlateCase> {
 protected:
  static std::vector<MaterialLine> lines(const std::vector<double>& at) {
    std::vector<MaterialLine> out;
    for (const double x : at) out.push_back({x, {}});
    return out;
  }
  std::unique_ptr<Element> plate() const {
    const PlateCase& c = GetParam();
    return std::make_unique<AncfPlate>(c.dim, c.shapes, lines(c.m), lines(c.n));
  }
  std::vector<int> all_components() const {
    if (GetParam().dim == 3) return {0, 1, 2};
    return {0, 1};
  }
  std::vector<std::string> terms() const {
    if (GetParam().dim == 3) return {"membrane", "bending"};
    return {"membrane"};
  }
};
std::vector<PlateCase> plates() {
  std::vector<PlateCase> out;
  for (const int dim : {2, 3})
    for (const ShapeSet shapes : {ShapeSet::h12, ShapeSet::h16}) {
      out.push_back({dim, shapes, {0, 0.5}, {0, 0.3}});
      out.push_back({dim, shapes, {0, 0.1, 0.35, 0.5}, {0, 0.22, 0.3}});
      out.push_back({dim, shapes, {0, 0.05, 0.2, 0.25, 0.4, 0.5}, {0, 0.1, 0.2, 0.3}});
    }
  return out;
}
INSTANTIATE_TEST_SUITE_P(Meshes, HotPlate, ::testing::ValuesIn(plates()));

const PlaneSection kPlate{0.02, 1e9, 0.3, 1000};

TEST_P(HotPlate, GrowsWithoutStressWhereNothingHoldsIt) {
  const double a = 0.03;
  const HoldLocation along = HoldLocation::at({0.5, 0}), across = HoldLocation::at({0, 0.3});
  std::vector<Held> held = {{kRoot, NodeVector::r, all_components()}, {along, NodeVector::r, {1}}};
  if (GetParam().dim == 3) {
    held[1].components = {1, 2};
    held.push_back({across, NodeVector::r, {2}});
  }
  for (const auto volume : {ThermalVolume::grown, ThermalVolume::reference}) {
    auto e = solve(plate(), kPlate, terms(), held, testing::constant_heat(a, volume));
    EXPECT_GT(e.held, 1);
    EXPECT_LE(e.model.energies(e.x).strain, 1e-20 * e.held);
    const Element& element = *e.model.bodies()[0].element;
    const MatrixXd q = rows_of_body(e.model, e.x.q), X = element.reference();
    for (int k = 0; k < element.n_vectors(); ++k)
      EXPECT_LT(element.scale(k) * (q.row(k) - (1 + a) * X.row(k)).norm(), 1e-10) << k;
  }
}

// With F = 1 the stress is S = E/(1 - ν) ½ (s⁻² - 1) in all directions, and the force on an edge of
// width w is sᵖ⁻² h w S.
TEST_P(HotPlate, HeldAtAllEdgesIsPressedFromAllSides) {
  const double a = 0.03, s = 1 + a;
  std::vector<Held> held;
  for (const char* edge : {"root", "free_end", "side_low", "side_high"}) {
    held.push_back({{edge}, NodeVector::r, all_components()});
    const bool along_m = std::string(edge).starts_with("side");
    held.push_back({{edge}, along_m ? NodeVector::r_m : NodeVector::r_n, all_components()});
  }
  const Heat hot = testing::constant_heat(a);
  auto e = solve(plate(), kPlate, terms(), held, hot);
  const double stress = 1e9 / 0.7 * 0.5 * (1 / (s * s) - 1);
  const VectorXd force = e.model.joint_force(0, e.x);
  for (const auto& [edge, width, component] :
       {std::tuple{"free_end", 0.3, 0}, {"side_high", 0.5, 1}}) {
    double sum = 0;
    for (const NodeVectors& node : e.model.bodies()[0].element->edge(edge))
      sum += force[GetParam().dim * node.r + component];
    EXPECT_NEAR(sum, s * 0.02 * width * stress, 1e-10 * std::abs(sum));
  }
  EXPECT_NEAR(e.model.energies(e.x).strain, s * s * s * 0.15 * 0.02 * 0.7 / 1e9 * stress * stress,
              1e-9 * e.held);
}

}  // namespace
}  // namespace flexmorph::fem
