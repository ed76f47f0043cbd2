// Shows that tables of results find their columns, that integrals over them are those of the
// trapezoidal rule, and that everything a run writes has a name of its own, a unit and a meaning.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "cases/check/ready.h"
#include "cases/results/motion_columns.h"
#include "cases/results/schema.h"
#include "cases/results/warnings.h"
#include "cases/run/motion_run.h"
#include "tests/cases/scenes.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

TEST(Series, FindsColumnsByNameAndGroup) {
  Series table({{"time", "s", "time", ColumnGroup::abscissa},
                {"tip", "m", "a point", ColumnGroup::observed},
                {"arm.energy", "J", "an energy", ColumnGroup::mechanism}});
  EXPECT_EQ(table.n_rows(), 0u);
  table.add_row(std::vector<double>{0, 1, 2});
  table.add_row(std::vector<double>{0.5, -3, 4});
  EXPECT_EQ(table.n_rows(), 2u);
  EXPECT_EQ(table.at("tip"), (std::vector<double>{1, -3}));
  EXPECT_EQ(table.find("tip.x"), nullptr);
  EXPECT_THROW(table.at("tip.x"), std::out_of_range);
  EXPECT_EQ(table.of_group(ColumnGroup::mechanism), (std::vector<size_t>{2}));
  EXPECT_EQ(largest_size(table.at("tip")), 3);
}

// Reference: ∫ (2 + 3 t) dt from 0 to 2 = 10; the trapezoidal rule is exact for this integrand on
// any steps.
TEST(MotionRecord, IntegratesTheStrainEnergy) {
  MotionRecord record;
  record.table = Series({{kTimeColumn, "s", "time", ColumnGroup::abscissa},
                         {kStrainColumn, "J", "strain energy", ColumnGroup::energy}});
  for (const double t : {0.0, 0.1, 0.7, 0.75, 2.0})
    record.table.add_row(std::vector<double>{t, 2 + 3 * t});
  EXPECT_NEAR(record.strain_integral(), 10, 1e-14);
  EXPECT_FALSE(record.amplitude("arm"));
}

// A spring stores much more energy than the designed rocker. What compares designs is the energy of
// the model without that of the spring, which has a column of its own.
TEST(MotionRecord, ComparesDesignedBodiesWithoutSprings) {
  const Changes alone = {"time.end=0.03", "time.step=2e-3"};
  Changes spring = alone;
  spring.push_back("spring=[{type='torsion', name='coil', b='shaft', stiffness=40.0}]");
  const MotionRecord record = run_motion(PreparedCase(read("four_bar", spring)), {}).record;
  const std::vector<double>&designed = record.table.at(kDesignedColumn),
        &strain = record.table.at(kStrainColumn), &coil = record.table.at("coil.energy"),
        &t = record.time();
  double integral = 0;
  for (size_t k = 0; k < t.size(); ++k) {
    EXPECT_GT(coil[k], 10 * designed[k]);
    EXPECT_NEAR(designed[k], strain[k] - coil[k], 1e-12 * strain[k]);
    if (k > 0) integral += 0.5 * (t[k] - t[k - 1]) * (designed[k] + designed[k - 1]);
  }
  EXPECT_NEAR(record.strain_integral(), integral, 1e-15 * strain[0]);
  const MotionRecord without = run_motion(PreparedCase(read("four_bar", alone)), {}).record;
  EXPECT_EQ(without.table.find(kDesignedColumn), nullptr);
}

/// Returns a motion over two periods whose tip deflection is mean + size sin(2 pi t), and whose
/// energy error decreases to -loss; the largest energy is 1 J.
MotionRecord swinging(double mean, double size, double loss = 0) {
  MotionRecord record;
  record.table = Series({{kTimeColumn, "s", "time", ColumnGroup::abscissa},
                         {"plate" + kDeflectionEnding, "m", "tip", ColumnGroup::deflection},
                         {kStrainColumn, "J", "strain energy", ColumnGroup::energy},
                         {kEnergyErrorColumn, "J", "defect", ColumnGroup::energy}});
  for (int k = 0; k <= 2000; ++k) {
    const double t = 1e-3 * k;
    const double tip = mean + size * std::sin(2 * std::numbers::pi * t);
    record.table.add_row(std::vector<double>{t, tip, 1, -loss * t / 2});
  }
  record.result.energy_error = std::abs(loss);
  return record;
}

