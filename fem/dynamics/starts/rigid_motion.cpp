#include "fem/dynamics/starts/rigid_motion.h"

#include "fem/dynamics/integrators/integrator.h"
#include "fem/solve/redundancy.h"

namespace flexmorph::fem {

RigidMotion::RigidMotion(RigidKinematics kinematics)
    : kinematics_(std::move(kinematics)), start_(kinematics_.guess()) {
  const bool moves = kinematics_.assemble(start_);
  const Diagnosis diagnosis = diagnose(kinematics_.model(), start_);
  indeterminate_ = !diagnosis.is_independent();
  if (diagnosis.is_contradictory() &&
      (!kinematics_.mechanism().bends || diagnosis.misses_positions()))
    throw kinematics_.refusal(diagnosis);
  if (indeterminate_ && !kinematics_.mechanism().bends)
    leave_out_redundant(kinematics_.model(), start_);
  if (moves) give_initial_velocities(kinematics_, start_);
  dofs_ = diagnosis.degrees_of_freedom();
  if (dofs_ > 0 || (indeterminate_ && diagnosis.is_contradictory())) return;
  driven_ = std::make_unique<Kinematics>(kinematics_.model(), start_);
}

bool RigidMotion::reaches(double t) {
  if (!indeterminate_) return true;
  if (!driven_) return false;
  try {
    driven_->at(t);
    return true;
  } catch (const Error&) {
    return false;
  }
}

const State& RigidMotion::at(double t) { return driven_ ? driven_->at(t) : start_; }

bool RigidMotion::follow(double t, int max_steps) {
  return !driven_ || driven_->follow(t, max_steps);
}

double RigidMotion::start_speed() const {
  return kinematics_.model().scales().cwiseProduct(start_.v).lpNorm<Eigen::Infinity>();
}

double RigidMotion::start_acceleration() {
  State x = start_;
  make_integrator(kinematics_.model(), {})->make_consistent(x);
  return kinematics_.model().scales().cwiseProduct(x.a).lpNorm<Eigen::Infinity>();
}

void require_motion(RigidKinematics kinematics, double end) {
  constexpr int kTimes = 200;
  RigidMotion motion(std::move(kinematics));
  // Flexible plates may reach positions that the rigid model cannot reach.
  const bool bends = motion.kinematics().mechanism().bends;
  if (motion.degrees_of_freedom() > 0 || (bends && motion.is_indeterminate())) return;
  // For drives with thousands of revolutions it is sufficient to check the first ones.
  constexpr int kMaxSteps = 4000;
  for (int k = 1; k <= kTimes; ++k)
    if (!motion.follow(end * k / kTimes, kMaxSteps)) return;
}

namespace {

/// The function that rigid_configuration() returns; the motion of a copy begins with its first
/// call.
class Configuration {
 public:
  explicit Configuration(RigidKinematics kinematics) : kinematics_(std::move(kinematics)) {}
  Configuration(const Configuration& other) : kinematics_(other.kinematics_) {}
  Configuration& operator=(const Configuration&) = delete;

  std::vector<BodyPose> operator()(double t) {
    if (!motion_) motion_ = std::make_unique<RigidMotion>(kinematics_);
    const State& x = motion_->at(t);
    std::vector<BodyPose> out;
    for (const MechanismBody& b : kinematics_.mechanism().bodies)
      if (b.is_placed) out.push_back({b.name, motion_->kinematics().frame(b.name, x), b.line});
    return out;
  }

 private:
  RigidKinematics kinematics_;
  std::unique_ptr<RigidMotion> motion_;
};

}  // namespace

BodyPoses rigid_configuration(RigidKinematics kinematics) {
  return Configuration(std::move(kinematics));
}

}  // namespace flexmorph::fem
