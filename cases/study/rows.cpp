#include "cases/study/rows.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "cases/assembly/resource_estimate.h"
#include "cases/check/ready.h"
#include "cases/output/kept_case.h"
#include "io/files.h"
#include "io/output_folder.h"
#include "io/shell.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxNames = 12;  // largest number of rows that a line names

/// Returns a line with the names of rows: "missing: a=1, a=2".
std::string named(const std::string& what, const std::vector<std::string>& names) {
  std::string out = what + ":";
  for (size_t i = 0; i < std::min(names.size(), kMaxNames); ++i)
    out += (i > 0 ? "; " : " ") + names[i];
  if (names.size() > kMaxNames)
    out += "; and " + std::to_string(names.size() - kMaxNames) + " more (rows.csv)";
  return out + "\n";
}

std::string count_text(size_t count, const std::string& what) {
  return std::to_string(count) + " " + what;
}

/// Returns the address space that the shell allows a row, as a prefix of its command line.
std::string memory_prefix(const StudyOptions& options, const std::string& line) {
  if (options.memory_limit <= 0) return line;
  return "(ulimit -v " + io::to_text(std::llround(options.memory_limit / 1024)) + " && exec " +
         line + ")";
}

}  // namespace

std::string row_command(const StudyOptions& options, const Variant& variant) {
  const std::string line =
      options.dispatch.program + " " + io::shell_line(row_arguments(options, variant, true));
  if (line.find_first_of("\t\n\r") != std::string::npos)
    throw Error::input("row '" + variant.name +
                       "': a setting has a line end or a tabulator; command lines of rows cannot "
                       "contain them");
  return memory_prefix(options, line);
}

bool is_answered(const StudyOptions& options, const Variant& variant, const VariantResult& result) {
  const bool failed = result.status == "failed" && result.ending.code == 3;
  if (!result.done() && !failed) return false;
  // An equal run has equal numbers, but not an equal disk.
  if (failed && result.message.find("cannot be written") != std::string::npos) return false;
  if (result.ending.over_time && result.seconds_limit < options.time_limit) return false;
  return keeps_case(folder_of(options, variant), case_of(options, variant));
}

VariantResult collected_row(const StudyOptions& options, const Variant& variant) {
  VariantResult out = read_result(options, variant);
  if (out.status != "missing") {
    if (keeps_case(out.directory, case_of(options, variant))) return out;
    VariantResult other;
    other.name = out.name;
    other.directory = out.directory;
    other.status = "another case";
    return other;
  }
  // A refused row has no folder; the reason may be in the log.
  out.message = last_text(text_of(out.directory + ".log"));
  if (!options.keeps_failures) return out;
  try {
    check_variants(options, {&variant, 1});
  } catch (const Error& error) {
    out.status = "failed";
    out.message = error.what();
    out.ending.code = error.kind() == Error::Kind::input ? 2 : 3;
  }
  return out;
}

void free_folder(const StudyOptions& options, const Variant& variant) {
  const std::string folder = folder_of(options, variant);
  if (fs::exists(folder + "/run.json") && !keeps_case(folder, case_of(options, variant)))
    io::OutputFolder moved(folder);
}

void make_folder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw Error::input("folder '" + path + "' cannot be created: " + error.message());
}

std::string Origin::words() const {
  std::string out = "version " + (version.empty() ? "unknown" : version);
  for (const auto& [name, value] :
       {std::pair{"commit", &commit}, {"processor", &processor}, {"kernels", &kernels}})
    if (!value->empty()) out += std::string(", ") + name + " " + *value;
  return out;
}

std::string origin_note(std::span<const VariantResult> rows) {
  std::vector<Origin> origins;
  std::vector<std::vector<std::string>> names;
  for (const VariantResult& row : rows) {
    if (!row.done()) continue;
    const auto at = std::find(origins.begin(), origins.end(), row.origin);
    if (at == origins.end()) {
      origins.push_back(row.origin);
      names.push_back({row.name});
    } else {
      names[static_cast<size_t>(at - origins.begin())].push_back(row.name);
    }
  }
  if (origins.size() < 2) return "";
  std::string out =
      "\nThe rows have different origins. The last digits of their results may differ for this "
      "reason:\n";
  for (size_t i = 0; i < origins.size(); ++i) out += named("- " + origins[i].words(), names[i]);
  return out;
}

std::string rows_note(std::span<const VariantResult> rows, bool keeps_failures) {
  std::map<std::string, std::vector<std::string>> names;
  size_t complete = 0;
  for (const VariantResult& row : rows) {
    const bool counts = row.done() || (keeps_failures && row.status == "failed");
    complete += counts;
    if (!counts)
      names[row.status].push_back(row.name + (row.message.empty() ? "" : " (" + row.message + ")"));
  }
  std::string out;
  if (!names.empty()) {
    out = "\n" + count_text(rows.size(), "rows: ") + count_text(complete, "complete");
    for (const auto& [status, list] : names) out += ", " + count_text(list.size(), status);
    out += "\n";
    for (const auto& [status, list] : names) out += named(status, list);
  }
  return out + origin_note(rows);
}