// The root mean square of a sine over whole periods is size / sqrt(2); the trapezoidal rule is
// exact for it on equal steps.
TEST(Variation, OfASine) {
  const MotionRecord motion = swinging(-2, 3);
  const Variation found = variation_of(motion.time(), motion.table.values[1]);
  EXPECT_NEAR(found.mean, -2, 1e-12);
  EXPECT_NEAR(found.rms, 3 / std::numbers::sqrt2, 1e-12);
  EXPECT_NEAR(found.peak_to_peak, 6, 1e-12);
  EXPECT_NEAR(found.largest, 5, 1e-12);
}

/// Returns the number of warnings that mention all these parts.
std::ptrdiff_t count(const std::vector<Warning>& warnings, const std::vector<std::string>& parts) {
  return std::count_if(warnings.begin(), warnings.end(), [&](const Warning& w) {
    return static_cast<bool>(testing::mentions_all(w.words, parts));
  });
}

TEST(Warnings, OfVibrationAndDissipation) {
  const Scene scene = read("rotating_plate_v01");
  RunResult result;
  result.design.outcomes.emplace_back();
  result.design.outcomes[0].body = "plate";
  result.design.outcomes[0].iterations = 1;
  result.design.outcomes[0].crisp.connectivity.connected = true;
  const auto warned = [&](double size, double loss, double uniform_size = 1) {
    result.motions.motion = swinging(0.1, size, loss);
    result.motions.uniform = swinging(0.5, uniform_size);
    return warnings_of(scene, result);
  };
  EXPECT_EQ(count(warned(1.06, 0), {"tip", "'plate'", "peak-to-peak", "1.06"}), 1);
  EXPECT_EQ(count(warned(1.04, 0), {"peak-to-peak"}), 0);
  // For static plates the difference is due to rounding.
  EXPECT_EQ(count(warned(2e-13, 0, 1e-13), {"peak-to-peak"}), 0);
  EXPECT_EQ(count(warned(1, 0.011), {"time integration", "dissipates", "1.1 %"}), 1);
  EXPECT_EQ(count(warned(1, 0.009), {"time integration"}), 0);
  EXPECT_EQ(count(warned(1, -0.02), {"time integration", "adds", "2 %"}), 1);
  EXPECT_EQ(count(warned(1, -0.009), {"time integration"}), 0);
  const std::optional<PointVariation> tip = tip_variation(result.motions, "plate");
  ASSERT_TRUE(tip);
  EXPECT_NEAR(tip->rms_ratio(), 1, 1e-12);
  EXPECT_NEAR(tip->designed.mean / tip->uniform.mean, 0.2, 1e-12);
  EXPECT_FALSE(tip_variation(result.motions, "arm"));
}

// A warning is given for mesh changes that change the strain energy by more than a fraction of the
// largest strain energy of the motion; it contains the time and the value of the largest change.
TEST(Warnings, OfChangesOfTheMeshThatMoveStrainEnergy) {
  const Scene scene = read("rotating_plate_v01");
  const auto warned = [&](std::vector<double> moved) {
    RunResult result;
    result.motions.motion = swinging(0.1, 1);
    std::vector<double>& strain = result.motions.motion->table.values[2];
    std::fill(strain.begin(), strain.end(), 0.5);
    strain.back() = 2;
    for (size_t k = 0; k < moved.size(); ++k) {
      fem::MeshEvent event;
      event.time = 0.25 * static_cast<double>(k + 1);
      event.body = "plate";
      event.before.strain = 0.5;
      event.after.strain = 0.5 + moved[k];
      result.motions.motion->result.events.push_back(event);
    }
    return warnings_of(scene, result);
  };
  EXPECT_EQ(count(warned({}), {"mesh changes"}), 0);
  EXPECT_EQ(count(warned({0.099, -0.099}), {"mesh changes"}), 0);
  const std::vector<Warning> found = warned({0.05, -0.3, 0.2});
  EXPECT_EQ(count(found, {"mesh changes", "2 of 3", "2 J", "0.3 J", "t = 0.5 s", "'plate'"}), 1);
}

void expect_described(const std::vector<ColumnInfo>& columns, const std::string& name) {
  std::set<std::string> names;
  for (const ColumnInfo& c : columns) {
    EXPECT_TRUE(names.insert(c.name).second) << name << ": " << c.name << " twice";
    EXPECT_FALSE(c.unit.empty()) << name << ": " << c.name;
    EXPECT_GT(c.meaning.size(), 3u) << name << ": " << c.name;
  }
}

