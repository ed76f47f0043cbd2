// Shows that exported outlines are correct: CalculiX, an independent finite-element program, solves
// the files that a run exports. The designs are input data (tests/data/), so that the result does
// not depend on the path of an optimizer.

#include <gtest/gtest.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

#include "tests/cases/program.h"
#include "tests/cases/run_json.h"

namespace flexmorph::test {
namespace {

/// Runs a case with the design of tests/data/NAME.csv; its optimizer may move a variable by 1e-9 of
/// the variable's range only. @returns the member body_fitted of run.json, which describes the
/// exported outline
json verified(const Scratch& scratch, const std::string& name, const std::string& folder,
              Words changes = {}) {
  changes.insert(changes.end(),
                 {"design.start='" FLEXMORPH_DATA "/" + name + ".csv'", "design.min_feature=0",
                  "optimizer.max_iterations=1", "optimizer.move_limit=1e-9",
                  "output.design_every=0", "output.plots=false"});
  const Ended ended = run(scratch, name, folder, changes);
  // Designs of tests/data may exceed the volume that the case allows.
  EXPECT_TRUE(is_done(ended, folder));
  return run_json(folder)["results"][0]["body_fitted"];
}

/// The nodes of an input file of CalculiX and the nodal forces of its steps (node, direction,
/// size).
struct Input {
  struct Force {
    int node, direction;
    double size;
  };
  std::map<int, std::pair<double, double>> nodes;
  std::vector<std::vector<Force>> steps;
  double thickness = 0;

