#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <set>
#include <sstream>

#include "cases/assembly/resource_estimate.h"
#include "cases/check/ready.h"
#include "cases/run/progress.h"
#include "cases/scene/scene.h"
#include "cases/study/processes.h"
#include "cases/study/rows.h"
#include "io/files.h"
#include "io/output_folder.h"
#include "io/shell.h"

namespace flexmorph::cases {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;
using Clock = std::chrono::steady_clock;

constexpr auto kBetweenLooks = std::chrono::milliseconds(300);  // at the log of GNU parallel
constexpr double kSecondsToEnd = 30;  // for GNU parallel and its runs after an interruption
const char* const kLogHead =
    "Seq\tHost\tStarttime\tJobRuntime\tSend\tReceive\tExitval\tSignal\tCommand\n";
const char* const kReturned = "/.returned";  // folder of rows that return from other machines

/// Returns the path of a file relative to the working directory.
/// @throws Error (input) if it lies outside of it, because it would have no place on a machine
std::string path_to_send(const std::string& path, const std::string& what) {
  const fs::path out =
      fs::absolute(path).lexically_normal().lexically_proximate(fs::current_path());
  if (out.empty() || *out.begin() == ".." || out.is_absolute())
    throw Error::input("--hosts: " + what + " '" + path +
                       "' lies outside of the working directory, from which files are sent to "
                       "machines; start the study in a folder that contains it, or use "
                       "--shared-disk");
  return out.string();
}

/// Returns the number of files in a folder and below it.
size_t files_in(const std::string& folder) {
  std::error_code error;
  size_t out = 0;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error))
    out += at->is_regular_file() && !at->is_symlink();
  return out;
}

/// The rows of a study on several machines, and the files of GNU parallel in the study's folder:
/// parallel.rows (a line per row: its number, its folder and its command line), parallel.log (its
/// job log), and parallel.out (its messages).
class Hosts {
 public:
  Hosts(const StudyOptions& options, std::span<const Variant> variants)
      : options_(options), variants_(variants), stem_(options.directory + "/parallel") {
    for (const Variant& variant : variants) {
      out_.results.push_back(collected_row(options, variant));
      answered_.push_back(is_answered(options, variant, out_.results.back()));
    }
    n_before_ = static_cast<size_t>(std::count(answered_.begin(), answered_.end(), true));
  }

  StudyOutcome run(const ResultsChanged& changed) {
    if (n_before_ < variants_.size()) start(changed);
    for (size_t i = 0; i < variants_.size(); ++i)
      out_.results[i] = collected_row(options_, variants_[i]);
    out_.exit_code = exit_code_of(options_, out_.results);
    changed(out_.results);
    return std::move(out_);
  }

 private:
  bool shared() const { return options_.dispatch.shared_disk; }
  std::string folder(size_t i) const { return folder_of(options_, variants_[i]); }
  std::string returned() const { return options_.directory + kReturned; }

  void say(const std::string& words) const {
    if (!options_.quiet) print_text(words);
  }

  /// Writes the list of all rows: number, folder and command line. A row whose exit code is 3 or 5
  /// has a result, therefore GNU parallel is told that it has ended well. A row on another machine
  /// returns under its number, because GNU parallel and rsync disagree on how to quote other names.
  void write_rows_file() const {
    const std::string here = "[ \"$PARALLEL_SSHLOGIN\" = : ]";
    std::string out;
    for (size_t i = 0; i < variants_.size(); ++i) {
      const std::string row = io::shell_word(folder(i)), log = io::shell_word(folder(i) + ".log"),
                        number = std::to_string(i + 1);
      std::string line = "mkdir -p " + row + "; " + row_command(options_, variants_[i]) + " >" +
                         log + " 2>&1; code=$?; ";
      if (!shared())
        line = here + " && cd " + io::shell_word(fs::current_path().string()) + "; " + line + here +
               " || { mv " + row + " " + number + ".row; mv " + log + " " + number + ".log; find " +
               number + ".row -type f | wc -l >" + number + ".files; }; ";
      out += number + "\t" + folder(i) + "\t" + line +
             "[ $code = 3 ] || [ $code = 5 ] || exit $code\n";
    }
    io::write_file(stem_ + ".rows", out);
  }

