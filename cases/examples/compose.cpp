// A carriage slides along a guide and is decelerated by air drag, while a boom is deployed from it.
// The program writes the boom for ParaView, and compares the final speed with that of a carriage
// whose boom is rigid.
//   compose FOLDER
#include <cstdio>
#include <filesystem>
#include <numbers>

#include "cases/output/surface.h"
#include "cases/scene/elements/row.h"
#include "fem/body_joints.h"
#include "fem/dynamics/starts/rigid_kinematics.h"
#include "fem/elements/ancf_plate.h"
#include "fem/force_elements/pair_force_element.h"
#include "fem/terms.h"

using namespace flexmorph;
const double kMass = 2, kDrag = 1, kSpeed = 1, kShort = 0.3, kLong = 0.6, kWidth = 0.05, kEnd = 1;
const double kGrowth = 0.2;                                // rate of the length of the boom [m/s]
const fem::PlaneSection kSection(0.002, 7e10, 0.3, 2700);  // thickness, E, Poisson ratio, density

/// A user-defined force element: the drag c |v| v of the air on point a.
class Drag final : public fem::PairForceElement {
 public:
  explicit Drag(const fem::MarkerLocation& a)
      : PairForceElement("air", a, {}, {Part::kPositionA}, true) {}
  std::unique_ptr<ForceElement> clone() const override { return std::make_unique<Drag>(*this); }

 protected:
  void fill(const fem::State&, const Values&, const Values& rate, fem::PairForce& out) const final {
    const Vec2 v = rate.head<2>();
    const double speed = std::max(v.norm(), 1e-12);
    out.s.head<2>() = kDrag * speed * v;
    out.s_rate.topLeftCorner<2, 2>() =
        kDrag * (speed * Eigen::Matrix2d::Identity() + v * v.transpose() / speed);
  }
};

/// Returns the elements of the boom. The mesh line at the root moves through the material; all
/// other mesh lines have constant material coordinates.
std::unique_ptr<fem::Element> growing_plate() {
  std::vector<fem::MaterialLine> along, across;
  for (int i = 0; i <= 4; ++i) along.push_back({kLong - kShort * (4 - i) / 4, {}});
  along[0].drive = [](double t) { return fem::Motion{kLong - kShort - kGrowth * t, -kGrowth, 0}; };
  for (const double y : {-0.5, 0.0, 0.5}) across.push_back({y * kWidth, {}});
  return std::make_unique<fem::AncfPlate>(2, fem::AncfPlate::ShapeSet::h16, along, across);
}

int main(int argc, char** argv) {
  const std::filesystem::path folder = argc > 1 ? argv[1] : ".";
  const fem::MarkerLocation carriage{.body = "carriage"},
      up{"carriage", {0, 0}, std::numbers::pi / 2};
  fem::Workspace model;
  fem::add_rigid_body(model, {"carriage", {kMass, {0, 0}, 0.01}, 0.1}, VectorXd());
  const std::vector<std::string> terms{"inertia", "membrane_assumed"};
  model.add_body("boom", growing_plate(), kSection, fem::make_terms(terms, kSection, {}));
  model.add_joint(fem::make_slider("guide", {}, carriage));
  model.add_joint(fem::make_edge_weld("root", "boom", "root", up, fem::WeldMode::edge));
  model.add_force_element(std::make_unique<Drag>(carriage));
  const fem::MovingRoot growth{"boom", fem::DrivenFrame(up.body, up.point, up.angle)};
  fem::MotionSettings settings{.end = kEnd, .step = 1e-3, .start = fem::Start::rigid};
  settings.body_poses = [](double t) {
    const fem::FrameMotion running{.origin = {kSpeed * t, 0}, .origin_rate = {kSpeed, 0}};
    return std::vector<fem::BodyPose>{{"carriage", running}};
  };
  for (int frame = 1; frame <= 20; ++frame) settings.stops.push_back(kEnd * frame / 20);
  std::filesystem::create_directories(folder);
  io::Series frames(folder / "boom.pvd");
  const auto write = [&](const fem::MotionStep& step) {
    if (!step.stop && step.x.t > 0) return;
    const fem::ReferencePose start{.angle = up.angle, .line = kLong - kShort};
    const cases::Surface boom = cases::deformed_surface(*cases::find_element("ale_ancf_plate"),
                                                        step.model.body("boom"), step.x, start);
    const std::string name = "boom_" + std::to_string(frames.size()) + ".vtu";
    const io::Field displacement{"displacement", boom.displacement, 2};
    io::write_quad_mesh(folder / name, boom.mesh, {}, {&displacement, 1});
    frames.add(step.x.t, name);
  };
  const fem::MotionResult result = fem::integrate(model, {&growth, 1}, settings, write);
  const double v = fem::frame_of(model.body("carriage"), result.final).origin_rate.x();
  // With a rigid boom, deployed material has the speed of the carriage: (m + m' t) dv/dt = -c v².
  const double per_time = kSection.density * kSection.thickness * kWidth * kGrowth,
               mass = kMass + per_time * kShort / kGrowth;
  const double rigid = 1 / (1 / kSpeed + kDrag / per_time * std::log1p(per_time * kEnd / mass));
  std::printf("%zu changes of the mesh; %.5f m/s, with a rigid boom %.5f m/s\n",
              result.events.size(), v, rigid);
  return std::abs(v / rigid - 1) < 0.01 ? 0 : 1;
}
