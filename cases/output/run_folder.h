#pragma once

#include <atomic>
#include <deque>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cases/assembly/build.h"
#include "cases/output/surface.h"
#include "cases/results/static_loads.h"
#include "fem/dynamics/motion.h"
#include "geometry/archive.h"
#include "io/background.h"
#include "io/output_folder.h"
#include "io/plane_frames.h"
#include "io/surfaces.h"
#include "io/tables.h"
#include "io/vtk.h"
#include "optim/mmc/cycles/corrected_cycles.h"
#include "optim/mmc/cycles/esl_loop.h"

namespace flexmorph::cases {

/// Returns a file name with a number of at least five digits, such as "frame_00012.vti".
std::string numbered(const std::string& stem, int number, const std::string& ending);

/// Returns the name of the file with the components of the final design of a body.
std::string components_name(const Scene& scene, const std::string& body);

/// The folder of one run (cases/docs/output.md). All files of the run are written into
/// it.
class RunFolder {
 public:
  /// Mode of opening a folder: begin a new run, or continue the run in the folder.
  using Begin = io::OutputFolder::Begin;
  /// Opens the folder. With Begin::anew an earlier run in the folder is moved as a whole.
  /// @param path    path of the folder
  /// @param scene   scene of the run; outlives the object
  /// @param beside  true: files for ParaView are written by a separate thread while the run goes on
  /// @throws Error (input) as io::OutputFolder: another process uses the folder, or it is no run
  ///         folder.
  RunFolder(std::string path, const Scene& scene, bool beside = false, Begin begin = Begin::anew);

  /// Returns the path of the folder.
  const std::string& path() const { return folder_.path(); }
  /// Returns the new path of an earlier run that was in the folder; empty if there was none.
  const std::string& moved_to() const { return folder_.moved_to(); }
  /// Returns the path of a file of the run, see io::OutputFolder::file().
  std::string file(const std::string& name) { return folder_.file(name); }
  /// Waits until all files are written and, except frames for ParaView, on the disk (io::Sync).
  /// @throws Error (numerical) naming the first file that could not be written.
  void finish();
  /// Returns the paths of the files with this ending, of this run and of the run that it continues.
  std::vector<std::string> files_of(const std::string& ending) { return folder_.files_of(ending); }
  /// Returns a message about frames for ParaView that could not be written; empty if all are
  /// written.
  std::string lost_frames();
  /// Returns a message about exports that could not be made; empty if all exist.
  std::string missing_exports() const;

  /// Writes one design iteration: a row of history.csv, and the VTK files that the scene requests.
  void add_iteration(const mmc::IterationReport& report);
  /// Returns true if the history of a continued run has this row and all frames that belong to it;
  /// the row then counts as written. Rows must be requested in their order: after the first missing
  /// row, all further rows are missing.
  bool has_row(const mmc::RowOfHistory& row);
  /// Returns the CPU time spent on files since the last call [s]. Files that a separate thread
  /// writes are counted when they are finished.
  double take_output_seconds();

  /// Writes loads/<body>.csv with one row per load set.
  /// @param outcome  result of the design under these loads; null: its columns stay empty
  void write_loads(const std::string& body, const fem::EslSets& loads,
                   const mmc::BodyOutcome* outcome);
  /// Writes loads/<domain>.csv of a static plate with one row per load case.
  void write_static_loads(const Domain& domain, std::span<const StaticLoad> loads);
  /// Writes a body with a design to a frame of motion/motion.pvd: the deformed body with the
  /// density of its design, displacements and strain energy per area. A frame has one file per
  /// body.
  /// @param part  number of the body in the frame, written as the field `body`
  void add_motion_frame(const std::string& body, const DesignedSurface& surface, double time,
                        int part);
  /// Writes a body without a design to a frame of motion/motion.pvd: the deformed mid-surface with
  /// displacements and strain energy per area, for a beam also with its elastic strain.
  /// @param part  number of the body in the frame, written as the field `body`
  void add_surface_frame(const std::string& body, const Surface& surface, double time, int part);
  /// Writes a rigid body, a hub or a point mass to a frame of motion/motion.pvd.
  /// @param part  number of the body in the frame, written as the field `body`
  void add_rigid_frame(const std::string& name, const io::QuadMesh& mesh, double time, int part);

  /// Writes plots/start_<body>.svg, the layout before the first iteration.
  void write_start(const mmc::BodyProblem& problem);
  /// Writes outlines, pictures and tables of a final design.
  void write_design(const mmc::BodyProblem& problem, const mmc::BodyOutcome& outcome);
  /// Writes the current outline of a design to <name>.svg; of several designs to <name>_<body>.svg.
  void keep_outline(const mmc::BodyProblem& problem, const std::string& name);
  /// Writes all of cycles.csv: one row per cycle and body, then one row per corrected cycle.
  void write_cycles(std::span<const mmc::CycleVerdict> cycles,
                    std::span<const mmc::CorrectedCycle> corrected);
  /// Writes a text file, which is on the disk when the function returns.
  void write_text(const std::string& name, const std::string& text);

