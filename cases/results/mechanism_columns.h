#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "cases/assembly/build.h"
#include "cases/results/series.h"

namespace flexmorph::cases {

/// Computes the columns that describe a mechanism in the table of a motion, and without powers in
/// that of a [static] analysis; columns() says what each of them holds. Moments of joints are about
/// the joint's point: that of body b, the driven one of point_drive; where b is the ground, the
/// joint acts on its body a. Powers of drives are λ · ∂Φ/∂t.
class MechanismColumns {
 public:
  /// Tells whether all bodies move in the plane and none is held by the ground or a hub: forces
  /// between bodies conserve their total momentum then.
  static bool is_free(const Scene& scene);

  explicit MechanismColumns(const Scene& scene);

  /// Describes the values in the order of append().
  const std::vector<ColumnInfo>& columns() const { return columns_; }
  /// Appends the values of a state to a row.
  /// @param x  state with the multipliers λ that belong to it
  void append(fem::Workspace& model, const fem::State& x, std::vector<double>& row);
  /// Saves and restores the angles, which go on through half turns.
  void remember(Memory& memory);

 private:
  /// A named joint: the body it acts on, and the place its moment is about.
  struct Watched {
    const Joint* joint;
    Anchor about;
    bool driven;
  };

  /// A hub and the joints that sit in it.
  struct WatchedHub {
    fem::FrameDrive drive;
    std::vector<const Joint*> joints;
  };

  void describe_bodies();
  void describe_joints();
  void describe_hubs();
  void describe_springs();
  /// Adds descriptions of columns "<of>.<quantity>".
  void describe(const std::string& of,
                std::initializer_list<std::array<const char*, 3>> quantities);
  void append_trajectory(double t, std::vector<double>& row);
  void append_hub(const WatchedHub& hub, fem::Workspace& model, const fem::State& x,
                  std::vector<double>& row) const;

  const Scene& scene_;
  bool is_free_;
  std::vector<fem::FrameMotion> frames_;  // of the rigid bodies, angles unwrapped
  std::optional<double> turns_;           // of the trajectory's angle against the body's [rad]
  std::array<std::function<fem::Motion(double)>, 3> path_;
  std::vector<Watched> joints_;
  std::vector<WatchedHub> hubs_;
  std::vector<ColumnInfo> columns_;
};

}  // namespace flexmorph::cases