  /// Writes the job log so that GNU parallel leaves out exactly the rows with results.
  void write_log() const {
    std::string out = kLogHead;
    for (size_t i = 0; i < variants_.size(); ++i)
      if (answered_[i]) out += std::to_string(i + 1) + "\t:\t0\t0\t0\t0\t0\t0\t" + folder(i) + "\n";
    io::write_file(stem_ + ".log", out);
  }

  /// Returns the files that the rows read, which are sent to the machines. The machines have the
  /// files of shipped cases.
  std::set<std::string> inputs() const {
    std::set<std::string> out;
    for (size_t i = 0; i < variants_.size(); ++i) {
      if (answered_[i]) continue;
      const Variant& variant = variants_[i];
      const std::string& name = variant.case_name.empty() ? options_.case_name : variant.case_name;
      const io::CaseFile file = case_of(options_, variant);
      if (fs::is_regular_file(name)) {
        if (fs::path(name).is_absolute())
          throw Error::input("--hosts: the path of the case '" + name +
                             "' has to be relative to the working directory");
        out.insert(path_to_send(name, "the case"));
      }
      for (const std::string& each : overrides_of_files(file)) {
        const size_t at = each.find('=');  // such as "drive.0.csv='/data/turn.csv'"
        const std::string path = each.substr(at + 2, each.size() - at - 3);
        if (!path.starts_with(cases_folder() + "/")) out.insert(path_to_send(path, "the file"));
      }
    }
    return out;
  }

  /// Returns the largest estimated memory of the rows without results [bytes].
  double memory() const {
    double out = 0;
    for (size_t i = 0; i < variants_.size(); ++i)
      if (!answered_[i])
        out = std::max(
            out, estimate_resources(read_scene(case_of(options_, variants_[i]))).memory_bytes());
    return out;
  }

  Words words() const {
    Words out = {"parallel",
                 "--plain",
                 "--will-cite",
                 "--arg-file",
                 stem_ + ".rows",
                 "--colsep",
                 "\t",
                 "--joblog",
                 stem_ + ".log",
                 "--resume-failed",
                 "--retries",
                 "2",
                 "--sshloginfile",
                 options_.dispatch.hosts,

                 "--memfree",
                 io::to_text(static_cast<long long>(memory())),
                 "--termseq",
                 "TERM,20000,KILL,25"};
    if (options_.threads > 1)
      out.insert(out.end(), {"--jobs", io::to_text(std::max(1, 100 / options_.threads)) + "%"});
    if (shared()) {
      out.insert(out.end(), {"--workdir", "."});
    } else {
      out.insert(out.end(), {"--workdir", "..."});
      for (const std::string& file : inputs()) out.insert(out.end(), {"--transferfile", file});
      out.insert(out.end(), {"--transferfile", "{2}"});
      for (const char* ending : {".row", ".log", ".files"})
        out.insert(out.end(), {"--return", returned() + "/./{1}" + ending});
      out.emplace_back("--cleanup");
    }
    out.insert(out.end(), {"sh", "-c", "{3}"});
    return out;
  }

  void start(const ResultsChanged& changed) {
    for (size_t i = 0; i < variants_.size(); ++i) {
      if (answered_[i]) continue;
      free_folder(options_, variants_[i]);
      make_folder(folder(i));
    }
    fs::remove_all(returned());
    write_rows_file();
    write_log();
    const Child child{words(), stem_ + ".out", "/usr/bin/env"};
    if (n_before_ > 0)
      say(std::to_string(n_before_) + " of " + std::to_string(variants_.size()) +
          " rows have results already");
    Ending ending;
    auto looked = begin_;
    const bool whole = run_children({child}, 1, {.grace = kSecondsToEnd},
                                    {.ended = [&](size_t, const Ending& end) { ending = end; },
                                     .waiting =
                                         [&](const std::vector<size_t>&) {
                                           if (Clock::now() - looked < kBetweenLooks) return;
                                           looked = Clock::now();
                                           look(changed);
                                         }});
    look(changed);
    fs::remove_all(returned());
    if (!whole) {
      say("interrupted: the same command continues the study in " + options_.directory);
      return;
    }
    if (ending.code == 127)
      throw Error::input(
          "--hosts: GNU parallel is not installed (Debian package `parallel`; hosts without a "
          "shared disk need `rsync`, too)");
    if (ending.code != 0 && n_ended_ == 0)
      throw Error::input("--hosts: no row was run; GNU parallel says: " +
                         last_text(text_of(stem_ + ".out")) + " (" + stem_ + ".out)");
    if (ending.code != 0)
      say("Rows without results: the same command runs them again; messages of the machines are "
          "in " +
          stem_ + ".out");
  }

