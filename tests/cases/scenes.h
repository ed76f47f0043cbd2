#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "cases/assembly/build.h"
#include "tests/support/disturbance.h"

/// Functions by which tests read shipped cases.
namespace flexmorph::cases {

using Changes = std::vector<std::string>;

/// Returns the path of a shipped case.
inline std::string shipped(const std::string& name) {
  return (std::filesystem::path(FLEXMORPH_CASES) / (name + ".toml")).string();
}

/// Reads a shipped case with overrides "key=value". @throws Error (input).
inline Scene read(const std::string& name, const Changes& changes = {}) {
  Scene scene = read_scene(io::CaseFile(shipped(name), changes));
  for (Body& body : scene.bodies) body.youngs_modulus = testing::disturbed(body.youngs_modulus);
  return scene;
}

/// Returns the error message for rotating_plate_v01 with these changes; empty if the case is
/// accepted.
inline std::string complaint_of_v01(const Changes& changes) {
  try {
    read("rotating_plate_v01", changes);
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), Error::Kind::input);
    return e.what();
  }
  return "";
}

/// Returns the location with which a message must begin: the change that it names, otherwise the
/// file of the case.
inline std::string location_in(const std::string& message, const std::string& file,
                               const Changes& changes) {
  for (const std::string& change : changes)
    if (const std::string option = "--set " + change + ": "; message.starts_with(option))
      return option;
  return file + ":";
}

}  // namespace flexmorph::cases
