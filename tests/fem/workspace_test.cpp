// Shows that a model is a value and that a work space is always prepared for its state: copies
// share nothing that changes, evaluations at any states in any order equal those of a new work
// space, and two simultaneous motions of one model equal consecutive motions bit for bit.
#include "fem/model/workspace.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "fem/body_joints.h"
#include "fem/dynamics/motion.h"
#include "fem/dynamics/parallel_jobs.h"
#include "fem/terms.h"
#include "tests/support/models.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

using testing::RotatingPlate;

/// Returns a plate with varying scale factors that slides out of its hub and rotates; a rigid arm
/// is hinged to its tip, with a spring to the ground. It has moving lines, a mesh that changes, a
/// joint and a force element.
testing::Scene scene() {
  RotatingPlate p;
  p.speed = 0.5;
  p.gravity = Vec2(0, -9.81);
  p.factors = testing::chequered(p);
  testing::Scene out = testing::make_scene(p);
  testing::add_rigid(out.model, "arm", {0.3, {0, -0.1}, 1e-3}, p.gravity);
  out.model.add_joint(make_revolute("hinge", {.body = "plate", .point = p.tip()}, {.body = "arm"}));
  out.model.add_force_element(make_spring("spring", {.body = "arm", .point = {0, -0.2}},
                                          {.point = {1, -0.5}}, {20, 0.1, 0.3}));
  return out;
}

/// Returns the pose of the arm at a time: it hangs below the tip and has the velocity of the tip.
std::vector<BodyPose> body_poses(double t) {
  RotatingPlate p;
  p.speed = 0.5;
  const double angle = p.omega * t, length = p.length + p.speed * t;
  const Vec2 e(std::cos(angle), std::sin(angle)), n(-e.y(), e.x());
  FrameMotion f;
  f.origin = length * e;
  f.origin_rate = p.speed * e + length * p.omega * n;
  f.origin_acceleration = 2 * p.speed * p.omega * n - length * p.omega * p.omega * e;
  return {{"arm", f, 0}};
}

MotionSettings settings(double step) {
  MotionSettings out;
  out.end = 0.25;
  out.step = step;
  out.start = Start::rigid;
  out.body_poses = body_poses;
  out.keep = Keep::steps;
  return out;
}

double difference(const Trajectory& a, const Trajectory& b) {
  if (a.points.size() != b.points.size() || a.changes.size() != b.changes.size()) return 1;
  double out = 0;
  for (size_t i = 0; i < a.points.size(); ++i) {
    const State &x = a.points[i].x, &y = b.points[i].x;
    if (x.q.size() != y.q.size()) return 1;
    out += std::abs(x.t - y.t) + (x.q - y.q).norm() + (x.v - y.v).norm() + (x.a - y.a).norm() +
           (x.lambda - y.lambda).norm();
  }
  return out;
}

TEST(Workspaces, OfOneModelMoveInTwoThreadsAsOneAfterTheOther) {
  const testing::Scene built = scene();
  const Model& model = built.model;
  const auto move = [&](double step, Trajectory& out) {
    Workspace mine(model);
    out = integrate(mine, built.moving_roots, settings(step), [](const MotionStep&) {}).trajectory;
  };
  Trajectory first, second, coarse;
  move(1e-3, first);
  move(2e-3, coarse);
  ASSERT_EQ(first.points.size(), 251u + 2);
  ASSERT_EQ(first.changes.size(), 2u);
  EXPECT_GT((first.points.back().x.q - coarse.points.back().x.q).norm(), 1e-9);

  Trajectory beside, other;
  std::thread a([&] { move(1e-3, beside); }), b([&] { move(2e-3, other); });
  a.join();
  b.join();
  EXPECT_EQ(difference(beside, first), 0);
  EXPECT_EQ(difference(other, coarse), 0);

  // The model that was copied is unchanged.
  EXPECT_EQ(grid_of(model.bodies()[0]).n_m(), 10);
  move(1e-3, second);
  EXPECT_EQ(difference(second, first), 0);
}

