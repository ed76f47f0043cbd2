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

/// Reads the scene of a case file, and computes the drives that follow from a trajectory.
/// @throws Error (input) located in the file, see io::Table; Error (numerical) where the path of
///         the trajectory cannot be reached.
Scene read_scene(const io::CaseFile& file);

/// A scene that is ready for integration in time: its model and the settings of its motion.
struct Mechanism {
  fem::Workspace model;  ///< Model with the work space of one motion.

  /// Moving-root mesh control (when elements at the moving root are split or merged), one for each
  /// plate that is held by a hub, a sleeve or a rigid body. A hub is a rigid frame with prescribed
  /// motion that carries a body.
  std::vector<fem::MovingRoot> moving_roots;
  fem::MotionSettings motion;  ///< Settings of the motion.
  std::string start_text;      ///< Text about the start if the program chooses it; otherwise empty.

  /// Text about the initial positions if others were found than those near the given ones;
  /// otherwise empty (fem::RigidKinematics::remark()).
  std::string assembly_text;
};

/// A mesh of a run that can differ from that of the scene (see Verify). The lengths at which
/// elements at the moving root are split or merged scale with the mesh.
struct MeshChoice {
  /// Numbers of elements along and across each body; absent for those of the scene.
  std::optional<std::array<int, 2>> elements;
  int refine = 1;  ///< Number of parts of every element in each direction.

  /// Number of elements per design cell in each direction, for designed bodies that are meshed by
  /// the cells of their designs; 0 for the mesh of the scene.
  int cells = 0;
  int coarse = 1;  ///< Number of design cells that are merged into one cell in each direction.

  auto operator<=>(const MeshChoice&) const = default;
};

/// Returns the scene with designed bodies that are meshed by the cells of their designs.
/// @param parts  number of elements per cell in each direction
Scene on_cells(Scene scene, int parts);

/// Builds the model, the joints and the settings of the integrator of a scene. Stops for loads and
/// output stay empty. The model of a [static] analysis contains all bodies, joints and loads, too.
/// @param rigid  rigid kinematic model of the scene, which is copied; null: it is built here
/// @throws Error (input) for combinations that the tables of elements, terms and joints do not
///         have.
Mechanism build_mechanism(const Scene& scene, const MeshChoice& mesh = {},
                          const fem::RigidKinematics* rigid = nullptr);

/// Sets the time step of a motion and the times of discontinuities at which a step must end. The
/// step is constant if it differs from that of the scene, even where the scene has adaptive steps.
/// @param step  time step [s]
void set_step(const Scene& scene, double step, fem::MotionSettings& motion);

/// Returns the energy of strains of 1e-13 in all bodies, which result from round-off of position
/// gradients of order one [J].
double stress_round_off(const Scene& scene);

/// Returns the hub that an edge is welded to.
const Hub& hub_of(const Scene& scene, const Joint& joint);
/// Returns the prescribed motion of the frame of a weld to a hub, or of a static sleeve.
fem::FrameDrive hub_drive(const Scene& scene, const Joint& joint);

/// Returns the thickness and the material of a body.
fem::PlaneSection section_of(const Body& body);

/// Returns the point masses of one body, for its equivalent static loads.
std::vector<fem::AttachedMass> attached_masses(const Scene& scene, const std::string& name);

/// Returns the joints of one body except the one that carries it, for its equivalent static loads.
std::vector<fem::AttachedJoint> attached_joints(const Scene& scene, const std::string& name);

/// Returns the applied forces on one body at a time t [s], for its equivalent static loads. Loads
/// that turn with the body are left out.
std::vector<fem::AttachedForce> applied_forces(const Scene& scene, const std::string& name,
                                               double t);

/// Returns the design problems of a scene with their initial layouts, one per designed body.
std::vector<mmc::BodyProblem> build_problems(const Scene& scene);

/// Finds the cells of every support and of every force of a static scene, with names for messages.
/// @param outside  1 for cells outside of the domain (n_cells); empty: none
/// @throws Error (input) for a location without a node that can be material.
std::vector<HeldOrLoaded> static_locations(const Scene& scene, const Grid& grid,
                                           std::span<const signed char> outside);
/// Creates the evaluator of the compliances of a static scene on its design mesh.
/// @throws Error (input) for a location without a node that can be material.
std::unique_ptr<mmc::ComplianceEvaluator> build_static_loads(const Scene& scene,
                                                             const mmc::BodyProblem& problem);

/// Returns the times of the equivalent static loads: multiples of esl.every up to the end [s].
std::vector<double> load_times(const Scene& scene);

}  // namespace flexmorph::cases
