#pragma once

#include <gtest/gtest.h>

#include <csignal>
#include <sstream>
#include <string>
#include <vector>

#include "tests/io/scratch.h"
#include "tests/support/child_program.h"

/// The program as tests start it. FLEXMORPH_PROGRAM is its path, FLEXMORPH_SHORT_CASE a case of
/// about a second.
namespace flexmorph::test {

using Words = std::vector<std::string>;

inline Words lines_of(const std::string& text) {
  Words out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

using Ended = testing::ChildEnd;
using testing::ChildProgram;
using testing::eventually;

/// Starts the program with these arguments, its output in files of the scratch folder.
inline ChildProgram start(const Scratch& scratch, const Words& arguments) {
  Words words = {FLEXMORPH_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return {words, scratch / ""};
}

/// Exit code of a run that is whole, but ended after so few iterations that its design is worse
/// than uniform material: "done, not usable".
inline constexpr int kTooFew = 5;

/// Returns whether a run wrote run.json, whose status is that of the exit code: whether designs of
/// few iterations are better than uniform material depends on the path of the optimizer, and the
/// exit code may be 0 or kTooFew.
inline ::testing::AssertionResult is_done(const Ended& ended, const std::string& folder) {
  const char* const status = ended.code == 0         ? "\"status\": \"done\""
                             : ended.code == kTooFew ? "\"status\": \"done, not usable\""
                                                     : nullptr;
  const std::string run = contents_of(folder + "/run.json");
  if (status != nullptr && run.find(status) != std::string::npos)
    return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "exit code " << ended.code << "\n" << ended.err << run;
}

inline Ended flexmorph(const Scratch& scratch, const Words& arguments) {
  return start(scratch, arguments).end();
}

/// Runs a case with changes; what it expects of itself as it is does not count with them.
inline Ended run(const Scratch& scratch, const std::string& name, const std::string& folder,
                 Words changes = {}) {
  Words words = {"run", name, "-o", folder};
  if (!changes.empty()) changes.emplace_back("expect=");
  for (const std::string& change : changes) words.insert(words.end(), {"--set", change});
  return flexmorph(scratch, words);
}

/// Runs short_plate.toml with changes.
inline Words short_run(const std::string& folder, const Words& changes = {}) {
  Words words = {"run", FLEXMORPH_SHORT_CASE, "-o", folder};
  for (const std::string& change : changes) {
    words.emplace_back("--set");
    words.push_back(change);
  }
  return words;
}

}  // namespace flexmorph::test
