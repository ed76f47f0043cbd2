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

const io::Key& kIndex = io::key("body.line", "index")
                            .integer("the number of an m-line before the free end", 0, 100'000)
                            .says("Its number; 0 is the root.");
const io::Key& kFree = io::key("body.line", "free")
                           .boolean()
                           .otherwise(false)
                           .says("It moves through the material; a joint says how.");
const io::Key& kAt = io::key("body.line", "at")
                         .number(any_number("a material coordinate", "m"))
                         .otherwise_as("where an even mesh has it")
                         .says("Where it stands at the start.");
const io::Key& kMaxLength =
    io::key("body.line", "max_length")
        .number(positive("a length", "m"))
        .otherwise_as("lines of nodes stay")
        .when("`index = 0`, `free = true`")
        .says("Lines of nodes come and go: a longer element at the root is split.");
const io::Key& kMinLength = io::key("body.line", "min_length")
                                .number(positive("a length", "m"))
                                .otherwise_as("0.3 `max_length`")
                                .when("`max_length` is given")
                                .says("A shorter one is merged with its neighbour.");

/// Reads the limits of the length of the element next to a free root line. They are checked so that
/// the two halves of an element that was just split are not merged again.
void read_limits(const Table& t, const Body& body, BodyLine& line) {
  const io::Key& key = t.has(kMaxLength) ? kMaxLength : kMinLength;
  if (!line.free || line.index != 0)
    t.fail(key, "lines of nodes come and go next to a free root line: index = 0, free = true");
  line.max_length = t.number(kMaxLength);
  line.min_length = t.number(kMinLength, 0.3 * line.max_length);
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
  std::vector<Table> tables = body_table.tables(body_keys::kLine);
  for (const Table& t : tables) {
    BodyLine line;
    line.index = t.integer(kIndex.within(0, body.elements[0] - 1));
    line.free = t.boolean(kFree);
    if (t.has(kAt)) line.at = t.number(kAt);
    if (!line.free && !line.at) t.fail("a line is `free`, or `at` a place of its own, or both");
    if (line.at && line.index == 0) t.fail(kAt, "the first line is an end of the body");
    for (const BodyLine& other : out)
      if (other.index == line.index) t.fail(kIndex, "there is another line of this number");
    if (body.flow)
      t.fail("material flows through '" + body.name + "': its lines move with it, or come and go");
    if (t.has(kMaxLength) || t.has(kMinLength)) read_limits(t, body, line);
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
