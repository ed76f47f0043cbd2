// Shows that a design depends neither on the order of the loads in its case file, nor on a power of
// two by which all loads are multiplied: components are equal in every bit.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <sstream>

#include "tests/cases/program.h"

namespace flexmorph::test {
namespace {

constexpr const char* kBracket = R"(title = "A bracket with three loads"
[domain]
name = "bracket"
size = [2.0, 1.0]
thickness = 1.0
youngs_modulus = 1.0
poisson_ratio = 0.3

[[support]]
edge = "left"
fix = ["x", "y"]

[[design]]
cell = 0.1
components = [4, 2]
max_volume = 0.4
min_thickness = 0.05

[optimizer]
max_iterations = 6
)";

/// Returns a force of a load case at a point.
std::string force(double x, double y, double fx, double fy, double factor) {
  std::ostringstream out;
  out.precision(17);
  out << "[[load.force]]\npoint = [" << x << ", " << y << "]\nforce = [" << factor * fx << ", "
      << factor * fy << "]\n";
  return out.str();
}

/// Returns the case with its load cases, and the forces of a load case, in an order.
std::string bracket(const std::array<int, 3>& order, bool reversed, double factor) {
  std::string out = kBracket;
  for (const int load : order) {
    out += "\n[[load]]\nname = \"load " + std::to_string(load) + "\"\n";
    if (load == 2) out += "weight = 0.7\n";
    // Three forces at one node: the last bits of their sum depend on its order.
    std::array<std::string, 3> forces = {force(2, 0.5, 0.1 * (load + 1), -1.0 / 3, factor),
                                         force(2, 0.5, 0.7, 0.3 * load, factor),
                                         force(2, 0.5, -1e-3, 0.1, factor)};
    if (reversed) std::reverse(forces.begin(), forces.end());
    for (const std::string& each : forces) out += each;
    if (load == 1) out += force(1, 1, 0, -0.2, factor);
  }
  return out;
}

class LoadOrder : public ::testing::TestWithParam<const char*> {};

TEST_P(LoadOrder, ChangesNoBitOfADesign) {
  const Scratch scratch;
  const Words changes = {std::string("design.loads=\"") + GetParam() + "\"", "output.vtk=false",
                         "design.min_feature=0", "output.plots=false"};
  const auto components = [&](const std::string& name, const std::string& text) {
    const std::string folder = scratch / name;
    const Ended ended = run(scratch, scratch.write(name + ".toml", text), folder, changes);
    EXPECT_TRUE(is_done(ended, folder)) << ended.err;
    return contents_of(folder + "/components.csv");
  };
  const std::string first = components("first", bracket({0, 1, 2}, false, 1));
  EXPECT_EQ(components("permuted_four_times", bracket({2, 0, 1}, true, 4)), first);
  EXPECT_EQ(lines_of(first).size(), 17u);  // a header and 16 components
}

INSTANTIATE_TEST_SUITE_P(Combinations, LoadOrder, ::testing::Values("sum", "worst"));

}  // namespace
}  // namespace flexmorph::test
