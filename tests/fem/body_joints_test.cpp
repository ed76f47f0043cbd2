// Shows that the rows of every joint between markers are correct: value, rate, right side of the
// acceleration and tangent against differences at random states and along random motions, on rigid
// bodies, plates (also with lines that move) and the ground. Shows also that the positions of their
// matrix entries do not change, that a plate welded to a moving rigid body has the rows of a plate
// welded to a driven hub with that motion, and that an undeformed plate fits its weld.
#include "fem/body_joints.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/support/differences.h"
#include "tests/support/errors.h"
#include "tests/support/models.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::second_difference;
using testing::ShapeSet;
using testing::SmoothMotion;

Motion swing(double mean, double amplitude, double angular_frequency, double t) {
  return {mean + amplitude * std::sin(angular_frequency * t),
          amplitude * angular_frequency * std::cos(angular_frequency * t),
          -amplitude * angular_frequency * angular_frequency * std::sin(angular_frequency * t)};
}
Motion length(double t) { return swing(0.7, 0.2, 1.9, t); }
Motion angle(double t) { return swing(0.4, 1.1, 1.4, t); }

MarkerLocation one() { return {.body = "one", .point = {0.3, -0.2}, .angle = 0.8}; }
MarkerLocation one_shifted() {
  return {.body = "one", .point = {0.3, -0.2}, .angle = 0.8, .along = [](double t) {
            return swing(0.1, 0.2, 2.3, t);
          }};
}
MarkerLocation two() { return {.body = "two", .point = {-0.1, 0.4}, .angle = -1.9}; }
MarkerLocation ground() { return {.point = {0.2, 0.1}, .angle = 0.3}; }
MarkerLocation ground_shifted() {
  return {.point = {0.2, 0.1}, .angle = 0.3, .along = [](double t) {
            return swing(-0.1, 0.3, 1.7, t);
          }};
}
MarkerLocation plate() { return {.body = "plate", .point = {0.13, 0.02}}; }
MarkerLocation tip() { return {.body = "plate", .point = {0.3, 0.05}}; }

std::vector<Motion> path(double t) { return {swing(0.1, 0.4, 1.2, t), swing(0.3, 0.2, 2.2, t)}; }
std::vector<Motion> path_y(double t) { return {swing(0.3, 0.2, 2.2, t)}; }

struct JointCase {
  std::string name;
  int rows;
  std::function<std::unique_ptr<Joint>()> make;
  std::string edge_of{}, edge{};  // only for welds
  MarkerLocation (*frame)() = nullptr;
};

std::vector<JointCase> cases() {
  std::vector<JointCase> out = {
      {"unit_axis", 1, [] { return make_unit_axis("j", "one"); }},
      {"revolute", 2, [] { return make_revolute("j", one(), two()); }},
      {"revolute_on_ground", 2, [] { return make_revolute("j", ground_shifted(), two()); }},
      {"revolute_shifted", 2, [] { return make_revolute("j", two(), one_shifted()); }},
      {"revolute_on_plate", 2, [] { return make_revolute("j", plate(), one()); }},
      {"weld", 3, [] { return make_rigid_weld("j", one(), two()); }},
      {"weld_on_ground", 3, [] { return make_rigid_weld("j", one_shifted(), ground_shifted()); }},
      {"slider", 2, [] { return make_slider("j", one(), two()); }},
      {"slider_shifted", 2, [] { return make_slider("j", one_shifted(), two()); }},
      {"slider_on_ground", 2, [] { return make_slider("j", ground(), two()); }},
      {"ground_on_slider", 2, [] { return make_slider("j", two(), ground_shifted()); }},
      {"angle_drive", 1, [] { return make_angle_drive("j", one(), two(), angle); }},
      {"angle_drive_on_ground", 1, [] { return make_angle_drive("j", ground(), two(), angle); }},
      {"distance", 1, [] { return make_distance("j", one_shifted(), two(), length); }},
      {"distance_of_plate", 1, [] { return make_distance("j", ground(), plate(), length); }},
      {"distance_in_plate", 1, [] { return make_distance("j", tip(), plate(), length); }},
      {"point_drive", 2, [] { return make_point_drive("j", one_shifted(), path, {}); }},
      {"point_drive_y", 1, [] { return make_point_drive("j", plate(), path_y, {1}); }}};
  return out;
}

