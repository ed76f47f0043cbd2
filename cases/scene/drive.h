#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fem/element.h"

/// Prescribed functions of time of a case: [[drive]] and [trajectory].
namespace flexmorph::cases {

/// A prescribed quantity: a drive, or a constant where no drive is named.
struct Law {
  std::string drive;  ///< Name of the drive; empty for a constant.
  double value = 0;   ///< Value of the constant; not used with a drive.
};

/// A function of time that a case defines under a name.
struct Drive {
  std::string name;   ///< Name by which the case refers to the drive.
  std::string words;  ///< Text for summaries: the formula, or the source of the table.

  /// Value, rate and acceleration at a time [s]. Outside of the time span of the run the function
  /// is continued by the parabola of value, rate and acceleration at the nearer end.
  std::function<fem::Motion(double)> motion;

  std::vector<double>
      discontinuities;  ///< Times in (0, end] at which the formula changes branches [s].
  std::string jump;     ///< Text about the first jump of value or rate; empty if none.

  /// End of the parameter of a coordinate of a curve, which replaces time; absent for a function
  /// of time. Only `path` joints use such a drive, and its `discontinuities` are empty.
  std::optional<double> until;

  /// True if inverse kinematics determines the drive from the trajectory (follow_trajectory()).
  bool from_trajectory = false;
};

/// The prescribed path of a rigid body. Drives with from = "trajectory" are determined from it.
struct TargetTrajectory {
  std::string body;  ///< Name of the rigid body.
  Law x, y, angle;   ///< Position of the origin of the body's axes [m] and their angle [rad].
};

/// A row of the table of sources of drives, which the key `from` of a drive names. The row
/// "trajectory" belongs to Flexmorph; a program adds rows with functions of its own.
struct DriveRow {
  std::string name;      ///< Name in case files, as in from = "trajectory".
  std::string sentence;  ///< Sentence that describes the source.

  /// Returns value, rate and acceleration at a time from 0 to the end of the run [s]. Several
  /// threads may call it at the same time. It is empty for "trajectory".
  std::function<fem::Motion(double)> motion;
};

/// Returns all rows, in the order in which messages list them.
std::span<const DriveRow* const> drive_rows();
/// Adds a row to the table of sources of drives, see Registry::add().
/// @throws Error (input) if the row has no motion, or for a name that is taken
void register_drive(const DriveRow& row);

}  // namespace flexmorph::cases
