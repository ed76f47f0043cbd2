#include "cases/output/animation_writer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cases/assembly/joints.h"
#include "cases/output/rigid_fit.h"
#include "cases/scene/elements/row.h"
#include "cases/scene/joints/row.h"
#include "fem/dynamics/mesh_changes/moving_root.h"
#include "fem/dynamics/starts/driven_frame.h"
#include "fem/dynamics/starts/reference_pose.h"
#include "io/surfaces.h"

namespace flexmorph::cases {
namespace {

constexpr int kAlong = 24;  // intervals of the grid of a body along its axis

double angle_of(const Vec2& direction) { return std::atan2(direction.y(), direction.x()); }

void append(std::vector<double>& out, const Vec2& origin, double angle) {
  out.insert(out.end(), {origin.x(), origin.y(), angle});
}
void append(std::vector<double>& out, const fem::FrameMotion& frame) {
  append(out, frame.origin, frame.angle);
}

/// Returns the rigid motion of points in the plane (2 n) that is nearest to their present positions
/// (2 n).
fem::FrameMotion nearest_pose(std::span<const double> shape, std::span<const double> points) {
  const RigidFit fit = rigid_fit(2, shape, points);
  fem::FrameMotion out;
  out.angle = angle_of(fit.rotation.col(0).head<2>());
  out.origin = fit.translation.head<2>();
  return out;
}

/// Tells whether the root edge of a body is held, so that its rigid motion is that of this edge.
bool has_held_root(const Scene& scene, const std::string& body) {
  return std::any_of(scene.joints.begin(), scene.joints.end(), [&](const Joint& j) {
    return j.holds_frame() && j.body == body && j.edge == "root";
  });
}

/// Returns the place of a point in the plane of the animation.
Vec2 in_picture(const Scene& scene, const Vec3& point) {
  return (scene.in_space() ? io::seen_from_above(point) : point).head<2>();
}

/// Returns the time of the drives at a step; there is none in a path of equilibria.
double drive_time(const Scene& scene, const StepRecord& step) {
  return scene.statics ? 0 : step.abscissa;
}

/// The anchors of the drawn joints and springs of a scene.
struct DrawnAnchor {
  const Joint* joint;
  Anchor at;
};
std::vector<DrawnAnchor> drawn_joints(const Scene& scene) {
  std::vector<DrawnAnchor> out;
  for (const Joint& joint : scene.joints) {
    if (joint.joins_edges() || joint.holds_edges() || joint.drives_line || joint.holds_frame())
      continue;
    if (joint.between_bodies())
      out.push_back({&joint, joint.a.on_ground() ? completed(scene, joint.b, joint.a)
                                                 : completed(scene, joint.a, joint.b)});
    else if (!joint.body.empty())
      out.push_back({&joint, {joint.body, joint.point}});
  }
  return out;
}

/// Tells whether a joint is a frame at rest through which material slides.
bool is_sleeve(const Joint& joint) {
  return joint.holds_frame() && joint.to.empty() && !joint.on_rigid_body();
}

bool is_driven(const Joint& joint) {
  return std::any_of(joint.laws.begin(), joint.laws.end(),
                     [](const Law& law) { return !law.drive.empty(); });
}

}  // namespace

AnimationWriter::AnimationWriter(const BodyShapes& shapes, int n, Animation& out)
    : shapes_(shapes), n_(n), out_(out) {}

/// Returns the points of a rigid body at which joints and springs act, in its axes (2 n) [m].
std::vector<double> AnimationWriter::anchors_on(const std::string& rigid_body) const {
  const Scene& scene = shapes_.scene();
  std::vector<double> out;
  const auto add = [&](const Anchor& anchor, const Anchor& other) {
    if (anchor.body != rigid_body) return;
    const Vec2 point = completed(scene, anchor, other).point;
    out.insert(out.end(), {point.x(), point.y()});
  };
  for (const Joint& joint : scene.joints) {
    if (joint.joins_edges() || joint.holds_frame() || !joint.between_bodies()) continue;
    add(joint.a, joint.b);
    add(joint.b, joint.a);
  }
  for (const Spring& spring : scene.springs) {
    if (!spring.row->points) continue;
    add(spring.a, spring.b);
    add(spring.b, spring.a);
  }
  return out;
}

/// Creates the bodies, marks and springs, without frames.
void AnimationWriter::begin() {
  const Scene& scene = shapes_.scene();
  for (const Body& body : scene.bodies) {
    AnimatedBody& grid = out_.bodies.emplace_back();
    grid.name = body.name;
    grid.along = kAlong;
    grid.across = body.width > 0 && body.row->across ? 2 : 0;
    grid.width = body.width;
  }
  const bool in_plane = !scene.in_space();
  for (const RigidBody& body : scene.rigid_bodies) {
    AnimatedBody& rigid = out_.bodies.emplace_back();
    rigid.name = body.name;
    rigid.kind = AnimatedBody::Kind::rigid;
    if (!body.size.isZero())
      for (const Vec2& corner :
           {Vec2(-0.5, -0.5), Vec2(0.5, -0.5), Vec2(0.5, 0.5), Vec2(-0.5, 0.5)})
        for (int c = 0; c < 2; ++c)
          rigid.shape.push_back(body.center[c] + corner[c] * body.size[c]);
    rigid.anchors = anchors_on(body.name);
  }
  for (const Hub& hub : scene.hubs) {
    if (!in_plane) break;
    AnimatedBody& disc = out_.bodies.emplace_back();
    disc.name = hub.name;
    disc.kind = AnimatedBody::Kind::hub;
    disc.width = drawn_radius(scene, hub);
  }
  for (const PointMass& mass : scene.point_masses) {
    AnimatedBody& disc = out_.bodies.emplace_back();
    disc.name = mass.body + "_mass";
    disc.kind = AnimatedBody::Kind::mass;
    disc.width = drawn_radius(scene, mass);
  }
  for (const Observe& point : scene.observed)
    out_.marks.push_back({point.body + "." + point.name, "observe", false, false, {}});
  if (!in_plane) return;
  for (const DrawnAnchor& each : drawn_joints(scene)) {
    const Joint& joint = *each.joint;
    const bool ground = !joint.between_bodies() || joint.a.on_ground() || joint.b.on_ground();
    out_.marks.push_back(
        {joint.named ? joint.name : "", joint.row->name, ground, is_driven(joint), {}});
  }
  for (const Joint& joint : scene.joints)
    if (is_sleeve(joint))
      out_.marks.push_back({joint.named ? joint.name : "", joint.row->name, true, false, {}});
  for (const Spring& spring : scene.springs)
    out_.springs.push_back({spring.named ? spring.name : "", spring.row->name, {}});
}

void AnimationWriter::add(const StepRecord& step) {
  const Scene& scene = shapes_.scene();
  const auto shown = static_cast<double>(out_.time.size());
  const bool is_motion = !scene.statics;
  if (is_motion && (shown >= n_ || step.abscissa < shown / (n_ - 1) * scene.time.end - 1e-9))
    return;
  if (out_.time.empty()) begin();
  out_.time.push_back(step.abscissa);
  if (!is_motion) out_.factor.push_back(step.row[1]);
  add_bodies(step);
  add_marks(step);
}

void AnimationWriter::add_grid(const StepRecord& step, size_t body, AnimatedBody& out) const {
  const Scene& scene = shapes_.scene();
  const Body& drawn = scene.bodies[body];
  const fem::Body& model = step.model.body(drawn.name);
  const std::vector<double> lines = model.element->lines()[0];
  const double root = lines.front(), end = lines.back();
  const double curvature = shapes_.pose_of(body).curvature;
  std::vector<double> shape, points;
  for (int i = 0; i <= out.along; ++i)
    for (int j = 0; j <= out.across; ++j) {
      const double y = out.across == 0 ? 0 : drawn.low() + drawn.width * j / out.across;
      const double x = i == out.along ? end : root + (end - root) * i / out.along;
      const Vec3 p = fem::point_position(model, step.x, {x, y});
      const Vec2 from = fem::location_on_arc(curvature, {x - root, y});
      shape.insert(shape.end(), {from.x(), from.y()});
      points.insert(points.end(), {p.x(), p.y()});
    }
  fem::FrameMotion pose;
  if (has_held_root(scene, drawn.name)) {
    const double step_x = 1e-6 * (end - root);
    const auto at = [&](double x, double y) -> Vec2 {
      return fem::point_position(model, step.x, {x, y}).head<2>();
    };
    pose.origin = at(root, 0);
    pose.angle = out.across > 0
                     ? angle_of(at(root, drawn.low() + drawn.width) - at(root, drawn.low())) -
                           0.5 * std::numbers::pi
                     : angle_of(at(root + step_x, 0) - pose.origin);
  } else {
    pose = nearest_pose(shape, points);
  }
  append(out.poses, pose);
  out.roots.push_back(root);
  out.largest = end;
  out.points.insert(out.points.end(), points.begin(), points.end());
  if (!drawn.flow && !drawn.has_eulerian_lines()) out.shape = std::move(shape);
}

void AnimationWriter::add_grid_in_space(const StepRecord& step, size_t body,
                                        AnimatedBody& out) const {
  const Body& drawn = shapes_.scene().bodies[body];
  const fem::Body& model = step.model.body(drawn.name);
  const std::vector<double> lines = model.element->lines()[0];
  const double root = lines.front(), end = lines.back();
  std::vector<double> from, to;
  for (int i = 0; i <= out.along; ++i)
    for (int j = 0; j <= out.across; ++j) {
      const Vec2 material(i == out.along ? end : root + (end - root) * i / out.along,
                          out.across == 0 ? 0 : drawn.low() + drawn.width * j / out.across);
      const Vec3 before = shapes_.pose_of(body).location(material),
                 now = fem::point_position(model, step.x, material);
      from.insert(from.end(), before.begin(), before.end());
      to.insert(to.end(), now.begin(), now.end());
    }
  const RigidFit fit = rigid_fit(3, from, to);
  for (size_t k = 0; k < from.size(); k += 3) {
    const Vec3 before(from[k], from[k + 1], from[k + 2]), now(to[k], to[k + 1], to[k + 2]);
    const Vec3 point = io::seen_from_above(now),
               rigid = io::seen_from_above(fit.rotation * before + fit.translation);
    out.points.insert(out.points.end(), {point.x(), point.y()});
    out.rigid.insert(out.rigid.end(), {rigid.x(), rigid.y()});
  }
  out.roots.push_back(root);
  out.largest = end;
}

void AnimationWriter::add_bodies(const StepRecord& step) {
  const Scene& scene = shapes_.scene();
  size_t next = 0;
  for (size_t i = 0; i < scene.bodies.size(); ++i)
    if (scene.in_space())
      add_grid_in_space(step, i, out_.bodies[next++]);
    else
      add_grid(step, i, out_.bodies[next++]);
  for (const RigidBody& body : scene.rigid_bodies)
    append(out_.bodies[next++].poses, fem::frame_of(step.model.body(body.name), step.x));
  for (const Hub& hub : scene.hubs) {
    if (scene.in_space()) break;
    Joint held;  // stands for a joint that is welded to the hub
    held.to = hub.name;
    append(out_.bodies[next++].poses, hub_drive(scene, held)(drive_time(scene, step)));
  }
  for (const PointMass& mass : scene.point_masses) {
    fem::FrameMotion frame;
    frame.origin =
        in_picture(scene, fem::point_position(step.model.body(mass.body), step.x, mass.point));
    append(out_.bodies[next++].poses, frame);
  }
}

void AnimationWriter::add_marks(const StepRecord& step) {
  const Scene& scene = shapes_.scene();
  size_t next = 0;
  const auto location = [&](const Anchor& at) {
    return step.model.location_motion({at.body, at.point, at.angle, {}}, step.x);
  };
  for (const Observe& point : scene.observed) {
    const Vec3 p = fem::point_position(step.model.body(point.body), step.x, point.point);
    append(out_.marks[next++].at, in_picture(scene, p), 0);
  }
  if (scene.in_space()) return;
  for (const DrawnAnchor& each : drawn_joints(scene)) {
    const fem::LocationMotion at = location(each.at);
    append(out_.marks[next++].at, at.position, angle_of(at.axis));
  }
  for (const Joint& joint : scene.joints)
    if (is_sleeve(joint)) append(out_.marks[next++].at, joint.position, joint.angle);
  for (size_t i = 0; i < scene.springs.size(); ++i) {
    const Spring& spring = scene.springs[i];
    const Vec2 a = location(completed(scene, spring.a, spring.b)).position,
               b = location(completed(scene, spring.b, spring.a)).position;
    std::vector<double>& ends = out_.springs[i].ends;
    ends.insert(ends.end(), {a.x(), a.y(), b.x(), b.y()});
  }
}

}  // namespace flexmorph::cases
