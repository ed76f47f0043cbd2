#include <algorithm>

#include "cases/scene/read.h"
#include "io/files.h"

namespace flexmorph::cases {

using io::any_number;
using io::positive;
using io::Table;
using io::to_text;

namespace {

/// Limits of the element next to a free root line; two halves that were just split must not be
/// merged again.
void read_limits(const Table& t, const Body& body, BodyLine& line) {
  const std::string key = t.has("max_length") ? "max_length" : "min_length";
  if (!line.free || line.index != 0)
    t.fail(key, "lines of nodes come and go next to a free root line: index = 0, free = true");
  line.max_length = t.number("max_length", positive("a length", "m"));
  line.min_length = t.number("min_length", positive("a length", "m"), 0.3 * line.max_length);
  const double element = body.length / body.elements[0];
  if (element > line.max_length * (1 + 1e-9) || element < line.min_length * (1 - 1e-9))
    t.fail(key, "the elements are " + to_text(element, 4) +
                    " m long at the start: between min_length and max_length [m]");
  if (line.min_length + 0.5 * line.max_length > 0.9 * line.max_length * (1 + 1e-9))
    t.fail(key,
           "min_length + 0.5 max_length stays below 0.9 max_length, or elements are split and "
           "merged in turn");
}

}  // namespace

std::vector<BodyLine> read_lines(const Table& body_table, const Body& body) {
  std::vector<BodyLine> out;
  std::vector<Table> tables = body_table.tables("line");
  for (const Table& t : tables) {
    BodyLine line;
    line.index =
        t.integer("index", "the number of an m-line before the free end", 0, body.elements[0] - 1);
    line.free = t.boolean("free", false);
    if (t.has("at")) line.at = t.number("at", any_number("a material coordinate", "m"));
    if (!line.free && !line.at) t.fail("a line is `free`, or `at` a place of its own, or both");
    if (line.at && line.index == 0) t.fail("at", "the first line is an end of the body");
    for (const BodyLine& other : out)
      if (other.index == line.index) t.fail("index", "there is another line of this number");
    if (body.flow) t.fail("material flows through '" + body.name + "': its lines come and go");
    if (t.has("max_length") || t.has("min_length")) read_limits(t, body, line);
    out.push_back(line);
  }
  std::sort(out.begin(), out.end(),
            [](const BodyLine& a, const BodyLine& b) { return a.index < b.index; });
  if (out.empty()) return out;
  if (out.front().has_limits() && out.size() > 1)
    tables.front().fail(
        "lines come and go next to the root: no other line has a number to name it");
  Body with_lines = body;
  with_lines.lines = out;
  const std::vector<double> at = with_lines.start_lines(0, body.elements[0]);
  for (size_t i = 0; i + 1 < at.size(); ++i)
    if (at[i + 1] <= at[i])
      tables.front().fail("lines " + std::to_string(i) + " and " + std::to_string(i + 1) +
                          " begin at " + to_text(at[i], 4) + " m and " + to_text(at[i + 1], 4) +
                          " m: they must increase");
  return out;
}

}  // namespace flexmorph::cases
