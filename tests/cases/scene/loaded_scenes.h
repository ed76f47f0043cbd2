#pragma once

#include <gtest/gtest.h>

#include <string>

#include "io/files.h"
#include "tests/cases/scenes.h"
#include "tests/io/scratch.h"

namespace flexmorph::cases {

inline Scene scene_of(const std::string& text, const Changes& changes = {}) {
  const Scratch scratch;
  return read_scene(io::CaseFile(scratch.write("case.toml", text), changes));
}

inline std::string complaint(const std::string& text, const Changes& changes = {}) {
  try {
    scene_of(text, changes);
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), Error::Kind::input);
    return e.what();
  }
  return "";
}

inline std::string drive(const std::string& name, const std::string& formula) {
  return "\n[[drive]]\nname = \"" + name + "\"\nformula = \"" + formula + "\"\n";
}
inline std::string load(const std::string& type, const std::string& more) {
  return "\n[[load]]\ntype = \"" + type + "\"\n" + more + "\n";
}

/// A slender cantilever of 1 m x 0.02 m x 0.01 m with E = 2e9 Pa: E I = 13.33 N m^2.
inline const std::string kCantilever = R"toml(
[static]
path = "load"
steps = 4

[[body]]
name = "rod"
element = "ancf_beam"
terms = ["ecm"]
length = 1.0
height = 0.02
width = 0.01
youngs_modulus = 2e9
poisson_ratio = 0.0
elements = 16

[[hub]]
name = "wall"

[[joint]]
type = "weld"
body = "rod"
edge = "root"
to = "wall"
)toml";
/// A plate in a rotating hub; material flows out of the hub at a constant speed.
inline const std::string kPlate = R"toml(
[time]
end = 0.2
step = 0.001
rho_inf = 0.9
start = "rigid"

[[hub]]
name = "hub"
angular_velocity = 2.0

[[body]]
name = "plate"
element = "ale_ancf_plate"
terms = ["inertia", "membrane"]
length = 0.4
width = 0.1
thickness = 0.01
density = 2700.0
youngs_modulus = 1e7
poisson_ratio = 0.3
elements = [4, 1]

[body.flow]
speed = 0.2
max_length = 0.15

[[joint]]
type = "weld"
body = "plate"
edge = "root"
to = "hub"
)toml";

}  // namespace flexmorph::cases
