#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "geometry/base.h"

/// Texts of expected errors.
namespace flexmorph::testing {

/// Returns the text of the Error of the given kind that f() must throw.
template <class F>
std::string error_of(Error::Kind kind, const F& f) {
  try {
    f();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return "";
}

inline bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Returns success if the text begins with the location and every part is in the text after it.
/// A part that is listed twice must occur twice, such as a name in a list of allowed names and in a
/// suggestion.
inline ::testing::AssertionResult mentions_all(const std::string& text,
                                               const std::vector<std::string>& parts,
                                               const std::string& location = "") {
  if (!text.starts_with(location))
    return ::testing::AssertionFailure() << "not at " << location << ": " << text;
  std::map<std::string, std::size_t> ends;  // end of the last occurrence of each part
  for (const std::string& part : parts) {
    std::size_t& end = ends.try_emplace(part, location.size()).first->second;
    const std::size_t at = text.find(part, end);
    if (at == std::string::npos)
      return ::testing::AssertionFailure() << "without " << part << ": " << text;
    end = at + part.size();
  }
  return ::testing::AssertionSuccess();
}

}  // namespace flexmorph::testing
