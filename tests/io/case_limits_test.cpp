// Shows that texts which would exhaust the stack of a recursive TOML parser are refused with line
// and limit, but not similar text in strings and comments.
#include "io/case_files/case_limits.h"

#include "geometry/base.h"
#include "io/case_files/case_parser.h"
#include "tests/io/scratch.h"

namespace flexmorph::io {
namespace {

std::string repeated(const std::string& part, int n) {
  std::string out;
  for (int i = 0; i < n; ++i) out += part;
  return out;
}

std::string limit_refusal(const std::string& text) {
  try {
    parse_case(text, "a.toml");
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), Error::Kind::input);
    return e.what();
  }
  return "";
}

TEST(CaseLimits, OfKeysAndNesting) {
  const std::string start = "b = 1\nc = \"\"\"\n\n\"\"\"\n";  // the next line is the fifth
  const std::string fifth = "a.toml:5: ";
  for (const std::string& dotted :
       {repeated("a.", 20'000) + "a = 1", "[" + repeated("a.", 20'000) + "a]"})
    EXPECT_TRUE(says(limit_refusal(start + dotted), fifth, {"key", "100", "dots"}));
  for (const std::string& nested : {repeated("[", 20'000), repeated("{a = ", 20'000)})
    EXPECT_TRUE(says(limit_refusal(start + "x = " + nested), fifth, {"100", "nested"}));
  EXPECT_TRUE(says(limit_refusal(start + repeated("a", 5000) + " = 1"), fifth, {"key", "2000"}));
}

TEST(CaseLimits, LeaveStringsAndCommentsAlone) {
  const std::string dots = repeated("[{.", 1000);
  for (const std::string& text : std::vector<std::string>{
           "a = \"" + dots + "\"", "a = '" + dots + "'", "a = 1 # " + dots, "# ' \"\n# " + dots,
           "a = \"\"\"\n" + dots + "\n\"\"\"", "a = '''\n" + dots + "\n'''",
           "a = \"\\\"" + dots + "\"", "a = [" + repeated("1.5, ", 1000) + "]",
           repeated("a.", 99) + "a = 1", "x = " + repeated("[", 100) + repeated("]", 100)})
    EXPECT_EQ(limit_refusal(text), "") << text.substr(0, 20);
}

/// Returns the message of the check of the limits alone.
std::string limits_of(const std::string& text) {
  try {
    check_case_limits(text, "a.toml");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// The check must end for texts that are not TOML, and must still find excessive nesting before the
// error.
TEST(CaseLimits, EndAtBrokenTexts) {
  for (const std::string& text : std::vector<std::string>{"a = \"", "a = \"\\", "a = '''",
                                                          "a = \"\"\"\\", "#", "]]]", "\"\n"}) {
    EXPECT_EQ(limits_of(text), "") << text;
    EXPECT_NE(limits_of("x = " + repeated("[", 20'000) + "\n" + text), "") << text;
  }
}

TEST(CaseLimits, OptionsHaveThem) {
  EXPECT_THROW(parse_option(repeated("[", 1000), "--set a=..."), Error);
}

TEST(CaseLimits, CasesComeFromPipesButHaveAnEnd) {
  EXPECT_THROW(read_text("/dev/zero"), Error);
  EXPECT_EQ(read_text("/dev/null"), "");
}

}  // namespace
}  // namespace flexmorph::io
