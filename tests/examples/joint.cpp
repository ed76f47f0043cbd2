#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"
#include "fem/joints/pair_joint.h"

/// Complete example of a joint: the axes of two bodies stay parallel.
namespace flexmorph::cases {
namespace {

class Parallel final : public fem::PairJoint {  // Φ = e_a × e_b
 public:
  Parallel(const std::string& name, const JointParts& parts)
      : PairJoint(name, parts.a, parts.b,
                  {{bits({Part::kAxisA, Part::kAxisB})}, {{Part::kAxisA, Part::kAxisB}}}) {}
  std::unique_ptr<fem::Joint> clone() const override { return std::make_unique<Parallel>(*this); }

 private:
  void fill(double, const Values& y, std::vector<fem::PairRow>& rows) const override {
    const Vec2 a = y.segment<2>(Part::kAxisA), b = y.segment<2>(Part::kAxisB);
    rows[0].f = a.x() * b.y() - a.y() * b.x();
    rows[0].f_y.segment<2>(Part::kAxisA) = Vec2(b.y(), -b.x());
    rows[0].f_y.segment<2>(Part::kAxisB) = Vec2(-a.y(), a.x());
    rows[0].f_yy.block<2, 2>(Part::kAxisA, Part::kAxisB) << 0, 1, -1, 0;
    rows[0].f_yy.block<2, 2>(Part::kAxisB, Part::kAxisA) << 0, -1, 1, 0;
  }
};

}  // namespace

extern const JointRow kParallel;
const JointRow kParallel = {
    .name = "parallel",
    .sentence = "The first axes of two bodies stay parallel.",
    .read =
        [](const io::Table& t, const Scene& scene, Joint& joint) {
          const auto [a, b] = read_anchors(t, scene, false, true);
          joint.a = a, joint.b = b;
          name_between(t, scene, joint);
        },
    .make = [](const Joint& j, const JointParts& parts) -> std::unique_ptr<fem::Joint> {
      return std::make_unique<Parallel>(j.name, parts);
    },
    .has_force = false,
    .has_moment = true};

}  // namespace flexmorph::cases
