#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <locale>
#include <string>

namespace flexmorph {

/// A folder of its own for one test, removed afterwards.
class Scratch {
 public:
  Scratch();
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  /// Returns the path of a file in the folder.
  std::string operator/(const std::string& name) const;
  /// Writes a file into the folder. @return its path
  std::string write(const std::string& name, const std::string& contents) const;

 private:
  std::filesystem::path folder_;
};

/// Returns what a file contains; empty where there is none.
std::string contents_of(const std::string& path);

::testing::AssertionResult contains(const std::string& text, const std::string& part);
::testing::AssertionResult starts(const std::string& text, const std::string& start);
::testing::AssertionResult ends(const std::string& text, const std::string& end);

/// While it lives, the program speaks with a decimal comma and points between thousands.
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
