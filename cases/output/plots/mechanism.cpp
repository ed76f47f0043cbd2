#include <algorithm>

#include "cases/output/plots/plots.h"
#include "cases/scene/joints/row.h"

namespace flexmorph::cases {
namespace {

constexpr int kSamples = 400;
constexpr const char* kTime = "time [s]";

/// Names of the drives that are used: drives of lengths and coordinates, and drives of angles. With
/// a trajectory only the drives that follow from it are listed.
struct UsedDrives {
  std::vector<std::string> lengths, angles;

  explicit UsedDrives(const Scene& scene) {
    for (const Hub& hub : scene.hubs) {
      add(hub.turn, angles);
      for (const Law& law : hub.path) add(law, lengths);
    }
    for (const Body& body : scene.bodies)
      if (body.flow) add(body.flow->length, lengths);
    for (const Joint& joint : scene.joints) {
      for (const Law& law : joint.laws) add(law, joint.row->drives_angle ? angles : lengths);
      add(joint.at, lengths);
    }
    if (!scene.trajectory) return;
    const auto is_path = [&](const std::string& name) {
      return !scene.follows_trajectory({name, 0});
    };
    std::erase_if(lengths, is_path);
    std::erase_if(angles, is_path);
  }

 private:
  static void add(const Law& law, std::vector<std::string>& names) {
    const bool known = std::find(names.begin(), names.end(), law.drive) != names.end();
    if (!law.drive.empty() && !known) names.push_back(law.drive);
  }
};

bool varies(const std::vector<double>& y) {
  return std::any_of(y.begin(), y.end(), [](double each) { return each != 0; });
}

}  // namespace

io::Figure inputs_plot(const Scene& scene) {
  const UsedDrives used(scene);
  io::Figure figure;
  figure.title =
      scene.trajectory ? "Inputs for the trajectory of " + scene.trajectory->body : "Inputs";
  const auto add = [&](const std::vector<std::string>& names, const char* label) {
    if (names.empty()) return;
    io::Panel panel;
    panel.x.label = kTime;
    panel.y.label = label;
    for (const std::string& name : names) {
      io::Curve curve{name};
      const auto motion = scene.motion_of({name, 0});
      for (int k = 0; k <= kSamples; ++k) {
        curve.x.push_back(scene.time.end * k / kSamples);
        curve.y.push_back(motion(curve.x.back()).value);
      }
      panel.curves.push_back(std::move(curve));
    }
    figure.panels.push_back(std::move(panel));
  };
  add(used.lengths, "length [m]");
  add(used.angles, "angle [rad]");
  return figure;
}

io::Figure error_plot(const Scene& scene, const MotionRecord& design,
                      const std::optional<MotionRecord>& uniform) {
  if (!scene.trajectory) return {};
  const std::string& body = scene.trajectory->body;
  io::Figure figure;
  figure.title = "Deviation of " + body + " from its trajectory";
  for (const auto& [quantity, label] : {std::pair{".delta_x", "\xCE\x94x [m]"},
                                        {".delta_y", "\xCE\x94y [m]"},
                                        {".delta_angle", "\xCE\x94 angle [rad]"}}) {
    io::Panel panel;
    panel.x.label = kTime;
    panel.y.label = label;
    const std::string column = body + quantity;
    const auto add = [&](const char* name, const MotionRecord& motion, bool second) {
      if (const auto* values = motion.table.find(column)) {
        io::Curve curve{name, motion.time(), *values};
        curve.dashed = second;
        panel.curves.push_back(std::move(curve));
      }
    };
    add(uniform ? "optimized" : "", design, false);
    if (uniform) add("uniform material", *uniform, true);
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

std::string snapshot_plot(const MotionRecord& motion) {
  const bool any =
      std::any_of(motion.snapshots.begin(), motion.snapshots.end(),
                  [](const io::PlaneFrame& f) { return !f.plates.empty() || !f.outlines.empty(); });
  return any ? io::plane_frames_svg("Snapshots of the mechanism", motion.snapshots) : "";
}

io::Figure joint_forces_plot(const Scene& scene, const MotionRecord& motion) {
  io::Figure figure;
  figure.title = "Joint forces";
  figure.panel_height = 230;
  for (const Joint& joint : scene.joints) {
    if (!joint.named) continue;
    const bool acts_on_a = joint.b.on_ground();
    const std::vector<std::string>& redundant = motion.result.redundant_joints;
    const std::string title = joint.name + ", on " + (acts_on_a ? joint.a.body : joint.b.body) +
                              (std::ranges::count(redundant, joint.name) ? ", not unique" : "");
    const auto add = [&](const std::vector<std::pair<const char*, const char*>>& quantities,
                         const char* label) {
      io::Panel panel;
      panel.title = title;
      panel.x.label = kTime;
      panel.y.label = label;
      bool any = false;
      for (const auto& [quantity, name] : quantities)
        if (const auto* values = motion.table.find(joint.name + "." + quantity)) {
          any = any || varies(*values);
          panel.curves.push_back({name, motion.time(), *values});
        }
      if (any) figure.panels.push_back(std::move(panel));
    };
    // A component that a joint cannot transmit is zero up to rounding and has no panel.
    if (joint.row->has_force) add({{"force_x", "x"}, {"force_y", "y"}}, "force [N]");
    if (joint.row->has_moment) add({{"moment", ""}}, "moment [N m]");
    add({{"power", ""}}, "power [W]");
  }
  return figure;
}

}  // namespace flexmorph::cases
