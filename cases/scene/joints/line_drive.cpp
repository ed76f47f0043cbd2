#include <cmath>

#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::to_text;

const io::Key& kLine = io::key("joint", "line")
                           .integer("a free m-line", 0, std::numeric_limits<int>::max())
                           .when("`type = \"line_drive\"`")
                           .description("Number of the free line that is driven.");
const io::Key& kAt = io::key("joint", "at")
                         .name_of("a drive")
                         .otherwise_as("the line moves at `speed`")
                         .when("`type = \"line_drive\"`")
                         .description("Drive of the material coordinate of the line.");
const io::Key& kSpeed =
    io::key("joint", "speed")
        .number(io::any_number("the speed of a line", "m/s"))
        .otherwise(0.0)
        .when("`type = \"line_drive\"`")
        .description(
            "Speed of the line through the material; 0 holds the line at its material coordinate.");

double start_of_line(const Body& body, const Joint& joint) {
  return body.start_lines(0, body.elements[0])[static_cast<size_t>(joint.line)];
}

void read(const io::Table& t, const Scene& scene, Joint& joint) {
  const Body& body = read_jointed_body(t, scene, joint);
  joint.drives_line = true;
  joint.line = t.integer(kLine.within(0, body.elements[0]));
  joint.name = joint.body + ".line " + std::to_string(joint.line);
  const bool free = std::any_of(body.lines.begin(), body.lines.end(),
                                [&](const BodyLine& l) { return l.free && l.index == joint.line; });
  if (!free) t.fail(kLine, "a driven line is free, see [[body.line]]");
  if (t.has(kAt)) {
    if (t.has(kSpeed)) t.fail(kSpeed, "a line has either a `speed` or a drive `at`");
    joint.at.drive = t.choice(kAt, names_of(scene.drives));
    const double start = scene.motion_of(joint.at)(0).value, line = start_of_line(body, joint);
    if (std::abs(start - line) > 1e-9)
      t.fail(kAt, "this drive starts at " + to_text(start) + " m, but the line starts at " +
                      to_text(line) + " m");
  } else {
    joint.speed = t.number(kSpeed);
  }
  if (scene.statics && joint.speed != 0)
    t.fail(kSpeed, "in a [static] analysis the speed of a line is 0");
  for (const Joint& other : scene.joints)
    if (other.drives_line && other.body == joint.body && other.line == joint.line)
      t.fail(kLine, "this line of '" + joint.body + "' is driven already");
}

std::unique_ptr<fem::Joint> make(const Joint& joint, const JointParts& parts) {
  if (parts.rigid) return nullptr;
  const Body& body = parts.scene.body(joint.body);
  std::function<fem::Motion(double)> motion = [start = start_of_line(body, joint),
                                               speed = joint.speed](double t) {
    return fem::Motion{start + speed * t, speed, 0};
  };
  if (!joint.at.drive.empty()) motion = parts.scene.motion_of(joint.at);
  const auto number = std::count_if(body.lines.begin(), body.lines.end(), [&](const BodyLine& l) {
    return l.free && l.index < joint.line;  // lines before it among the free lines of its body
  });
  return fem::make_line_drive(joint.name, joint.body, static_cast<int>(number), std::move(motion));
}

}  // namespace

extern const JointRow kLineDrive;
const JointRow kLineDrive = {
    .name = "line_drive",
    .sentence =
        "Moves a free line through the material at a constant speed, or as a drive prescribes.",
    .read = read,
    .make = make};

}  // namespace flexmorph::cases
