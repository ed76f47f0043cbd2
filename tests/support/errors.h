#pragma once

#include <gtest/gtest.h>

#include <string>

#include "geometry/base.h"

/// What errors say.
namespace flexmorph::testing {

/// The text of the Error that f() must throw, of that kind.
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

inline bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace flexmorph::testing
