// Shows that the matrix of a Newton step is the derivative of the whole residual by unknowns and
// multipliers, with material flow and nonlinear joints; that it is not symmetric when material
// flows; that bodies are independent; that batches and threads do not change results; and that a
// missing body is an error.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>

#include "fem/loads.h"
#include "fem/model/workspace.h"
#include "fem/terms.h"
#include "tests/support/differences.h"
#include "tests/support/models.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::ShapeSet;

/// The constraint |r|² = L² of the first two unknowns of a body, whose Hessian is not zero.
class Distance final : public Joint {
 public:
  std::unique_ptr<Joint> clone() const override { return std::make_unique<Distance>(*this); }
  std::string name() const override { return "distance"; }
  int size() const override { return 1; }
  void bind(std::span<const BodyView> bodies) override {
    first_ = find_body(bodies, "distance", "plate").first_dof;
  }
  void evaluate(double, const VectorXd& q, const VectorXd& v, ConstraintRows& rows) const override {
    const auto r = q.segment<2>(first_), r_t = v.segment<2>(first_);
    rows.value = VectorXd::Constant(1, r.squaredNorm() - 1);
    rows.rate = VectorXd::Zero(1);
    rows.acceleration = VectorXd::Constant(1, -2 * r_t.squaredNorm());
    rows.jacobian.clear();
    for (int c = 0; c < 2; ++c) rows.jacobian.emplace_back(0, first_ + c, 2 * r[c]);
  }
  void add_stiffness(double, const VectorXd&, const VectorXd& lambda,
                     std::vector<Eigen::Triplet<double>>& out) const override {
    for (int c = 0; c < 2; ++c) out.emplace_back(first_ + c, first_ + c, 2 * lambda[0]);
  }

 private:
  int first_ = 0;
};

/// A joint without rows that counts how often it and its copies are bound.
class Counting final : public Joint {
 public:
  explicit Counting(int& count) : count_(&count) {}
  std::unique_ptr<Joint> clone() const override { return std::make_unique<Counting>(*this); }
  std::string name() const override { return "counting"; }
  int size() const override { return 0; }
  void bind(std::span<const BodyView>) override { ++*count_; }
  void evaluate(double, const VectorXd&, const VectorXd&, ConstraintRows&) const override {}

 private:
  int* count_;
};

// In a chain of n bodies, each followed by its joint, a joint is bound a few times on the average,
// not n times, because the list of bodies moves only when its capacity doubles.
TEST(Model, IsBoundAFewTimesWhileItGrows) {
  constexpr int kBodies = 512;
  Workspace model;
  int count = 0;
  for (int i = 0; i < kBodies; ++i) {
    testing::add_rigid(model, "link" + std::to_string(i), {1, {0, 0}, 1});
    model.add_joint(std::make_unique<Counting>(count));
    EXPECT_EQ(model.bodies().back().first_dof, 4 * i);
    EXPECT_EQ(model.n_dofs(), 4 * (i + 1));
    EXPECT_EQ(model.n_constraints(), i + 1);  // rows of the unit axes
    EXPECT_EQ(model.first_row(model.joints().size()), i + 1);
  }
  EXPECT_LT(count, 3 * kBodies);
  const Model copy(model);
  EXPECT_EQ(copy.n_dofs(), model.n_dofs());
  EXPECT_EQ(copy.n_constraints(), model.n_constraints());
}

FrameMotion accelerated_hub(double t) {
  FrameMotion f;
  f.angle = 1.3 * t * t;
  f.angle_rate = 2.6 * t;
  f.angle_acceleration = 2.6;
  return f;
}

std::vector<std::unique_ptr<Term>> all_terms(const PlaneSection& s) {
  std::vector<std::unique_ptr<Term>> out;
  out.push_back(make_inertia(s));
  out.push_back(make_membrane(s));
  out.push_back(make_gravity(s, Vec2(0, -9.81)));
  out.push_back(make_point_mass(0.5, {0.17, 0.02}, Vec2(0, -9.81)));
  return out;
}

class ModelTangent : public ::testing::TestWithParam<ShapeSet> {
 protected:
  ModelTangent() {
    // The material is soft, so that inertia and membrane have entries of similar size in the
    // matrix.
    const PlaneSection section{0.01, 1e3, 0.3, 2700};
    model.add_body("plate", std::make_unique<AncfPlate>(testing::swinging_plate(GetParam())),
                   section, all_terms(section));
    model.add_joint(make_weld("root", "plate", "root", accelerated_hub, WeldMode::direction));
    model.add_joint(std::make_unique<Distance>());
    const State reference = model.reference();
    x = testing::SmoothMotion(reference.q, 0.05 * model.scales().cwiseInverse(), 2).state(0.37);
    x.lambda = VectorXd::Random(model.n_constraints());
    model.prepare(x.t);
  }
  /// Returns F + Φ_qᵀ λ and Φ.
  VectorXd residual(const State& y) {
    VectorXd out(model.n_dofs() + model.n_constraints()), force;
    Constraints c;
    model.constraints(y, c);
    model.force(y, force);
    model.add_constraint_force(c, y.lambda, force);
    out << force, c.value;
    return out;
  }

