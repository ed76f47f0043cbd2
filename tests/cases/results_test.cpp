// Shows that tables of results find their columns, that integrals over them are those of the
// trapezoidal rule, and that everything a run writes has a name of its own, a unit and a meaning.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "cases/check/ready.h"
#include "cases/results/motion_columns.h"
#include "cases/results/schema.h"
#include "tests/cases/scenes.h"

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

// ∫ (2 + 3 t) dt from 0 to 2 = 10: the trapezoidal rule is exact for it, on any steps.
TEST(MotionRecord, IntegratesTheStrainEnergy) {
  MotionRecord record;
  record.table = Series({{kTimeColumn, "s", "time", ColumnGroup::abscissa},
                         {kStrainColumn, "J", "strain energy", ColumnGroup::energy}});
  for (const double t : {0.0, 0.1, 0.7, 0.75, 2.0})
    record.table.add_row(std::vector<double>{t, 2 + 3 * t});
  EXPECT_NEAR(record.strain_integral(), 10, 1e-14);
  EXPECT_FALSE(record.amplitude("arm"));
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
    expect_described(MotionColumns(scene, mechanism.growths, true).columns(), name);
    // Without the energy balance its columns are left out, and no other ones.
    const size_t fewer = MotionColumns(scene, mechanism.growths, false).columns().size();
    EXPECT_LE(fewer, MotionColumns(scene, mechanism.growths, true).columns().size()) << name;
    ++motions;
  }
  EXPECT_GT(motions, 10);
  EXPECT_GT(paths, 2);
}

template <class Source>
void expect_quantities(std::span<const Quantity<Source>> table) {
  std::set<std::string> names;
  for (const Quantity<Source>& q : table) {
    EXPECT_TRUE(names.insert(q.name).second) << q.name << " twice";
    EXPECT_GT(std::string(q.meaning).size(), 3u) << q.name;
  }
}

TEST(Quantities, HaveNamesOfTheirOwnAndMeanings) {
  expect_quantities(design_quantities());
  expect_quantities(clean_up_quantities());
  expect_quantities(outline_quantities());
  expect_quantities(energy_quantities());
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

// An outline with an infinite compliance has no error, no stress and names its loose load.
TEST(Quantities, OfAnOutlineDependOnItsVerification) {
  VerifiedOutline outline;
  outline.why_not = "its statics failed";
  std::map<std::string, Value> found;
  const auto read_all = [&] {
    for (const auto& q : outline_quantities()) found[q.name] = q.value(outline);
  };
  read_all();
  EXPECT_EQ(std::get<std::string>(found["not_judged"]), "its statics failed");
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
