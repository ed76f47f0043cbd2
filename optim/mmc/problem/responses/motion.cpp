#include "optim/mmc/problem/motion_response.h"
#include "optim/mmc/problem/responses/rows.h"

/// Responses of the motion of the mechanism, with exact gradients
/// (fem/dynamics/gradients/motion_gradient.h).
namespace flexmorph::mmc {
namespace {

template <const ResponseRow& row>
class OfMotion final : public Response {
 public:
  void evaluate(const DesignView& at, Values& out) override {
    if (!at.motion)
      throw Error::input("the " + std::string(row.words) +
                         " needs a motion, but there is no motion");
    at.motion->state->value(row, at.motion->body, out);
  }
};

}  // namespace

const ResponseRow kStrainEnergy{.name = "strain_energy",
                                .words = "strain energy in motion",
                                .unit = "J",
                                .of_motion = true,
                                .make = make_response<OfMotion<kStrainEnergy>>};

const ResponseRow kPeakStrainEnergy{.name = "peak_strain_energy",
                                    .words = "largest strain energy in motion",
                                    .unit = "J",
                                    .of_motion = true,
                                    .make = make_response<OfMotion<kPeakStrainEnergy>>};

extern const ResponseRow kDeflection, kTrajectoryError, kJointForce;

const ResponseRow kDeflection{.name = "deflection",
                              .words = "deflection of the free end",
                              .unit = "m",
                              .of_motion = true,
                              .of_body = true,
                              .make = make_response<OfMotion<kDeflection>>};

const ResponseRow kTrajectoryError{.name = "trajectory_error",
                                   .words = "trajectory error",
                                   .unit = "m",
                                   .of_motion = true,
                                   .make = make_response<OfMotion<kTrajectoryError>>};

const ResponseRow kJointForce{.name = "joint_force",
                              .words = "force in the joint that supports the body",
                              .unit = "N",
                              .of_motion = true,
                              .of_body = true,
                              .make = make_response<OfMotion<kJointForce>>};

}  // namespace flexmorph::mmc
