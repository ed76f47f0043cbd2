#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>

#include "cases/output/run_folder.h"
#include "cases/results/schema.h"
#include "cases/scene/design/goal.h"
#include "geometry/cpu_time.h"
#include "io/files.h"

/// Members of RunFolder that write the history of designs, or continue the history of an earlier
/// run: a row per iteration, and frames.
namespace flexmorph::cases {
namespace {

/// Returns the names of the first columns of the history.
const std::vector<std::string>& history_columns() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const auto& quantity : iteration_quantities()) out.emplace_back(quantity.name);
    return out;
  }();
  return names;
}
/// Last columns; the responses of further_rows() are between history_columns() and these columns.
const std::vector<std::string> kHistorySeconds = {
    "seconds_tdf",         "seconds_outlines",  "seconds_factor", "seconds_solve",
    "seconds_sensitivity", "seconds_optimizer", "seconds_output"};

std::vector<std::string> columns_of(const Scene& scene) {
  std::vector<std::string> out = history_columns();
  for (const mmc::ResponseRow* row : further_rows(scene)) out.push_back(mmc::key_of(*row));
  out.insert(out.end(), kHistorySeconds.begin(), kHistorySeconds.end());
  return out;
}

/// Bits of the mantissa of density and topology description function in the files of every
/// iteration, which are a third smaller with them. Outlines move by less than a thousandth of a
/// cell.
constexpr int kBits = 10;

/// Returns the value of a cell of a table that was read; NaN if the cell is empty.
double value_of(const std::string& cell) {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return value;
}

}  // namespace

/// Names of the frame of a design that belongs to the n-th row of the history: density and
/// topology description function, all other fields, and outlines of the components. Only the
/// latest files of all other fields and of outlines exist, unless they are kept; the latest ones
/// have the same names in every iteration.
struct RunFolder::FrameNames {
  std::string image, fields, lines, latest_fields, latest_lines;
  bool kept;  ///< True if all fields of this frame are kept.

  FrameNames(const Scene& scene, const std::string& body, int n, bool keeps) : kept(keeps) {
    const std::string stem = scene.designs.size() > 1 ? body + "_" : "";
    image = numbered("iteration_" + stem, n, ".vti");
    latest_fields = "fields_" + stem + "last.vti";
    latest_lines = "components_" + stem + "last.vtp";
    fields = kept ? numbered("fields_" + stem, n, ".vti") : latest_fields;
    lines = kept ? numbered("components_" + stem, n, ".vtp") : latest_lines;
  }
};

void RunFolder::begin_history(Begin begin) {
  const std::vector<std::string> columns = columns_of(scene_);
  for (const std::string& name : kHistorySeconds)
    phases_.emplace_back(name.substr(std::string("seconds_").size()), 0);
  const std::string path = folder_.file("history.csv");
  if (begin == Begin::keep_running && std::filesystem::exists(path)) {
    history_ = std::make_unique<io::CsvWriter>(io::CsvWriter::keep_running(path, columns.size()));
    const io::CsvTable old = io::read_csv(path);
    if (old.columns == columns) {
      for (size_t r = 0; r < old.n_rows(); ++r) old_rows_.push_back(old.row(r));
      return;
    }
  }
  history_ = std::make_unique<io::CsvWriter>(path, columns);
}

bool RunFolder::wants_frame(int iteration) const {
  const Output& request = scene_.output;
  return request.vtk && request.design_every > 0 &&
         (iteration == 1 || iteration % request.design_every == 0);
}

/// Returns true if displacement, strain energy and outlines of a frame are kept: they are kept for
/// the first frame after every `fields_every` iterations.
bool RunFolder::keeps_fields(int iteration) const {
  const Output& request = scene_.output;
  if (request.fields_every == 0) return false;
  return iteration / request.fields_every !=
         std::max(0, iteration - request.design_every) / request.fields_every;
}

bool RunFolder::has_frames(const mmc::RowOfHistory& row) const {
  if (!wants_frame(row.iteration)) return true;
  const FrameNames names(scene_, row.body, rows_ + 1, keeps_fields(row.iteration));
  const auto exists = [this](const std::string& name) {
    return std::filesystem::exists(path() + "/design/" + name);
  };
  return exists(names.image) && (!names.kept || (exists(names.fields) && exists(names.lines)));
}

