// Shows that linear and angular momentum of all bodies equal the formulas of rigid-body mechanics
// when the bodies move rigidly.
#include <gtest/gtest.h>

#include "fem/dynamics/total_momentum.h"
#include "fem/terms.h"
#include "tests/support/models.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

// Each body has P = m c', L = m c × c' + J ω; for a plate c is its centre and J = m (l² + w²)/12.
TEST(TotalMomentum, IsThatOfRigidBodies) {
  Workspace model;
  PlaneSection section{0.01, 1e8, 0.3, 2700};
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(section));
  terms.push_back(make_membrane(section));
  model.add_body(
      "plate",
      std::make_unique<AncfPlate>(2, testing::ShapeSet::h16, testing::uniform_lines(0, 0.6, 3),
                                  testing::uniform_lines(-0.1, 0.1, 1)),
      section, std::move(terms));
  testing::add_rigid(model, "block", {3, {0.2, -0.1}, 0.5});
  State x = model.reference();
  x.v = VectorXd::Zero(model.n_dofs());
  const double spin = 0.8;
  const Vec2 velocity(0.3, -0.4);
  const Body& plate = model.body("plate");
  for (int k = 0; k < plate.element->n_vectors(); ++k) {
    const int at = plate.first_dof + 2 * k;
    const Vec2 r = x.q.segment<2>(at);
    x.v.segment<2>(at) = spin * Vec2(-r.y(), r.x());
    if (plate.element->is_position(k)) x.v.segment<2>(at) += velocity;
  }
  testing::put(model, "block", {{1, 2}, 0.5, {-1, 0.7}, -2}, x);

  const double mass = section.density * section.thickness * 0.6 * 0.2;
  const Vec2 middle(0.3, 0), of_plate = velocity + spin * Vec2(0, 0.3);
  const Vec2 arm = Eigen::Rotation2Dd(0.5) * Vec2(0.2, -0.1), center = Vec2(1, 2) + arm,
             of_block = Vec2(-1, 0.7) - 2 * Vec2(-arm.y(), arm.x());
  const auto cross = [](const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); };
  const Vec2 linear = mass * of_plate + 3 * of_block;
  const double angular = mass * cross(middle, of_plate) + mass * (0.36 + 0.04) / 12 * spin +
                         3 * cross(center, of_block) - 0.5 * 2;
  const TotalMomentum all = total_momentum(model, x);
  EXPECT_LT((all.linear - linear).norm(), 1e-13 * linear.norm());
  EXPECT_NEAR(all.angular, angular, 1e-13 * std::abs(angular));

  x.v.setZero();
  EXPECT_EQ(total_momentum(model, x).angular, 0);
}

}  // namespace
}  // namespace flexmorph::fem
