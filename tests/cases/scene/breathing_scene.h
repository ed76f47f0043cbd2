#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "io/files.h"
#include "tests/cases/scenes.h"
#include "tests/io/scratch.h"

namespace flexmorph::cases {

/// A rotating plate whose length increases and decreases.
inline const std::string kBreathing = R"toml(
[time]
end = 1.0

[constants]
L0 = 0.45
swing = 0.2

[[drive]]
name = "out"
formula = "L0 + swing*sin(2*pi*t)"

[[drive]]
name = "turn"
table = [[0, 0], [0.25, 0.1], [0.5, 0.3], [0.75, 0.6], [1.0, 1.0], [1.25, 1.5]]

[[drive]]
name = "side"
csv = "side.csv"
column = "y"

[[hub]]
name = "hub"
angle = "turn"
position = ["out", "side"]

[[body]]
name = "plate"
element = "ale_ancf_plate"
terms = ["inertia", "membrane"]
length = 0.45
width = 0.1
thickness = 0.01
density = 2700.0
youngs_modulus = 1e8
poisson_ratio = 0.3
elements = [9, 1]

[body.flow]
length = "out"
mesh = "split"
max_length = 0.1

[[joint]]
type = "weld"
body = "plate"
edge = "root"
to = "hub"
)toml";

class Drives : public ::testing::Test {
 protected:
  Scene read(const Changes& changes = {}, const std::string& text = kBreathing) const {
    return read_scene(io::CaseFile(scratch_.write("breathing.toml", text), changes));
  }

  std::string complaint(const Changes& changes) const {
    try {
      read(changes);
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), Error::Kind::input);
      return e.what();
    }
    return "";
  }

  void SetUp() override {
    std::string rows = "time,y,note\n";
    for (int i = 0; i <= 20; ++i)
      rows += io::to_text(0.05 * i) + "," + io::to_text(std::sin(0.05 * i)) + ",here\n";
    scratch_.write("side.csv", rows);
  }

  Scratch scratch_;
};

}  // namespace flexmorph::cases
