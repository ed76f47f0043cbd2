#include "cases/scene/tables.h"

namespace flexmorph::cases::tables {
namespace {

/// Declares a table that a case may contain once.
io::Key& one(const char* name, const char* absence = "absent") {
  return io::key("", name).table().otherwise_as(absence);
}

/// Declares a list of tables.
io::Key& many(const char* name) { return io::key("", name).tables_of().otherwise_as("none"); }

constexpr const char* kDefaults = "all its defaults";

}  // namespace

const io::Key& kGravity =
    io::key("", "gravity")
        .numbers_or_names(io::any_number("gravity", "m/s^2"), "a drive", 2, 3)
        .otherwise_as("nothing weighs")
        .says(
            "Two entries in the plane, three in space; with a [domain] the weight of the design.");
const io::Key& kConstants =
    one("constants").says("Numbers with names, for the formulas of drives.");
const io::Key& kTime = one("time").says("How long the motion lasts, and its steps.");
const io::Key& kStatic =
    one("static").says("In place of a motion: equilibria of the bodies under growing loads.");
const io::Key& kDrive = many("drive").says("A function of time with a name.");
const io::Key& kHub = many("hub").says("A driven frame that plates sit in.");
const io::Key& kRigidBody = many("rigid_body").says("A body of a mechanism that does not bend.");
const io::Key& kBody = many("body").says("A plate or a beam.");
const io::Key& kJoint = many("joint").says("What holds a body, or two together.");
const io::Key& kSpring = many("spring").says("A spring and damper between two places.");
const io::Key& kTrajectory =
    one("trajectory").says("The path of a rigid body that drives follow from.");
const io::Key& kPointMass = many("point_mass").says("A mass on a body.");
const io::Key& kLoad = many("load").says("Forces on a body or, at rest, on the domain.");
const io::Key& kObserve = many("observe").says("A material point whose position is written.");
const io::Key& kMeasure = many("measure").says("Quantities of a body that are written.");
const io::Key& kDomain = one("domain").says("A plate at rest that is designed: nothing moves.");
const io::Key& kSupport = many("support").says("Where the domain is held.");
const io::Key& kEsl =
    one("esl").says("When the motion becomes equivalent static loads, and of which kind.");
const io::Key& kDesign = many("design").says("The design of a body.");
const io::Key& kOptimizer = one("optimizer", kDefaults).says("Who solves the design problem.");
const io::Key& kCycle =
    one("cycle", kDefaults).says("How often the design is taken back into the motion.");
const io::Key& kVerify =
    one("verify").says("The final design moves once more, on a finer mesh or on its cells.");
const io::Key& kCertificate =
    one("certificate").says("What the motion itself says of final designs, by its exact gradient.");
const io::Key& kOutput = one("output", kDefaults).says("What a run writes.");
const io::Key& kAccuracy = one("accuracy").says("What `flexmorph accuracy` measures.");
const io::Key& kExpect = one("expect").says("Numbers that a run must come to, by their names.");

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

}  // namespace flexmorph::cases::tables
