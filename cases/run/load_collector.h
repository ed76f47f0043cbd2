#pragma once

#include "cases/assembly/build.h"
#include "cases/output/step_writer.h"

namespace flexmorph::cases {

/// A step writer that collects the equivalent static loads of the designed bodies at the times that
/// are multiples of esl.every.
class LoadCollector : public StepWriter {
 public:
  /// Creates the collector and one empty entry in `loads` per design.
  /// @param moving_roots  moving roots of the model
  /// @param loads    receives one entry per design; outlives the writer
  LoadCollector(const Scene& scene, std::span<const fem::MovingRoot> moving_roots,
                std::vector<fem::EslSets>& loads);
  void add(const StepRecord& step) override;
  void archive(Archive& memory) override;

 private:
  fem::EslSet load_of(const StepRecord& step, const BodyDesign& design) const;

  const Scene& scene_;
  std::span<const fem::MovingRoot> moving_roots_;
  std::vector<fem::EslSets>& loads_;
};

}  // namespace flexmorph::cases
