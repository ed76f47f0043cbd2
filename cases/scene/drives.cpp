#include <algorithm>
#include <cmath>

#include "cases/scene/read.h"
#include "io/files.h"
#include "io/formula.h"
#include "io/smooth_table.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

using io::any_number;
using io::Jet;
using io::Table;
using io::to_text;

using Constants = std::map<std::string, double>;

Constants read_constants(const Table& root) {
  Constants out;
  if (!root.has("constants")) return out;
  const Table t = root.table("constants");
  for (const std::string& key : t.keys()) {
    const std::string why = io::Formula::refusal_of_name(key);
    if (!why.empty()) t.fail(key, why);
    out[key] = t.number(key, any_number("a constant"));
  }
  return out;
}

/// A function that is known in [0, end] only: beyond, its parabola goes on.
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

/// What a reader of formulas or tables says, without the text that the place in the file shows.
[[noreturn]] void pass_on(const Table& t, const std::string& key, const Error& error,
                          const std::string& text = "") {
  std::string words = error.what();
  const std::string start = "formula '" + text + "': ";
  if (words.starts_with(start)) words = words.substr(start.size());
  t.fail(key, words);
}

std::function<fem::Motion(double)> read_formula(const Table& t, const Constants& constants,
                                                double end, std::string& words) {
  words = t.string("formula", "a formula of the time t");
  try {
    io::Formula formula(words, constants);
    formula.check(end);
    return over_run(std::move(formula), end);
  } catch (const Error& error) {
    pass_on(t, "formula", error, words);
  }
}

std::function<fem::Motion(double)> tabulated(const Table& t, const std::string& key,
                                             const std::vector<double>& times,
                                             const std::vector<double>& values, double end) {
  const auto make = [&] {
    try {
      return io::SmoothTable(times, values);
    } catch (const Error& error) {
      pass_on(t, key, error);
    }
  };
  io::SmoothTable table = make();
  if (table.first() > 0 || table.last() < end)
    t.fail(key, "a table covers the run from 0 to time.end = " + to_text(end) +
                    " s; this one lasts from " + to_text(table.first()) + " to " +
                    to_text(table.last()) + " s");
  return over_run(std::move(table), end);
}

std::function<fem::Motion(double)> read_table(const Table& t, double end, std::string& words) {
  std::vector<double> times, values;
  for (const std::vector<double>& row : t.rows("table", any_number("a time or a value"), 2)) {
    times.push_back(row[0]);
    values.push_back(row[1]);
  }
  words = "table of " + to_text(static_cast<int>(times.size())) + " points";
  return tabulated(t, "table", times, values, end);
}

std::function<fem::Motion(double)> read_csv_drive(const Table& t, double end, std::string& words) {
  const std::string name = t.string("csv", "a file");
  const std::string time_column = t.string("time", "a column", "time");
  const std::string column = t.string("column", "a column");
  const auto numbers = [&](const io::CsvTable& csv, const std::string& key,
                           const std::string& wanted) {
    try {
      return csv.numbers(wanted);
    } catch (const Error& error) {
      std::string known;
      for (const std::string& each : csv.columns)
        known += (known.empty() ? "'" : ", '") + each + "'";
      t.fail(key, "'" + name + "' has no column '" + wanted + "'; its columns are " + known);
    }
  };
  io::CsvTable csv;
  try {
    csv = io::read_csv(t.beside(name));
  } catch (const Error& error) {
    pass_on(t, "csv", error);
  }
  const std::vector<double> times = numbers(csv, t.has("time") ? "time" : "csv", time_column);
  const std::vector<double> values = numbers(csv, "column", column);
  words = "'" + name + "', column '" + column + "', " + to_text(static_cast<int>(times.size())) +
          " points";
  return tabulated(t, "csv", times, values, end);
}

