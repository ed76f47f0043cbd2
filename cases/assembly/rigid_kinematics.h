#pragma once

#include "cases/scene/scene.h"
#include "fem/dynamics/starts/reference_pose.h"
#include "fem/dynamics/starts/rigid_kinematics.h"

/// Construction of the rigid kinematic model of a scene (fem/dynamics/starts/rigid_kinematics.h).
namespace flexmorph::cases {

/// Returns the pose of an undeformed plate or beam at the start. It is given by its hub (a rigid
/// frame with prescribed motion), its rigid body or the case, or it follows from welds to other
/// bodies.
fem::ReferencePose start_pose(const Scene& scene, const Body& body);
/// Returns the location of a material point in the axes of the undeformed body at its root [m]. It
/// differs from the material coordinates only for a beam that is an arc.
Vec2 undeformed_location(const Body& body, const Vec2& material);

/// Returns the data of a rigid body of the scene, its point masses included.
fem::MechanismBody mechanism_body(const RigidBody& body);
/// Returns the force elements of the loads on rigid bodies.
std::vector<std::unique_ptr<fem::ForceElement>> rigid_loads(const Scene& scene);

/// Returns the bodies, joints, springs and loads of a planar scene with rigid plates. A joint whose
/// drive follows from the trajectory is empty until follow_trajectory() has computed the drive.
/// @throws Error (input) for a free line in a hub, and for a plate in a hub whose material flow
///         follows from the trajectory. (Free line: mesh line whose material coordinate is an
///         unknown.)
fem::RigidMechanism rigid_mechanism(const Scene& scene);
/// Returns the rigid kinematic model of a scene.
/// @throws Error (input) for joints that do not fit the bodies.
fem::RigidKinematics rigid_kinematics(const Scene& scene);

/// Computes the drives that follow from the scene's trajectory, see fem::inverse_kinematics().
/// @throws Error as fem::inverse_kinematics(); Error (input) where no drive follows from it.
void follow_trajectory(Scene& scene);

}  // namespace flexmorph::cases