std::vector<JointCase> edge_cases() {
  struct Location {
    std::string name, body, edge;
    MarkerLocation (*frame)();
    int rows[3];  // for each mode
  };
  const Location locations[] = {
      {"root_of_sheet", "sheet", "root", one_shifted, {12, 18, 24}},
      {"line_of_sheet", "sheet", "line 2", two, {12, 18, 24}},
      {"end_of_plate", "plate", "free_end", one, {12, 15, 18}},
      {"end_on_ground", "plate", "free_end", ground_shifted, {12, 15, 18}}};
  const char* modes[] = {"edge", "direction", "full"};
  std::vector<JointCase> out;
  for (const Location& p : locations)
    for (const WeldMode mode : {WeldMode::edge, WeldMode::direction, WeldMode::full})
      out.push_back({p.name + "_" + modes[static_cast<size_t>(mode)],
                     p.rows[static_cast<size_t>(mode)],
                     [p, mode] { return make_edge_weld("j", p.body, p.edge, p.frame(), mode); },
                     p.body, p.edge, p.frame});
  return out;
}

/// Two rigid bodies, a plate whose lines are fixed (h12) and a plate whose lines oscillate (h16).
class EveryBodyJoint : public ::testing::TestWithParam<JointCase> {
 protected:
  EveryBodyJoint()
      : plate(2, ShapeSet::h12, testing::uniform_lines(0, 0.3, 2),
              testing::uniform_lines(-0.05, 0.05, 2)),
        sheet(testing::swinging_plate(ShapeSet::h16)),
        joint(GetParam().make()) {
    const Element* elements[] = {&sheet, &first, &plate, &second};
    for (size_t i = 0; i < 4; ++i) {
      views.push_back({&names[i], elements[i], n});
      n += 2 * elements[i]->n_vectors();
    }
    joint->bind(views);
    motion = std::make_unique<SmoothMotion>(VectorXd::Random(n), VectorXd::Ones(n), 8);
  }
  ConstraintRows rows(double t) const { return rows(t, motion->q(t), motion->v(t)); }
  ConstraintRows rows(double t, const VectorXd& q, const VectorXd& v) const {
    ConstraintRows out;
    joint->evaluate(t, q, v, out);
    return out;
  }
  VectorXd times(const ConstraintRows& r, const VectorXd& x) const {
    VectorXd out = VectorXd::Zero(joint->size());
    for (const auto& entry : r.jacobian) out[entry.row()] += entry.value() * x[entry.col()];
    return out;
  }
  VectorXd transposed_times(const ConstraintRows& r, const VectorXd& lambda) const {
    VectorXd out = VectorXd::Zero(n);
    for (const auto& entry : r.jacobian) out[entry.col()] += entry.value() * lambda[entry.row()];
    return out;
  }

  std::string names[4] = {"sheet", "one", "plate", "two"};
  RigidBody first{0.4}, second{1.3};
  AncfPlate plate, sheet;
  std::unique_ptr<Joint> joint;
  std::vector<BodyView> views;
  int n = 3;  // the joint acts on unknowns that do not begin at 0
  std::unique_ptr<SmoothMotion> motion;
};
INSTANTIATE_TEST_SUITE_P(Joints, EveryBodyJoint, ::testing::ValuesIn(cases()),
                         [](const auto& c) { return c.param.name; });
INSTANTIATE_TEST_SUITE_P(EdgeWelds, EveryBodyJoint, ::testing::ValuesIn(edge_cases()),
                         [](const auto& c) { return c.param.name; });