bool RunFolder::has_row(const mmc::RowOfHistory& row) {
  if (old_rows_.empty()) return false;
  const std::vector<std::string> old = old_rows_.front();
  if (old[0] != row.body || old[1] != io::to_text(row.cycle) ||
      old[2] != io::to_text(row.iteration) || !has_frames(row)) {
    forget_old_rows();
    return false;
  }
  keep_row(row, old);
  kept_rows_.push_back(old);
  old_rows_.pop_front();
  return true;
}

/// Discards the remaining rows of a continued history, because the run differs from here on or
/// files are missing. The rows kept so far are written again.
void RunFolder::forget_old_rows() {
  old_rows_.clear();
  history_ = std::make_unique<io::CsvWriter>(folder_.file("history.csv"), columns_of(scene_));
  for (const std::vector<std::string>& kept : kept_rows_)
    history_->row(std::vector<io::Cell>(kept.begin(), kept.end()));
}

/// Restores an iteration from its row, with the effects of add_iteration().
void RunFolder::keep_row(const mmc::RowOfHistory& row, const std::vector<std::string>& old) {
  ++rows_;
  if (wants_frame(row.iteration))
    write_frame([this, number = rows_,
                 names = FrameNames(scene_, row.body, rows_, keeps_fields(row.iteration))] {
      list_frame(number, names);
    });
  const auto number = [&](const char* name) {
    const std::vector<std::string>& names = history_columns();
    const auto at = std::find(names.begin(), names.end(), name);
    return value_of(old[static_cast<size_t>(at - names.begin())]);
  };
  for (size_t i = 0, first = old.size() - phases_.size(); i < phases_.size(); ++i)
    phases_[i].second += value_of(old[first + i]);
  History& h = history_of(row.body);
  h.row.push_back(static_cast<double>(h.row.size() + 1));
  h.compliance.push_back(number("compliance"));
  h.volume.push_back(number("volume"));
  h.kkt.push_back(number("kkt"));
  h.components.emplace_back();
  if (const double crisp = number("crisp_compliance"); std::isfinite(crisp)) {
    h.crisp_row.push_back(h.row.back());
    h.crisp_compliance.push_back(crisp);
  }
}

/// Adds a frame to the index files in place of the latest one, and removes the latest files if the
/// frame has its own.
void RunFolder::list_frame(int row, const FrameNames& names) {
  iterations_.add(row, names.image);
  const auto list = [&](FrameIndex& index, const std::string& name, const std::string& latest) {
    const std::string folder = path() + "/design/";
    index.drop(latest);
    if (std::filesystem::exists(folder + name)) index.add(row, name);
    std::error_code none;  // ignored: the file may be missing
    if (names.kept) std::filesystem::remove(folder + latest, none);
  };
  list(fields_, names.fields, names.latest_fields);
  list(components_, names.lines, names.latest_lines);
}

