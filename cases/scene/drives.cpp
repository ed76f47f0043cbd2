#include <algorithm>
#include <cmath>

#include "cases/scene/body_keys.h"
#include "cases/scene/read.h"
#include "cases/scene/tables.h"
#include "geometry/registry.h"
#include "geometry/text.h"
#include "io/case_files/formula.h"
#include "io/files.h"
#include "io/smooth_table.h"
#include "io/table_noise.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

Registry<DriveRow>& drive_sources() {
  static const DriveRow trajectory{
      "trajectory", "The [trajectory] by inverse kinematics of the rigid mechanism.", {}};
  static Registry<DriveRow> all("source of a drive", [](const DriveRow& row) { return row.name; },
                                {&trajectory});
  return all;
}

using io::any_number;
using io::Jet;
using io::Key;
using io::Table;
using io::to_text;

using Constants = std::map<std::string, double>;

const Key& kConstant = io::key("constants", "*")
                           .number(any_number("a constant"))
                           .description(
                               "Constant NAME for formulas of drives and numbers; a number with a "
                               "unit is converted to SI units.");
const Key& kName =
    io::key("drive", "name")
        .text("the name of a drive")
        .description(
            "Name of the drive, by which hubs, joints, flows, loads and temperatures refer to it.");
const Key& kFormula = io::key("drive", "formula")
                          .text("a formula of the time t")
                          .otherwise_as("required unless `table`, `csv` or `from` is given")
                          .description(
                              "Formula of `t` and other drives: + - * / ^ pi sin ... sqrt abs "
                              "min max step smoothstep piecewise.");
const Key& kTable =
    io::key("drive", "table")
        .rows(any_number("a time or a value"), 2)
        .otherwise_as("required unless `formula`, `csv` or `from` is given")
        .description(
            "Rows of time and value from 0 to `time.end`, which a smooth curve interpolates.");
const Key& kCsv = io::key("drive", "csv")
                      .text("a CSV file")
                      .otherwise_as("required unless `formula`, `table` or `from` is given")
                      .description("CSV file with times and values, beside the case file.");
const Key& kTimeColumn = io::key("drive", "time")
                             .text("the name of a column")
                             .otherwise("time")
                             .when("`csv` is given")
                             .description("Column of times in the CSV file.");
const Key& kColumn = io::key("drive", "column")
                         .text("the name of a column")
                         .when("`csv` is given")
                         .description("Column of values in the CSV file.");
const Key& kUntil =
    io::key("drive", "until")
        .number(io::positive("the end of a parameter"))
        .otherwise_as("the drive is a function of time")
        .when("coordinates of the curve of a `path` joint")
        .description(
            "End of the parameter `t` of the curve, which begins at 0 and replaces the time.");
const Key& kFrom = io::key("drive", "from")
                       .word("a source of a drive",
                             [] {
                               io::Glossary rows;
                               for (const DriveRow* row : drive_rows())
                                 rows.emplace_back(row->name, row->sentence);
                               return rows;
                             })
                       .otherwise_as("required unless `formula`, `table` or `csv` is given")
                       .description(
                           "Source: the trajectory of the case, or a function that a program has "
                           "registered.");

/// Returns a function that is defined in [0, end] and is continued outside by the parabola of
/// value, rate and acceleration at the nearer end.
template <class Function>
std::function<fem::Motion(double)> over_run(Function function, double end) {
  return [function = std::move(function), end](double t) {
    const double inside = std::min(std::max(t, 0.0), end), beyond = t - inside;
    const Jet x = function(inside);
    if (beyond == 0) return fem::Motion{x.value, x.rate, x.acceleration};
    return fem::Motion{x.value + beyond * (x.rate + 0.5 * beyond * x.acceleration),
                       x.rate + beyond * x.acceleration, x.acceleration};
  };
}

/// Throws the error of a reader of formulas or tables again, located at a key. The text of the
/// formula is removed from the message, because the location shows it.
[[noreturn]] void pass_on(const Table& t, const Key& key, const Error& error,
                          const std::string& text = "") {
  std::string words = error.what();
  const std::string start = "formula '" + text + "': ";
  if (words.starts_with(start)) words = words.substr(start.size());
  t.fail(key, words);
}

