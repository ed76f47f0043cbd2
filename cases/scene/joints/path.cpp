#include <algorithm>

#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using fem::PlaneCurve;

const io::Key& coordinate_key(const char* name) {
  return io::key("joint", name)
      .name_of("a drive")
      .when("`type = \"path\"`")
      .description(std::string("Coordinate ") + name +
                   " of the curve in the axes of `a` from `point_a`: a drive with `until`.");
}
const io::Key &kX = coordinate_key("x"), &kY = coordinate_key("y");

const Drive& read_coordinate(const io::Table& t, const io::Key& key, const Scene& scene) {
  const std::string name = t.choice(key, names_of(scene.drives));
  const Drive& drive = *std::find_if(scene.drives.begin(), scene.drives.end(),
                                     [&](const Drive& d) { return d.name == name; });
  if (!drive.until)
    t.fail(key, "the drive '" + name +
                    "' is a function of time; a coordinate of a curve needs a drive with `until`");
  if (!drive.jump.empty()) t.fail(key, "in the drive '" + name + "' " + drive.jump);
  return drive;
}

PlaneCurve read_curve(const io::Table& t, const Scene& scene) {
  const Drive &x = read_coordinate(t, kX, scene), &y = read_coordinate(t, kY, scene);
  if (*x.until != *y.until)
    t.fail(kY, "the parameter of `y` ends at " + io::to_text(*y.until) +
                   ", but the parameter of `x` ends at " + io::to_text(*x.until));
  PlaneCurve curve(x.motion, y.motion, *x.until);
  if (const double s = curve.corner(); s >= 0)
    t.fail(kX, "the curve has no tangent, or a corner, at the parameter t = " + io::to_text(s, 4));
  if (curve.crosses_itself()) t.fail(kX, "the curve crosses itself");
  return curve;
}

void read(const io::Table& t, const Scene& scene, Joint& joint) {
  joint.a = read_anchor(t, kAnchorA, scene, true, true);
  joint.b = read_anchor(t, kAnchorB, scene, true, false);
  joint.a.given = joint.b.given = true;  // the default on the ground is [0, 0]
  if (joint.a.on_ground() && joint.b.on_ground())
    t.fail(
        "`a` and `b` are both the ground: `a` carries the curve, `b` carries the point, and at "
        "most one is the ground");
  if (joint.a.body == joint.b.body) t.fail(kAnchorB.body, "`a` and `b` are two different bodies");
  joint.own = read_curve(t, scene);
  name_between(t, scene, joint);
}

std::unique_ptr<fem::Joint> make(const Joint& joint, const JointParts& parts) {
  return fem::make_path(joint.name, parts.a, parts.b, std::any_cast<const PlaneCurve&>(joint.own));
}

}  // namespace

extern const JointRow kPath;
const JointRow kPath = {
    .name = "path",
    .sentence = "Guides point b along a curve on a, such as a cam, a slot or a rail.",
    .read = read,
    .make = make};

}  // namespace flexmorph::cases
