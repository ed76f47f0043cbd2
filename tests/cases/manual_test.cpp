// Shows that the manual pages contain every command with every option, and every key of case
// files, and that all requests in them are known to troff.

#include "cases/keys/manual.h"

#include <gtest/gtest.h>

#include <cctype>
#include <set>
#include <sstream>

#include "cases/keys/book.h"
#include "tests/cases/program.h"

namespace flexmorph::test {
namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Returns the requests that a page uses, such as ".TP".
std::set<std::string> requests(const std::string& page) {
  std::set<std::string> out;
  for (const std::string& line : lines_of(page))
    if (!line.empty() && (line[0] == '.' || line[0] == '\''))
      out.insert(line.substr(0, line.find(' ')));
  return out;
}

const std::set<std::string> kRequests = {".TH", ".SH", ".SS", ".TP", ".B", ".BI",
                                         ".BR", ".I",  ".P",  ".nf", ".fi"};

TEST(Manual, ContainsEveryCommandAndOption) {
  const Scratch scratch;
  const std::string page = flexmorph(scratch, {"manual"}).out;
  // The completion of bash has the options of every command from the same declarations, in another
  // form.
  std::string script = flexmorph(scratch, {"completion", "bash"}).out;
  for (char& c : script)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-') c = ' ';
  std::istringstream words(script);
  std::set<std::string> options;
  for (std::string word; words >> word;)
    if (word.size() > 2 && word.starts_with("--") && word[2] != '-') options.insert(word);
  EXPECT_GT(options.size(), 15u);
  options.erase("--help");
  for (const std::string& option : options)
    EXPECT_TRUE(has(page, cases::manual_text(option))) << option;
  for (const char* command : {"run", "check", "modes", "sweep", "compare", "accuracy", "stability",
                              "verify", "certify", "cases", "keys", "completion", "manual"})
    EXPECT_TRUE(has(page, std::string(".SS flexmorph ") + command + "\n")) << command;
  for (const std::string& request : requests(page)) EXPECT_TRUE(kRequests.contains(request));
}

TEST(Manual, ContainsEveryKey) {
  const Scratch scratch;
  const std::string page = flexmorph(scratch, {"manual", "5"}).out;
  for (const std::string& request : requests(page)) EXPECT_TRUE(kRequests.contains(request));
  for (const cases::KeyTable& table : cases::key_book()) {
    const std::string heading = ".SH \"" + cases::manual_text(table.title()) + "\"\n";
    const size_t begin = page.find(heading);
    ASSERT_NE(begin, std::string::npos) << heading;
    const std::string section = page.substr(begin, page.find("\n.SH", begin) - begin);
    for (const io::Key* key : table.keys)
      EXPECT_TRUE(has(section, "\n.B " + cases::manual_text(cases::shown_name(*key)) + "\n"))
          << table.title() << " " << key->name;
  }
}

TEST(Manual, EscapesWhatTroffWouldExecute) {
  EXPECT_EQ(cases::manual_text(".SH a\n'b\\c --d"), "\\&.SH a\n\\&'b\\ec \\-\\-d");
  const Scratch scratch;
  EXPECT_EQ(flexmorph(scratch, {"manual", "7"}).code, 2);
}

}  // namespace
}  // namespace flexmorph::test