TEST(Columns, OfAllShippedCasesAreDescribed) {
  int motions = 0, paths = 0;
  for (const std::string& name : shipped_cases()) {
    const Scene scene = read(name);
    if (scene.domain) continue;
    if (scene.statics) {
      expect_described(path_columns(scene), name);
      ++paths;
      continue;
    }
    const Mechanism mechanism = build_mechanism(scene);
    expect_described(MotionColumns(scene, mechanism.moving_roots, true).columns(), name);
    // Without the energy balance only its columns are left out.
    const size_t fewer = MotionColumns(scene, mechanism.moving_roots, false).columns().size();
    EXPECT_LE(fewer, MotionColumns(scene, mechanism.moving_roots, true).columns().size()) << name;
    ++motions;
  }
  EXPECT_GT(motions, 10);
  EXPECT_GT(paths, 2);
}

// Where b is the ground, the columns of a joint are the force on body a.
TEST(Columns, OfForcesNameTheBody) {
  const auto meaning = [](const std::string& joint) {
    const Scene scene = read_scene(io::CaseFile::of_text(
        "gravity = [0.0, -9.81]\n[time]\nend = 1.0\nstep = 1e-2\n"
        "[[rigid_body]]\nname = \"rod\"\nmass = 1.0\nsize = [1.0, 0.1]\n[[joint]]\n"
        "type = \"revolute\"\nname = \"pin\"\n" +
            joint,
        "pendulum.toml", {}));
    const MotionColumns columns(scene, {}, true);
    for (const ColumnInfo& c : columns.columns())
      if (c.name == "pin.force_x") return c.meaning;
    return std::string();
  };
  for (const char* joint : {"a = \"rod\"\nb = \"ground\"\n", "a = \"ground\"\nb = \"rod\"\n"})
    EXPECT_NE(meaning(std::string(joint) + "point_a = [0.0, 0.0]\n").find("'rod'"),
              std::string::npos);
}

template <class Source>
void expect_quantities(std::span<const ResultQuantity<Source>> table) {
  std::set<std::string> names;
  for (const ResultQuantity<Source>& q : table) {
    EXPECT_TRUE(names.insert(q.name).second) << q.name << " twice";
    EXPECT_GT(std::string(q.meaning).size(), 3u) << q.name;
  }
}

TEST(Quantities, HaveNamesOfTheirOwnAndMeanings) {
  expect_quantities(design_quantities());
  expect_quantities(length_scale_quantities());
  expect_quantities(outline_quantities());
  expect_quantities(static_load_quantities());
  expect_quantities(load_difference_quantities());
  expect_quantities(point_quantities());
  expect_quantities(motion_quantities());
  expect_quantities(path_quantities());
  expect_quantities(cycle_quantities());
  expect_quantities(corrected_cycle_quantities());
  expect_quantities(certificate_quantities());
}

TEST(Values, AreJsonThatEveryReaderTakes) {
  EXPECT_EQ(json_of(2.5), nlohmann::ordered_json(2.5));
  EXPECT_EQ(json_of(true), nlohmann::ordered_json(true));
  EXPECT_EQ(json_of(INFINITY), nlohmann::ordered_json("infinite"));
  EXPECT_TRUE(json_of(NAN).is_null());
  EXPECT_TRUE(json_of(nullptr).is_null());
}

// If the compliance of an outline is infinite, there is neither an error nor a stress, and the load
// without support is named.
TEST(Quantities, OfAnOutlineDependOnItsVerification) {
  VerifiedOutline outline;
  outline.why_not = "its statics failed";
  std::map<std::string, Value> found;
  const auto read_all = [&] {
    for (const auto& q : outline_quantities()) found[q.name] = q.value(outline);
  };
  read_all();
  EXPECT_EQ(std::get<std::string>(found["not_verified"]), "its statics failed");
  EXPECT_TRUE(std::holds_alternative<std::monostate>(found["compliance"]));
  outline.verification.emplace();
  outline.verification->compliance = INFINITY;
  outline.verification->unsupported_load = "tip";
  read_all();
  EXPECT_EQ(std::get<std::string>(found["loose_load"]), "tip");
  EXPECT_TRUE(std::holds_alternative<std::monostate>(found["error"]));
  outline.verification->compliance = 3;
  read_all();
  EXPECT_TRUE(std::holds_alternative<std::monostate>(found["loose_load"]));
  EXPECT_EQ(std::get<double>(found["error"]), 0);
}

}  // namespace
}  // namespace flexmorph::cases
