#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/tables.h"
#include "tests/io/scratch.h"
#include "tests/support/child_program.h"

/// Functions by which tests start the program. FLEXMORPH_PROGRAM is the path of the program,
/// FLEXMORPH_SHORT_CASE the path of a case that runs for about a second.
namespace flexmorph::test {

using Words = std::vector<std::string>;

/// Returns the lines of a text without their line ends.
Words lines_of(const std::string& text);

/// Returns the text of a page without its tags and with plain quotes.
std::string without_tags(const std::string& html);

using Ended = testing::ChildEnd;
using testing::ChildProgram;
using testing::eventually;

/// Starts the program with the given arguments; its output goes to files in the scratch folder.
ChildProgram start(const Scratch& scratch, const Words& arguments);

/// Exit code "done, not usable": the run is complete, but after so few iterations its design is
/// worse than uniform material.
inline constexpr int kTooFew = 5;

/// Returns success if the run wrote run.json with the status that belongs to its exit code, 0 or
/// kTooFew. Both codes are accepted because it depends on the path of the optimizer whether a
/// design of few iterations is better than uniform material.
::testing::AssertionResult is_done(const Ended& ended, const std::string& folder);

/// Returns the lines of a text that are longer than 80 columns, except for single words, such as
/// paths.
Words wide_lines(const std::string& text);

/// Returns a text of the program with the lines that it splits at 80 columns in one piece: a line
/// that begins with more spaces than the one before continues it if its first word did not fit
/// there.
std::string in_whole_lines(const std::string& text);

/// Runs the program with the given arguments until it ends. Its output is given in whole lines,
/// except for the tables of `keys` and for cases with --explain.
Ended flexmorph(const Scratch& scratch, const Words& arguments);

/// Runs a case with changes. Its table [expect] is removed if there are changes, because it holds
/// for the unchanged case only.
Ended run(const Scratch& scratch, const std::string& name, const std::string& folder,
          const Words& changes = {});

/// Runs a case with this text, expects exit code 0, and returns its motion.csv.
/// @param to    name of the output folder in the scratch folder
io::CsvTable motion_of(const Scratch& scratch, const std::string& text,
                       const std::string& to = "out");

/// Returns a number with 17 digits, so that it is read again without a difference.
std::string exact_text(double x);

/// Returns the arguments that run short_plate.toml with changes.
Words short_run(const std::string& folder, const Words& changes = {});

}  // namespace flexmorph::test
