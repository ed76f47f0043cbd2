#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/io/scratch.h"
#include "tests/support/child_program.h"

/// The program as tests start it. FLEXMORPH_PROGRAM is its path, FLEXMORPH_SHORT_CASE a case of
/// about a second.
namespace flexmorph::test {

using Words = std::vector<std::string>;

/// Returns the lines of a text, without their ends.
Words lines_of(const std::string& text);

using Ended = testing::ChildEnd;
using testing::ChildProgram;
using testing::eventually;

/// Starts the program with these arguments, its output in files of the scratch folder.
ChildProgram start(const Scratch& scratch, const Words& arguments);

/// Exit code of a run that is whole, but ended after so few iterations that its design is worse
/// than uniform material: "done, not usable".
inline constexpr int kTooFew = 5;

/// Returns whether a run wrote run.json, whose status is that of the exit code: whether designs of
/// few iterations are better than uniform material depends on the path of the optimizer, and the
/// exit code may be 0 or kTooFew.
::testing::AssertionResult is_done(const Ended& ended, const std::string& folder);

/// Runs the program with these arguments to its end.
Ended flexmorph(const Scratch& scratch, const Words& arguments);

/// Runs a case with changes; what it expects of itself as it is does not count with them.
Ended run(const Scratch& scratch, const std::string& name, const std::string& folder,
          const Words& changes = {});

/// Returns the arguments of a run of short_plate.toml with changes.
Words short_run(const std::string& folder, const Words& changes = {});

}  // namespace flexmorph::test
