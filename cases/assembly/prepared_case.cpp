#include "cases/assembly/prepared_case.h"

namespace flexmorph::cases {

PreparedCase::PreparedCase(Scene scene) : parts_(std::make_unique<Parts>(std::move(scene))) {}

const Mechanism& PreparedCase::mechanism(const MeshChoice& mesh) const {
  const std::lock_guard guard(parts_->lock);
  const auto found = parts_->mechanisms.find(mesh);
  if (found != parts_->mechanisms.end()) return found->second;
  Mechanism built = build_mechanism(parts_->scene, mesh, rigid());
  ++parts_->counts.mechanisms;
  return parts_->mechanisms.emplace(mesh, std::move(built)).first->second;
}

const fem::RigidKinematics* PreparedCase::rigid() const {
  if (!parts_->scene.is_mechanism()) return nullptr;
  const std::lock_guard guard(parts_->lock);
  if (!parts_->rigid) {
    parts_->rigid = rigid_kinematics(parts_->scene);
    ++parts_->counts.rigid;
  }
  return &*parts_->rigid;
}

const std::vector<mmc::BodyProblem>& PreparedCase::design_problems() const {
  const std::lock_guard guard(parts_->lock);
  if (!parts_->problems) {
    parts_->problems = build_problems(parts_->scene);
    ++parts_->counts.design_problems;
  }
  return *parts_->problems;
}

const ResourceEstimate& PreparedCase::resource_estimate() const {
  const std::lock_guard guard(parts_->lock);
  if (!parts_->resource_estimate) parts_->resource_estimate = estimate_resources(parts_->scene);
  return *parts_->resource_estimate;
}

PreparedCase::Counts PreparedCase::counts() const {
  const std::lock_guard guard(parts_->lock);
  return parts_->counts;
}

}  // namespace flexmorph::cases