/// Constants and other drives, which formulas can name.
struct Names {
  Constants constants;
  /// Drives by the end of their parameter; without one they are functions of time.
  std::map<std::optional<double>, io::NamedFunctions> drives;
};

void read_formula(const Table& t, const Names& names, double end, Drive& drive) {
  drive.words = t.string(kFormula);
  try {
    io::Formula formula(drive.words, names.constants, names.drives.at(drive.until));
    formula.check(end);
    drive.discontinuities = formula.discontinuities(end);
    if (const auto jump = formula.first_jump(end))
      drive.jump = std::string(jump->of_rate ? "the rate" : "the value") + " jumps from " +
                   to_text(jump->before, 4) + " to " + to_text(jump->after, 4) +
                   " at t = " + to_text(jump->time, 6) + " s";
    drive.motion = over_run(std::move(formula), end);
  } catch (const Error& error) {
    pass_on(t, kFormula, error, drive.words);
  }
  if (drive.until) drive.discontinuities.clear();
}

/// Appends a note if the errors of a table would dominate the acceleration of the drive.
void note_noise(const Table& t, const Key& key, const std::vector<double>& times,
                const std::vector<double>& values, std::vector<std::string>& notes) {
  const auto noise = io::noise_of(times, values);
  if (!noise) return;
  notes.push_back(t.subject_of(key) +
                  ": the table contains noise: " + to_text(100 * noise->sign_changes, 2) +
                  " % of its neighbouring second differences have opposite signs, and the "
                  "acceleration over one interval is " +
                  to_text(noise->ratio, 2) +
                  " times the acceleration over four intervals. The drive follows every point; "
                  "smooth the table before the run");
}

std::function<fem::Motion(double)> tabulated(const Table& t, const Key& key,
                                             const std::vector<double>& times,
                                             const std::vector<double>& values, double end,
                                             std::vector<std::string>& notes) {
  const auto make = [&] {
    try {
      return io::SmoothTable(times, values);
    } catch (const Error& error) {
      pass_on(t, key, error);
    }
  };
  io::SmoothTable table = make();
  note_noise(t, key, times, values, notes);
  if ((table.first() > 0 || table.last() < end) && t.has(kUntil))
    t.fail(key, "the table of a curve must cover the parameter from 0 to until = " + to_text(end) +
                    "; this table extends from " + to_text(table.first()) + " to " +
                    to_text(table.last()));
  if (table.first() > 0 || table.last() < end)
    t.fail(key, "a table must cover the run from 0 to time.end = " + to_text(end) +
                    " s; this table extends from " + to_text(table.first()) + " to " +
                    to_text(table.last()) + " s");
  return over_run(std::move(table), end);
}

std::function<fem::Motion(double)> read_table(const Table& t, double end, std::string& words,
                                              std::vector<std::string>& notes) {
  std::vector<double> times, values;
  for (const std::vector<double>& row : t.rows(kTable)) {
    times.push_back(row[0]);
    values.push_back(row[1]);
  }
  words = "table of " + to_text(static_cast<int>(times.size())) + " points";
  return tabulated(t, kTable, times, values, end, notes);
}

std::function<fem::Motion(double)> read_csv_drive(const Table& t, double end, std::string& words,
                                                  std::vector<std::string>& notes) {
  const std::string name = t.string(kCsv);
  const std::string time_column = t.string(kTimeColumn);
  const std::string column = t.string(kColumn);
  const auto numbers = [&](const io::CsvTable& csv, const Key& key, const std::string& wanted) {
    const std::vector<std::string>& known = csv.columns;
    if (std::find(known.begin(), known.end(), wanted) == known.end())
      t.fail(key, "'" + name + "' has no column '" + wanted + "'; its columns are " +
                      joined(known, ", ", "'"));
    try {
      return csv.all_numbers(wanted);
    } catch (const Error& error) {
      pass_on(t, kCsv, error);
    }
  };
  io::CsvTable csv;
  try {
    csv = io::read_csv(t.path_of(kCsv));
  } catch (const Error& error) {
    pass_on(t, kCsv, error);
  }
  const std::vector<double> times =
      numbers(csv, t.has(kTimeColumn) ? kTimeColumn : kCsv, time_column);
  const std::vector<double> values = numbers(csv, kColumn, column);
  words = "'" + name + "', column '" + column + "', " + to_text(static_cast<int>(times.size())) +
          " points";
  return tabulated(t, kCsv, times, values, end, notes);
}

