#include "tests/cases/program.h"

#include <sstream>

namespace flexmorph::test {

Words lines_of(const std::string& text) {
  Words out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

ChildProgram start(const Scratch& scratch, const Words& arguments) {
  Words words = {FLEXMORPH_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return {words, scratch / ""};
}

::testing::AssertionResult is_done(const Ended& ended, const std::string& folder) {
  const char* const status = ended.code == 0         ? "\"status\": \"done\""
                             : ended.code == kTooFew ? "\"status\": \"done, not usable\""
                                                     : nullptr;
  const std::string run = contents_of(folder + "/run.json");
  if (status != nullptr && run.find(status) != std::string::npos)
    return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "exit code " << ended.code << "\n" << ended.err << run;
}

Ended flexmorph(const Scratch& scratch, const Words& arguments) {
  return start(scratch, arguments).end();
}

namespace {

Words run_text(const std::string& name, const std::string& folder, const Words& changes) {
  Words words = {"run", name, "-o", folder};
  for (const std::string& change : changes) words.insert(words.end(), {"--set", change});
  return words;
}

}  // namespace

Ended run(const Scratch& scratch, const std::string& name, const std::string& folder,
          const Words& changes) {
  Words words = run_text(name, folder, changes);
  if (!changes.empty()) words.insert(words.end(), {"--set", "expect="});
  return flexmorph(scratch, words);
}

Words short_run(const std::string& folder, const Words& changes) {
  return run_text(FLEXMORPH_SHORT_CASE, folder, changes);
}

}  // namespace flexmorph::test
