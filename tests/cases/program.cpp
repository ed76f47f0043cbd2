#include "tests/cases/program.h"

#include <algorithm>
#include <iomanip>
#include <sstream>

#include "io/screen.h"

namespace flexmorph::test {

Words lines_of(const std::string& text) {
  Words out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

std::string without_tags(const std::string& html) {
  std::string out;
  bool inside = false;
  for (const char c : html) {
    if (c == '<') inside = true;
    if (!inside) out += c;
    if (c == '>') inside = false;
  }
  for (const auto& [code, text] :
       {std::pair{"&quot;", "\""}, {"&lt;", "<"}, {"&gt;", ">"}, {"&amp;", "&"}})
    for (size_t at = 0; (at = out.find(code, at)) != std::string::npos; ++at)
      out.replace(at, std::string(code).size(), text);
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

Words wide_lines(const std::string& text) {
  Words out;
  for (const std::string& line : lines_of(text)) {
    const size_t first = std::min(line.size(), line.find_first_not_of(' '));
    if (io::columns_of(line) > io::kColumnsOfFiles && line.find(' ', first) != std::string::npos)
      out.push_back(line);
  }
  return out;
}

std::string in_whole_lines(const std::string& text) {
  std::string out;
  size_t columns = 0;  // of the last line as the program has written it
  size_t indent = 0;   // of the first line of the piece
  for (const std::string& line : lines_of(text)) {
    const size_t first = std::min(line.size(), line.find_first_not_of(' ')),
                 end = std::min(line.size(), line.find(' ', first));
    const bool continues =
        first > indent && first < line.size() &&
        columns + 1 + io::columns_of(line.substr(first, end - first)) > io::kColumnsOfFiles;
    if (continues && !out.empty()) {
      out.back() = ' ';
      out += line.substr(first) + "\n";
    } else {
      out += line + "\n";
      indent = first;
    }
    columns = io::columns_of(line);
  }
  return out;
}

Ended flexmorph(const Scratch& scratch, const Words& arguments) {
  Ended out = start(scratch, arguments).end();
  const auto has = [&](const char* word) {
    return std::find(arguments.begin(), arguments.end(), word) != arguments.end();
  };
  if (has("keys") || has("--explain")) return out;
  out.out = in_whole_lines(out.out);
  out.err = in_whole_lines(out.err);
  return out;
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

io::CsvTable motion_of(const Scratch& scratch, const std::string& text, const std::string& to) {
  const std::string folder = scratch / to;
  const Ended ended = run(scratch, scratch.write(to + ".toml", text), folder);
  EXPECT_EQ(ended.code, 0) << ended.err;
  return io::read_csv(folder + "/motion.csv");
}

std::string exact_text(double x) {
  std::ostringstream out;
  out << std::setprecision(17) << x;
  return out.str();
}

Words short_run(const std::string& folder, const Words& changes) {
  return run_text(FLEXMORPH_SHORT_CASE, folder, changes);
}

}  // namespace flexmorph::test