TEST(Workspaces, ShareNothingWithTheModelTheyCopy) {
  testing::Scene built = scene();
  Workspace copy = built.model;
  State x =
      testing::SmoothMotion(copy.reference().q, 0.05 * copy.scales().cwiseInverse(), 3).state(0.01);
  x.lambda = VectorXd::Ones(copy.n_constraints());
  VectorXd before, after;
  copy.force(x, before);
  Constraints rows;
  copy.constraints(x, rows);
  const VectorXd value = rows.value;
  // The original gets another mesh, other material, other loads and another time.
  State y = x;
  built.model.prepare(0.2);
  change_mesh(built.model, built.model.bodies()[0], MeshChange::insertion, y);
  built.model.set_factors(built.model.bodies()[0], {});
  built.model.scale_loads(3);
  copy.force(x, after);
  copy.constraints(x, rows);
  EXPECT_EQ((after - before).norm(), 0);
  EXPECT_EQ((rows.value - value).norm(), 0);
  EXPECT_NE(built.model.n_dofs(), copy.n_dofs());
  // This is a copy of a copy that has been used.
  Workspace again = copy;
  again.force(x, after);
  EXPECT_EQ((after - before).norm(), 0);
}

/// Returns all evaluations at one state in one vector.
VectorXd all_of(Workspace& model, const State& x) {
  VectorXd f;
  Constraints c;
  SparseMatrix kkt;
  const Energies e = model.energies(x);
  model.constraints(x, c);
  model.kkt(x, c, {1, 0.5, 0.2}, 2, kkt);
  model.force(x, f);
  VectorXd out(f.size() + kkt.nonZeros() + 8);
  out << f, Eigen::Map<const VectorXd>(kkt.valuePtr(), kkt.nonZeros()), e.kinetic, e.strain,
      e.potential, model.flow_power(x), model.force_element_power(x), model.smallest_area_ratio(x),
      model.momentum(x).head<2>();
  return out;
}

TEST(Workspaces, KnowWhatTheyArePreparedFor) {
  const testing::Scene built = scene();
  Workspace used = built.model;
  const testing::SmoothMotion motion(used.reference().q, 0.02 * used.scales().cwiseInverse(), 4);
  ScaleFactors other;
  for (const double t : {0.0, 0.07, 0.02, 0.02, 0.09, 0.0}) {
    State x = motion.state(t);
    x.lambda = VectorXd::Ones(used.n_constraints());
    Workspace fresh = built.model;
    EXPECT_EQ((all_of(used, x) - all_of(fresh, x)).norm(), 0) << t;
  }
  // A change of the material takes effect at the next evaluation.
  State x = motion.state(0.09);
  x.lambda = VectorXd::Ones(used.n_constraints());
  const double designed = used.energies(x).strain;
  used.set_factors(used.bodies()[0], {});
  const double full = used.energies(x).strain;
  EXPECT_GT(full, 1.1 * designed);
  Workspace fresh = used;
  EXPECT_EQ(fresh.energies(x).strain, full);
}

// Free lines have the positions given by the state, whatever was evaluated before.
TEST(Workspaces, FollowFreeLines) {
  RotatingPlate p;
  const auto build = [&] {
    std::vector<std::unique_ptr<Term>> terms;
    terms.push_back(make_inertia(p.section));
    terms.push_back(make_membrane(p.section));
    std::vector<MaterialLine> m = testing::uniform_lines(0, 0.4, 4);
    m[2].free = true;
    Workspace out;
    out.add_body("plate",
                 std::make_unique<AncfPlate>(2, testing::ShapeSet::h16, std::move(m),
                                             testing::uniform_lines(0, 0.1, 2)),
                 p.section, std::move(terms));
    return out;
  };
  using testing::AncfPlate;
  Workspace used = build();
  const testing::SmoothMotion motion(used.reference().q, 0.02 * used.scales().cwiseInverse(), 4);
  const Eigen::Index line = used.n_dofs() - 1;
  VectorXd f, g;
  for (int k = 0; k < 4; ++k) {
    State x = motion.state(0.1);
    x.lambda.resize(0);
    x.q[line] = 0.2 + 0.01 * (k / 2);
    x.v[line] = k % 2;
    used.force(x, f);
    Workspace fresh = build();
    fresh.force(x, g);
    EXPECT_EQ((f - g).norm(), 0) << k;
    EXPECT_EQ(grid_of(used.bodies()[0]).line_m(2).value, x.q[line]);
  }
}

