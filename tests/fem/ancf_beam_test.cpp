// Shows that the shape functions of the beam are those of paper T and integrate to the matrices
// printed there, against exact rational integrals: (A.3), (A.4), (A.5), (A.7), (A.10), (32), (35),
// (36). Shows also that a curved, tapered or sheared reference configuration has the right area,
// inertia and gradients.
#include "fem/elements/ancf_beam.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>

#include "fem/loads.h"
#include "fem/terms.h"
#include "tests/support/crooked_beam.h"
#include "tests/support/differences.h"
#include "tests/support/errors.h"
#include "tests/support/fractions.h"
#include "tests/support/rates.h"
#include "tests/support/sections.h"

namespace flexmorph::fem {
namespace {

using testing::error_of;
using testing::Fraction;
using testing::mentions;
using testing::Polynomial;

constexpr double kLength = 0.7, kHeight = 0.2;

/// A shape function is lᵃ hᵇ times a polynomial in ξ = x/l and ζ = y/h.
struct Shape {
  Polynomial p;
  int l = 0, h = 0;
};
const std::array<Shape, 6>& paper_shapes() {
  static const std::array<Shape, 6> shapes = {
      Shape{{{{{0, 0}, 1}, {{2, 0}, -3}, {{3, 0}, 2}}}, 0, 0},
      Shape{{{{{1, 0}, 1}, {{2, 0}, -2}, {{3, 0}, 1}}}, 1, 0},
      Shape{{{{{0, 1}, 1}, {{1, 1}, -1}}}, 0, 1},
      Shape{{{{{2, 0}, 3}, {{3, 0}, -2}}}, 0, 0},
      Shape{{{{{2, 0}, -1}, {{3, 0}, 1}}}, 1, 0},
      Shape{{{{{1, 1}, 1}}}, 0, 1}};
  return shapes;
}
/// Returns S_rd = S - S(x_o) for x_o = 0, where s₁ = 1 and all other shape functions are zero.
std::array<Shape, 6> relative_shapes() {
  std::array<Shape, 6> out = paper_shapes();
  out[0].p = out[0].p - Polynomial{{{{0, 0}, 1}}};
  return out;
}

using Fractions = std::array<std::array<Fraction, 6>, 6>;
Fractions products(const std::array<Shape, 6>& s) {
  Fractions out;
  for (size_t i = 0; i < 6; ++i)
    for (size_t j = 0; j < 6; ++j) out[i][j] = (s[i].p * s[j].p).integral();
  return out;
}
/// Returns the matrix multiplied by the powers of l and h that its entries belong to.
MatrixXd with_lengths(const Fractions& x, double sign = 1) {
  MatrixXd out(6, 6);
  for (size_t i = 0; i < 6; ++i)
    for (size_t j = 0; j < 6; ++j)
      out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          x[i][j].value() * std::pow(kLength, sign * (paper_shapes()[i].l + paper_shapes()[j].l)) *
          std::pow(kHeight, sign * (paper_shapes()[i].h + paper_shapes()[j].h));
  return out;
}
/// Returns the symmetric matrix with the given upper triangle.
Fractions symmetric(std::initializer_list<Fraction> rows) {
  Fractions out;
  auto at = rows.begin();
  for (size_t i = 0; i < 6; ++i)
    for (size_t j = i; j < 6; ++j) out[i][j] = out[j][i] = *at++;
  return out;
}

/// Returns the printed mass matrix (A.3) of T divided by m, without powers of l and h.
Fractions printed_mass() {
  return symmetric({{13, 35}, {11, 210},  0,         {9, 70},   {-13, 420}, 0,  //
                    {1, 105}, 0,          {13, 420}, {-1, 140}, 0,              //
                    {1, 36},  0,          0,         {1, 72},                   //
                    {13, 35}, {-11, 210}, 0,                                    //
                    {1, 105}, 0,                                                //
                    {1, 36}});
}
/// Returns the printed matrix (A.7) of T divided by m, without powers of l and h.
Fractions printed_relative_mass() {
  return symmetric({{13, 35}, {-13, 420}, 0,         {-13, 35}, {11, 210}, 0,  //
                    {1, 105}, 0,          {13, 420}, {-1, 140}, 0,             //
                    {1, 36},  0,          0,         {1, 72},                  //
                    {13, 35}, {-11, 210}, 0,                                   //
                    {1, 105}, 0,                                               //
                    {1, 36}});
}
/// Returns the printed inverse (A.5) of T times m, without powers of l and h.
Fractions printed_inverse() {
  return symmetric({16,   -120, 0,  -4,  -60, 0,  //
                    1200, 0,    60, 840, 0,       //
                    48,   0,    0,  -24,          //
                    16,   120,  0,                //
                    1200, 0,                      //
                    48});
}

double mass() { return kBeamSection.density * kBeamSection.thickness * kLength * kHeight; }

ShapeTable table_of(const AncfBeam& beam, int degree, Tabulate what = Tabulate::position) {
  ShapeTable t;
  beam.tabulate(0, degree, what, {}, ScaleFactorKind::mass, t);
  return t;
}

double difference(const MatrixXd& x, const MatrixXd& expected) {
  return (x - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
}
/// Returns the largest relative difference after scaling all entries to one unit by powers of l and
/// h.
double scaled_difference(const MatrixXd& x, const MatrixXd& expected, double sign = 1) {
  VectorXd s(6);
  for (size_t i = 0; i < 6; ++i)
    s[static_cast<Eigen::Index>(i)] = std::pow(kLength, -sign * paper_shapes()[i].l) *
                                      std::pow(kHeight, -sign * paper_shapes()[i].h);
  return difference(s.asDiagonal() * x * s.asDiagonal(),
                    s.asDiagonal() * expected * s.asDiagonal());
}

MatrixXd computed_mass() {
  const AncfBeam beam(kLength, kHeight, 1);
  const std::unique_ptr<Term> inertia = make_inertia(kBeamSection);
  inertia->prepare(beam, {}, true);
  Local x;
  x.q = x.v = x.a = LocalRows::Zero(6, 2);
  LocalTangent t = LocalTangent::Zero(12, 12);
  inertia->add_tangent(0, x, {0, 0, 1}, t);
  MatrixXd out(6, 6);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      out(i, j) = t(2 * i, 2 * j);
      EXPECT_EQ(t(2 * i + 1, 2 * j + 1), t(2 * i, 2 * j));
      EXPECT_EQ(t(2 * i, 2 * j + 1), 0);
    }
  return out;
}

TEST(AncfBeamMatrices, MassIsExactAndPrintedRight) {
  EXPECT_EQ(products(paper_shapes()), printed_mass());  // (A.3)
  EXPECT_LT(scaled_difference(computed_mass(), mass() * with_lengths(printed_mass())), 1e-13);
}

TEST(AncfBeamMatrices, InverseOfTheMassIsPrintedRight) {
  const Fractions m = products(paper_shapes()), inverse = printed_inverse();  // (A.5)
  for (size_t i = 0; i < 6; ++i)
    for (size_t j = 0; j < 6; ++j) {
      Fraction sum;
      for (size_t k = 0; k < 6; ++k) sum = sum + m[i][k] * inverse[k][j];
      EXPECT_EQ(sum, Fraction(i == j ? 1 : 0)) << i << " " << j;
    }
  // The inverse loses digits in proportion to the condition number of M, 1.5e4 in these units.
  EXPECT_LT(scaled_difference(computed_mass().inverse(),
                              with_lengths(printed_inverse(), -1) / mass(), -1),
            1e-11);
}

TEST(AncfBeamMatrices, MassOfRelativeMotionIsPrintedRight) {
  EXPECT_EQ(products(relative_shapes()), printed_relative_mass());  // (A.7)
  const AncfBeam beam(kLength, kHeight, 1);
  const ShapeTable t = table_of(beam, 6);
  ShapeTable origin;
  beam.locate({0, 0}, Tabulate::position, origin);
  const MatrixXd relative = t.N - VectorXd::Ones(t.N.rows()) * origin.N;
  const double density = kBeamSection.density * kBeamSection.thickness;
  EXPECT_LT(scaled_difference(density * relative.transpose() * t.weight.asDiagonal() * relative,
                              mass() * with_lengths(printed_relative_mass())),
            1e-13);
}

// Compares S̄ (A.4), I_x and I_y (36) with the rational numbers printed in T.
TEST(AncfBeamMatrices, FirstMomentsArePrintedRight) {
  const std::array<Fraction, 6> mean = {Fraction(1, 2), {1, 12}, 0, {1, 2}, {-1, 12}, 0},
                                of_x = {Fraction(3, 20), {1, 30}, 0, {7, 20}, {-1, 20}, 0},
                                of_y = {0, 0, Fraction(1, 24), 0, 0, {1, 24}};
  const Polynomial x{{{{1, 0}, 1}}}, y{{{{0, 1}, 1}}};
  const AncfBeam beam(kLength, kHeight, 1);
  const ShapeTable t = table_of(beam, 4);
  const double density = kBeamSection.density * kBeamSection.thickness;
  VectorXd points_x(t.weight.size()), points_y(t.weight.size());
  for (Eigen::Index p = 0; p < t.weight.size(); ++p) {
    points_x[p] = t.material[static_cast<size_t>(p)].x();
    points_y[p] = t.material[static_cast<size_t>(p)].y();
  }
  const VectorXd weight = density * t.weight;
  const VectorXd s = t.N.transpose() * weight,
                 i_x = t.N.transpose() * weight.cwiseProduct(points_x),
                 i_y = t.N.transpose() * weight.cwiseProduct(points_y);
  for (size_t k = 0; k < 6; ++k) {
    const Shape& shape = paper_shapes()[k];
    EXPECT_EQ(shape.p.integral(), mean[k]) << k;
    EXPECT_EQ((shape.p * x).integral(), of_x[k]) << k;
    EXPECT_EQ((shape.p * y).integral(), of_y[k]) << k;
    const double unit = mass() * std::pow(kLength, shape.l) * std::pow(kHeight, shape.h);
    const auto row = static_cast<Eigen::Index>(k);
    EXPECT_NEAR(s[row], unit * mean[k].value(), 1e-13 * unit);
    EXPECT_NEAR(i_x[row], unit * kLength * of_x[k].value(), 1e-13 * unit * kLength);
    EXPECT_NEAR(i_y[row], unit * kHeight * of_y[k].value(), 1e-13 * unit * kHeight);
  }
}

// (35): M⁻¹ S̄ᵀ = (1 0 0 1 0 0)ᵀ, because M times that translation is S̄ᵀ, (A.10). Therefore I_u =
// 1 - M⁻¹ S̄ᵀ S(x_o) (32) is the unit matrix except for its first column, (0 0 0 -1 0 0).
TEST(AncfBeamMatrices, TranslationsAreFoundByTheMass) {
  const Fractions m = products(paper_shapes());
  for (size_t i = 0; i < 6; ++i) EXPECT_EQ(m[i][0] + m[i][3], paper_shapes()[i].p.integral()) << i;
  const AncfBeam beam(kLength, kHeight, 1);
  const ShapeTable t = table_of(beam, 6);
  const VectorXd mean =
      kBeamSection.density * kBeamSection.thickness * (t.N.transpose() * t.weight);
  ShapeTable origin;
  beam.locate({0, 0}, Tabulate::position, origin);
  const MatrixXd I_u =
      MatrixXd::Identity(6, 6) - computed_mass().ldlt().solve(mean) * MatrixXd(origin.N);
  MatrixXd expected = MatrixXd::Identity(6, 6);
  expected(0, 0) = 0;
  expected(3, 0) = -1;
  // Entries of slopes have the scale 1/l.
  EXPECT_LT((I_u - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(AncfBeam, ShapesInterpolateNodalValues) {
  const AncfBeam beam({0.1, 0.3, 0.8}, kHeight);
  const auto nodes = beam.nodes();
  for (size_t n = 0; n < 3; ++n) {
    ShapeTable t;
    const int e = beam.locate(nodes[n].material, Tabulate::gradient, t);
    const auto vectors = beam.vectors(e);
    for (size_t k = 0; k < 6; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      EXPECT_NEAR(t.N(0, column), vectors[k] == nodes[n].r, 1e-15);
      EXPECT_NEAR(t.N_m(0, column), vectors[k] == nodes[n].r_m, 1e-14);
      EXPECT_NEAR(t.N_n(0, column), vectors[k] == nodes[n].r_n, 1e-15);
    }
  }
  EXPECT_EQ(beam.edge("root")[0].r, 0);
  EXPECT_EQ(beam.edge("free_end")[0].r_n, 8);
  EXPECT_EQ(beam.edge("line 1")[0].r_m, 4);
  EXPECT_EQ(beam.reference().row(6), Eigen::RowVector2d(0.8, 0));
}

// r_m and r_n are derivatives by X. Differences of the shape functions along x and y must equal
// these derivatives times the chain rule.
TEST(AncfBeam, GradientsAreThoseByTheReferenceCoordinates) {
  const AncfBeam beam = testing::crooked_beam(0.1);
  const MatrixXd X = beam.reference();
  for (const Vec2& at : {Vec2(0.07, 0.02), Vec2(0.3, -0.04), Vec2(0.5, 0.049)}) {
    ShapeTable t;
    const int e = beam.locate(at, Tabulate::gradient, t);
    Eigen::Matrix<double, 6, 2> nodal;
    for (int k = 0; k < 6; ++k) nodal.row(k) = X.row(beam.vectors(e)[static_cast<size_t>(k)]);
    EXPECT_LT((t.N_m * nodal - Eigen::RowVector2d(1, 0)).norm(), 1e-13);  // ∂X/∂X = 1
    EXPECT_LT((t.N_n * nodal - Eigen::RowVector2d(0, 1)).norm(), 1e-13);
    const auto along = [&](const Vec2& direction) {
      return MatrixXd(testing::first_difference(
          [&](double by) {
            ShapeTable moved;
            EXPECT_EQ(beam.locate(at + by * direction, Tabulate::position, moved), e);
            return MatrixXd(moved.N);
          },
          1e-4));
    };
    for (const Vec2& direction : {Vec2(1, 0), Vec2(0, 1)}) {
      const MatrixXd dN = along(direction);
      const Vec2 dX = (dN * nodal).transpose();
      EXPECT_LT((dN - dX.x() * t.N_m - dX.y() * t.N_n).cwiseAbs().maxCoeff(), 1e-9);
    }
  }
}

/// Returns the sum over all elements of weight · f(X).
double integral(const AncfBeam& beam, const std::function<double(const Vec2&)>& f) {
  const MatrixXd X = beam.reference();
  double sum = 0;
  ShapeTable t;
  for (int e = 0; e < beam.n_elements(); ++e) {
    beam.tabulate(e, 8, Tabulate::position, {}, ScaleFactorKind::none, t);
    Eigen::Matrix<double, 6, 2> nodal;
    for (int k = 0; k < 6; ++k) nodal.row(k) = X.row(beam.vectors(e)[static_cast<size_t>(k)]);
    const MatrixXd points = t.N * nodal;
    for (Eigen::Index p = 0; p < points.rows(); ++p)
      sum += t.weight[p] * f(points.row(p).transpose());
  }
  return sum;
}

// A thick quarter ring of radius R has the area R φ h, the second moment about its centre φ (R₊⁴ -
// R₋⁴)/4, and ∫ X dA = ∫∫ r sin θ r dr dθ. The axis approximates the arc to order 4. r_y is linear
// between unit normals an angle φ/n apart, so that the height is cos(φ/2n) in the middle of an
// element and smaller by (φ/n)²/12 on the average: the order is 2 with that constant.
TEST(AncfBeam, ArcIsASectorOfARing) {
  const double angle = std::numbers::pi / 2, length = 1.2, h = 0.2, radius = length / angle,
               outer = radius + h / 2, inner = radius - h / 2;
  const Vec2 centre(0, radius);
  const auto rate = [&](const std::function<double(const Vec2&)>& f, double exact) {
    return testing::fit_rate({0.25, 0.125, 0.0625}, [&](double step) {
      const int n = static_cast<int>(std::lround(1 / step));
      const AncfBeam arc(uniform_nodes(length, n), h, arc_reference(length, angle, n));
      return std::abs(integral(arc, f) / exact - 1);
    });
  };
  const testing::Rate area = rate([](const Vec2&) { return 1.0; }, length * h),
                      polar = rate([&](const Vec2&X) { return (X - centre).squaredNorm(); },
                                   angle * (std::pow(outer, 4) - std::pow(inner, 4)) / 4),
                      first = rate([](const Vec2&X) { return X.x(); },
                                   (std::pow(outer, 3) - std::pow(inner, 3)) / 3);
  for (const testing::Rate& r : {area, polar, first}) {
    EXPECT_NEAR(r.order(), 2, 0.02) << r.table();
    EXPECT_LT(r.error.back(), 9e-4) << r.table();
  }
  EXPECT_NEAR(area.error.back(), std::pow(angle / 16, 2) / 12, 1e-3 * area.error.back());
}

// The weights are exact for a reference of straight lines: the area of a tapered beam is the area
// of a trapezoid, and shear does not change it.
TEST(AncfBeam, TaperedAndShearedAreasAreExact) {
  const std::vector<double> x = {0, 0.5, 1};
  std::vector<BeamNode> nodes;
  for (const double at : x) nodes.push_back({{at, 0}, {1, 0}, {0.3, 1 - 0.5 * at}});
  const AncfBeam beam(x, 0.2, nodes);
  EXPECT_NEAR(integral(beam, [](const Vec2&) { return 1.0; }), 0.2 * 0.75, 1e-15);
}

TEST(AncfBeam, RefusesWhatMakesNoSense) {
  const auto refused = [](const std::function<void()>& f, const std::string& part) {
    const std::string text = error_of(Error::Kind::input, f);
    EXPECT_TRUE(mentions(text, part)) << text;
  };
  refused([] { AncfBeam(-1, 0.1, 3); }, "length");
  refused([] { AncfBeam(1, 0.1, 0); }, "element");
  refused([] { AncfBeam(1, 0, 3); }, "height");
  refused([] { AncfBeam(1, std::nan(""), 3); }, "height");
  refused([] { AncfBeam(std::vector<double>{0, 1, 1}, 0.1); }, "increase");
  refused([] { AncfBeam({0, 1}, 0.1, arc_reference(1, 1, 2)); }, "3 nodes");
  // An arc of radius 0.1 cannot have a height of 0.3, because its inner half would be folded.
  refused([] { AncfBeam(uniform_nodes(0.1, 4), 0.3, arc_reference(0.1, 1, 4)); }, "folded");
  refused([] { AncfBeam({0, 1}, 0.1, {{}, {{1, 0}, {1, 0}, {0, -1}}}); }, "folded");
  refused([] { AncfBeam({0, 1}, 0.1, {{}, {{std::nan(""), 0}, {1, 0}, {0, 1}}}); }, "finite");
  const AncfBeam beam(1, 0.1, 4);
  ShapeTable t;
  refused([&] { beam.locate({1.01, 0}, Tabulate::position, t); }, "outside");
  refused([&] { beam.locate({0.5, 0.051}, Tabulate::position, t); }, "outside");
  refused([&] { beam.locate({std::nan(""), 0}, Tabulate::position, t); }, "outside");
  refused([&] { beam.edge("side_low"); }, "'line 4'");
  refused([&] { beam.edge("line 5"); }, "'line 4'");
  refused([&] { beam.tabulate(0, 4, Tabulate::curvature, {}, ScaleFactorKind::none, t); },
          "second derivatives");
  ScaleFactors factors;
  factors.stiffness = factors.mass = VectorXd::Ones(4);
  refused([&] { make_inertia(kBeamSection)->prepare(beam, factors, true); }, "scale factors");
  refused([&] { make_beam_ecm(kBeamSection)->prepare(beam, factors, true); }, "scale factors");
  refused([&] { make_membrane(kBeamSection)->prepare(beam, {}, true); }, "four nodes");
  VectorXd load = VectorXd::Ones(2);
  refused([&] { make_edge_load("free_end", load)->prepare(beam, {}, true); }, "one node");
  refused([&] { make_turning_edge_load("free_end", load)->prepare(beam, {}, true); }, "one node");
}

}  // namespace
}  // namespace flexmorph::fem
