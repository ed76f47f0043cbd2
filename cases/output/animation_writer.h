#pragma once

#include "cases/output/motion_frames.h"
#include "cases/results/animation.h"

namespace flexmorph::cases {

/// Collects the frames for the animation of the report: of a motion the first steps that reach
/// equally spaced times, of a path of equilibria all of them. In space, plates, beams, point masses
/// and observed points are projected onto the plane of the pictures; other parts are left out.
class AnimationWriter : public StepWriter {
 public:
  /// Prepares a writer.
  /// @param shapes  surfaces of the bodies; outlives the writer
  /// @param n       number of frames of a whole motion, at least 2
  /// @param out     receives the frames; outlives the writer
  AnimationWriter(const BodyShapes& shapes, int n, Animation& out);
  void add(const StepRecord& step) override;
  void archive(Archive& memory) override { memory(out_); }

 private:
  void begin();
  void add_grid(const StepRecord& step, size_t body, AnimatedBody& out) const;
  void add_grid_in_space(const StepRecord& step, size_t body, AnimatedBody& out) const;
  void add_bodies(const StepRecord& step);
  void add_marks(const StepRecord& step);
  std::vector<double> anchors_on(const std::string& rigid_body) const;

  const BodyShapes& shapes_;
  int n_;
  Animation& out_;
};

}  // namespace flexmorph::cases
