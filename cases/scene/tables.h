#pragma once

#include <string>
#include <vector>

#include "io/case_files/key.h"

/// The tables at the top of a case file. Their keys are declared beside the code that reads them.
namespace flexmorph::cases::tables {

extern const io::Key &kConstants, &kTime, &kStatic, &kDrive, &kHub, &kRigidBody, &kBody, &kJoint,
    &kSpring, &kTrajectory, &kPointMass, &kLoad, &kObserve, &kMeasure, &kDomain, &kSupport, &kEsl,
    &kDesign, &kOptimizer, &kCycle, &kVerify, &kCertificate, &kOutput, &kAccuracy, &kExpect;
extern const io::Key& kGravity;  // no table, but at the top, too

/// All tables ("" is the file itself, "body.flow" a table in a table), as people read about them.
const std::vector<std::string>& order();

}  // namespace flexmorph::cases::tables
