#pragma once

#include "cases/scene/scene.h"
#include "fem/dynamics/starts/reference_pose.h"
#include "fem/dynamics/starts/rigid_kinematics.h"

/// What a scene says of its rigid kinematic model (fem/dynamics/starts/rigid_kinematics.h).
namespace flexmorph::cases {

/// Returns where an undeformed plate or beam lies at the start: as its hub, its rigid body or the
/// case says, or as welds to other bodies put it.
fem::ReferencePose start_pose(const Scene& scene, const Body& body);
/// Returns a material point in the axes of the undeformed body at its root [m]: the point itself,
/// but of a beam that is an arc.
Vec2 undeformed_place(const Body& body, const Vec2& material);

/// Returns a rigid body of the scene with its point masses.
fem::MechanismBody mechanism_body(const RigidBody& body);
/// Returns the loads on rigid bodies.
std::vector<std::unique_ptr<fem::Link>> rigid_loads(const Scene& scene);

/// Returns the bodies, joints, springs and loads of a scene in the plane with rigid plates. A joint
/// that follows a drive from the trajectory is empty until follow_trajectory() has filled the
/// drive.
/// @throws Error (input) for a free line, or material from the trajectory, in a driven hub.
fem::RigidMechanism rigid_mechanism(const Scene& scene);
/// Returns the rigid kinematic model of a scene.
/// @throws Error (input) for joints that do not fit the bodies.
fem::RigidKinematics rigid_kinematics(const Scene& scene);

/// Fills the drives that follow from the scene's trajectory, see fem::inverse_kinematics().
/// @throws Error as fem::inverse_kinematics(); Error (input) where no drive follows.
void follow_trajectory(Scene& scene);

}  // namespace flexmorph::cases
