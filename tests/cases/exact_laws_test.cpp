// Shows that runs of the program obey exact laws: the dependence of the compliance on material and
// loads, rest without loads, and the times at which lines of nodes are inserted; and that
// meaningless changes of a case are refused.

#include <gtest/gtest.h>

#include <numbers>

#include "cases/assembly/build.h"
#include "cases/check/ready.h"
#include "cases/run/run.h"
#include "io/files.h"
#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"

namespace flexmorph::cases {
namespace {

using nlohmann::json;
using test::Ended;
using test::Words;
using Components = std::vector<Component>;

/// Returns run.json of a run that must succeed.
json results_of_run(const Scratch& scratch, const std::string& name, const Words& changes) {
  const std::string folder = scratch / "run";
  Words all = {"accuracy=", "output.vtk=false", "output.plots=false"};
  all.insert(all.end(), changes.begin(), changes.end());
  const Ended ended = test::run(scratch, name, folder, all);
  EXPECT_TRUE(test::is_done(ended, folder));
  return test::run_json(folder);
}

/// Returns the result of the start design of the short beam.
json start_of_short_beam(const Scratch& scratch, const Words& changes) {
  Words all = {"optimizer.max_iterations=0", "design.cell=0.05", "output.crisp_every=0"};
  all.insert(all.end(), changes.begin(), changes.end());
  return results_of_run(scratch, "short_beam", all)["results"][0];
}

void expect_ratio(const json& changed, const json& own, const std::string& key, double ratio) {
  const double value = own[key].get<double>() * ratio;
  EXPECT_NEAR(changed[key].get<double>(), value, 1e-8 * value) << key;
}

TEST(ExactLaws, ComplianceIsProportionalToTheLoadSquaredAndInverseToTheStiffness) {
  const Scratch scratch;
  const Scene scene = read_scene(io::CaseFile(find_case("short_beam")));
  // Without fillets the outline does not depend on loads and stiffness.
  const auto start = [&](const std::string& change) {
    return start_of_short_beam(scratch, {"design.min_feature=0", change});
  };
  const double modulus = scene.domain->youngs_modulus, thickness = scene.domain->thickness;
  const json own = start("title='as it is'"), stiff = start("domain.youngs_modulus=2e11"),
             soft = start("domain.youngs_modulus=1e-6"), thin = start("domain.thickness=1e-4");
  const Vec2 force = 1e6 * scene.domain->loads[0].forces[0].force;
  const json loaded = start("load.0.force.0.force=[" + io::to_text(force.x()) + ", " +
                            io::to_text(force.y()) + "]");
  for (const char* key : {"compliance", "crisp_compliance"}) {
    expect_ratio(stiff, own, key, modulus / 2e11);
    expect_ratio(soft, own, key, modulus / 1e-6);
    expect_ratio(thin, own, key, thickness / 1e-4);
    expect_ratio(loaded, own, key, 1e12);
  }
}

std::string csv_of(const Components& components) {
  std::string out = "X0,Y0,half_length,angle,c1,c2,c3\n";
  for (const Component& c : components) {
    std::string row;
    for (const double p : c.parameters()) row.append(row.empty() ? "" : ",").append(io::to_text(p));
    out.append(row).append("\n");
  }
  return out;
}

// Components that lie on others, rotated by whole half turns, add nothing. Without fillets this is
// exact; with fillets the outlines agree within their tolerance, a hundredth of a cell.
TEST(ExactLaws, TheSameUnionHasTheSameSharpDesign) {
  const Scratch scratch;
  const Components own =
      build_problems(read_scene(io::CaseFile(find_case("short_beam")))).front().design.components();
  Components twice = own;
  for (Component c : own) {
    c.angle += 1000 * std::numbers::pi;
    twice.push_back(c);
  }
  const auto start = [&](const Components& list, const std::string& feature) {
    return start_of_short_beam(scratch,
                               {"design.start='" + scratch.write("start.csv", csv_of(list)) + "'",
                                "design.min_feature=" + feature, "design.cell=0.1"});
  };
  const json unchanged = start(own, "0"), same = start(twice, "0");
  for (const char* key : {"crisp_volume", "crisp_compliance"})
    expect_ratio(same, unchanged, key, 1);
  constexpr double kPerimeter = 20, kTolerance = 0.01 * 0.1, kArea = 2;
  EXPECT_NEAR(start(twice, "0.1")["crisp_volume"].get<double>(),
              start(own, "0.1")["crisp_volume"].get<double>(), kPerimeter * kTolerance / kArea);
}

TEST(ExactLaws, NothingMovesAtRest) {
  const Scratch scratch;
  const std::string folder = scratch / "run";
  const Ended ended =
      test::run(scratch, "plate_pendulum", folder,
                {"gravity=", "time.end=0.04", "body.elements=[2, 2]", "output.plots=false"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const io::CsvTable motion = io::read_csv(folder + "/motion.csv");
  // Young's modulus times volume is 90 J: strains of 1e-13 (round-off) have an energy far below
  // 1e-16 J.
  for (const char* column : {"energy.kinetic", "energy.strain"})
    for (const double energy : motion.numbers(column)) EXPECT_LT(std::abs(energy), 1e-16);
}

// The first row of elements has a thousandth of the length of its neighbour.
TEST(TinyElements, KeepTheConstraintsAndTheEnergy) {
  const Scratch scratch;
  const json motion = results_of_run(
      scratch, "plate_pendulum",
      {"body.elements=[2, 2]", "body.line=[{ index = 1, at = 3e-4 }]", "time.end=0.01"})["motion"];
  EXPECT_LT(motion["constraint_drift"].get<double>(), 1e-8);
  EXPECT_LT(motion["energy_error"].get<double>(), 0.01);
}

// The first line of nodes is inserted when the boundary element has grown to max_length. Its outer
// half then grows to max_length within (max_length / 2) / speed. The time steps of the rows do not
// coincide with these times.
TEST(ExactLaws, LinesComeInWhenMaxLengthIsReached) {
  const Scratch scratch;
  const std::string name = "rotating_plate_v01";
  const Scene scene = read_scene(io::CaseFile(find_case(name)));
  const Body& body = scene.bodies.front();
  const double element = body.length / body.elements[0], speed = body.flow->speed;
  const double first = (body.flow->max_length - element) / speed,
               again = 0.5 * body.flow->max_length / speed;
  struct Row {
    double step, end;
    size_t events;
  };
  for (const Row& row :
       {Row{0.37 * first, first + 0.4 * again, 1}, Row{first / 30, first + 0.4 * again, 1},
        Row{0.05 * (first + 0.4 * again), first + 1.4 * again, 2}, Row{first / 25, first, 0}}) {
    const json out = results_of_run(
        scratch, name,
        {"design=", "optimizer=", "cycle=", "verify=", "esl=", "time.step=" + io::to_text(row.step),
         "time.end=" + io::to_text(row.end)});
    EXPECT_EQ(out["motion"].value("events", json::array()).size(), row.events) << row.step;
  }
}

TEST(WhatHasNoMeaning, IsRefusedWithItsLocation) {
  const Scratch scratch;
  const std::string header = "X0,Y0,half_length,angle,c1,c2,c3\n";
  const std::string empty = scratch.write("empty.csv", header),
                    bad = scratch.write("nan.csv", header + "0.1,0,0.05,0,nan,0.01,0.01\n");
  for (const Words& words : {Words{"short_beam", "--set", "design.start='" + empty + "'"},
                             Words{"short_beam", "--set", "design.start='" + bad + "'"},
                             Words{"short_beam", "--set", "support.0.fix=[]"},
                             Words{"plate_pendulum", "--set", "joint.0.components=[]"},
                             Words{"rotating_plate_v05", "--set", "joint.0.edges=[]"},
                             Words{"free_beam_heated", "--set", "body.heat.rise=-1e9"}}) {
    Words all = {"check"};
    all.insert(all.end(), words.begin(), words.end());
    const Ended ended = test::flexmorph(scratch, all);
    EXPECT_EQ(ended.code, 2) << words.back() << ": " << ended.out << ended.err;
    EXPECT_FALSE(ended.err.empty());
  }
}

// A second pin at the point of the first one holds nothing more. The motion is that of one pin; the
// forces of the two pins are not unique, and both are named.
TEST(TwoPinsAtOnePoint, MoveAsOne) {
  const Scratch scratch;
  const std::string pendulum = contents_of(find_case("plate_pendulum"));
  const std::string begin = pendulum.substr(0, pendulum.find("[expect]"));
  const std::string twice = scratch.write(
      "twice.toml", begin + "[[joint]]\ntype = \"pin\"\nbody = \"plate\"\npoint = [0.0, 0.0]\n");
  const Words changes = {"time.end=0.02", "body.elements=[2, 2]", "output.plots=false",
                         "output.vtk=false"};
  const std::string one = scratch / "one", both = scratch / "both";
  ASSERT_EQ(test::run(scratch, "plate_pendulum", one, changes).code, 0);
  const Ended ended = test::run(scratch, twice, both, changes);
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(contains(contents_of(both + "/run.json"), "\"not_unique_forces\": \"plate.pin\""));
  const std::vector<double> expected = io::read_csv(one + "/motion.csv").numbers("plate.corner_z"),
                            found = io::read_csv(both + "/motion.csv").numbers("plate.corner_z");
  ASSERT_EQ(found.size(), expected.size());
  for (size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], expected[k], 1e-9);
}

}  // namespace
}  // namespace flexmorph::cases