class EveryEdgeWeld : public EveryBodyJoint {};
INSTANTIATE_TEST_SUITE_P(EdgeWelds, EveryEdgeWeld, ::testing::ValuesIn(edge_cases()),
                         [](const auto& c) { return c.param.name; });

// Truncation (1e-3 x 3)^4 / 30 and round-off 1e-16 / 1e-6 (second derivative) are below 1e-8.
TEST_P(EveryBodyJoint, RowsAreDifferencesAlongAMotion) {
  ASSERT_EQ(joint->size(), GetParam().rows);
  for (const double t : {0.6, 2.1}) {
    const ConstraintRows r = rows(t);
    ASSERT_EQ(r.value.size(), joint->size());
    const auto value = [&](double dt) { return VectorXd(rows(t + dt).value); };
    EXPECT_LT((times(r, motion->v(t)) + r.rate - first_difference(value, 1e-3)).norm(), 1e-9);
    EXPECT_LT((times(r, motion->a(t)) - r.acceleration - second_difference(value, 1e-3)).norm(),
              1e-7);
  }
}

TEST_P(EveryBodyJoint, RateIsThePartialDerivativeByTime) {
  const double t = 0.6;
  const VectorXd q = motion->q(t), v = motion->v(t);
  const auto value = [&](double dt) { return VectorXd(rows(t + dt, q, v).value); };
  EXPECT_LT((rows(t).rate - first_difference(value, 1e-3)).norm(), 1e-10);
}

// The rows are of degree 2 in q; therefore differences are exact except for round-off.
TEST_P(EveryBodyJoint, JacobianAndTangentAreDerivativesByTheUnknowns) {
  const double t = 0.6;
  const VectorXd direction = VectorXd::Random(n), lambda = VectorXd::Random(joint->size());
  const VectorXd q = motion->q(t), v = motion->v(t);
  const auto value = [&](double by) { return VectorXd(rows(t, q + by * direction, v).value); };
  EXPECT_LT((times(rows(t), direction) - first_difference(value, 0.1)).norm(), 1e-12);

  const auto force = [&](double by) {
    return transposed_times(rows(t, q + by * direction, v), lambda);
  };
  std::vector<Eigen::Triplet<double>> entries;
  joint->add_stiffness(t, q, lambda, entries);
  VectorXd tangent = VectorXd::Zero(n);
  for (const auto& entry : entries) tangent[entry.row()] += entry.value() * direction[entry.col()];
  EXPECT_LT((tangent - first_difference(force, 0.1)).norm(), 1e-12);
}

TEST_P(EveryBodyJoint, LocationsStayAndHoldNoNumberThatIsAlwaysZero) {
  const auto locations = [&](double t, const VectorXd& q) {
    std::vector<std::pair<int, int>> out;
    for (const auto& entry : rows(t, q, q).jacobian) out.emplace_back(entry.row(), entry.col());
    std::vector<Eigen::Triplet<double>> entries;
    joint->add_stiffness(t, q, VectorXd::Ones(joint->size()), entries);
    for (const auto& entry : entries) out.emplace_back(entry.row(), entry.col());
    return out;
  };
  EXPECT_EQ(locations(0, VectorXd::Zero(n)), locations(1.3, VectorXd::Random(n)));
  for (const auto& entry : rows(0.6).jacobian) EXPECT_NE(entry.value(), 0);
}

