#pragma once

#include "cases/scene/scene.h"
#include "fem/model/model.h"

namespace flexmorph::cases {

/// Returns remarks on the differences between the start of a motion and the case, if they exceed
/// 1e-9 m, rad, m/s or rad/s. One remark names the rigid bodies whose positions were changed by
/// joints. One names the velocities that differ from the given ones; a prestretched start adds the
/// rates of the bodies that it stretches. One reports velocities of plates and beams that were
/// changed because joints did not allow them.
/// @param x       state of the model at the start
/// @param change  fem::MotionResult::start_change [m/s]
std::vector<std::string> start_remarks(const Scene& scene, const fem::Model& model,
                                       const fem::State& x, double change);

}  // namespace flexmorph::cases