  /// Reads the job log and takes the results of the rows that have ended since the last call.
  void look(const ResultsChanged& changed) {
    // A row that was interrupted on its machine continues elsewhere from the folder that returned.
    for (size_t i = 0; i < variants_.size(); ++i)
      if (!answered_[i] && !shared()) move_returned(i);
    std::istringstream log(text_of(stem_ + ".log"));
    std::string line;
    std::getline(log, line);
    bool any = false;
    while (std::getline(log, line)) {
      size_t number = 0;
      const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
      if (error != std::errc() || number < 1 || number > variants_.size() || log.eof()) continue;
      if (answered_[number - 1] || !ended_.insert(number - 1).second) continue;
      any = true;
      take(number - 1, line);
    }
    if (any) changed(out_.results);
  }

  /// Moves the folder of a row that has returned to its place, if it is whole: the number of its
  /// files, which returns last, says so.
  void move_returned(size_t i) const {
    const std::string from = returned() + "/" + std::to_string(i + 1), to = folder(i);
    const std::string count = text_of(from + ".files");
    if (count.empty() || count != std::to_string(files_in(from + ".row")) + "\n") return;
    std::error_code none;
    fs::remove(from + ".files", none);
    fs::rename(from + ".log", to + ".log", none);
    // The returned folder has all files of the former one, which was sent to the machine.
    const std::string former = returned() + "/former";
    fs::rename(to, former, none);
    fs::rename(from + ".row", to);
    fs::remove_all(former, none);
  }

  void take(size_t i, const std::string& line) {
    if (!shared()) move_returned(i);
    VariantResult& result = out_.results[i];
    result = collected_row(options_, variants_[i]);
    ++n_ended_;
    const double seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
    const auto ended = static_cast<double>(n_ended_),
               left = static_cast<double>(variants_.size() - n_before_ - n_ended_);
    const double rest = seconds * left / ended;
    const std::string login = line.substr(0, line.find('\t', line.find('\t') + 1));
    const std::string host = login.substr(login.find_last_of("\t /") + 1);  // of "1\tssh -p 22 a@b"
    say(std::to_string(n_before_ + n_ended_) + "/" + std::to_string(variants_.size()) + " " +
        result.name + ": " + result.words() + ", " + host +
        (left > 0 ? left_text({rest, rest}) : ""));
  }

  const StudyOptions& options_;
  std::span<const Variant> variants_;
  std::string stem_;
  StudyOutcome out_;
  std::vector<bool> answered_;  // rows with results before the start
  std::set<size_t> ended_;      // rows that have ended since then
  size_t n_before_ = 0, n_ended_ = 0;
  Clock::time_point begin_ = Clock::now();
};

}  // namespace

StudyOutcome run_on_hosts(const StudyOptions& options, std::span<const Variant> variants,
                          const ResultsChanged& changed) {
  if (!options.dispatch.shared_disk) {
    path_to_send(options.directory, "the folder of the study");
    if (fs::path(options.directory).is_absolute())
      throw Error::input("--hosts: the path of the folder '" + options.directory +
                         "' has to be relative to the working directory");
  }
  make_folder(options.directory);
  const io::FolderLock lock(options.directory);
  return Hosts(options, variants).run(changed);
}

}  // namespace flexmorph::cases
