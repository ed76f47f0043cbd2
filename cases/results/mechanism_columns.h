#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "cases/assembly/build.h"
#include "cases/results/series.h"

namespace flexmorph::cases {

/// The columns that describe a mechanism in the table of a motion or of a [static] analysis; a
/// static table has no powers. columns() describes each column. The moment of a joint is about the
/// point of the joint: the point of body b, or the driven point of a point_drive. If b is the
/// ground, force and moment are those on body a. The power of a drive is λ · ∂Φ/∂t.
class MechanismColumns {
 public:
  /// Tells whether all bodies move in the plane and no joint or hub (a rigid frame with
  /// prescribed motion) connects them to the ground. In this case the forces between the bodies
  /// conserve their total momentum.
  static bool is_free(const Scene& scene);

  /// Creates the columns of a scene; the scene has to outlive them.
  explicit MechanismColumns(const Scene& scene);

  /// Describes the values in the order of append().
  const std::vector<ColumnInfo>& columns() const { return columns_; }
  /// Appends the values of a state to a row.
  /// @param x  state, with its Lagrange multipliers λ
  void append(fem::Workspace& model, const fem::State& x, std::vector<double>& row);
  /// Saves or restores the unwrapped angles, which are continuous across ±π.
  void archive(Archive& memory);

 private:
  /// A named joint and the point about which its moment is computed.
  struct Watched {
    const Joint* joint;
    Anchor about;
    bool driven;
  };

  /// A hub and the joints that connect bodies to it.
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
  /// Adds descriptions of the force and the moment of a joint or a spring on a body.
  void describe_wrench(const std::string& of, const std::string& kind, const std::string& body);
  void append_trajectory(double t, std::vector<double>& row);
  void append_hub(const WatchedHub& hub, fem::Workspace& model, const fem::State& x,
                  std::vector<double>& row) const;

  const Scene& scene_;
  bool is_free_;
  std::vector<fem::FrameMotion> frames_;  // frames of the rigid bodies, with unwrapped angles
  std::optional<double> turns_;  // whole turns between the angles of body and trajectory [rad]
  std::array<std::function<fem::Motion(double)>, 3> path_;
  std::vector<Watched> joints_;
  std::vector<WatchedHub> hubs_;
  std::vector<ColumnInfo> columns_;
};

}  // namespace flexmorph::cases
