// Shows that designs are verified by the motion on their cells where the case asks for it, and that
// runs without such a motion report the difference of energies instead.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "cases/results/series.h"
#include "io/drawings/exports.h"
#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

/// Integrates the column by the trapezoidal rule.
double strain_integral(const io::CsvTable& motion) {
  const auto t = motion.numbers("time"), u = motion.numbers("energy.strain");
  double out = 0;
  for (size_t k = 1; k < t.size(); ++k) out += 0.5 * (t[k] - t[k - 1]) * (u[k] + u[k - 1]);
  return out;
}

// Two plates, three cycles: the integral, the best cycle, amplitudes and expectations are those of
// the motion on cells, and differ from those on the mesh of the scene.
TEST(CellsRun, CyclesAndDesignsAreJudgedOnCells) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = flexmorph(
      scratch, {"run", FLEXMORPH_TWO_PLATES, "-o", folder, "--set", "verify.cells=1", "--set",
                "expect={amplitude={at_least=0}, \"energy.strain.largest\"={at_least=0}}"});
  ASSERT_EQ(ended.code, kTooFew) << ended.err;
  const json run = run_json(folder);
  const io::CsvTable on_cells = io::read_csv(folder + "/motion_verified.csv"),
                     coarse = io::read_csv(folder + "/motion.csv");
  const double integral = strain_integral(on_cells);
  int best = 0;
  ASSERT_GE(run["cycles"].size(), 2u);
  for (const auto& cycle : run["cycles"]) {
    const double found = cycle["measure"];
    if (cycle["best"].get<bool>()) {
      ++best;
      EXPECT_NEAR(found, integral, 1e-12 * integral);
    } else {
      EXPECT_GT(found, integral);
    }
  }
  EXPECT_EQ(best, 1);
  const json& motion = run["motion"];
  EXPECT_TRUE(testing::mentions_all(motion["verified_on"], {"cells"}));
  EXPECT_NEAR(motion["strain_energy_integral"].get<double>(), integral, 1e-12 * integral);
  EXPECT_NEAR(motion["scene_mesh_strain_energy_integral"].get<double>(), strain_integral(coarse),
              1e-12 * integral);
  const json& heavy = run["results"][0];
  const double amplitude = cases::largest_size(on_cells.numbers("heavy.tip_deflection"));
  EXPECT_EQ(heavy["dynamic_amplitude"].get<double>(), amplitude);
  EXPECT_EQ(heavy["scene_mesh_amplitude"].get<double>(),
            cases::largest_size(coarse.numbers("heavy.tip_deflection")));
  EXPECT_NE(heavy["dynamic_amplitude"], heavy["scene_mesh_amplitude"]);
  EXPECT_LT(heavy["load_difference"]["geometric"].get<double>(), 1);
  EXPECT_EQ(run["expect"]["amplitude"]["found"].get<double>(), amplitude);
  EXPECT_EQ(run["expect"]["energy.strain.largest"]["found"].get<double>(),
            cases::largest_size(on_cells.numbers("energy.strain")));
  EXPECT_FALSE(std::filesystem::exists(folder + "/motion_on_cells.csv"));
  // The report contains the picture of the verification.
  const std::string picture = contents_of(folder + "/plots/deflection_verified.svg");
  ASSERT_NE(picture.find("<svg"), std::string::npos);
  EXPECT_NE(contents_of(folder + "/report.html").find(picture.substr(picture.find("<svg"))),
            std::string::npos);
}

/// Evaluates the full plate, cut through by a gap. @param said  receives the output of the program
json analysed(const Scratch& scratch, double gap, std::string& said) {
  const double half = 0.5 * (0.56 - gap) / 2;  // half the length of a bar
  std::vector<Component> bars;
  for (const double centre : {half, 0.56 - half})
    for (const double y : {-0.025, 0.025})
      bars.push_back({{centre, y}, half + (gap > 0 ? 0 : 0.01), 0, 0.027, 0.027, 0.027});
  io::write_components_csv(scratch / "bars.csv", bars);
  const std::string folder = scratch / "out";
  const Ended ended = flexmorph(scratch, {"run", FLEXMORPH_SHORT_CASE, "-o", folder, "--set",
                                          "design.start='" + (scratch / "bars.csv") + "'", "--set",
                                          "optimizer.max_iterations=0"});
  said = ended.out + ended.err;
  return run_json(folder);
}

// If no motion on cells verifies the design, a difference of energies indicates a cut: the 50 mm
// elements of the short plate bridge a gap of two cells.
TEST(CellsRun, EnergiesThatAreApartAreAWarning) {
  for (const double gap : {0.0, 0.01}) {
    const Scratch scratch;
    std::string said;
    const json run = analysed(scratch, gap, said);
    const double apart = run["results"][0]["load_difference"]["geometric"];
    const bool warned = said.find("static strain energy") != std::string::npos;
    EXPECT_EQ(warned, run["warnings"].dump().find("static strain energy") != std::string::npos);
    EXPECT_EQ(warned, gap > 0) << apart << said;
    if (gap > 0) {
      EXPECT_GT(apart, 1);
    } else {
      // The energy of the full plate on elements of 50 mm differs by 5 % from the energy on its
      // cells.
      EXPECT_LT(apart, 0.1);
    }
    // A design that was not optimized for any loads is assessed by the loads of its own motion.
    EXPECT_NEAR(run["results"][0]["load_difference"]["loads"].get<double>(), 0, 1e-9);
  }
}

}  // namespace
}  // namespace flexmorph::test
