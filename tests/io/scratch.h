#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <locale>
#include <string>
#include <vector>

namespace flexmorph {

/// A folder for one test, removed afterwards.
class Scratch {
 public:
  Scratch();
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  /// Returns the path of a file in the folder.
  std::string operator/(const std::string& name) const;
  /// Writes a file into the folder.
  /// @returns the path of the file
  std::string write(const std::string& name, const std::string& contents) const;

 private:
  std::filesystem::path folder_;
};

/// Returns the contents of a file; empty if the file does not exist.
std::string contents_of(const std::string& path);

::testing::AssertionResult contains(const std::string& text, const std::string& part);
::testing::AssertionResult starts(const std::string& text, const std::string& start);
::testing::AssertionResult ends(const std::string& text, const std::string& end);

/// Asks for a message that starts with a location and contains all of the parts behind it, each at
/// least as often as it is listed. The parts are keys, names, values and technical terms, because
/// the wording of messages may change.
::testing::AssertionResult says(const std::string& message, const std::string& location,
                                const std::vector<std::string>& parts);

/// Sets a locale with a decimal comma and points between thousands during its lifetime.
class CommaLocale {
 public:
  CommaLocale();
  ~CommaLocale();
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;

 private:
  std::locale before_;
};

}  // namespace flexmorph
