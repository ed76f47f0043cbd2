#include <algorithm>

#include "cases/scene/body_keys.h"
#include "cases/scene/read.h"
#include "io/files.h"

namespace flexmorph::cases {

using io::any_number;
using io::positive;
using io::Table;
using io::to_text;

namespace {

const io::Key& kIndex =
    io::key("body.line", "index")
        .integer("the number of an m-line before the free end", 0, 100'000)
        .description("Number of the m-line (mesh line across the axis); 0 is the root.");
const io::Key& kFree =
    io::key("body.line", "free")
        .boolean()
        .otherwise(false)
        .description(
            "True if the line can move through the material; a joint then holds or drives it.");
const io::Key& kAt = io::key("body.line", "at")
                         .number(any_number("a material coordinate", "m"))
                         .otherwise_as("its location in a uniform mesh")
                         .description("Material coordinate of the line at the start.");
const io::Key& kMaxLength = io::key("body.line", "max_length")
                                .number(positive("a length", "m"))
                                .otherwise_as("no lines of nodes are inserted or removed")
                                .when("`index = 0`, `free = true`")
                                .description(
                                    "Largest length of the element at the root; a longer element "
                                    "is split by a new line of nodes.");
const io::Key& kMinLength = io::key("body.line", "min_length")
                                .number(positive("a length", "m"))
                                .otherwise_as("0.3 `max_length`")
                                .when("`max_length` is given")
                                .description(
                                    "Smallest length of the element at the root; a shorter one is "
                                    "merged with its neighbour.");

/// Reads the limits of the length of the element next to a free root line. They are checked so that
/// the two halves of an element that was just split are not merged again.
void read_limits(const Table& t, const Body& body, BodyLine& line) {
  const io::Key& key = t.has(kMaxLength) ? kMaxLength : kMinLength;
  if (!line.free || line.index != 0)
    t.fail(
        key,
        "lines of nodes are inserted and removed only at a free root line: index = 0, free = true");
  line.max_length = t.number(kMaxLength);
  line.min_length = t.number(kMinLength, 0.3 * line.max_length);
  const double element = body.length / body.elements[0];
  if (element > line.max_length * (1 + 1e-9) || element < line.min_length * (1 - 1e-9))
    t.fail(key,
           "the elements are " + to_text(element, 4) +
               " m long at the start; this length must lie between min_length and max_length [m]");
  if (line.min_length + 0.5 * line.max_length > 0.9 * line.max_length * (1 + 1e-9))
    t.fail(key,
           "min_length is at most 0.4 max_length; otherwise elements are split and merged again "
           "and again");
}

}  // namespace

std::vector<BodyLine> read_lines(const Table& body_table, const Body& body) {
  std::vector<BodyLine> out;
  std::vector<Table> tables = body_table.tables(body_keys::kLine);
  for (const Table& t : tables) {
    BodyLine line;
    line.index = t.integer(kIndex.within(0, body.elements[0] - 1));
    line.free = t.boolean(kFree);
    if (t.has(kAt)) line.at = t.number(kAt);
    if (!line.free && !line.at)
      t.fail("a line needs free = true, a material coordinate `at`, or both");
    if (line.at && line.index == 0)
      t.fail(kAt, "the root line has no `at`, because it is an end of the body");
    for (const BodyLine& other : out)
      if (other.index == line.index) t.fail(kIndex, "there is another line with this number");
    if (body.flow)
      t.fail("'" + body.name +
             "' has material flow, which controls its lines: it has no [[body.line]]");
    if (t.has(kMaxLength) || t.has(kMinLength)) read_limits(t, body, line);
    out.push_back(line);
  }
  std::sort(out.begin(), out.end(),
            [](const BodyLine& a, const BodyLine& b) { return a.index < b.index; });
  if (out.empty()) return out;
  if (out.front().has_limits() && out.size() > 1)
    tables.front().fail(
        "lines are inserted and removed at the root, which changes their numbers: no other "
        "[[body.line]] is allowed");
  Body with_lines = body;
  with_lines.lines = out;
  const std::vector<double> at = with_lines.start_lines(0, body.elements[0]);
  for (size_t i = 0; i + 1 < at.size(); ++i)
    if (at[i + 1] <= at[i])
      tables.front().fail("lines " + std::to_string(i) + " and " + std::to_string(i + 1) +
                          " begin at " + to_text(at[i], 4) + " m and " + to_text(at[i + 1], 4) +
                          " m; the material coordinates of lines must increase");
  return out;
}

}  // namespace flexmorph::cases
