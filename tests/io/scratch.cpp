#include "tests/io/scratch.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <iterator>

namespace flexmorph {

Scratch::Scratch() {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  static std::atomic<int> count = 0;  // a test may have several
  std::string name = "flexmorph_" + std::to_string(getpid()) + "_" + test->test_suite_name() + "_" +
                     test->name() + "_" + std::to_string(++count);
  std::replace(name.begin(), name.end(), '/', '_');  // for tests with parameters
  folder_ = std::filesystem::temp_directory_path() / name;
  std::filesystem::create_directories(folder_);
}

Scratch::~Scratch() { std::filesystem::remove_all(folder_); }

std::string Scratch::operator/(const std::string& name) const { return (folder_ / name).string(); }

std::string Scratch::write(const std::string& name, const std::string& contents) const {
  std::ofstream(*this / name, std::ios::binary) << contents;
  return *this / name;
}

std::string contents_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

::testing::AssertionResult contains(const std::string& text, const std::string& part) {
  const bool found = text.find(part) != std::string::npos;
  return (found ? ::testing::AssertionSuccess() : ::testing::AssertionFailure())
         << "'" << part << "' in:\n"
         << text;
}

::testing::AssertionResult starts(const std::string& text, const std::string& start) {
  if (text.starts_with(start)) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "does not start with '" << start << "':\n" << text;
}

::testing::AssertionResult ends(const std::string& text, const std::string& end) {
  if (text.ends_with(end)) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "does not end with '" << end << "':\n" << text;
}

::testing::AssertionResult says(const std::string& message, const std::string& location,
                                const std::vector<std::string>& parts) {
  if (!message.starts_with(location)) return starts(message, location);
  for (const std::string& part : parts) {
    std::ptrdiff_t found = 0;
    for (size_t at = location.size(); (at = message.find(part, at)) != std::string::npos;
         at += part.size())
      ++found;
    if (found < std::count(parts.begin(), parts.end(), part))
      return ::testing::AssertionFailure() << "'" << part << "' behind '" << location << "' in:\n"
                                           << message;
  }
  return ::testing::AssertionSuccess();
}

namespace {

struct Comma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

}  // namespace

CommaLocale::CommaLocale() : before_(std::locale::global({std::locale::classic(), new Comma})) {}
CommaLocale::~CommaLocale() { std::locale::global(before_); }

}  // namespace flexmorph