/// Writes the VTK files of an intermediate design.
void RunFolder::write_design_frame(const mmc::IterationReport& r) {
  const double start = thread_seconds();
  const mmc::CellScaleFactors& factors = r.state.factors();
  // The weighted strain energy of a cell is Σ w ½ uᵀ K_cell u, and the derivative by its stiffness
  // scale factor contains uᵀ K_cell u. The energies of the loads and of held thermal growth are
  // added. Their mixed terms are left out because they sum to zero over the cells.
  VectorXd by_stiffness = -r.value.d_stiffness;
  if (by_stiffness.size() == 0)
    by_stiffness.setZero(factors.stiffness.size());  // the state was not solved
  if (r.value.d_held.size() > 0) by_stiffness += 2 * r.value.d_held;
  VectorXd shown = r.loads.displacement(factors.stiffness, factors.mass,
                                        r.loads.position(r.loads.n_loads() - 1));
  output_seconds_ += thread_seconds() - start;
  // All data are copied because a separate thread may write them during the next iteration.
  write_frame([this, row = rows_,
               names = FrameNames(scene_, r.problem.body, rows_, keeps_fields(r.iteration)),
               grid = r.problem.grid, mass = factors.mass, stiffness = factors.stiffness,
               energy = VectorXd(0.5 * by_stiffness.cwiseProduct(factors.stiffness)),
               phi = VectorXd(r.state.phi()), displacement = std::move(shown),
               components = r.state.components(),
               min_half_thickness = r.problem.bands.back().min_half_thickness] {
    const double clock = thread_seconds();
    const auto view = [](const VectorXd& v) {
      return std::span<const double>(v.data(), static_cast<size_t>(v.size()));
    };
    const io::Field density{.name = "density", .values = view(mass), .bits = kBits};
    const io::Field tdf{.name = "tdf", .values = view(phi), .bits = kBits};
    const io::Field cells[] = {{"stiffness_factor", view(stiffness)},
                               {.name = "strain_energy", .values = view(energy), .unit = "J"}};
    const io::Field points{
        .name = "displacement", .values = view(displacement), .components = 2, .unit = "m"};
    std::vector<double> parameters;
    for (const Component& component : components)
      for (const double each : component.parameters()) parameters.push_back(each);
    const io::Field data{"components", parameters, Component::kParameters};
    io::write_image_data(folder_.file("design/" + names.image), grid, {&density, 1}, {&tdf, 1},
                         {&data, 1});
    io::write_image_data(folder_.file("design/" + names.fields), grid, cells, {&points, 1});
    io::write_components(folder_.file("design/" + names.lines), components, min_half_thickness);
    list_frame(row, names);
    output_seconds_ += thread_seconds() - clock;
  });
}

namespace {

/// Adds the components of an iteration to the history of its body.
void keep_components(const mmc::IterationReport& r, RunFolder::History& h) {
  h.min_half_thickness = r.problem.bands.back().min_half_thickness;
  h.solid = r.problem.solid;
  h.empty = r.problem.empty;
  std::vector<float>& out = h.components.emplace_back();
  for (const Component& c : r.state.components())
    for (const double p : c.parameters()) out.push_back(static_cast<float>(p));
}

}  // namespace

void RunFolder::add_iteration(const mmc::IterationReport& r) {
  if (!old_rows_.empty()) forget_old_rows();
  ++rows_;
  if (wants_frame(r.iteration)) write_design_frame(r);
  History& h = history_of(r.problem.body);
  h.row.push_back(static_cast<double>(h.row.size() + 1));
  h.compliance.push_back(r.state.compliance());
  h.volume.push_back(r.state.volume());
  h.kkt.push_back(r.iterate.kkt);
  keep_components(r, h);
  if (r.crisp) {
    h.crisp_row.push_back(h.row.back());
    h.crisp_compliance.push_back(r.crisp->compliance);
  }
  write_history_row(r);
}

void RunFolder::write_history_row(const mmc::IterationReport& r) {
  std::vector<io::Cell> row;
  for (const auto& quantity : iteration_quantities()) row.emplace_back(text_of(quantity.value(r)));
  const mmc::ComplianceEvaluator::Seconds s = r.state.seconds();
  for (const mmc::ResponseRow* further : further_rows(scene_)) {
    const std::optional<VectorXd> values = r.state.values(*further);
    row.push_back(values ? io::Cell(values->maxCoeff()) : io::Cell());
  }
  const std::array seconds = {r.state.seconds_tdf(),
                              r.crisp ? r.crisp->seconds_outlines : 0,
                              s.factor,
                              s.solve,
                              s.sensitivity,
                              r.iterate.seconds,
                              take_output_seconds()};
  row.insert(row.end(), seconds.begin(), seconds.end());
  for (size_t i = 0; i < seconds.size(); ++i) phases_.at(i).second += seconds[i];
  history_->row(row);
}

RunFolder::History& RunFolder::history_of(const std::string& body) {
  for (History& h : histories_)
    if (h.body == body) return h;
  histories_.emplace_back().body = body;
  return histories_.back();
}

}  // namespace flexmorph::cases