Drive read_drive(const Table& t, const Constants& constants, const Scene& scene,
                 bool has_trajectory) {
  Drive drive;
  drive.name = read_word(t, "the name of a drive");
  for (const Drive& other : scene.drives)
    if (other.name == drive.name) t.fail("name", "there is another drive '" + drive.name + "'");
  if (t.has("formula") + t.has("table") + t.has("csv") + t.has("from") != 1)
    t.fail("a drive has one of `formula`, `table`, `csv` and `from`");
  if (t.has("from")) {
    t.choice("from", "a drive follows from", std::vector<std::string>{"trajectory"});
    if (!has_trajectory) t.fail("from", "the [trajectory] to follow is missing");
    drive.from_trajectory = true;
    drive.words = "from the trajectory";
    return drive;
  }
  const double end = scene.time.end;
  drive.motion = t.has("formula") ? read_formula(t, constants, end, drive.words)
                 : t.has("table") ? read_table(t, end, drive.words)
                                  : read_csv_drive(t, end, drive.words);
  return drive;
}

/// The value where the rate changes its sign between a and b.
double extreme(const std::function<fem::Motion(double)>& motion, double a, double b) {
  const bool rises = motion(a).rate > 0;
  for (int k = 0; k < 100 && b - a > 1e-15 * std::abs(b); ++k) {
    const double mid = 0.5 * (a + b);
    ((motion(mid).rate > 0) == rises ? a : b) = mid;
  }
  return motion(0.5 * (a + b)).value;
}

/// Limits of the boundary element. They must not chatter: two halves that were just split must
/// not be short enough to be merged again, nor a merged element long enough to be split.
void check_limits(const Table& t, const Body& body, double end) {
  const Flow& flow = *body.flow;
  const double element = body.length / body.elements[0];
  const double shortest = body.shortest(end);
  if (element > flow.max_length * (1 + 1e-9))
    t.fail("max_length", "the elements are " + to_text(element, 4) +
                             " m long at the start: more elements, or a larger max_length [m]");
  const std::string min_key = t.has("min_length") ? "min_length" : "max_length";
  if (element < flow.min_length * (1 - 1e-9))
    t.fail(min_key, "the elements are " + to_text(element, 4) +
                        " m long at the start, shorter than min_length = " +
                        to_text(flow.min_length, 4) + " m, and would be merged at once");
  // Elements of the start are merged only where the body gets shorter than it was.
  const double neighbour = shortest < body.length * (1 - 1e-12)
                               ? std::max(element, 0.5 * flow.max_length)
                               : 0.5 * flow.max_length;
  if (flow.min_length + neighbour > 0.9 * flow.max_length * (1 + 1e-9))
    t.fail(min_key, "min_length + the neighbour's " + to_text(neighbour, 4) +
                        " m stays below 0.9 max_length, or elements are split and merged in turn");
  if (shortest < flow.min_length)
    t.fail(flow.motion ? "length" : "speed", "the body keeps at least min_length, but " +
                                                 to_text(shortest, 4) + " m are left at " +
                                                 (flow.motion ? "its shortest" : "time.end"));
}

}  // namespace

Law read_law(const Table& t, const std::string& key, const io::Quantity& quantity,
             const Scene& scene, std::optional<double> fallback) {
  if (t.is_string(key)) return {t.choice(key, "a drive", names_of(scene.drives)), 0};
  return {{}, t.number(key, quantity, fallback)};
}

void read_drives(const Table& root, Scene& scene) {
  const Constants constants = read_constants(root);
  for (const Table& t : root.tables("drive"))
    scene.drives.push_back(read_drive(t, constants, scene, root.has("trajectory")));
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

void follow_length(const Table& t, const Scene& scene, Body& body) {
  Flow& flow = *body.flow;
  if (!flow.length.drive.empty()) {
    flow.motion = scene.motion_of(flow.length);
    const double start = flow.motion(0).value;
    if (body.length == 0) body.length = start;
    if (std::abs(start - body.length) > 1e-9)
      t.fail("length", "this drive starts at " + to_text(start) + ", '" + body.name +
                           "' at length = " + to_text(body.length) + " [m]");
    const std::array<double, 2> range = range_of(flow.motion, scene.time.end);
    flow.shortest = range[0];
    flow.longest = range[1];
  }
  check_limits(t, body, scene.time.end);
}

}  // namespace flexmorph::cases