  /// Returns the CPU times of the phases of all design iterations, summed over all threads [s]. The
  /// iterations of the run that this one continues are included. Empty without designs.
  const std::vector<std::pair<std::string, double>>& phases() const { return phases_; }

  /// The history of the design of one body, for plots.
  struct History {
    std::string body;  ///< Name of the designed body.

    /// Values of every iteration: number of the row, compliance [J], volume fraction [-], KKT
    /// residual [-]; and of crisp evaluations: number of the row, compliance of the crisp design
    /// [J].
    std::vector<double> row, compliance, volume, kkt, crisp_row, crisp_compliance;

    /// Components of every iteration, with their parameters one after the other; empty for
    /// iterations of the run that this one continues.
    std::vector<std::vector<float>> components;
    double min_half_thickness = 0;  ///< Lower bound of the half-thickness of components [m].

    /// Polygons of the solid and of the void passive regions [m].
    std::vector<std::vector<Vec2>> solid, empty;
  };
  /// Returns the histories of all designed bodies.
  const std::vector<History>& histories() const { return histories_; }

  /// Outlines of the design of one body.
  struct DesignPictures {
    /// Name of the body; initial layout and latest result as SVG, empty if there is none.
    std::string body, start, result;
    std::vector<Region> outline;  ///< Outline of the latest result [m].
  };
  /// Returns the outlines of all designed bodies.
  const std::vector<DesignPictures>& design_pictures() const { return pictures_; }

  /// The equivalent static loads of one body: a value per load set.
  struct LoadSets {
    std::string body;  ///< Name of the body.

    /// Times [s], strain energies of the motion [J], and ratios of the strain energy of the static
    /// displacements to that of the motion [-]; no ratios before a design exists.
    std::vector<double> time, strain_energy, energy_ratio;
  };
  /// Returns the latest equivalent static loads of all designed bodies.
  const std::vector<LoadSets>& load_sets() const { return load_sets_; }
  /// Returns the names of all files of the run so far.
  std::vector<std::string> files() { return folder_.files(); }

  /// Saves or restores the list of frames of a motion; when restored, their index is written again.
  void archive_frames(Archive& memory);
  /// Returns the names of the files of all frames of a motion, as for file().
  std::vector<std::string> frames() const;

  /// Returns frames of the first body in space for a picture: all of them, or `most` equally spaced
  /// ones if there are more.
  std::vector<io::SurfaceFrame> shapes(size_t most) const;

 private:
  History& history_of(const std::string& body);
  DesignPictures& pictures_of(const std::string& body);
  /// One body of a frame of the motion: its mesh, fields, time [s] and number.
  struct FramePart {
    const io::QuadMesh& mesh;
    std::vector<io::Field> cells, points;
    double time;
    int number;
  };
  void write_part(const std::string& body, FramePart part);
  /// Executes a task that writes a frame, at once or in the separate thread. Frames that cannot be
  /// written are counted.
  void write_frame(std::function<void()> task);
  void begin_history(Begin begin);
  void keep_row(const mmc::RowOfHistory& row, const std::vector<std::string>& old);
  void forget_old_rows();
  bool wants_frame(int iteration) const;
  bool keeps_fields(int iteration) const;
  struct FrameNames;
  void list_frame(int row, const FrameNames& names);
  bool has_frames(const mmc::RowOfHistory& row) const;
  void write_design_frame(const mmc::IterationReport& report);
  void write_history_row(const mmc::IterationReport& report);

  io::OutputFolder folder_;
  const Scene& scene_;
  std::unique_ptr<io::CsvWriter> history_;
  /// An index of frames (.pvd), which is created with its first frame.
  class FrameIndex {
   public:
    FrameIndex(RunFolder& folder, std::string name) : folder_(folder), name_(std::move(name)) {}
    void add(double time, const std::string& file, int part = 0);
    void drop(const std::string& file);

   private:
    RunFolder& folder_;
    std::string name_;
    std::optional<io::Series> series_;
  };
  FrameIndex iterations_, fields_, components_, motion_;
  /// A written file of a frame of the motion: one body at one time [s].
  struct Frame {
    std::string file;
    double time = 0;
    int part = 0;
    void archive(Archive& memory) { memory(file, time, part); }
  };
  std::vector<Frame> frames_;
  std::map<std::string, std::string> missing_;  // by the name of the export: why it is missing
  int lost_frames_ = 0;                         // set by tasks of writer_, like why_lost_
  std::string why_lost_;
  std::vector<History> histories_;
  std::deque<std::vector<std::string>> old_rows_;    // remaining rows of a continued history
  std::vector<std::vector<std::string>> kept_rows_;  // rows of a continued history that are kept
  std::vector<DesignPictures> pictures_;
  std::vector<LoadSets> load_sets_;
  int rows_ = 0, motion_frames_ = 0;
  std::vector<io::SurfaceFrame> shapes_;
  std::vector<std::pair<std::string, double>> phases_;  // name and CPU time [s]
  std::atomic<double> output_seconds_ = 0;
  io::Background writer_;  // last member: its tasks use the others
};

}  // namespace flexmorph::cases
