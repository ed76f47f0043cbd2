// Shows that plates in space have known solutions: linear plates (Levy's series, Timoshenko &
// Woinowsky-Krieger 1959), roll-up, the elastica, thin limits with and without assumed strains, and
// the snap-through of a buckled strip.
#include <gtest/gtest.h>

#include <cmath>

#include "fem/loads.h"
#include "tests/support/elastica.h"
#include "tests/support/rates.h"
#include "tests/support/space_plates.h"

namespace flexmorph::fem {
namespace {

using testing::at_point;
using testing::ShapeSet;
using testing::SpacePlate;
using testing::vector;

/// Returns a quarter of the unit square, with n x n elements on the whole square and its centre at
/// (1/2, 1/2).
SpacePlate quarter(ShapeSet shapes, int n) {
  SpacePlate p;
  p.length = p.width = 0.5;
  p.nx = p.ny = n / 2;
  p.shapes = shapes;
  p.hold(symmetry_edge("free_end"));
  p.hold(symmetry_edge("side_high"));
  return p;
}

SpacePlate supported(ShapeSet shapes, int n) {
  SpacePlate p = quarter(shapes, n);
  p.hold(supported_edge("root"));
  p.hold(supported_edge("side_low"));
  return p;
}

/// Returns the deflection of the linear plate at a point.
double deflection(Workspace model, const Vec2& at) {
  return at_point(model, linear_displacement(model, model.reference()), at).z();
}

/// Returns D w / (q L⁴) at the centre.
double uniform(SpacePlate p) {
  return p.stiffness() * deflection(p.model(make_surface_load(vector(0, 0, 1))), {0.5, 0.5});
}
/// Returns D w / (P L²) under a point force, a quarter of which acts on the quarter of the plate.
double central(SpacePlate p) {
  return p.stiffness() *
         deflection(p.model(make_point_force({0.5, 0.5}, vector(0, 0, 0.25))), {0.5, 0.5});
}
/// Returns 2 D (1 - ν) w / (P L²) at the loaded corner; the other three corners are held.
double twisted(ShapeSet shapes, int n) {
  SpacePlate p;
  p.nx = p.ny = n;
  p.shapes = shapes;
  p.hold({{HoldLocation::at({0, 0}), NodeVector::r, {0, 1, 2}, {}},
          {HoldLocation::at({1, 0}), NodeVector::r, {1, 2}, {}},
          {HoldLocation::at({0, 1}), NodeVector::r, {2}, {}}});
  return 2 * p.stiffness() * (1 - p.section.poisson_ratio) *
         deflection(p.model(make_point_force({1, 1}, vector(0, 0, 1))), {1, 1});
}
SpacePlate clamped(ShapeSet shapes, int n) {
  SpacePlate p = quarter(shapes, n);
  p.hold(clamped_edge("root"));
  p.hold(clamped_edge("side_low"));
  return p;
}

/// Returns Navier's series of the supported square under uniform load; terms fall like 1/(mn
/// (m²+n²)²).
double navier() {
  double sum = 0;
  for (int m = 1; m < 400; m += 2)
    for (int n = 1; n < 400; n += 2) {
      const double sign = ((m + n) / 2 - 1) % 2 ? -1 : 1, k = m * m + n * n;
      sum += sign / (m * n * k * k);
    }
  return 16 / std::pow(std::numbers::pi, 6) * sum;
}
/// Returns Levy's series for the point load; terms fall like 1/m³, and the rest is below 1e-9.
double levy_point() {
  double sum = 0;
  for (int m = 19999; m > 0; m -= 2) {
    const double a = m * std::numbers::pi / 2, c = m < 200 ? std::cosh(a) : INFINITY;
    sum += (std::tanh(a) - a / (c * c)) / (static_cast<double>(m) * m * m);
  }
  return sum / (2 * std::pow(std::numbers::pi, 3));
}

TEST(LinearPlate, SeriesAreThePublishedNumbers) {
  EXPECT_NEAR(navier(), 0.00406235, 5e-9);
  EXPECT_NEAR(levy_point(), 0.0116008, 5e-8);
}

TEST(LinearPlate, SupportedSquareConvergesWithOrderFour) {
  const testing::Rate rate = testing::fit_rate({0.5, 0.25, 0.125, 0.0625}, [](double h) {
    const int n = static_cast<int>(std::lround(1 / h));
    return std::abs(uniform(supported(ShapeSet::h16, n)) / navier() - 1);
  });
  EXPECT_GE(rate.order(), 3.8) << rate.table();
  EXPECT_LT(rate.error.back(), 1e-5) << rate.table();
}

// The published value has six digits, 4e-6, which hides the order on fine meshes, and coarse meshes
// (up to 8 x 8) are not yet asymptotic. Therefore the order is that of differences, and their limit
// is compared with the published number.
TEST(LinearPlate, ClampedSquareConvergesWithOrderFour) {
  const double published = 0.00126532, w16 = uniform(clamped(ShapeSet::h16, 16)),
               w32 = uniform(clamped(ShapeSet::h16, 32)), w64 = uniform(clamped(ShapeSet::h16, 64));
  const double ratio = (w32 - w16) / (w64 - w32);
  EXPECT_GE(std::log2(ratio), 3.8);
  EXPECT_NEAR((w64 + (w64 - w32) / (ratio - 1)) / published, 1, 4e-6);
  EXPECT_NEAR(w16 / published, 1, 1e-5);
}

// The deflection under a force contains h² log h: the order is 2.
TEST(LinearPlate, PointLoadConvergesWithOrderTwo) {
  const testing::Rate rate = testing::fit_rate({0.25, 0.125, 0.0625}, [](double h) {
    const int n = static_cast<int>(std::lround(1 / h));
    return std::abs(central(supported(ShapeSet::h16, n)) / levy_point() - 1);
  });
  EXPECT_NEAR(rate.order(), 2, 0.15) << rate.table();
  EXPECT_LT(rate.error.back(), 1e-3) << rate.table();
}

TEST(LinearPlate, CompleteShapesTwistExactly) { EXPECT_NEAR(twisted(ShapeSet::h16, 2), 1, 1e-9); }

// The incomplete shapes of P converge to these values (fem/README.md, Plate element).
TEST(LinearPlate, IncompleteShapesStopAtTheirPlateaus) {
  EXPECT_NEAR(uniform(supported(ShapeSet::h12, 16)) / navier(), 1 - 0.047, 0.003);
  EXPECT_NEAR(uniform(clamped(ShapeSet::h12, 16)) / 0.00126532, 1 - 0.022, 0.003);
  EXPECT_NEAR(central(supported(ShapeSet::h12, 16)) / levy_point(), 1 - 0.044, 0.003);
  EXPECT_NEAR(twisted(ShapeSet::h12, 32), 1 - 0.12, 0.003);
}

/// Returns a strip of unit length without lateral contraction, clamped at its root.
SpacePlate strip(double thickness, const std::string& membrane, int nx = 8) {
  SpacePlate p;
  p.width = 0.2;
  p.nx = nx;
  p.ny = 1;
  p.section = {thickness, 1e9, 0, 1000};
  p.terms = {membrane, "bending"};
  p.hold(clamped_edge("root"));
  return p;
}

// The end moment 2π E I / L bends the strip to a full circle, so that the tip returns to the root.
TEST(LargeBending, StripRollsUpToACircle) {
  const SpacePlate p = strip(1e-2, "membrane_assumed");
  Workspace model = p.model(make_edge_moment("free_end", 2 * std::numbers::pi * p.stiffness()));
  State x = model.reference();
  EXPECT_TRUE(solve_static(model, x).completed);
  const Vec3 tip = at_point(model, x.q, {1, 0.1});
  EXPECT_LT(std::hypot(tip.x(), tip.z()), 1e-3) << tip.transpose();
}

// In a very thin strip the membrane forces depend on the last digits of the positions; Newton's
// method must nevertheless stop.
TEST(LargeBending, AVeryThinStripRollsUpToACircle) {
  const SpacePlate p = strip(1e-4, "membrane_assumed", 16);
  Workspace model = p.model(make_edge_moment("free_end", 2 * std::numbers::pi * p.stiffness()));
  State x = model.reference();
  EXPECT_TRUE(solve_static(model, x).completed);
  const Vec3 tip = at_point(model, x.q, {1, 0.1});
  EXPECT_LT(std::hypot(tip.x(), tip.z()), 1e-3) << tip.transpose();
}

/// Returns the relative error of the deflection of the tip under the load 10 E I / L².
double elastica_error(double thickness, const std::string& membrane) {
  const double alpha = 10;
  const SpacePlate p = strip(thickness, membrane);
  Workspace model = p.model(make_edge_load("free_end", vector(0, 0, alpha * p.stiffness())));
  State x = model.reference();
  EXPECT_TRUE(solve_static(model, x).completed);
  return at_point(model, x.q, {1, 0.1}).z() / reference::elastica(alpha).z - 1;
}

TEST(LargeBending, StripIsTheElastica) {
  EXPECT_LT(std::abs(elastica_error(1e-2, "membrane")), 2e-3);
  EXPECT_LT(std::abs(elastica_error(1e-2, "membrane_assumed")), 2e-3);
}

// Without assumed strains 8 elements are 2 % too stiff at c/L = 1e-4; with them the error is that
// of the shape functions.
TEST(LargeBending, AssumedStrainsDoNotLockInTheThinLimit) {
  for (const double c : {1e-3, 1e-4})
    EXPECT_LT(std::abs(elastica_error(c, "membrane_assumed")), 1e-3) << c;
  EXPECT_LT(elastica_error(1e-4, "membrane"), -1.5e-2);
}

/// Returns the deflection of the corner of a square cantilever that a force D/L at this corner
/// bends obliquely to its mesh lines.
double bent_obliquely(const std::string& membrane, double thickness) {
  SpacePlate p;
  p.nx = p.ny = 8;
  p.section.thickness = thickness;
  p.terms = {membrane, "bending"};
  p.hold(clamped_edge("root"));
  Workspace model = p.model(make_point_force({1, 1}, vector(0, 0, p.stiffness())));
  State x = model.reference();
  EXPECT_TRUE(solve_static(model, x).completed);
  return at_point(model, x.q, {1, 1}).z();
}

// There is no closed form. CalculiX 2.20 (S8R, *STATIC with NLGEOM, thickness 1e-3) gives 0.37239,
// 0.37568 and 0.37673 on 8 x 8, 16 x 16 and 24 x 24 elements, with an error of order 1: the limit
// is 0.3789. Its uncertainty is the 0.6 % between the finest mesh and the limit.
TEST(LargeBending, SquareIsThatOfCalculix) {
  EXPECT_NEAR(bent_obliquely("membrane_assumed", 1e-3) / 0.3789, 1, 6e-3);
}

// Nearly inextensible plates have equal deflections under a force D/L: for a tenth of the thickness
// CalculiX gives 2.5 % less (16 x 16 elements, 0.3855 at 1e-2, 0.3757 at 1e-3), and the next tenth
// must change it by less. Without assumed strains the membrane locks.
TEST(LargeBending, SquareDoesNotLockEither) {
  const double assumed = bent_obliquely("membrane_assumed", 1e-4);
  EXPECT_NEAR(assumed / bent_obliquely("membrane_assumed", 1e-3), 1, 2.5e-2);
  EXPECT_LT(bent_obliquely("membrane", 1e-4), 0.99 * assumed);
}

/// Half of a pinned strip whose ends were moved towards each other: the root is pinned, the middle
/// is a plane of symmetry at l - δ, and the strip is buckled upwards.
struct Buckled {
  static constexpr double kShortening = 1e-3, kThickness = 1e-3, kStiffness = 1e9 * 1e-9 / 12;

