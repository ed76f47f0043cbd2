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

/// What a case file says, as plain data. Nobody else reads the case file; what a case does not
/// list is absent here too (empty lists, empty optionals), not zero.
namespace flexmorph::cases {

struct Scene {
  std::string name;  ///< of the case file, without folder and ending
  std::string title;
  std::optional<Domain> domain;  ///< a static scene: nothing moves, all that follows is absent
  TimeSpan time;
  std::optional<StaticAnalysis> statics;  ///< bodies at rest under growing loads: no time
  std::optional<VectorXd> gravity;        ///< (dim), at the start [m/s^2]
  std::vector<Law> gravity_laws;          ///< its entries; empty as well where nothing weighs
  std::vector<Drive> drives;
  std::vector<Hub> hubs;
  std::vector<RigidBody> rigid_bodies;
  std::vector<Body> bodies;
  std::vector<Joint> joints;
  std::vector<Spring> springs;
  std::optional<Trajectory> trajectory;
  std::vector<PointMass> point_masses;
  std::vector<BodyLoad> loads;
  std::vector<Observe> observed;
  std::vector<Measure> measures;
  std::optional<Esl> esl;           ///< always there when bodies that move are designed
  std::vector<BodyDesign> designs;  ///< one per designed body
  optim::Settings optimizer;
  Cycle cycle;
  std::optional<Verify> verify;
  std::optional<Certify> certify;
  Output output;
  std::optional<Accuracy> accuracy;           ///< for the command of that name; no run needs it
  std::map<std::string, Expectation> expect;  ///< by name of the result
  std::optional<io::CaseFile> file;           ///< where it comes from, for messages; none: made

  const Body& body(const std::string& name) const;  ///< name resolves: checked when read
  /// A law in time; drives that follow from a trajectory: after follow_trajectory().
  std::function<fem::Motion(double)> motion_of(const Law& law) const;
  /// Components of a load or of gravity in time.
  fem::LoadLaw load_law(std::span<const Law> laws) const;
  /// Gravity in time; of size 0 where nothing weighs.
  fem::LoadLaw gravity_law() const { return load_law(gravity_laws); }
  bool follows_trajectory(const Law& law) const;
  /// Do joints say where its bodies are, not hubs and places alone? The rigid kinematic model finds
  /// out.
  bool is_mechanism() const {
    return !rigid_bodies.empty() || std::any_of(joints.begin(), joints.end(),
                                                [](const Joint& j) { return j.joins_edges(); });
  }
  bool in_space() const { return !bodies.empty() && bodies.front().in_space(); }  ///< all, or none
  bool has_free_lines() const;
  bool has_heat() const;
  /// Are designs judged by motions on their cells?
  bool judges_on_cells() const { return verify && verify->cells > 0; }
  /// @param key_path  see io::CaseFile::where(): "body.plate.elements"
  /// @throws Error (input): "<file:line:column>: <path> = <value>: <why>"
  [[noreturn]] void refuse(const std::string& key_path, const std::string& why) const;
};

/// Fills the drives that follow from the trajectory of a scene read as far as its joints: a job for
/// those who know mechanisms (assembly/rigid_kinematics.h); here it is only asked.
using Follow = std::function<void(Scene&)>;

/// Changes of the command line by which the case finds its files from any folder.
std::vector<std::string> overrides_of_files(const io::CaseFile& file);

/// Reads and checks a case: types, ranges, names, and what must fit together. Keys nobody knows
/// are errors.
/// @throws Error (input) located in the file, see io::Table.
Scene read_scene(const io::CaseFile& file, const Follow& follow);

}  // namespace flexmorph::cases
