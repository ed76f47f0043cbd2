// Shows that the examples of cases/docs/extending.md work: an element fills its plate, the energy
// of a term agrees with a hand calculation, the constraint of a joint and its rate follow from the
// angles, an optimizer finds the nearest point of a box, a refinement series reads its case. The
// example of a response is tested in optim/mmc_responses_test.cpp.
#include <gtest/gtest.h>

#include <cmath>

#include "cases/accuracy/parameters.h"
#include "cases/scene/elements/row.h"
#include "cases/scene/joints/row.h"
#include "fem/dynamics/mesh_changes/moving_root.h"
#include "fem/elements/ancf_plate.h"
#include "fem/solve/statics.h"
#include "fem/terms.h"
#include "io/case_files/case_file.h"
#include "optim/makers.h"
#include "tests/support/rigid_models.h"

namespace flexmorph {
namespace cases {
extern const ElementRow kGradedPlate;
extern const JointRow kParallel;
extern const Parameter kSpinUp;
}  // namespace cases
namespace fem {
const TermRow& cords_row();
}
namespace optim {
std::unique_ptr<Optimizer> make_steepest_descent(const Settings& settings);
}

namespace {

TEST(Examples, AnElementOfItsOwnFillsItsPlate) {
  cases::Body body;
  body.row = &cases::kGradedPlate;
  body.space = "plane";
  body.length = 2;
  body.width = 0.5;
  const auto element = body.row->make(body, 1.0, {4, 2});
  const auto [m, n] = element->lines();
  ASSERT_EQ(m.size(), 5u);
  EXPECT_NEAR(m[1], 1 - std::sqrt(0.5), 1e-15);  // (1 - cos 45 degrees) of half the length
  double area = 0;
  fem::ShapeTable points;
  for (int e = 0; e < element->n_elements(); ++e) {
    element->tabulate(e, 2, fem::Tabulate::position, {}, fem::ScaleFactorKind::none, points);
    area += points.weight.sum();
  }
  EXPECT_NEAR(area, 1.0, 1e-14);
}

TEST(Examples, ATermOfItsOwnHasTheEnergyOfAStretchedSheet) {
  const std::vector<fem::MaterialLine> m{{0, {}}, {0.3, {}}, {0.4, {}}}, n{{0, {}}, {0.2, {}}};
  const fem::AncfPlate sheet(2, fem::AncfPlate::ShapeSet::h16, m, n);
  const fem::TermRow& row = fem::cords_row();
  const auto term = row.make({{0.01, 1e8, 0.3, 2700}, {{"cord_stiffness", 700}}, {&row}});
  const fem::ScaleFactors uniform;
  term->prepare(sheet, uniform, true);
  const double stretch = 1.1, strain = 0.5 * (stretch * stretch - 1);
  MatrixXd q = sheet.reference();
  q.col(0) *= stretch;
  double energy = 0;
  for (int e = 0; e < sheet.n_elements(); ++e) {
    fem::Local x;
    x.q.resize(sheet.n_shapes(), 2);
    for (int k = 0; k < sheet.n_shapes(); ++k)
      x.q.row(k) = q.row(sheet.vectors(e)[static_cast<size_t>(k)]);
    x.v = x.a = fem::LocalRows::Zero(sheet.n_shapes(), 2);
    energy += term->strain_energy(e, x);
  }
  EXPECT_NEAR(energy, 0.5 * 700 * strain * strain * 0.08, 1e-13);
}

// A sheet with cords rotates slowly with a hub. Reference: u = ρ h ω² L³ / 3 (E h + k), to first
// order in the strain.
TEST(Examples, ASheetWithATermOfItsOwnTurnsLikeARod) {
  const fem::PlaneSection section{0.01, 1e8, 0, 2700};
  const double length = 0.6, width = 0.1, cords = 5e5, omega = 0.1;
  std::vector<std::unique_ptr<fem::Term>> terms;
  terms.push_back(fem::make_inertia(section));
  terms.push_back(fem::make_membrane(section));
  terms.push_back(fem::cords_row().make({section, {{"cord_stiffness", cords}}, {}}));
  fem::Workspace model;
  const std::vector<fem::MaterialLine> m{{0, {}}, {0.2, {}}, {0.4, {}}, {length, {}}};
  const std::vector<fem::MaterialLine> n{{-width / 2, {}}, {width / 2, {}}};
  model.add_body("blade", std::make_unique<fem::AncfPlate>(2, fem::AncfPlate::ShapeSet::h16, m, n),
                 section, std::move(terms));
  const auto hub = [](double) { return fem::FrameMotion{}; };
  model.add_joint(fem::make_weld("hub", "blade", "root", hub, fem::WeldMode::edge));
  fem::State x = model.reference();
  const VectorXd spin = VectorXd::Constant(model.n_dofs(), omega * omega);
  fem::solve_rotating_equilibrium(model, spin, VectorXd::Zero(model.n_dofs()), x);
  const double u = fem::point_motion(model.body("blade"), x, {length, 0}).position.x() - length;
  const double stiffness = section.youngs_modulus * section.thickness + cords;
  const double rod =
      section.density * section.thickness * omega * omega * std::pow(length, 3) / 3 / stiffness;
  EXPECT_NEAR(u / rod, 1, 1e-3);
}

TEST(Examples, AJointOfItsOwnSeesTheAnglesOfItsBodies) {
  const cases::Scene scene;
  cases::Joint joint;
  joint.name = "parallel";
  const cases::JointParts parts{
      .scene = scene, .a = {.body = "one"}, .b = {.body = "two", .angle = 0.3}};
  fem::Workspace model;
  for (const char* name : {"one", "two"})
    testing::add_rigid(model, name, {.mass = 1, .inertia = 1});
  model.add_joint(cases::kParallel.make(joint, parts));
  const double a = 0.7, b = -0.2, rate_a = 1.3, rate_b = 0.4, between = b + 0.3 - a;
  fem::State x;
  x.q = x.v = x.a = VectorXd::Zero(model.n_dofs());
  testing::put(model, "one", {.angle = a, .angle_rate = rate_a}, x);
  testing::put(model, "two", {.angle = b, .angle_rate = rate_b}, x);
  fem::ConstraintRows rows;
  model.joints().back()->evaluate(0, x.q, x.v, rows);
  ASSERT_EQ(rows.value.size(), 1);
  EXPECT_NEAR(rows.value[0], std::sin(between), 1e-15);
  double rate = rows.rate[0];
  for (const auto& entry : rows.jacobian) rate += entry.value() * x.v[entry.col()];
  EXPECT_NEAR(rate, std::cos(between) * (rate_b - rate_a), 1e-15);
}

/// The point of a box nearest to another point, with a linear constraint: x0 + x1 <= 1.
class Nearest final : public optim::Problem {
 public:
  int n_variables() const override { return 2; }
  int n_constraints() const override { return 1; }
  VectorXd lower() const override { return VectorXd::Zero(2); }
  VectorXd upper() const override { return VectorXd::Ones(2); }
  VectorXd start() const override { return VectorXd::Constant(2, 0.3); }
  optim::ProblemValues evaluate(const VectorXd& x) override {
    const Vec2 off = x - Vec2(0.2, -0.5);
    optim::ProblemValues r;
    r.f = off.squaredNorm();
    r.df = 2 * off;
    r.g = VectorXd::Constant(1, x.sum() - 1);
    r.dg = MatrixXd::Ones(1, 2);
    return r;
  }
};

TEST(Examples, AnOptimizerOfItsOwnFindsTheNearestPoint) {
  Nearest problem;
  const auto optimizer = optim::make_steepest_descent({});
  const optim::Result result = optimizer->minimize(problem, {});
  EXPECT_NEAR(result.x[0], 0.2, 1e-3);
  EXPECT_EQ(result.x[1], 0);
  EXPECT_THROW(optim::make_steepest_descent({.options = {{"depth", 1.0}}}), Error);
}

TEST(Examples, ALadderOfItsOwnReadsItsCase) {
  cases::Scene scene;
  EXPECT_NE(cases::kSpinUp.absent(scene, cases::Part::motion), "");
  scene.time.start = cases::Start::hub_at_rest;
  scene.time.spin_up = 0.2;
  EXPECT_EQ(cases::kSpinUp.absent(scene, cases::Part::motion), "");
  const io::CaseFile file(FLEXMORPH_CASE, {});
  const auto levels = cases::kSpinUp.levels(scene, file);
  ASSERT_EQ(levels.size(), 4u);
  EXPECT_TRUE(levels[1].overrides.empty());
  EXPECT_EQ(levels[2].h, 0.5);
  EXPECT_EQ(levels[2].overrides.front(), "time.spin_up=0.4");
}

}  // namespace
}  // namespace flexmorph