  explicit Buckled(std::unique_ptr<Term> load = nullptr) {
    plate.width = 0.2;
    plate.nx = 8;
    plate.ny = 1;
    plate.section = {kThickness, 1e9, 0, 1000};
    plate.terms = {"membrane_assumed", "bending"};
    plate.hold({{{.edge = "root"}, NodeVector::r, {0, 1, 2}, {}},
                {{.edge = "root"}, NodeVector::r_n, {0, 1, 2}, {}}});
    std::vector<Held> middle = symmetry_edge("free_end");
    middle[0].value = vector(1 - kShortening, 0, 0);
    plate.hold(middle);
    model = load ? plate.model(std::move(load)) : plate.model();
    x = model.reference();
    // w = h sin(πX/2) with ∫ w'²/2 = δ, and the axial displacement that keeps the length.
    const double pi = std::numbers::pi, height = 4 * std::sqrt(kShortening) / pi;
    for (const NodeVectors& node : model.bodies()[0].element->nodes()) {
      const double m = node.material.x(), slope = height * pi / 2 * std::cos(pi * m / 2);
      x.q[3 * node.r + 2] = height * std::sin(pi * m / 2);
      x.q[3 * node.r_m + 2] = slope;
      x.q[3 * node.r] -= kShortening * (m + std::sin(pi * m) / pi);
      x.q[3 * node.r_m] -= slope * slope / 2;
    }
  }
  double middle() const { return at_point(model, x.q, {1, 0.1}).z(); }

