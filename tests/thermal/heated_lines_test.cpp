// Shows that the forces of heat on free material lines are the gradient of the hot energy, that a
// path may scale the temperature, and that unsuitable terms are refused.
#include <gtest/gtest.h>

#include <cmath>

#include "fem/model/body_term.h"
#include "fem/terms.h"
#include "tests/support/differences.h"
#include "tests/support/errors.h"
#include "tests/support/sections.h"
#include "tests/thermal/hot_models.h"

namespace flexmorph::fem {
namespace {

using testing::error_of;
using testing::first_difference;
using testing::mentions;
using testing::ShapeSet;

// All lines of the element are free. Force and tangent must be derivatives of the energy by
// unknowns and by lines, and the power of heat must be the rate at fixed unknowns.
class HeatedLines : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Terms, HeatedLines, ::testing::Values("membrane", "bending"));

TEST_P(HeatedLines, ForcesAreTheGradientOfTheHotEnergy) {
  const auto lines = [](double from, double to) {
    return std::vector<MaterialLine>{{from, {}, true}, {to, {}, true}};
  };
  AncfPlate plate(3, ShapeSet::h16, lines(0.1, 0.18), lines(-0.02, 0.05));
  const BodyTerm term(make_heated(make_term(GetParam(), kThickSection), testing::moving_heat()));
  const VectorRows rest = testing::random_shape(plate, 0.2, 5);
  const Eigen::Index n = rest.size() + 4;
  VectorXd all(n);
  all << Eigen::Map<const VectorXd>(rest.data(), rest.size()), 0.1, 0.18, -0.02, 0.05;
  const auto local = [&](const VectorXd& y) {
    plate.move_lines(y.tail(4), VectorXd::Zero(4), VectorXd::Zero(4));
    term->prepare(plate, {}, true);
    const LocalRows q = testing::rows_of_element(
        plate, Eigen::Map<const VectorRows>(y.data(), rest.rows(), rest.cols()), 0);
    return Local{q, 0 * q, 0 * q};
  };
  term.heated->heat_to(0.4);
  const auto energy = [&](const VectorXd& y) {
    const Local x = local(y);
    return term->strain_energy(0, x);
  };
  const auto force = [&](const VectorXd& y) {
    const Local x = local(y);
    EulerianForce f = EulerianForce::Zero(n);
    term.with_eulerian_lines().add_eulerian_force(0, x, f);
    return VectorXd(f);
  };
  // Indices of the unknowns of the element among all unknowns.
  std::vector<Eigen::Index> location;
  for (const int k : plate.vectors(0))
    for (int c = 0; c < 3; ++c) location.push_back(3 * k + c);
  for (int l = 0; l < 4; ++l)
    location.push_back(rest.size() + plate.free_sides(0)[static_cast<size_t>(l)]);
  EulerianTangent exact = EulerianTangent::Zero(n, n);
  const Local x = local(all);
  term.with_eulerian_lines().add_eulerian_tangent(0, x, {1, 0, 0}, exact);
  const VectorXd f = force(all);
  VectorXd unit(n);  // a displacement of 1e-5 m
  for (Eigen::Index k = 0; k < n; ++k)
    unit[k] =
        k < rest.size() ? 2e-5 / plate.scale(plate.vectors(0)[static_cast<size_t>(k / 3)]) : 2e-5;
  MatrixXd scaled(n, n), difference(n, n);
  VectorXd gradient(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto at = [&](double h) {
      VectorXd y = all;
      y[location[static_cast<size_t>(k)]] += h * unit[k];
      return y;
    };
    gradient[k] = first_difference([&](double h) { return energy(at(h)); }, 1.0);
    const VectorXd df = first_difference([&](double h) { return force(at(h)); }, 1.0);
    for (Eigen::Index i = 0; i < n; ++i) {
      scaled(i, k) = exact(i, k) * unit[k] * unit[i];
      difference(i, k) = df[i] * unit[i];
    }
  }
  const VectorXd scaled_force = f.cwiseProduct(unit);
  EXPECT_LT((scaled_force - gradient).cwiseAbs().maxCoeff(),
            1e-8 * scaled_force.cwiseAbs().maxCoeff());
  EXPECT_LT((scaled_force - gradient).tail(4).cwiseAbs().maxCoeff(),
            1e-7 * scaled_force.tail(4).cwiseAbs().maxCoeff());
  for (const auto& [rows, columns] :
       {std::pair{n - 4, n - 4}, std::pair{n - 4, Eigen::Index{4}},
        std::pair{Eigen::Index{4}, n - 4}, std::pair{Eigen::Index{4}, Eigen::Index{4}}}) {
    const auto block = [&](const MatrixXd& m) {
      return MatrixXd(m.block(rows == 4 ? n - 4 : 0, columns == 4 ? n - 4 : 0, rows, columns));
    };
    EXPECT_LT((block(scaled) - block(difference)).cwiseAbs().maxCoeff(),
              1e-6 * block(scaled).cwiseAbs().maxCoeff());
  }
  const Local again = local(all);
  const double rate = first_difference(
      [&](double dt) {
        term.heated->heat_to(0.4 + dt);
        return term->strain_energy(0, again);
      },
      1e-3);
  term.heated->heat_to(0.4);
  EXPECT_NEAR(term.heated->heat_power(0, again), rate, 1e-8 * std::abs(rate));
}

// A path of equilibria may have the temperature as its factor.
TEST(Heated, ScalesItsTemperature) {
  AncfBeam beam(1, 0.1, 1);
  const auto hot = [&](double a) {
    BodyTerm term(make_heated(make_beam_gcm(kThickSection), testing::constant_heat(a)));
    term->prepare(beam, {}, true);
    term.heated->heat_to(0);
    return term;
  };
  const LocalRows q = testing::rows_of_element(beam, beam.reference(), 0);
  const Local x{q, 0 * q, 0 * q};
  const auto half = hot(0.04), all = hot(0.02);
  half.scaled->scale_load(0.5);
  EXPECT_EQ(half->strain_energy(0, x), all->strain_energy(0, x));
  EXPECT_GT(all->strain_energy(0, x), 0);
  all.scaled->scale_load(0);
  EXPECT_EQ(all->strain_energy(0, x), 0);
}

TEST(Heated, RefusesWhatItCannotHeat) {
  using Kind = Error::Kind;
  const Heat good = testing::constant_heat(0.01);
  EXPECT_TRUE(mentions(
      error_of(Kind::input, [&] { make_heated(make_inertia(kThickSection), good); }), "'inertia'"));
  EXPECT_TRUE(mentions(error_of(Kind::input,
                                [&] {
                                  make_heated(make_beam_gcm(kThickSection), Heat{1, {}});
                                }),
                       "temperature"));
  Heat endless = good;
  endless.expansion = std::nan("");
  EXPECT_TRUE(
      mentions(error_of(Kind::input, [&] { make_heated(make_beam_gcm(kThickSection), endless); }),
               "finite"));
  for (const double a : {-1.0, -2.0, std::nan("")}) {
    const BodyTerm term(make_heated(make_beam_gcm(kThickSection), testing::constant_heat(a)));
    EXPECT_TRUE(
        mentions(error_of(Kind::numerical, [&] { term.heated->heat_to(0.25); }), "t = 0.25"));
  }
  const auto body_of = [](std::unique_ptr<Element> element, std::unique_ptr<Term> term) {
    Body body;
    body.name = "arm";
    body.element = std::move(element);
    body.terms.push_back(std::move(term));
    return body;
  };
  Body no_strain = body_of(std::make_unique<AncfBeam>(1, 0.1, 1), make_inertia(kThickSection));
  const std::string unstrained = error_of(Kind::input, [&] { heat(no_strain, good); });
  EXPECT_TRUE(mentions(unstrained, "'arm'") && mentions(unstrained, "elastic")) << unstrained;
  Body body = body_of(std::make_unique<AncfBeam>(1, 0.1, 1), make_beam_ecm(kThickSection));
  heat(body, good);
  EXPECT_TRUE(body.heat.has_value());
  EXPECT_EQ(body.terms[0]->name(), "ecm");
  const std::string twice = error_of(Kind::input, [&] { heat(body, good); });
  EXPECT_TRUE(mentions(twice, "'arm'") && mentions(twice, "already")) << twice;
}

}  // namespace
}  // namespace flexmorph::fem