// The rows vanish for the undeformed plate that moves rigidly with its frame.
TEST_P(EveryEdgeWeld, RigidlyMovedPlateFits) {
  const double t = 0.6;
  const bool is_sheet = GetParam().edge_of == "sheet";
  const LineGrid& grid = is_sheet ? sheet : plate;
  const int first_of = views[is_sheet ? 0 : 2].first_dof;
  VectorXd q = motion->q(t);
  for (const size_t i : {1U, 3U}) q.segment<2>(views[i].first_dof + 2).normalize();
  // The pose of the frame, computed from the definition of a marker location.
  const MarkerLocation location = GetParam().frame();
  Vec2 at = location.point;
  if (location.along)
    at += location.along(t).value * Vec2(std::cos(location.angle), std::sin(location.angle));
  Eigen::Matrix2d turn = Eigen::Matrix2d::Identity();
  Vec2 origin(0, 0);
  if (!location.body.empty()) {
    const int dof = views[location.body == "one" ? 1 : 3].first_dof;
    const Vec2 u = q.segment<2>(dof + 2);
    turn << u.x(), -u.y(), u.y(), u.x();
    origin = q.segment<2>(dof);
  }
  const Vec2 hub = origin + turn * at;
  turn *= Eigen::Rotation2Dd(location.angle).toRotationMatrix();
  const MatrixXd reference = grid.reference();
  const double line = grid.edge(GetParam().edge)[0].material.x();
  for (int k = 0; k < grid.n_vectors(); ++k) {
    Vec2 local = reference.row(k).transpose();
    if (grid.is_position(k)) local.x() -= line;
    q.segment<2>(first_of + 2 * k) = turn * local + (grid.is_position(k) ? hub : Vec2::Zero());
  }
  EXPECT_LT(rows(t, q, q).value.cwiseAbs().maxCoeff(), 1e-15);
}

// The rows of a plate welded to a body that moves as a driven hub equal the rows of the weld to
// that hub.
TEST(EdgeWeld, OnABodyIsAWeldInADrivenHub) {
  const double t = 0.6;
  const Motion x = swing(0.1, 0.4, 1.2, t), y = swing(0.3, 0.2, 2.2, t), alpha = angle(t);
  const FrameDrive hub = [&](double) {
    FrameMotion f;
    f.origin = {x.value, y.value};
    f.origin_rate = {x.rate, y.rate};
    f.origin_acceleration = {x.acceleration, y.acceleration};
    f.angle = alpha.value;
    f.angle_rate = alpha.rate;
    f.angle_acceleration = alpha.acceleration;
    return f;
  };
  for (const int dim : {2, 3})
    for (const ShapeSet shapes : {ShapeSet::h12, ShapeSet::h16})
      for (const WeldMode mode : {WeldMode::edge, WeldMode::direction, WeldMode::full}) {
        Workspace model;
        model.add_body("plate",
                       std::make_unique<AncfPlate>(
                           dim, shapes,
                           std::vector<MaterialLine>{
                               testing::swinging_line(0, 0.02, 1.3), {0.1, {}}, {0.3, {}}},
                           testing::uniform_lines(-0.05, 0.05, 2)),
                       {}, {});
        testing::add_rigid(model, "hub", {.mass = 1, .inertia = 1});
        const BodyView views[] = {
            {&model.bodies()[0].name, model.bodies()[0].element.get(), model.bodies()[0].first_dof},
            {&model.bodies()[1].name, model.bodies()[1].element.get(),
             model.bodies()[1].first_dof}};
        const auto driven = make_weld("weld", "plate", "root", hub, mode);
        const auto carried = make_edge_weld("weld", "plate", "root", {.body = "hub"}, mode);
        driven->bind(views);
        carried->bind(views);
        ASSERT_EQ(driven->size(), carried->size());

        State s = model.reference();
        s.q.setRandom();
        s.v.setRandom();
        s.a.setRandom();
        testing::put(model, "hub",
                     {{x.value, y.value},
                      alpha.value,
                      {x.rate, y.rate},
                      alpha.rate,
                      {x.acceleration, y.acceleration},
                      alpha.acceleration},
                     s);
        // Φ, dΦ/dt and d²Φ/dt² of both joints; their rows are equal, but in another order.
        const auto measured = [&](const Joint& joint) {
          ConstraintRows rows;
          joint.evaluate(t, s.q, s.v, rows);
          VectorXd rate = rows.rate, acceleration = -rows.acceleration;
          for (const auto& entry : rows.jacobian) {
            rate[entry.row()] += entry.value() * s.v[entry.col()];
            acceleration[entry.row()] += entry.value() * s.a[entry.col()];
          }
          MatrixXd out(rows.value.size(), 3);
          out << rows.value, rate, acceleration;
          return out;
        };
        const MatrixXd one = measured(*driven), other = measured(*carried);
        for (Eigen::Index i = 0; i < one.rows(); ++i) {
          double best = 1;
          for (Eigen::Index j = 0; j < other.rows(); ++j)
            best = std::min(best, (one.row(i) - other.row(j)).cwiseAbs().maxCoeff());
          EXPECT_LT(best, 1e-14) << dim << ' ' << static_cast<int>(mode) << " row " << i;
        }
      }
}