/// Reads a drive as far as possible without the other drives, which its formula may name.
Drive read_drive(const Table& t, Scene& scene, bool has_trajectory) {
  Drive drive;
  drive.name = read_word(t, kName);
  for (const Drive& other : scene.drives)
    if (other.name == drive.name) t.fail(kName, "there is another drive '" + drive.name + "'");
  if (t.has(kFormula) + t.has(kTable) + t.has(kCsv) + t.has(kFrom) != 1)
    t.fail("a drive needs exactly one of `formula`, `table`, `csv` and `from`");
  if (t.has(kFrom)) {
    const DriveRow& source = *drive_sources().find(t.choice(kFrom));
    if (source.motion) {
      drive.words = "function '" + source.name + "' of the program";
      drive.motion = over_run(
          [motion = source.motion](double time) {
            const fem::Motion x = motion(time);
            return Jet{x.value, x.rate, x.acceleration};
          },
          scene.time.end);
      return drive;
    }
    if (!has_trajectory) t.fail(kFrom, "the case has no [trajectory]");
    drive.from_trajectory = true;
    drive.words = "from the trajectory";
    return drive;
  }
  if (t.has(kUntil)) drive.until = t.number(kUntil);
  const double end = drive.until.value_or(scene.time.end);
  if (t.has(kTable))
    drive.motion = read_table(t, end, drive.words, scene.notes);
  else if (t.has(kCsv))
    drive.motion = read_csv_drive(t, end, drive.words, scene.notes);
  return drive;
}

/// Returns what the formulas of drives can name.
Names names_for_formulas(const Table& root, const std::vector<Table>& tables, const Scene& scene) {
  Names out;
  out.constants = read_constants(root);
  for (size_t i = 0; i < tables.size(); ++i) {
    const Drive& drive = scene.drives[i];
    io::NamedFunctions& group = out.drives[drive.until];
    if (tables[i].has(kFormula))
      group.formulas[drive.name] = tables[i].string(kFormula);
    else if (drive.motion)
      group.functions[drive.name] =
          std::make_shared<const io::NamedFunctions::Function>([motion = drive.motion](double t) {
            const fem::Motion x = motion(t);
            return Jet{x.value, x.rate, x.acceleration};
          });
  }
  return out;
}

void refuse_curve(const Table& t, const Key& key, const Scene& scene, const std::string& drive) {
  for (const Drive& each : scene.drives)
    if (each.name == drive && each.until)
      t.fail(key, "the drive '" + drive +
                      "' is a coordinate of a curve (`until`), not a function of time");
}

/// Returns the value at the point between a and b where the rate changes its sign, by bisection.
double extreme(const std::function<fem::Motion(double)>& motion, double a, double b) {
  const bool rises = motion(a).rate > 0;
  for (int k = 0; k < 100 && b - a > 1e-15 * std::abs(b); ++k) {
    const double mid = 0.5 * (a + b);
    ((motion(mid).rate > 0) == rises ? a : b) = mid;
  }
  return motion(0.5 * (a + b)).value;
}

}  // namespace

std::span<const DriveRow* const> drive_rows() { return drive_sources().rows(); }

void register_drive(const DriveRow& row) {
  if (!row.motion) throw Error::input("the source of a drive '" + row.name + "' has no motion");
  drive_sources().add(row);
}

std::map<std::string, double> read_constants(const Table& root) {
  std::map<std::string, double> out;
  if (!root.has(tables::kConstants)) return out;
  const Table t = root.table(tables::kConstants);
  for (const std::string& key : t.keys()) {
    const std::string why = io::Formula::refusal_of_name(key);
    if (!why.empty()) t.fail(kConstant.named(key), why);
    out[key] = t.number(kConstant.named(key));
  }
  return out;
}

