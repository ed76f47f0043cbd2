#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cases/scene/accuracy.h"
#include "cases/scene/body.h"
#include "cases/scene/design.h"
#include "cases/scene/domain.h"
#include "cases/scene/drive.h"
#include "cases/scene/hub.h"
#include "cases/scene/joint.h"
#include "cases/scene/load.h"
#include "cases/scene/results.h"
#include "cases/scene/rigid_body.h"
#include "cases/scene/spring.h"
#include "cases/scene/time.h"
#include "io/case_files/case_file.h"
#include "optim/optimizer.h"

/// The contents of a case file as plain data. The rest of the program uses these data and does not
/// read the case file. Items that a case does not contain are absent here (empty lists, empty
/// optionals) and not zero.
namespace flexmorph::cases {

/// The contents of a case file: a motion, a static analysis, or a static scene with one plate; its
/// designs; and its output.
struct Scene {
  std::string name;              ///< Name of the case file, without folder and extension.
  std::string title;             ///< Title of the case.
  std::optional<Domain> domain;  ///< Plate of a static scene, which has no bodies and no motion.
  TimeSpan time;                 ///< Time span and time integration of the motion.
  std::optional<StaticAnalysis> statics;  ///< Static analysis in place of a motion.
  std::optional<VectorXd> gravity;        ///< Gravity at the start (dim) [m/s^2]; absent: none.
  std::vector<Law> gravity_laws;          ///< Components of gravity (dim) [m/s^2]; empty: none.
  std::vector<Drive> drives;              ///< Named functions of time.
  std::vector<Hub> hubs;                ///< Rigid frames with prescribed motion that carry bodies.
  std::vector<RigidBody> rigid_bodies;  ///< Rigid bodies.
  std::vector<Body> bodies;             ///< Plates and beams.
  std::vector<Joint> joints;            ///< Joints, in the order of the case.
  std::vector<Spring> springs;          ///< Springs and dampers.
  std::optional<TargetTrajectory> trajectory;  ///< Path of a rigid body that drives follow from.
  std::vector<PointMass> point_masses;         ///< Point masses on plates and beams.
  std::vector<BodyLoad> loads;                 ///< Loads on moving bodies.
  std::vector<Observe> observed;               ///< Material points whose positions are written.
  std::vector<MeasureRequest> measures;        ///< Measured quantities of bodies.
  std::optional<Esl> esl;  ///< Equivalent static loads; present if moving bodies are designed.
  std::vector<BodyDesign> designs;   ///< Designs, one per designed body.
  optim::Settings optimizer;         ///< Settings of the optimizer.
  Cycle cycle;                       ///< Cycles of motion and design.
  std::optional<Verify> verify;      ///< Verification of the final design by another motion.
  std::optional<Certify> certify;    ///< Optimality certificate of the final design.
  Output output;                     ///< Output of the run.
  std::optional<Accuracy> accuracy;  ///< Input of the command `accuracy`; runs ignore it.
  std::map<std::string, Expectation> expect;  ///< Expected results by their names.

  /// Sentences about contents of files that the reader ignored or doubts.
  std::vector<std::string> notes;
  std::optional<io::CaseFile>
      file;  ///< Case file, for messages; absent for a scene made in memory.

  /// Returns the plate or beam of this name. @throws Error (input) if there is none
  const Body& body(const std::string& name) const;
  /// Returns a law as a function of time. For a drive that follows from a trajectory,
  /// follow_trajectory() must have been called.
  std::function<fem::Motion(double)> motion_of(const Law& law) const;
  /// Returns the components of a load or of gravity as functions of time.
  fem::LoadLaw load_law(std::span<const Law> laws) const;
  /// Returns gravity as a function of time [m/s^2]; of size 0 without gravity.
  fem::LoadLaw gravity_law() const { return load_law(gravity_laws); }
  /// Returns true if a law names a drive that follows from the trajectory.
  bool follows_trajectory(const Law& law) const;
  /// Returns true if joints determine the locations of bodies, rather than hubs and given positions
  /// alone. The rigid kinematic model then computes the locations.
  bool is_mechanism() const {
    return !rigid_bodies.empty() || std::any_of(joints.begin(), joints.end(),
                                                [](const Joint& j) { return j.joins_edges(); });
  }
  /// Returns true if the plates are in space; either all bodies are in space or none is.
  bool in_space() const { return !bodies.empty() && bodies.front().in_space(); }
  /// Returns true if a body has a material line whose material coordinate is an unknown.
  bool has_eulerian_lines() const;
  /// Returns true if a body is heated.
  bool has_heat() const;
  /// Returns true if designs are verified by motions on the cells of the designs.
  bool verifies_on_cells() const { return verify && verify->cells > 0; }
  /// Throws an error that is located in the case file.
  /// @param key_path  see io::CaseFile::where(): "body.plate.elements"
  /// @throws Error (input): "<file:line:column>: <path> = <value>: <why>"
  [[noreturn]] void refuse(const std::string& key_path, const std::string& why) const;
};

/// A function that computes the drives that follow from the trajectory of a scene, which is read as
/// far as its joints. It is implemented in assembly/rigid_kinematics.h and passed to read_scene().
using Follow = std::function<void(Scene&)>;

/// Returns overrides "KEY=VALUE" that replace all file names in a case by absolute paths, so that
/// the case can be read from any folder.
std::vector<std::string> overrides_of_files(const io::CaseFile& file);

/// Reads a case and checks its types, ranges, names and consistency. Unknown keys are errors.
/// @param follow  computes the drives that follow from a trajectory
/// @throws Error (input) located in the file, see io::Table.
Scene read_scene(const io::CaseFile& file, const Follow& follow);

}  // namespace flexmorph::cases
