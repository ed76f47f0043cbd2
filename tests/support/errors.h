#pragma once

#include <gtest/gtest.h>

#include <string>

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

}  // namespace flexmorph::testing