  explicit Input(const std::string& path) {
    std::string card;
    for (const std::string& line : lines_of(contents_of(path))) {
      if (line.starts_with("**")) continue;
      if (line.starts_with("*")) {
        card = line;
        if (card.starts_with("*STEP")) steps.emplace_back();
        continue;
      }
      char comma = 0;
      std::istringstream in(line);
      if (card.starts_with("*NODE, NSET")) {
        int node = 0;
        double x = 0, y = 0;
        in >> node >> comma >> x >> comma >> y;
        nodes[node] = {x, y};
      }
      if (card.starts_with("*SOLID SECTION")) in >> thickness;
      if (card.starts_with("*CLOAD")) {
        Force f{};
        in >> f.node >> comma >> f.direction >> comma >> f.size;
        steps.back().push_back(f);
      }
    }
  }
};

using Values = std::map<int, std::vector<double>>;  // node -> its values

/// Returns the blocks DISP or STRESS of a result file of CalculiX, one per step.
std::vector<Values> blocks(const std::string& path, const std::string& name) {
  std::vector<Values> out;
  bool inside = false;
  for (const std::string& line : lines_of(contents_of(path))) {
    if (line.starts_with(" -4")) {
      inside = line.find(name) != std::string::npos;
      if (inside) out.emplace_back();
    }
    if (line.starts_with(" -3")) inside = false;
    if (!inside || !line.starts_with(" -1")) continue;
    std::vector<double>& values = out.back()[std::stoi(line.substr(3, 10))];
    for (std::size_t at = 13; at + 12 <= line.size(); at += 12)
      values.push_back(std::stod(line.substr(at, 12)));
  }
  return out;
}

double von_mises(const std::vector<double>& s) {
  return std::sqrt(
      0.5 * (std::pow(s[0] - s[1], 2) + std::pow(s[1] - s[2], 2) + std::pow(s[2] - s[0], 2)) +
      3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

/// Compares the fields of design.vtu with the results of CalculiX at all nodes of the first step.
///
/// Displacements: the largest difference is compared with the largest displacement. Both programs
/// solve the same elements under the same forces, but CalculiX uses bricks of one layer. Von Mises
/// stress: the root mean square of the difference is compared with the root mean square of the
/// stress, because each program averages element stresses at nodes in its own way. Single values at
/// re-entrant corners are not compared, because the stress there has no limit as elements shrink.
/// @param moved, stress  results of CalculiX
/// @param largest  largest von Mises stress that run.json reports
void expect_fields(const std::string& path, const Input& input, const Values& moved,
                   const Values& stress, double largest) {
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkUnstructuredGrid* grid = reader->GetOutput();
  ASSERT_GT(grid->GetNumberOfCells(), 0);
  EXPECT_EQ(grid->GetCellType(0), VTK_QUADRATIC_TRIANGLE);
  vtkDataArray* displacement = grid->GetPointData()->GetArray("displacement");
  vtkDataArray* mises = grid->GetPointData()->GetArray("von_mises");
  double largest_displacement = 0, difference = 0, squares = 0, stress_squares = 0, peak = 0;
  int n = 0;
  for (const auto& [node, at] : input.nodes) {
    if (!moved.contains(node) || node > grid->GetNumberOfPoints()) continue;
    const double* location = grid->GetPoint(node - 1);
    ASSERT_NEAR(location[0], at.first, 1e-6);
    ASSERT_NEAR(location[1], at.second, 1e-6);
    for (int c = 0; c < 2; ++c) {
      const double value = moved.at(node)[static_cast<std::size_t>(c)];
      largest_displacement = std::max(largest_displacement, std::abs(value));
      difference = std::max(difference, std::abs(value - displacement->GetComponent(node - 1, c)));
    }
    const double ours = mises->GetComponent(node - 1, 0), theirs = von_mises(stress.at(node));
    squares += std::pow(ours - theirs, 2);
    stress_squares += theirs * theirs;
    peak = std::max(peak, ours);
    ++n;
  }
  EXPECT_GT(n, 100);
  EXPECT_LT(difference, 5e-3 * largest_displacement);
  ::testing::Test::RecordProperty("stress_rms",
                                  std::to_string(std::sqrt(squares / stress_squares)));
  EXPECT_LT(std::sqrt(squares / stress_squares), 0.02);
  // The reported largest stress leaves out the surroundings of loads and supports.
  EXPECT_LE(largest, peak * (1 + 1e-6));
}

/// Runs CalculiX on design.inp and compares its results with those of the run.
/// @param thickness  thickness of the plate [m]
/// @param worst  True if the compliance is that of the worst load, false if it is the sum over all
/// loads
void expect_calculix_agrees(const std::string& folder, const json& found, double thickness,
                            bool worst) {
  const std::string command =
      "cd '" + folder + "' && OMP_NUM_THREADS=1 ccx -i design > ccx.log 2>&1";
  ASSERT_EQ(testing::run_shell(command).code, 0) << contents_of(folder + "/ccx.log");
  const Input input(folder + "/design.inp");
  const auto moved = blocks(folder + "/design.frd", "DISP"),
             stress = blocks(folder + "/design.frd", "STRESS");
  ASSERT_EQ(moved.size(), input.steps.size());
  ASSERT_EQ(stress.size(), input.steps.size());
  double sum = 0, largest = 0;
  for (std::size_t s = 0; s < moved.size(); ++s) {
    double compliance = 0;
    for (const Input::Force& f : input.steps[s])
      compliance += f.size * moved[s].at(f.node).at(static_cast<std::size_t>(f.direction - 1));
    compliance *= thickness / input.thickness;  // The file describes a slice of the plate.
    sum += compliance;
    largest = std::max(largest, compliance);
  }
  const auto expected = found["compliance"].get<double>();
  EXPECT_NEAR(worst ? largest : sum, expected, 0.005 * expected);
  const json& exported = found["exported"];
  const double x = exported["largest_stress_at"][0], y = exported["largest_stress_at"][1];
  const auto reported = exported["largest_stress"].get<double>();
  expect_fields(folder + "/design.vtu", input, moved[0], stress[0], reported);
  // The location of the largest reported stress must be a node of CalculiX.
  double nearest = INFINITY;
  for (const auto& [node, at] : input.nodes)
    if (stress[0].contains(node))
      nearest = std::min(nearest, std::hypot(at.first - x, at.second - y));
  EXPECT_LT(nearest, 1e-9);
}

bool has_calculix() { return testing::run_shell("command -v ccx").code == 0; }

struct Plate {
  const char* name;
  bool worst;
  double cell, thickness;  // smallest permitted gap and width [m]
};

void PrintTo(const Plate& plate, std::ostream* out) { *out << plate.name; }

/// Expects a warning for widths and gaps below the limits that names the smallest one first. The
/// reference values are `min_feature` and `min_gap` of the final design, computed by its medial
/// axis with another tolerance of outlines; they agree within a fiftieth of a cell.
void expect_length_scale_violations(const json& run, const Plate& plate) {
  const json& result = run["results"][0];
  for (const bool solid : {true, false}) {
    const json& smallest = result[solid ? "min_feature" : "min_gap"];
    const double width = smallest.is_number() ? smallest.get<double>() : INFINITY;
    const double wanted = solid ? plate.thickness : plate.cell;
    double said = INFINITY;
    for (const std::string warning : run["warnings"]) {
      const std::size_t at = warning.find(" narrower ");
      const bool of_material = warning.find("design.min_thickness") != std::string::npos;
      if (at != std::string::npos && of_material == solid)
        said = std::stod(warning.substr(warning.find(": ", at) + 2));
    }
    if (width < 0.95 * wanted) {
      EXPECT_NEAR(said, width, 0.02 * plate.cell) << run["warnings"];
    } else if (width >= wanted) {
      EXPECT_EQ(said, INFINITY) << run["warnings"];
    }
  }
}

class ExportedPlates : public ::testing::TestWithParam<Plate> {};

TEST_P(ExportedPlates, AreWhatCalculixFinds) {
  if (!has_calculix()) GTEST_SKIP() << "the program ccx is absent";
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const json found = verified(scratch, GetParam().name, folder);
  ASSERT_TRUE(found["compliance"].is_number()) << found;
  EXPECT_LE(found["error"].get<double>(), 0.005);
  EXPECT_GT(found["volume"].get<double>(), 0.2);
  expect_calculix_agrees(folder, found, 1, GetParam().worst);
  expect_length_scale_violations(run_json(folder), GetParam());
}

INSTANTIATE_TEST_SUITE_P(Shipped, ExportedPlates,
                         ::testing::Values(Plate{"short_beam", false, 0.025, 0.05},
                                           Plate{"mbb", false, 0.025, 0.05},
                                           Plate{"l_bracket", false, 0.0125, 0.03},
                                           Plate{"bridge", true, 0.025, 0.05}),
                         [](const auto& each) { return std::string(each.param.name); });

// The worst load of a growing plate: the material within the hub is held, and inertia forces are
// exported as nodal forces.
TEST(ExportedMotion, IsWhatCalculixFinds) {
  if (!has_calculix()) GTEST_SKIP() << "the program ccx is absent";
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const json found =
      verified(scratch, "rotating_plate_v05", folder,
               {"design.cell=0.01", "design.min_thickness=0.01", "output.tolerance=5e-4",
                "time.step=5e-3", "verify=", "esl.every=0.1", "design.loads=\"worst\"", "cycle="});
  ASSERT_TRUE(found["compliance"].is_number()) << found;
  EXPECT_LE(found["error"].get<double>(), 0.005);
  expect_calculix_agrees(folder, found, 0.01, true);
}

}  // namespace
}  // namespace flexmorph::test