TEST(BodyJoints, NameWhatTheyCannotUse) {
  const AncfPlate plate(2, ShapeSet::h16, testing::uniform_lines(0, 0.3, 2),
                        testing::uniform_lines(-0.05, 0.05, 2)),
      sheet = testing::swinging_plate(ShapeSet::h16),
      space(3, ShapeSet::h16, testing::uniform_lines(0, 0.3, 2),
            testing::uniform_lines(-0.05, 0.05, 2));
  const RigidBody one(1);
  const std::string names[] = {"plate", "sheet", "space", "one"};
  const BodyView views[] = {
      {&names[0], &plate, 0}, {&names[1], &sheet, 0}, {&names[2], &space, 0}, {&names[3], &one, 0}};
  const auto refused = [&](const std::unique_ptr<Joint>& joint,
                           const std::vector<std::string>& parts) {
    const std::string text = testing::error_of(Error::Kind::input, [&] { joint->bind(views); });
    for (const std::string& part : parts)
      EXPECT_TRUE(testing::mentions(text, part)) << part << ": " << text;
  };
  refused(make_revolute("j", {.body = "arm"}, {.body = "one"}), {"'j'", "no body", "'arm'"});
  refused(make_revolute("j", {}, {}), {"'j'", "ground"});
  refused(make_revolute("j", {.body = "one"}, {.body = "one", .point = {1, 0}}),
          {"'j'", "same", "'one'"});
  refused(make_slider("j", {.body = "one"}, {.body = "plate"}), {"'j'", "'plate'", "axes"});
  refused(make_revolute("j", {.body = "plate", .along = length}, {}), {"'j'", "'plate'", "axis"});
  refused(make_revolute("j", {.body = "plate", .point = {0.5, 0}}, {}), {"0.5", "outside"});
  refused(make_revolute("j", {.body = "sheet", .point = {0.2, 0}}, {}),
          {"'j'", "'sheet'", "material lines"});
  refused(make_revolute("j", {.body = "space"}, {}), {"'j'", "'space'", "plane"});
  refused(make_revolute("j", {.body = "one", .point = {NAN, 0}}, {}), {"'j'", "finite"});
  refused(make_unit_axis("j", "plate"), {"'j'", "'plate'", "axes"});
  refused(make_edge_weld("j", "plate", "side_low", {.body = "one"}, WeldMode::edge),
          {"'j'", "'side_low'", "across"});
  refused(make_edge_weld("j", "one", "root", {.body = "one"}, WeldMode::edge), {"'root'", "edges"});
  refused(make_weld("j", "one", "root", {}, WeldMode::edge), {"'root'", "edges"});
  EXPECT_THROW(make_angle_drive("j", {}, {.body = "one"}, {}), Error);
  EXPECT_THROW(make_point_drive("j", {.body = "one"}, {}, {}), Error);
  EXPECT_THROW(make_point_drive("j", {.body = "one"}, path, {2}), Error);
  EXPECT_THROW(make_distance("j", {}, {.body = "one"}, [](double) { return Motion{}; }), Error);
  const auto shrinking = make_distance("j", {}, {.body = "one"}, [](double t) {
    return Motion{1 - t, -1, 0};
  });
  shrinking->bind(views);
  ConstraintRows rows;
  EXPECT_THROW(shrinking->evaluate(1.5, VectorXd::Ones(4), VectorXd::Ones(4), rows), Error);
}

}  // namespace
}  // namespace flexmorph::fem
