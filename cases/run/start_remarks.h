#pragma once

#include "cases/scene/scene.h"
#include "fem/model/model.h"

namespace flexmorph::cases {

/// What the start of a motion is other than the case says, by more than 1e-9 m, rad, m/s or rad/s:
/// a sentence for positions of rigid bodies that joints moved, one for velocities that are not
/// those given (a prestretched start adds the rates of what it stretches), one for velocities of
/// plates and beams that joints did not allow.
/// @param x  of the model, at the start
/// @param change  fem::MotionResult::start_change [m/s]
std::vector<std::string> start_remarks(const Scene& scene, const fem::Model& model,
                                       const fem::State& x, double change);

}  // namespace flexmorph::cases