  SpacePlate plate;
  Workspace model;
  State x;
};

/// Returns the largest downward force per width on the half, in the middle, by the theory of
/// shallow buckled beams with l = 1: w = a sin kX - b kX, a cos k = b from w'(1) = 0, force E I k³
/// |b|, shortening ∫ w'²/2 + c² k²/12 = δ. The force is zero in the buckled shape k = π/2 and again
/// in the third shape, k = 3π/2.
double snap_force() {
  const double c = Buckled::kThickness;
  double largest = 0;
  for (double k = std::numbers::pi / 2 + 1e-3; k < 1.5 * std::numbers::pi; k += 1e-3) {
    double bowing = 0;  // ∫ w'²/2 for b = 1
    for (int i = 0; i < 400; ++i) {
      const double slope = k * (std::cos(k * (i + 0.5) / 400) / std::cos(k) - 1);
      bowing += 0.5 * slope * slope / 400;
    }
    const double left = Buckled::kShortening - c * c * k * k / 12;
    largest = std::max(largest, Buckled::kStiffness * k * k * k * std::sqrt(left / bowing));
  }
  return largest;
}

// The error of the shallow theory is of the order of squared slopes, 4 δ = 4e-3. Beyond the limit
// the force vanishes in the third shape, w = -a with a² k²/4 + c² k²/12 = δ.
TEST(ArcLength, BuckledStripSnapsAtItsLimitLoad) {
  Buckled b(make_edge_load("free_end", vector(0, 0, -snap_force())));
  StaticSettings s;
  s.path = StaticSettings::Path::arc_length;
  s.to = 2;
  s.first_step = 0.02;
  s.largest_step = 0.02;
  double limit = 0, last_factor = 0, last_height = 0, height_without_force = 0;
  const StaticResult r = solve_static(b.model, b.x, s, [&](const StaticStep& step) {
    limit = std::max(limit, step.factor);
    const double height = b.middle();
    if (step.number > 0 && step.factor < 0)
      height_without_force =
          height - step.factor * (height - last_height) / (step.factor - last_factor);
    last_factor = step.factor;
    last_height = height;
    return step.factor >= -1e-9;
  });
  EXPECT_FALSE(r.completed);  // stopped by the observer, beyond the limit
  EXPECT_NEAR(limit, 1, 5e-3);
  const double k = 1.5 * std::numbers::pi, c = Buckled::kThickness;
  const double third = -2 * std::sqrt(Buckled::kShortening - c * c * k * k / 12) / k;
  EXPECT_NEAR(height_without_force / third, 1, 5e-3);
}

// Displacement control must give the same limit: the middle is driven down, and the largest
// reaction is taken.
TEST(ArcLength, LimitLoadIsThatOfDisplacementControl) {
  const auto depth = std::make_shared<double>(0);
  Buckled b;
  StaticSettings s;
  s.from = s.to = 1;
  solve_static(b.model, b.x, s);
  const double top = b.middle();
  b.model.add_joint(make_pin("down", "plate", {1, 0.1},
                             [depth, top](double) {
                               return std::vector<Motion>{{top - *depth, 0, 0}};
                             },
                             {2}));
  double limit = 0;
  for (int i = 0; i <= 40; ++i) {
    *depth = top * i / 40;
    solve_static(b.model, b.x, s);
    limit = std::max(limit, std::abs(b.x.lambda[b.model.n_constraints() - 1]) / 0.2);
  }
  EXPECT_NEAR(limit / snap_force(), 1, 5e-3);
}

TEST(StaticPath, SaysWhereItFailed) {
  const SpacePlate p = strip(1e-2, "membrane");
  Workspace model = p.model(make_edge_load("free_end", vector(0, 0, p.stiffness())));
  State x = model.reference();
  StaticSettings s;
  s.max_iterations = 1;  // cannot converge: the problem is nonlinear
  try {
    solve_static(model, x, s);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::numerical);
    const std::string text = error.what();
    for (const char* part : {"converge", "load factor 0", "residuals"})
      EXPECT_NE(text.find(part), std::string::npos) << text;
  }
  EXPECT_EQ((x.q - model.reference().q).norm(), 0);  // the last equilibrium
  s.first_step = -1;
  EXPECT_THROW(solve_static(model, x, s), Error);
}

}  // namespace
}  // namespace flexmorph::fem
