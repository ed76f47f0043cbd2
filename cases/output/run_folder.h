#pragma once

#include <atomic>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cases/assembly/build.h"
#include "cases/output/surface.h"
#include "cases/results/static_loads.h"
#include "fem/dynamics/motion.h"
#include "geometry/memory.h"
#include "io/background.h"
#include "io/output_folder.h"
#include "io/plane_frames.h"
#include "io/surfaces.h"
#include "io/tables.h"
#include "io/vtk.h"
#include "optim/mmc/cycles/corrected_cycles.h"
#include "optim/mmc/cycles/esl_loop.h"

namespace flexmorph::cases {

/// "frame_00012.vti".
std::string numbered(const std::string& stem, int number, const std::string& ending);

/// Name of the file with the components of a body's result.
std::string components_name(const Scene& scene, const std::string& body);

/// The folder of one run (cases/README.md, The run folder): every file is written here and nowhere
/// else.
class RunFolder {
 public:
  /// Takes the folder. A run that is in it already is moved, whole.
  /// @param beside  files for ParaView are written by a thread of their own, while the run goes on
  /// @throws Error (input) as io::OutputFolder: taken, or not a run's.
  using Begin = io::OutputFolder::Begin;
  RunFolder(std::string path, const Scene& scene, bool beside = false, Begin begin = Begin::anew);

  const std::string& path() const { return folder_.path(); }
  /// Where the run is now that was here before; empty where there was none.
  const std::string& moved_to() const { return folder_.moved_to(); }
  /// Path of a file of the run, see io::OutputFolder::file().
  std::string file(const std::string& name) { return folder_.file(name); }
  /// Until all files are written and, but for frames for ParaView, on the disk (io::Sync).
  /// @throws Error (numerical) naming the first file that is not.
  void finish();
  /// Paths of its files with this ending: of this run, and of the one it goes on with.
  std::vector<std::string> files_of(const std::string& ending) { return folder_.files_of(ending); }
  /// What became of frames for ParaView that could not be written, in words; nothing when all are.
  std::string lost_frames();
  /// Exports that could not be made, in words; nothing when all are there.
  const std::string& missing_exports() const { return missing_; }

  /// One design iteration: a row of history.csv, and the VTK files the scene asks for.
  void add_iteration(const mmc::IterationReport& report);
  /// Of a folder that is gone on with: is this row in its history, with all frames that belong to
  /// it? It counts as written then. Rows are asked for in their order; the first one that is not
  /// there ends those that are.
  bool has_row(const mmc::RowOfHistory& row);
  /// CPU seconds spent on files since the last call; those of files that are written beside the run
  /// when they are done.
  double take_output_seconds();

  /// loads/<body>.csv: one row per load set.
  void write_loads(const std::string& body, const fem::EslSets& loads,
                   const mmc::BodyOutcome* outcome);
  /// Writes loads/<domain>.csv of a plate at rest: one row per load case.
  void write_static_loads(const Domain& domain, std::span<const StaticLoad> loads);
  /// A part of a frame of motion/motion.pvd, which has one file per part and time; the field `body`
  /// is its number. The deformed body with the density of its design, displacements and strain
  /// energy per area:
  void add_motion_frame(const std::string& body, const DesignedSurface& surface, double time,
                        int part);
  /// The deformed mid-surface of a body without a design, with displacements and strain energy per
  /// area, a beam with its elastic strain:
  void add_surface_frame(const std::string& body, const Surface& surface, double time, int part);
  /// What does not deform: rigid bodies, hubs, point masses.
  void add_rigid_frame(const std::string& name, const io::QuadMesh& mesh, double time, int part);

  /// plots/start_<body>.svg: the layout before the first iteration.
  void write_start(const mmc::BodyProblem& problem);
  /// Outlines, pictures and tables of a final design.
  void write_design(const mmc::BodyProblem& problem, const mmc::BodyOutcome& outcome);
  /// <name>.svg, of several designs <name>_<body>.svg: a design as it is now.
  void keep_outline(const mmc::BodyProblem& problem, const std::string& name);
  /// cycles.csv, anew: one row per cycle and body, then one per corrected cycle.
  void write_cycles(std::span<const mmc::CycleVerdict> cycles,
                    std::span<const mmc::CorrectedCycle> corrected);
  void write_text(const std::string& name, const std::string& text);

  /// What the iterations of all designs took, of earlier runs that this one goes on with too:
  /// phases with their CPU seconds of all threads. Empty without designs.
  const std::vector<std::pair<std::string, double>>& phases() const { return phases_; }

  /// Rows of the history per body, for plots.
  struct History {
    std::string body;
    std::vector<double> row, compliance, volume, kkt, sharp_row, sharp_compliance;
  };
  const std::vector<History>& histories() const { return histories_; }

  /// Outlines of the designs as SVG: where they start, and what came out so far.
  struct DesignPictures {
    std::string body, start, result;
  };
  const std::vector<DesignPictures>& design_pictures() const { return pictures_; }

  /// What there is of the frames of a motion. Put back, their index is written anew.
  void remember_frames(Memory& memory);
  /// Files of these frames, as file() takes them.
  std::vector<std::string> frames() const;

  /// Frames of the first body in space, for a picture: all up to a few, else some evenly spread.
  std::vector<io::SurfaceFrame> shapes(size_t most) const;

 private:
  History& history_of(const std::string& body);
  DesignPictures& pictures_of(const std::string& body);
  /// A part of a frame of the motion: its fields, and when it is shown.
  struct FramePart {
    const io::QuadMesh& mesh;
    std::vector<io::Field> cells, points;
    double time;
    int number;
  };
  void write_part(const std::string& body, FramePart part);
  /// Does the task, now or beside the run; a frame that cannot be written is counted.
  void write_frame(std::function<void()> task);
  void begin_history(Begin begin);
  void keep_row(const mmc::RowOfHistory& row, const std::vector<std::string>& old);
  void forget_old_rows();
  bool wants_frame(int iteration) const;
  bool has_frames(const mmc::RowOfHistory& row) const;
  void write_design_frame(const mmc::IterationReport& report);
  void write_history_row(const mmc::IterationReport& report);

  io::OutputFolder folder_;
  const Scene& scene_;
  std::unique_ptr<io::CsvWriter> history_;
  /// An index of frames, listed as a file of the run with its first one.
  class FrameIndex {
   public:
    FrameIndex(RunFolder& folder, std::string name) : folder_(folder), name_(std::move(name)) {}
    void add(double time, const std::string& file, int part = 0);

   private:
    RunFolder& folder_;
    std::string name_;
    std::optional<io::Series> series_;
  };
  FrameIndex iterations_, components_, motion_;
  /// A part of a frame of the motion that was written.
  struct Frame {
    std::string file;
    double time = 0;
    int part = 0;
    void remember(Memory& memory) { memory(file, time, part); }
  };
  std::vector<Frame> frames_;
  std::string missing_;
  int lost_frames_ = 0;  // of the writer, as the next
  std::string why_lost_;
  std::vector<History> histories_;
  std::deque<std::vector<std::string>> old_rows_;    // of a history that is gone on with
  std::vector<std::vector<std::string>> kept_rows_;  // of these what stays
  std::vector<DesignPictures> pictures_;
  int rows_ = 0, motion_frames_ = 0;
  std::vector<io::SurfaceFrame> shapes_;
  std::vector<std::pair<std::string, double>> phases_;  // CPU seconds of the history by phase
  std::atomic<double> output_seconds_ = 0;
  io::Background writer_;  // last: its tasks use the others
};

}  // namespace flexmorph::cases
