#pragma once

#include "cases/output/run_folder.h"

namespace flexmorph::cases {

/// The table of a motion's steps, motion.csv, which grows with it: what a run was killed after is
/// on the disk.
class MotionTable {
 public:
  /// @param path  of the file; nothing is written before the first row
  MotionTable(std::string path, const Scene& scene) : path_(std::move(path)), scene_(scene) {}

  /// The last step of a record, whose columns of bodies and joints may still be elsewhere.
  /// @throws Error (numerical) when it cannot be written
  void add(const MotionRecord& motion, const std::vector<Column>& measured,
           const std::vector<Column>& mechanism);
  /// All steps of a record, of a motion that goes on.
  void add_all(const MotionRecord& motion, const std::vector<Column>& measured,
               const std::vector<Column>& mechanism);

 private:
  void begin(const MotionRecord& motion, const std::vector<Column>& measured,
             const std::vector<Column>& mechanism, size_t n_rows);

  std::string path_;
  const Scene& scene_;
  std::optional<io::CsvWriter> csv_;
  std::vector<io::Cell> row_;
};

}  // namespace flexmorph::cases