  Workspace model;
  State x;
};
INSTANTIATE_TEST_SUITE_P(Shapes, ModelTangent, ::testing::Values(ShapeSet::h12, ShapeSet::h16),
                         [](const auto& s) { return s.param == ShapeSet::h12 ? "h12" : "h16"; });

TEST_P(ModelTangent, IsTheDerivativeOfTheResidual) {
  const Weights w{1, 37, 1500};
  Constraints c;
  model.constraints(x, c);
  SparseMatrix kkt;
  model.kkt(x, c, w, 1, kkt);
  const int n = model.n_dofs();
  const VectorXd scales = model.scales();
  // The residual is cubic in q and linear in the other unknowns; therefore differences of order 4
  // are exact except for round-off.
  for (int column = 0; column < n + model.n_constraints(); ++column) {
    const double step = column < n ? 1e-3 / scales[column] : 1;
    const VectorXd exact = kkt.col(column);
    VectorXd difference = first_difference(
        [&](double by) {
          State y = x;
          if (column < n) {
            y.q[column] += w.q * by;
            y.v[column] += w.v * by;
            y.a[column] += w.a * by;
          } else {
            y.lambda[column - n] += by;
          }
          return residual(y);
        },
        step);
    EXPECT_LT((exact - difference).cwiseAbs().maxCoeff(), 1e-8 * (1 + exact.cwiseAbs().maxCoeff()))
        << column;
  }
  // The scale multiplies the equations of motion and not the constraints; the multipliers are
  // divided by it.
  SparseMatrix scaled;
  model.kkt(x, c, w, 0.25, scaled);
  const MatrixXd a = MatrixXd(kkt), b = MatrixXd(scaled);
  EXPECT_LT((0.25 * a.topLeftCorner(n, n) - b.topLeftCorner(n, n)).norm(), 1e-14 * a.norm());
  EXPECT_EQ((a.bottomRows(model.n_constraints()) - b.bottomRows(model.n_constraints())).norm(), 0);
}

// 2 ∫ N Ṅᵀ is not symmetric; therefore a solver for symmetric matrices would be wrong.
TEST_P(ModelTangent, IsNotSymmetricWithMaterialFlow) {
  Constraints c;
  model.constraints(x, c);
  SparseMatrix kkt;
  const auto asymmetry = [&](const Weights& w) {
    model.kkt(x, c, w, 1, kkt);
    const MatrixXd k = MatrixXd(kkt).topLeftCorner(model.n_dofs(), model.n_dofs());
    return (k - k.transpose()).norm() / k.norm();
  };
  EXPECT_GT(asymmetry({0, 1, 0}), 0.1);
  EXPECT_LT(asymmetry({0, 0, 1}), 1e-14);
}

// The forces of the first body do not depend on a second body.
TEST(Model, BodiesAddUp) {
  const PlaneSection section{0.01, 1e8, 0.3, 2700};
  Workspace one, two;
  for (Workspace* model : {&one, &two})
    model->add_body("plate", std::make_unique<AncfPlate>(testing::swinging_plate(ShapeSet::h16)),
                    section, all_terms(section));
  two.add_body("arm", std::make_unique<AncfPlate>(testing::swinging_plate(ShapeSet::h12)), section,
               all_terms(section));
  State x =
      testing::SmoothMotion(one.reference().q, 0.05 * one.scales().cwiseInverse(), 2).state(0.37);
  State y =
      testing::SmoothMotion(two.reference().q, 0.05 * two.scales().cwiseInverse(), 3).state(0.37);
  y.q.head(one.n_dofs()) = x.q;
  y.v.head(one.n_dofs()) = x.v;
  y.a.head(one.n_dofs()) = x.a;
  one.prepare(x.t);
  two.prepare(y.t);
  VectorXd f, g;
  one.force(x, f);
  two.force(y, g);
  EXPECT_EQ((g.head(one.n_dofs()) - f).norm(), 0);
  EXPECT_EQ(two.bodies()[1].first_dof, one.n_dofs());
  EXPECT_GT(two.energies(y).strain, one.energies(x).strain);
  EXPECT_THROW(one.body("arm"), Error);
}

