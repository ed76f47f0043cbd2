#pragma once

#include "cases/output/run_folder.h"
#include "cases/output/step_writer.h"
#include "cases/results/motion_record.h"

/// Pictures of a motion: VTK files for ParaView, and snapshots of a mechanism for the report.
namespace flexmorph::cases {

/// Computes the deformed surfaces of the bodies of a scene.
class BodyShapes {
 public:
  /// @param densities  mass scale factors of the cells, one vector per design (n_cells); empty:
  /// full material
  BodyShapes(const Scene& scene, std::vector<VectorXd> densities);

  const Scene& scene() const { return scene_; }
  bool is_designed(size_t body) const { return design_of(body) < scene_.designs.size(); }
  /// The design grid of a designed body.
  const Grid& grid_of(size_t body) const { return scene_.designs[design_of(body)].grid; }
  /// The surface of a designed body, cell by cell of its design.
  DesignedSurface designed(const StepRecord& step, size_t body) const;
  /// The mid-surface of a body without a design.
  Surface deformed(const StepRecord& step, size_t body) const;

 private:
  size_t design_of(size_t body) const;

  const Scene& scene_;
  std::vector<VectorXd> densities_;
  std::vector<fem::ReferencePose> poses_;  // of the bodies at the start
};

/// Writes a frame of motion/motion.pvd at every stop that is a multiple of a time: all bodies,
/// rigid bodies that have a size, hubs, and point masses. Frames of a path show its bodies.
class FrameWriter : public StepWriter {
 public:
  /// @param every  spacing of the frames of a motion [s]; a path has a frame per equilibrium
  FrameWriter(const BodyShapes& shapes, double every, RunFolder& folder)
      : shapes_(shapes), every_(every), folder_(folder) {}
  void add(const StepRecord& step) override;
  void remember(Memory& memory) override { folder_.remember_frames(memory); }

 private:
  void add_bodies(const StepRecord& step);
  void add_rigid_parts(const StepRecord& step);

  const BodyShapes& shapes_;
  double every_;
  RunFolder& folder_;
};

/// Takes pictures of a mechanism at the first steps that reach evenly spaced times.
class SnapshotWriter : public StepWriter {
 public:
  /// @param n  pictures over the whole motion, at least 2
  /// @param snapshots  receives them; outlives the writer
  SnapshotWriter(const BodyShapes& shapes, int n, std::vector<io::PlaneFrame>& snapshots)
      : shapes_(shapes), n_(n), snapshots_(snapshots) {}
  void add(const StepRecord& step) override;
  void remember(Memory& memory) override;

 private:
  const BodyShapes& shapes_;
  int n_;
  std::vector<io::PlaneFrame>& snapshots_;
};

}  // namespace flexmorph::cases