TEST(SideBySide, DoesAllJobsOnce) {
  for (const int threads : {1, 2, 4}) {
    std::atomic<int> sum = 0;
    std::vector<Job> jobs;
    for (int k = 0; k < 7; ++k)
      jobs.push_back({"job", static_cast<double>(k % 3), [&sum, k](const auto& keep_running) {
                        EXPECT_TRUE(keep_running());
                        sum += 1 << k;
                      }});
    side_by_side(threads, jobs);
    EXPECT_EQ(sum, 127);
  }
}

// Jobs before the failure end, and jobs after it are stopped or never begun. The error contains the
// name of its job, as in consecutive execution.
TEST(SideBySide, StopsWhatComesBehindAFailure) {
  for (const int threads : {1, 2, 3}) {
    std::atomic<bool> first_ended = false, last_was_told = true, others_told = false;
    const std::vector<Job> jobs = {
        {"first", 1,
         [&](const auto& keep_running) {
           for (int k = 0; k < 100; ++k) {
             std::this_thread::sleep_for(std::chrono::milliseconds(1));
             if (!keep_running()) others_told = true;
           }
           first_ended = true;
         }},
        {"second", 2, [&](const auto&) { throw Error::numerical("no convergence"); }},
        {"last", 3, [&](const auto& keep_running) {
           last_was_told = false;
           for (int k = 0; k < 10000 && !last_was_told; ++k) {
             std::this_thread::sleep_for(std::chrono::milliseconds(1));
             last_was_told = !keep_running();
           }
         }}};
    try {
      side_by_side(threads, jobs);
      FAIL() << "nothing was thrown";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), Error::Kind::numerical);
      EXPECT_STREQ(error.what(), "second: no convergence");
    }
    EXPECT_TRUE(first_ended);
    EXPECT_TRUE(last_was_told);
    EXPECT_FALSE(others_told);
  }
}

// The products are compared with the matrix for F_q, F_v and M separately and for their sum, with a
// moving line and a damper.
TEST(Workspace, TransposedProductsAreThoseOfTheMatrix) {
  testing::Scene s = scene();
  fem::Workspace& model = s.model;
  State x = testing::SmoothMotion(model.reference().q, 0.01 * model.scales().cwiseInverse(), 3)
                .state(0.05);
  x.lambda.setZero(model.n_constraints());  // no contribution (Φ_qᵀ λ)_q
  const int n = model.n_dofs();
  const VectorXd psi = VectorXd::LinSpaced(n, -1, 1).array().sin();
  Constraints c;
  model.constraints(x, c);
  SparseMatrix kkt;
  for (const Weights& w : {Weights{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 30, 900}}) {
    model.kkt(x, c, w, 1, kkt);
    const VectorXd by_matrix = kkt.topLeftCorner(n, n).transpose() * psi;
    VectorXd product = VectorXd::Ones(n);
    model.add_transposed_product(x, w, psi, product);
    EXPECT_GT(by_matrix.norm(), 0);
    EXPECT_LT((product - VectorXd::Ones(n) - by_matrix).norm(), 1e-13 * (by_matrix.norm() + 1));
  }
}

}  // namespace
}  // namespace flexmorph::fem