void write_rows(std::span<const VariantResult> rows, const std::string& path) {
  const std::vector<std::string> columns = {
      "row",       "folder",  "status",      "exit_code",    "version",           "commit",
      "processor", "kernels", "seconds_cpu", "seconds_wall", "peak_memory_bytes", "message"};
  io::CsvWriter csv(path, columns);
  const auto folder_in_table = [](const std::string& folder, const fs::path& table) {
    return fs::path(folder).lexically_proximate(table.parent_path()).string();
  };
  const auto cell = [](bool known, double value) {
    return known && std::isfinite(value) ? io::Cell(value) : io::Cell();
  };
  for (const VariantResult& row : rows) {
    const bool ran = row.done() || row.status == "failed";
    const bool has_code = ran && row.ending.code >= 0;
    const std::vector<io::Cell> cells = {row.name,
                                         folder_in_table(row.directory, path),
                                         row.status,
                                         has_code ? io::Cell(row.ending.code) : io::Cell(),
                                         row.origin.version,
                                         row.origin.commit,
                                         row.origin.processor,
                                         row.origin.kernels,
                                         cell(ran, row.seconds_cpu),
                                         cell(ran, row.seconds_wall),
                                         cell(ran, row.peak_memory_bytes),
                                         row.message};
    csv.row(cells);
  }
}

int exit_code_of(const StudyOptions& options, std::span<const VariantResult> rows) {
  int out = 0;
  for (const VariantResult& row : rows) {
    if (!row.done() && row.status != "failed") return 4;
    if (row.status == "failed" && !options.keeps_failures) out = 3;
  }
  return out;
}

StudyOutcome collect_rows(const StudyOptions& options, std::span<const Variant> variants,
                          const ResultsChanged& changed) {
  make_folder(options.directory);
  const io::FolderLock lock(options.directory);
  StudyOutcome out;
  for (const Variant& variant : variants) out.results.push_back(collected_row(options, variant));
  out.exit_code = exit_code_of(options, out.results);
  changed(out.results);
  return out;
}

namespace {

/// Returns numbers as Slurm reads them, from flags of the numbers 1, 2, ...: "1-3,7".
std::string ranges_of(const std::vector<bool>& wanted) {
  std::string out;
  for (size_t first = 0; first < wanted.size(); ++first) {
    if (!wanted[first]) continue;
    size_t last = first;
    while (last + 1 < wanted.size() && wanted[last + 1]) ++last;
    out += (out.empty() ? "" : ",") + std::to_string(first + 1);
    if (last > first) out += "-" + std::to_string(last + 1);
    first = last;
  }
  return out;
}

/// Returns the script of a job array of Slurm. Its rows are the lines of a text in the script.
std::string array_script(const StudyOptions& options, std::span<const Variant> variants) {
  std::string lines;
  std::vector<bool> wanted;
  for (const Variant& variant : variants) {
    lines += row_command(options, variant) + "\n";
    wanted.push_back(!is_answered(options, variant, read_result(options, variant)));
  }
  const std::string numbers = ranges_of(wanted);
  if (numbers.empty())
    throw Error::input("all rows of the study in '" + options.directory +
                       "' have results already; --collect makes its tables");
  const std::string head = "#SBATCH ";
  std::string out = "#!/bin/bash\n# Rows of the study " + options.directory +
                    " that had no results when this script was printed.\n";
  out += head + "--job-name=" + fs::path(options.directory).filename().string() + "\n";
  out += head + "--array=" + numbers + "\n";
  out += head + "--requeue --open-mode=append --signal=TERM@60\n";
  out += head + "--output=\"" + options.directory + "/slurm_%a.log\"\n";
  out += head + *options.dispatch.sbatch + "\n";
  out += "row=$(sed -n \"${SLURM_ARRAY_TASK_ID}p\" <<'ROWS'\n" + lines + "ROWS\n)\n";
  return out + R"script(srun bash -c "trap : TERM; $row"
code=$?
# Exit code 4: the run was interrupted, and is continued. 143: SIGTERM came before it had begun.
case $code in 4 | 143) scontrol requeue "${SLURM_ARRAY_JOB_ID}_${SLURM_ARRAY_TASK_ID}" ;; esac
exit $code
)script";
}

}  // namespace

std::string rows_text(const StudyOptions& options, std::span<const Variant> variants) {
  make_folder(options.directory);
  io::require_study_folder(options.directory);
  for (const Variant& variant : variants) free_folder(options, variant);
  if (options.dispatch.sbatch) return array_script(options, variants);
  std::string out;
  for (const Variant& variant : variants) out += row_command(options, variant) + "\n";
  return out;
}

}  // namespace flexmorph::cases