std::vector<std::string> overrides_of_drive_files(const Table& root) {
  std::vector<std::string> out;
  const std::vector<Table> drives = root.tables(tables::kDrive);
  for (size_t i = 0; i < drives.size(); ++i)
    if (drives[i].is_string(kCsv))
      out.push_back("drive." + std::to_string(i) + ".csv='" + drives[i].absolute(kCsv) + "'");
  return out;
}

Law read_law(const Table& t, const Key& key, const Scene& scene, std::optional<double> computed) {
  if (!t.is_string(key)) return {{}, t.number(key, computed)};
  const std::string name = t.choice(key.called("a drive"), names_of(scene.drives));
  refuse_jumps(t, key, scene, name);
  return {name, 0};
}

Law read_load_law(const Table& t, const Key& key, const Scene& scene) {
  if (!t.is_string(key)) return {{}, t.number(key)};
  const std::string name = t.choice(key.called("a drive"), names_of(scene.drives));
  refuse_curve(t, key, scene, name);
  return {name, 0};
}

std::vector<Law> read_load_laws(const Table& t, const Key& key, const Scene& scene) {
  std::vector<Law> out;
  for (const io::NumberOrName& each : t.numbers_or_names(key, names_of(scene.drives))) {
    refuse_curve(t, key, scene, each.name);
    out.push_back({each.name, each.number});
  }
  return out;
}

void refuse_jumps(const Table& t, const Key& key, const Scene& scene, const std::string& drive) {
  refuse_curve(t, key, scene, drive);
  for (const Drive& each : scene.drives)
    if (each.name == drive && !each.jump.empty())
      t.fail(key, "in the drive '" + drive + "' " + each.jump +
                      "; a prescribed motion has a continuous value and rate, only its "
                      "acceleration may jump");
}

void read_drives(const Table& root, Scene& scene) {
  const std::vector<Table> all = root.tables(tables::kDrive);
  for (const Table& t : all)
    scene.drives.push_back(read_drive(t, scene, root.has(tables::kTrajectory)));
  const Names names = names_for_formulas(root, all, scene);
  for (size_t i = 0; i < all.size(); ++i) {
    Drive& drive = scene.drives[i];
    if (all[i].has(kFormula))
      read_formula(all[i], names, drive.until.value_or(scene.time.end), drive);
  }
}

std::array<double, 2> range_of(const std::function<fem::Motion(double)>& motion, double end) {
  constexpr int kSamples = 1000;
  fem::Motion before = motion(0);
  std::array<double, 2> out{before.value, before.value};
  const auto see = [&](double value) { out = {std::min(out[0], value), std::max(out[1], value)}; };
  for (int i = 1; i <= kSamples; ++i) {
    const fem::Motion now = motion(end * i / kSamples);
    see(now.value);
    if (before.rate * now.rate < 0)
      see(extreme(motion, end * (i - 1) / kSamples, end * i / kSamples));
    before = now;
  }
  return out;
}

void follow_length(const Table& body_table, const Scene& scene, Body& body) {
  const Table t = body_table.table(body_keys::kFlow);
  Flow& flow = *body.flow;
  if (!flow.length.drive.empty()) {
    flow.motion = scene.motion_of(flow.length);
    const double start = flow.motion(0).value;
    if (body.length == 0) body.length = start;
    body_table.record(body_keys::kLength, body.length);
    if (std::abs(start - body.length) > 1e-9)
      t.fail(flow_keys::kLength, "this drive starts at " + to_text(start) + " m, but '" +
                                     body.name + "' has length = " + to_text(body.length) +
                                     " m at the start");
    const std::array<double, 2> range = range_of(flow.motion, scene.time.end);
    flow.shortest = range[0];
    flow.longest = range[1];
  }
  const double leaves = body.longest(scene.time.end) - body.length;
  if (flow.reservoir_length && *flow.reservoir_length < leaves * (1 - 1e-9))
    t.fail(flow_keys::kReservoirLength,
           "the reservoir runs empty: " + to_text(leaves, 4) +
               " m of material leave it until the body is longest, therefore the reservoir "
               "contains at least this length [m]");
}

}  // namespace flexmorph::cases
