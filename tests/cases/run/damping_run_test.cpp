// Shows that runs with material damping report the dissipated work in a column and in run.json if
// and only if the scene has damping, with and without a design, for every integrator that accepts
// the scene; and that unsupported combinations are refused with one located message.
#include <gtest/gtest.h>

#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

const Words kDamped = {"body.terms=[\"inertia\", \"membrane\", \"damping\"]",
                       "body.damping_time=1e-3"};

/// Changes for the short plate with damping, without a design and without material flow (here, mesh
/// changes are tested only with generalized_alpha and constant steps).
Words still(Words more) {
  Words out = kDamped;
  for (const char* change :
       {"body.element=ancf_plate", "body.flow=", "design=", "esl=", "optimizer=", "cycle="})
    out.emplace_back(change);
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

/// Returns the values of a column of motion.csv; empty if the column does not exist.
std::vector<double> column(const std::string& folder, const std::string& name) {
  std::vector<double> out;
  size_t at = 0;
  bool known = false;
  for (const std::string& line : lines_of(contents_of(folder + "/motion.csv"))) {
    Words row;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) row.push_back(cell);
    if (known) {
      out.push_back(std::stod(row[at]));
      continue;
    }
    while (at < row.size() && row[at] != name) ++at;
    if (at == row.size()) return {};
    known = true;
  }
  return out;
}

/// @param missed  largest allowed error of the energy balance at the end [J]
void expect_dissipation(const std::string& folder, double missed) {
  const std::vector<double> lost = column(folder, "energy.dissipated"),
                            energy_error = column(folder, "energy.error"),
                            kinetic = column(folder, "energy.kinetic");
  ASSERT_GT(lost.size(), 10u);
  EXPECT_EQ(lost.front(), 0);
  for (size_t i = 1; i < lost.size(); ++i) EXPECT_GE(lost[i], lost[i - 1]);
  EXPECT_LE(std::abs(energy_error.back()), missed);
  EXPECT_LT(lost.back(), kinetic.front());
  const json written = run_json(folder);
  EXPECT_NEAR(written["motion"]["balance"]["energy.dissipated"].get<double>(), lost.back(),
              1e-9 * lost.back());
}

TEST(Damped, DesignWithFlowHasTheDissipatedWork) {
  Scratch scratch;
  const std::string damped = scratch / "damped", free = scratch / "free";
  const Words coarse = {"design.cell=0.01",      "design.min_thickness=0.01",
                        "esl.every=0.02",        "optimizer.max_iterations=2",
                        "body.elements=[10, 1]", "time.step=2e-3"};
  Words changes = kDamped;
  changes.insert(changes.end(), coarse.begin(), coarse.end());
  changes.emplace_back("body.damping_time=4e-3");
  const Ended run = flexmorph(scratch, short_run(damped, changes));
  ASSERT_EQ(run.code, kTooFew) << run.err;
  ASSERT_EQ(flexmorph(scratch, short_run(free, coarse)).code, kTooFew);
  // The two runs have different designs, but energy errors of similar size. Without the dissipated
  // work the error of the damped run would be six times as large.
  expect_dissipation(damped, 2 * std::abs(column(free, "energy.error").back()));
  EXPECT_TRUE(column(free, "energy.dissipated").empty());
  EXPECT_FALSE(run_json(free)["motion"].contains("balance"));
}

TEST(Damped, EveryIntegratorCountsTheDissipatedWork) {
  for (const char* changes : {"time.integrator=energy_momentum", "time.step=adaptive"}) {
    Scratch scratch;
    const std::string folder = scratch / "run";
    const Ended run = flexmorph(scratch, short_run(folder, still({changes, "time.start=rigid"})));
    ASSERT_EQ(run.code, 0) << run.err;
    expect_dissipation(folder, 0.1 * column(folder, "energy.dissipated").back());
  }
}

TEST(Damped, WhatItCannotDoIsRefusedWithItsLocation) {
  struct Bad {
    Words changes;
    std::vector<std::string> parts;
  };
  const std::string terms = "body.terms=[\"inertia\", \"membrane\", \"damping\"]";
  for (const auto& [changes, parts] :
       {Bad{{terms}, {"body.damping_time", "missing", "[s]"}},
        Bad{{terms, "body.damping_time=0"}, {"body.damping_time=0", "positive", "[s]"}},
        Bad{{"body.terms=[\"inertia\", \"damping\"]", "body.damping_time=1e-3"},
            {"body.terms=", "damping", "elastic"}},
        Bad{{"body.damping_time=1e-3"}, {"body.damping_time=1e-3", "unknown key"}},
        Bad{still({"body.line=[{ index = 1, free = true }]"}),
            {"body.terms=", "damping", "[[body.line]]"}}}) {
    Scratch scratch;
    const Ended run = flexmorph(scratch, short_run(scratch / "run", changes));
    EXPECT_EQ(run.code, 2);
    EXPECT_TRUE(testing::mentions_all(run.err, parts));
    EXPECT_TRUE(run.err.find(".toml:") != std::string::npos ||
                run.err.find("--set") != std::string::npos)
        << run.err;
  }
}

}  // namespace
}  // namespace flexmorph::test
