#pragma once

#include "cases/output/run_folder.h"
#include "cases/output/step_writer.h"
#include "cases/results/motion_record.h"

/// Pictures of a motion: VTK files for ParaView, and snapshots of a mechanism for the report.
namespace flexmorph::cases {

/// Computes the deformed surfaces of the bodies of a scene.
class BodyShapes {
 public:
  /// Prepares the surfaces of all bodies.
  /// @param scene      scene of the motion; outlives the object
  /// @param densities  mass scale factors of the cells, one vector per design (n_cells); empty:
  ///                   full material
  BodyShapes(const Scene& scene, std::vector<VectorXd> densities);

  /// Returns the scene of the motion.
  const Scene& scene() const { return scene_; }
  /// Returns true if a body has a design.
  bool is_designed(size_t body) const { return design_of(body) < scene_.designs.size(); }
  /// Returns the grid of the design of a body.
  const Grid& grid_of(size_t body) const { return scene_.designs[design_of(body)].grid; }
  /// Returns the pose of an undeformed body at the start.
  const fem::ReferencePose& pose_of(size_t body) const { return poses_[body]; }
  /// Returns the deformed surface of a body with a design, with one quad per cell, without stress.
  DesignedSurface designed(const StepRecord& step, size_t body) const;
  /// Returns the deformed mid-surface of a body without a design, without stress.
  Surface deformed(const StepRecord& step, size_t body) const;

 private:
  size_t design_of(size_t body) const;

  const Scene& scene_;
  std::vector<VectorXd> densities_;
  std::vector<fem::ReferencePose> poses_;  // poses of the undeformed bodies at the start
};

/// Writes the frames of motion/motion.pvd. A motion has a frame at every stop that is a multiple of
/// a spacing in time, with all bodies, rigid bodies that have a size, hubs, and point masses in the
/// plane. The frames of a path of equilibria contain plates and beams only.
class FrameWriter : public StepWriter {
 public:
  /// Prepares a writer of frames.
  /// @param shapes  surfaces of the bodies; outlives the writer
  /// @param every   spacing of the frames of a motion [s]; a path has a frame per equilibrium
  /// @param folder  run folder; outlives the writer
  FrameWriter(const BodyShapes& shapes, double every, RunFolder& folder)
      : shapes_(shapes), every_(every), folder_(folder) {}
  void add(const StepRecord& step) override;
  void archive(Archive& memory) override { folder_.archive_frames(memory); }

 private:
  void add_bodies(const StepRecord& step);
  void add_rigid_parts(const StepRecord& step);

  const BodyShapes& shapes_;
  double every_;
  RunFolder& folder_;
};

/// Makes snapshots of a mechanism at the first steps that reach equally spaced times.
class SnapshotWriter : public StepWriter {
 public:
  /// Prepares a writer of snapshots.
  /// @param shapes     surfaces of the bodies; outlives the writer
  /// @param n          number of snapshots of the whole motion, at least 2
  /// @param snapshots  receives the snapshots; outlives the writer
  SnapshotWriter(const BodyShapes& shapes, int n, std::vector<io::PlaneFrame>& snapshots)
      : shapes_(shapes), n_(n), snapshots_(snapshots) {}
  void add(const StepRecord& step) override;
  void archive(Archive& memory) override;

 private:
  const BodyShapes& shapes_;
  int n_;
  std::vector<io::PlaneFrame>& snapshots_;
};

}  // namespace flexmorph::cases
