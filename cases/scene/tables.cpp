#include "cases/scene/tables.h"

namespace flexmorph::cases::tables {
namespace {

/// Declares a table that a case may contain once.
io::Key& one(const char* name, const char* absence = "absent") {
  return io::key("", name).table().otherwise_as(absence);
}

/// Declares a list of tables.
io::Key& many(const char* name) { return io::key("", name).tables_of().otherwise_as("none"); }

constexpr const char* kDefaults = "default values";

}  // namespace

const io::Key& kGravity = io::key("", "gravity")
                              .numbers_or_names(io::any_number("gravity", "m/s^2"), "a drive", 2, 3)
                              .otherwise_as("no gravity")
                              .description(
                                  "Acceleration of gravity: 2 components, in space 3. With a "
                                  "[domain] it defines the weight.");
const io::Key& kConstants =
    one("constants").description("Named constants for formulas of drives and of numbers.");
const io::Key& kTime =
    one("time").description("Duration, time integration and initial state of the motion.");
const io::Key& kStatic = one("static").description(
    "Nonlinear static analysis in place of a motion, under loads or temperatures that increase.");
const io::Key& kDrive = many("drive").description(
    "A named function of time, or a coordinate of the curve of a `path` joint.");
const io::Key& kHub =
    many("hub").description("A rigid frame with prescribed motion that carries plates or beams.");
const io::Key& kRigidBody = many("rigid_body").description("A rigid body of a mechanism.");
const io::Key& kBody = many("body").description("A plate or a beam.");
const io::Key& kJoint =
    many("joint").description("A joint that holds or drives a body, or connects two bodies.");
const io::Key& kSpring = many("spring").description(
    "A spring, damper, bushing or stop between two bodies, or a body and the ground.");
const io::Key& kTrajectory =
    one("trajectory")
        .description(
            "Prescribed path of a rigid body; drives with `from = \"trajectory\"` follow from it.");
const io::Key& kPointMass = many("point_mass").description("A point mass on a body.");
const io::Key& kLoad =
    many("load").description("A load on a body; with a [domain], a load case of the plate.");
const io::Key& kObserve =
    many("observe").description("A material point whose position is written to the result tables.");
const io::Key& kMeasure = many("measure").description(
    "Measured quantities of a body that are written to the result tables.");
const io::Key& kDomain = one("domain").description(
    "A static plate that is designed. A case with a [domain] has no motion.");
const io::Key& kSupport = many("support").description("A support of the [domain].");
const io::Key& kEsl = one("esl").description(
    "Times and definition of the equivalent static loads that represent the motion in the design.");
const io::Key& kDesign = many("design").description("The design problem of one body.");
const io::Key& kOptimizer =
    one("optimizer", kDefaults)
        .description("Optimizer that solves the design problems, and its stopping criteria.");
const io::Key& kCycle =
    one("cycle", kDefaults)
        .description(
            "Cycles of motion, equivalent static loads and design, and their stopping criteria.");
const io::Key& kVerify = one("verify").description(
    "Verification of final designs by one more motion, on a finer mesh or on the design cells.");
const io::Key& kCertificate =
    one("certificate")
        .description(
            "Optimality certificate of the final designs from the exact gradient of the motion.");
const io::Key& kOutput = one("output", kDefaults).description("Files that a run writes.");
const io::Key& kAccuracy =
    one("accuracy")
        .description("Settings of the command `flexmorph accuracy`; a run ignores them.");
const io::Key& kExpect =
    one("expect").description("Results that a run must reproduce, by their names.");

const std::vector<std::string>& order() {
  static const std::vector<std::string> kOrder = {"",
                                                  "constants",
                                                  "time",
                                                  "static",
                                                  "drive",
                                                  "hub",
                                                  "rigid_body",
                                                  "body",
                                                  "body.flow",
                                                  "body.line",
                                                  "body.heat",
                                                  "joint",
                                                  "spring",
                                                  "trajectory",
                                                  "point_mass",
                                                  "load",
                                                  "load.force",
                                                  "observe",
                                                  "measure",
                                                  "domain",
                                                  "support",
                                                  "esl",
                                                  "design",
                                                  "design.objective",
                                                  "design.constraint",
                                                  "design.solid",
                                                  "design.void",
                                                  "optimizer",
                                                  "optimizer.options",
                                                  "cycle",
                                                  "verify",
                                                  "certificate",
                                                  "output",
                                                  "accuracy",
                                                  "accuracy.reference",
                                                  "accuracy.quantity",
                                                  "accuracy.quantity.reference",
                                                  "expect",
                                                  "expect.*"};
  return kOrder;
}

bool only_describes(const std::string& path) {
  return path == "title" || path.starts_with("expect.");
}

}  // namespace flexmorph::cases::tables