// Forces and tangents of batches of eight elements must equal the sums over single elements and
// terms, to the round-off of another order of summation.
TEST(Model, BatchesAreTheirElements) {
  const PlaneSection section{0.01, 1e3, 0.3, 2700};
  for (const ShapeSet shapes : {ShapeSet::h12, ShapeSet::h16})
    for (const bool designed : {false, true}) {
      Workspace model;
      // With 15 elements one batch is not full; one batch has elements with moving and with fixed
      // lines.
      std::vector<MaterialLine> lines = testing::uniform_lines(0.1, 0.45, 5);
      lines[0] = testing::swinging_line(0.1, 0.03, 2.1);
      Body& body = model.add_body(
          "plate",
          std::make_unique<AncfPlate>(2, shapes, lines, testing::uniform_lines(-0.05, 0.07, 3)),
          section, all_terms(section));
      if (designed) model.set_factors(body, testing::random_factors(3));
      const State x =
          testing::SmoothMotion(model.reference().q, 0.05 * model.scales().cwiseInverse(), 2)
              .state(0.37);
      model.prepare(0);
      model.prepare(x.t);
      VectorXd force, expected = VectorXd::Zero(model.n_dofs());
      MatrixXd stiffness = MatrixXd::Zero(model.n_dofs(), model.n_dofs());
      const Weights w{1, 3, 20};
      for (int e = 0; e < 15; ++e) {
        const auto vectors = body.element->vectors(e);
        const auto rows = [&](const VectorXd& all) {
          LocalRows out(static_cast<Eigen::Index>(vectors.size()), 2);
          for (size_t k = 0; k < vectors.size(); ++k)
            out.row(static_cast<Eigen::Index>(k)) = all.segment<2>(2 * vectors[k]).transpose();
          return out;
        };
        const Local local{rows(x.q), rows(x.v), rows(x.a)};
        LocalRows f = LocalRows::Zero(local.q.rows(), 2);
        LocalTangent t = LocalTangent::Zero(local.q.size(), local.q.size());
        for (const auto& term : body.terms) {
          term->add_force(e, local, f);
          term->add_tangent(e, local, w, t);
        }
        for (Eigen::Index i = 0; i < f.size(); ++i) {
          const auto row = 2 * vectors[static_cast<size_t>(i / 2)] + i % 2;
          expected[row] += f.data()[i];
          for (Eigen::Index j = 0; j < f.size(); ++j)
            stiffness(row, 2 * vectors[static_cast<size_t>(j / 2)] + j % 2) += t(i, j);
        }
      }
      model.force(x, force);
      EXPECT_LT((force - expected).norm(), 1e-14 * expected.norm());
      Constraints c;
      SparseMatrix kkt;
      model.constraints(x, c);
      model.kkt(x, c, w, 1, kkt);
      EXPECT_LT((MatrixXd(kkt) - stiffness).norm(), 1e-14 * stiffness.norm());
    }
}

// Sums are made in the order of the colours for any number of threads. (There are enough elements
// for two threads.)
TEST(Model, ThreadsChangeNothing) {
  const PlaneSection section{0.01, 1e3, 0.3, 2700};
  Workspace model;
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(section));
  terms.push_back(make_membrane(section));
  model.add_body("plate",
                 std::make_unique<AncfPlate>(2, ShapeSet::h12, testing::uniform_lines(0, 1, 92),
                                             testing::uniform_lines(0, 1, 92)),
                 section, std::move(terms));
  const State x =
      testing::SmoothMotion(model.reference().q, 1e-3 * model.scales().cwiseInverse(), 2)
          .state(0.37);
  model.prepare(x.t);
  Constraints c;
  model.constraints(x, c);
  const int before = omp_get_max_threads();
  VectorXd force[2];
  SparseMatrix kkt[2];
  for (const int k : {0, 1}) {
    omp_set_num_threads(k + 1);
    model.force(x, force[k]);
    model.kkt(x, c, {1, 3, 20}, 1, kkt[k]);
  }
  omp_set_num_threads(before);
  EXPECT_EQ((force[0] - force[1]).cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ((kkt[0] - kkt[1]).norm(), 0);
  EXPECT_GT(force[0].norm(), 0);
}

// The expected value is |r_m x r_n| of a plate that is stretched by (1.2, 0.5) everywhere.
TEST(Model, SmallestAreaRatioIsThatOfTheMaterial) {
  const PlaneSection section{0.01, 1e8, 0.3, 2700};
  Workspace model;
  model.add_body("plate", std::make_unique<AncfPlate>(testing::swinging_plate(ShapeSet::h16)),
                 section, all_terms(section));
  State x = model.reference();
  for (Eigen::Index k = 0; k < x.q.size(); k += 2) {
    x.q[k] *= 1.2;
    x.q[k + 1] *= 0.5;
  }
  model.prepare(0);
  EXPECT_NEAR(model.smallest_area_ratio(x), 0.6, 1e-13);
}

}  // namespace
}  // namespace flexmorph::fem
