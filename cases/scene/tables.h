#pragma once

#include <string>
#include <vector>

#include "io/case_files/key.h"

/// The tables at the top level of a case file. The keys of each table are declared in the source
/// file that reads them.
namespace flexmorph::cases::tables {

extern const io::Key &kConstants, &kTime, &kStatic, &kDrive, &kHub, &kRigidBody, &kBody, &kJoint,
    &kSpring, &kTrajectory, &kPointMass, &kLoad, &kObserve, &kMeasure, &kDomain, &kSupport, &kEsl,
    &kDesign, &kOptimizer, &kCycle, &kVerify, &kCertificate, &kOutput, &kAccuracy, &kExpect;
extern const io::Key& kGravity;  // a key at the top level that is not a table

/// Returns the names of all tables in the order in which the reference lists them. "" is the file
/// itself, and "body.flow" is a table inside [[body]].
const std::vector<std::string>& order();

/// Returns true for a key of which no result depends: the title and the expected results of a case.
/// @param path  path of the key: "expect.volume.value"
bool only_describes(const std::string& path);

}  // namespace flexmorph::cases::tables
