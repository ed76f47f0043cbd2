#pragma once

#include <optional>

#include "cases/output/run_folder.h"

namespace flexmorph::cases {

/// What the table of a motion says of a mechanism, step by step, in this order:
///
/// where nothing holds   momentum.x, .y [kg m/s], momentum.angular [kg m²/s] about the origin: of
/// all the bodies            that moves (see is_free()) every rigid body      <name>.x, .y [m],
/// .angle [rad]: its point and first axis; the angle goes
///                       on through half turns, from the one of the case
/// with a trajectory     <body>.delta_x, .delta_y [m], .delta_angle [rad]: where its body is, less
///                       where it should be
/// every named joint     <joint>.force_x, .force_y [N], .moment [N m]: what it does to its body b,
///                       or to a where b is the ground; the moment about the joint's point (that
///                       of b, the driven one of point_drive)
/// the driven ones       <joint>.power [W]: λ · ∂Φ/∂t, what the drive puts into the mechanism
/// every hub             <hub>.force_x, .force_y [N], .moment [N m]: what it does to all that it
///                       holds, about its own point, and .power [W], what its drive puts in
/// every named spring    <spring>.force_x, .force_y, .moment as of a joint, .energy [J]: stored in
///                       it, and .power [W]: what else enters through it, negative in a damper
///
/// Other scenes without rigid bodies, hubs and named joints and springs have none of these.
class MechanismColumns {
 public:
  /// Do all its bodies live in the plane, of which none is held by the ground or a hub? What they
  /// do to each other keeps their momentum then.
  static bool is_free(const Scene& scene);

  explicit MechanismColumns(const Scene& scene);

  /// The next row. @param x  λ belongs to it
  void add(fem::Workspace& model, const fem::State& x);
  const std::vector<Column>& columns() const { return columns_; }
  std::vector<Column> take() { return std::move(columns_); }
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

  void add_trajectory(double t);
  void add_joint(const Watched& watched, fem::Workspace& model, const fem::State& x);
  void add_hub(const WatchedHub& hub, fem::Workspace& model, const fem::State& x);
  void add_spring(const Spring& spring, fem::Workspace& model, const fem::State& x);
  void put(const fem::Wrench& wrench) {
    for (const double value : {wrench.force.x(), wrench.force.y(), wrench.moment.z()}) put(value);
  }
  void put(double value) { columns_[next_++].values.push_back(value + 0.0); }  // no "-0"

  const Scene& scene_;
  bool is_free_;
  std::vector<fem::FrameMotion> frames_;  // of the rigid bodies, angles unwrapped
  std::optional<double> turns_;           // of the trajectory's angle against the body's [rad]
  std::array<std::function<fem::Motion(double)>, 3> path_;
  std::vector<Watched> joints_;
  std::vector<WatchedHub> hubs_;
  std::vector<Column> columns_;
  size_t next_ = 0;
};

}  // namespace flexmorph::cases
