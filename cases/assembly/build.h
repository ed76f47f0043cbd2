#pragma once

#include <compare>
#include <memory>
#include <span>

#include "cases/assembly/rigid_kinematics.h"
#include "cases/scene/scene.h"
#include "fem/dynamics/esl.h"
#include "fem/dynamics/motion.h"
#include "optim/mmc/cycles/esl_loop.h"

namespace flexmorph::cases {

/// The scene of a case file, drives that follow from a trajectory included.
/// @throws Error (input) located in the file, see io::Table; Error (numerical) where the path of
/// the
///         trajectory cannot be reached.
Scene read_scene(const io::CaseFile& file);

/// A scene ready to be moved: what it lists is in here, nothing else.
struct Mechanism {
  fem::Workspace model;              ///< with the room of one motion
  std::vector<fem::Growth> growths;  ///< one per plate that sits in a hub or sleeve
  fem::MotionSettings motion;
  std::string start_words;  ///< how it starts, where the case leaves that to the program
};

/// Mesh of a run other than the scene's own (see Verify); limits of boundary elements scale along.
struct MeshChoice {
  std::optional<std::array<int, 2>> elements;
  int refine = 1;  ///< parts of every element in each direction
  int cells = 0;   ///< designed bodies move on their design's cells, each in so many parts each way
  int coarse = 1;  ///< or on cells that are so many of them each way

  auto operator<=>(const MeshChoice&) const = default;
};

/// The scene with its designed bodies on the cells of their designs, each in so many parts each
/// way.
Scene on_cells(Scene scene, int parts);

/// Builds the model, the joints and the settings of the integrator of a scene. Stops for loads and
/// output are left empty. The model of a [static] analysis has the same bodies, joints and loads.
/// @param rigid  the rigid kinematic model of the scene, which is copied; null: it is built here
/// @throws Error (input) for combinations the tables of elements, terms and joints do not have.
Mechanism build_mechanism(const Scene& scene, const MeshChoice& mesh = {},
                          const fem::RigidKinematics* rigid = nullptr);

/// Sets the time step of a motion and the times at which a step has to end. A motion with a step
/// other than the scene's keeps that step: it does not adapt.
/// @param step  [s]
void set_step(const Scene& scene, double step, fem::MotionSettings& motion);

/// Energy of strains of 1e-13, which slopes of size one have by round-off [J].
double stress_round_off(const Scene& scene);

/// The hub that an edge is welded to.
const Hub& hub_of(const Scene& scene, const Joint& joint);
/// The driven frame of a weld to a hub or of a sleeve at rest.
fem::FrameDrive hub_drive(const Scene& scene, const Joint& joint);

fem::PlaneSection section_of(const Body& body);

/// Point masses of one body, for its loads.
std::vector<fem::AttachedMass> attached_masses(const Scene& scene, const std::string& name);

/// Joints of one body besides the one that carries it, for its loads.
std::vector<fem::AttachedJoint> attached_joints(const Scene& scene, const std::string& name);

/// Applied forces on one body at a time, for its loads: those that do not turn.
std::vector<fem::AttachedForce> applied_forces(const Scene& scene, const std::string& name,
                                               double t);

/// Scene -> design problems, with the initial layout.
std::vector<mmc::BodyProblem> build_problems(const Scene& scene);

/// Finds the cells of every support and of every force of a static scene, with names for messages.
/// @throws Error (input) for a place without a node of the domain.
std::vector<HeldOrLoaded> static_places(const Scene& scene, const Grid& grid,
                                        std::span<const signed char> outside);
/// Supports and loads of a static scene on its design mesh.
/// @throws Error (input) likewise.
std::unique_ptr<mmc::ComplianceEvaluator> build_static_loads(const Scene& scene,
                                                             const mmc::BodyProblem& problem);

/// Load times: multiples of esl.every up to the end [s].
std::vector<double> load_times(const Scene& scene);

}  // namespace flexmorph::cases
