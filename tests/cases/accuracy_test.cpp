// Shows that refinement series keep a time budget (with simulated run times), that the cheapest
// combinations of levels agree with an enumeration by hand, and that values of columns are
// interpolated exactly.

#include "cases/accuracy/accuracy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "cases/accuracy/recommendation.h"
#include "cases/accuracy/report.h"
#include "cases/assembly/resource_estimate.h"
#include "cases/check/ready.h"
#include "io/tables.h"
#include "tests/cases/program.h"

namespace flexmorph::cases {
namespace {

using test::Ended;
using test::Words;

const std::vector<double> kHalves = {4, 2, 1, 0.5, 0.25};

TEST(Duration, IsReadWithItsUnit) {
  EXPECT_EQ(read_duration("--budget", "120s"), 120);
  EXPECT_EQ(read_duration("--budget", "90"), 90);
  EXPECT_EQ(read_duration("--budget", "2min"), 120);
  EXPECT_EQ(read_duration("--budget", "1.5h"), 5400);
  EXPECT_EQ(read_duration("--budget", "30d"), 30 * 24 * 3600);
  for (const char* bad : {"", "s", "-1s", "0", "1,5s", "2 days", "inf", "nan"})
    EXPECT_THROW(read_duration("--budget", bad), Error) << bad;
}

/// Refinement series whose runs take prescribed times.
struct Runs {
  double spent = 0;
  std::vector<Parameter> parameters;
  std::vector<RefinementSeries> series;
  std::vector<std::pair<size_t, size_t>> ran;

  Runs() { parameters.reserve(2); }
  void add(const std::vector<double>& h, double cost_exponent) {
    parameters.push_back({"a", "a", Approach::power, cost_exponent});
    RefinementSeries& s = series.emplace_back();
    s.parameter = &parameters.back();
    s.first_guess = 1;
    for (const double each : h) s.levels.emplace_back().level.h = each;
  }
  /// Runs levels until the budget is spent. @param seconds  run time [s] as a function of the index
  /// of the series and of h
  template <class Time>
  void go(double budget, const Time& seconds) {
    while (const auto next = next_level(series, std::max(0.0, budget - spent))) {
      LevelRun& run = series[next->first].levels[next->second];
      run.seconds_cpu = seconds(next->first, run.level.h);
      run.status = "measured";
      spent += run.seconds_cpu;
      ran.push_back(*next);
    }
  }
  bool is_cut(size_t s, size_t level) const { return series[s].levels[level].status == "cut"; }
};

TEST(Budget, CoarseLevelsFirstAndTheLadderIsCut) {
  Runs runs;
  runs.add({4, 2, 1, 0.5, 0.25, 0.125}, 1);
  runs.add({2, 1, 0.5, 0.25}, 3);
  // A level of series 0 takes 1/h: 0.25, 0.5, 1, 2, 4, 8 s. A level of series 1 takes h^-3: 0.125,
  // 1, 8, 64 s.
  const auto seconds = [](size_t t, double h) { return std::pow(h, t == 0 ? -1 : -3); };
  runs.go(10, seconds);
  // The levels that were run take 0.125 + 0.25 + 0.5 + 1 + 1 + 2 + 4 = 8.875 s. The next level of
  // either series takes 8 s, which exceeds the budget of 10 s.
  EXPECT_EQ(runs.spent, 8.875);
  EXPECT_EQ(runs.ran.front(), (std::pair<size_t, size_t>{1, 0}));
  EXPECT_TRUE(runs.is_cut(1, 2) && runs.is_cut(1, 3) && runs.is_cut(0, 5));
  EXPECT_EQ(runs.series[0].count("cut") + runs.series[1].count("cut"), 3U);
  for (size_t t = 0; t < 2; ++t)  // The levels of each series are run from coarse to fine.
    for (size_t i = 1; i < runs.ran.size(); ++i)
      for (size_t j = 0; j < i; ++j)
        if (runs.ran[i].first == t && runs.ran[j].first == t) {
          EXPECT_LT(runs.ran[j].second, runs.ran[i].second);
        }
}

TEST(Budget, IsKeptWhenTimesGrowFasterThanThought) {
  Runs runs;
  runs.add({8, 4, 2, 1, 0.5, 0.25}, 1);
  const auto seconds = [](size_t, double h) { return std::pow(h, -1.9); };
  runs.go(18, seconds);
  // Five levels take 0.02 + 0.07 + 0.27 + 1 + 3.7 s. The sixth would take 14 s, which is predicted
  // from the measured growth of the run times.
  EXPECT_EQ(runs.ran.size(), 5U);
  EXPECT_LT(runs.spent, 18);
  EXPECT_NEAR(runs.series[0].seconds(5), std::pow(0.25, -1.9), 1e-9);
}

TEST(Budget, WithoutTimeNothingRuns) {
  Runs runs;
  runs.add({2, 1, 0.5}, 1);
  runs.go(0.1, [](size_t, double h) { return 1 / h; });
  EXPECT_TRUE(runs.ran.empty());
  EXPECT_EQ(runs.series[0].count("cut"), 3U);
}

TEST(ParetoFront, KeepsWhatNothingBeats) {
  const std::vector<std::pair<double, double>> points = {{3, 1}, {1, 4},   {2, 4},  {2, 2},
                                                         {4, 1}, {NAN, 0}, {2.5, 3}};
  EXPECT_EQ(pareto_front(points), (std::vector<size_t>{1, 3, 0}));
  EXPECT_TRUE(pareto_front({}).empty());
}

Candidate candidate(double error, double cost) { return {"", {}, {error}, {cost}}; }

TEST(Cheapest, SplitsTheTargetOverTheParameters) {
  const std::vector<Group> groups = {
      {"a", {candidate(8e-3, 0.1), candidate(4e-3, 0.3), candidate(1e-3, 1), candidate(1e-4, 9)}},
      {"b", {candidate(5e-3, 0.5), candidate(1e-3, 1), candidate(2e-4, 2)}}};
  const std::vector<double> base = {10}, sure = {0};
  // Target error 1 %: the errors 8e-3 + 1e-3 at a cost of 0.1 x 1 beat 4e-3 + 5e-3 at 0.3 x 0.5.
  const auto loose = cheapest(groups, base, sure, 1e-2);
  ASSERT_TRUE(loose);
  EXPECT_EQ(loose->picked, (std::vector<size_t>{0, 1}));
  EXPECT_NEAR(loose->cost, 1, 1e-12);
  EXPECT_NEAR(loose->errors[0], 9e-3, 1e-15);
  EXPECT_EQ(cheapest(groups, base, sure, 1.25e-3)->picked, (std::vector<size_t>{2, 2}));
  EXPECT_FALSE(cheapest(groups, base, sure, 1e-4));
  // The uncertainty of the limits is counted as part of the error.
  const std::vector<double> unsure = {9.5e-4};
  EXPECT_EQ(cheapest(groups, base, unsure, 1.26e-3)->picked, (std::vector<size_t>{3, 2}));
  const std::vector<double> unknown = {INFINITY};
  EXPECT_FALSE(cheapest(groups, base, unknown, 1e-2));
}

TEST(Cheapest, PassesOverWhatIsNotKnownAndKeepsAllQuantities) {
  const auto two = [](double e1, double e2, double cost) {
    return Candidate{"", {}, {e1, e2}, {cost, 1}};
  };
  const std::vector<Group> groups = {
      {"a", {two(1e-3, NAN, 0.01), two(1e-3, 2e-2, 0.1), two(2e-3, 5e-3, 0.5)}}};
  const std::vector<double> base = {4, 1}, sure = {0, 0};
  const auto best = cheapest(groups, base, sure, 1e-2);
  ASSERT_TRUE(best);
  EXPECT_EQ(best->picked, (std::vector<size_t>{2}));
  EXPECT_EQ(best->cost, 3);  // The first part costs 0.5 x 4; the second keeps its cost of 1.
}

TEST(ValueAt, InterpolatesColumns) {
  std::vector<double> x, y;
  for (int i = 0; i <= 10; ++i) x.push_back(0.1 * i + 0.01 * (i % 2));
  for (const double t : x) y.push_back(1 + t - 2 * t * t + t * t * t);
  Interest interest;
  EXPECT_EQ(value_at(x, y, interest), y.back());
  interest.at = Interest::At::time;
  for (const double t : {0.0, 0.05, 0.433, 0.97, 1.0}) {
    interest.time = t;  // Cubic interpolation is exact for this cubic polynomial.
    EXPECT_NEAR(value_at(x, y, interest), 1 + t - 2 * t * t + t * t * t, 1e-14);
  }
  interest.time = 1.2;
  EXPECT_TRUE(std::isnan(value_at(x, y, interest)));
  // The largest magnitude, 3 at t = 0.52, lies between two rows: y = -3 + 5 (t - 0.52)².
  for (size_t i = 0; i < x.size(); ++i) y[i] = -3 + 5 * std::pow(x[i] - 0.52, 2);
  interest.at = Interest::At::max;
  EXPECT_NEAR(value_at(x, y, interest), 3, 1e-14);
}

// Returns a study whose errors are known: Q = 1 + 0.02 h² + 0.1 g⁴ for the time step h and the mesh
// size g.
AccuracyStudy known_study() {
  AccuracyStudy study;
  study.interests.emplace_back().name = "q";
  study.parts = {Part::motion};
  const auto value = [](double h, double g) { return 1 + 0.02 * h * h + 0.1 * std::pow(g, 4); };
  LevelRun own;
  own.status = "measured";
  own.values = {value(1, 1)};
  own.seconds_cpu = 1;
  study.own[Part::motion] = own;
  for (const bool mesh : {true, false}) {
    RefinementSeries& series = study.series.emplace_back();
    series.parameter = &parameter(mesh ? "elements" : "step");
    series.theories = {Theory{mesh ? 4.0 : 2.0, ""}};
    for (const double h : kHalves) {
      LevelRun& run = series.levels.emplace_back();
      run.level.h = h;
      run.level.name = std::to_string(h);
      if (h != 1) run.level.overrides = {(mesh ? "g=" : "h=") + std::to_string(h)};
      run.status = "measured";
      run.seconds_cpu = std::pow(h, mesh ? -3 : -1);
      run.values = {mesh ? value(1, h) : value(h, 1)};
    }
  }
  study.references = {1.0};
  evaluate(study);
  return study;
}

TEST(Study, AddsWhatIsMissingToTheLimits) {
  const AccuracyStudy study = known_study();
  const Estimate& estimate = study.estimates[0];
  // The case itself has 1.12; the limit is this value minus both error terms.
  EXPECT_NEAR(estimate.value, 1, 1e-9);
  EXPECT_LT(estimate.uncertainty, 1e-9);
  for (const RefinementSeries& series : study.series)
    for (const LevelRun& run : series.levels) {
      const bool mesh = series.parameter->name == "elements";
      // Errors refer to the limit of their own series, therefore the error of the other parameter
      // is not included.
      const double error = mesh ? 0.1 * std::pow(run.level.h, 4) : 0.02 * std::pow(run.level.h, 2);
      EXPECT_NEAR(run.errors[0], error / 1.12, 1e-9);
    }
}

TEST(Study, RecommendsWhatReachesTheTargetAndWithdrawsWhatDoesNot) {
  const AccuracyStudy study = known_study();
  const std::vector<Recommendation> all = {recommend(study, 1e-2), recommend(study, 1e-5)};
  ASSERT_FALSE(all[0].names.empty());
  // By hand: mesh 1/2 (0.56 %, 8 s) with step 1/2 (0.45 %, factor 2) exceeds 1 % in sum. Mesh 1/2
  // with step 1/4 (0.11 %, factor 4) and mesh 1/4 (0.03 %, 64 s) with step 1/2 are below 1 %; the
  // first one is cheaper.
  EXPECT_EQ(all[0].overrides, (Words{"g=0.500000", "h=0.250000"}));
  EXPECT_NEAR(all[0].seconds, 32, 1e-9);
  EXPECT_TRUE(all[1].names.empty());
  EXPECT_FALSE(all[1].sentence.empty());
  // With the share 0.3 the sum of errors must be below 0.3 %: mesh 1/4 (0.03 %) with step 1/4 (0.11
  // %) is the cheapest.
  const Recommendation careful = recommend(study, 1e-2, 0.3);
  ASSERT_FALSE(careful.names.empty());
  EXPECT_EQ(careful.overrides, (Words{"g=0.250000", "h=0.250000"}));
  Recommendation kept = all[0];
  verify(study, {1 + 0.02 / 16 + 0.1 / 16}, 1, kept);
  EXPECT_FALSE(kept.withdrawn) << kept.sentence;
  for (const double wrong : {1.02, std::nan("")}) {
    Recommendation broken = all[0];
    verify(study, {wrong}, 1, broken);
    EXPECT_TRUE(broken.withdrawn);
    EXPECT_NE(broken.sentence.find("withdrawn"), std::string::npos);
  }
}

TEST(Study, ASeriesThatIsNotConvergedOffersItsFinestLevel) {
  AccuracyStudy study = known_study();
  // The order of the step is 1.3 instead of the expected 2.
  for (LevelRun& run : study.series[1].levels)
    run.values[0] = 1.1 + 0.02 * std::pow(run.level.h, 1.3);
  evaluate(study);
  EXPECT_FALSE(study.series[1].limits[0].converged);
  // Coarser levels are candidates only if the uncertainty of the limit is at most a tenth of the
  // target error.
  const double unsure = study.series[1].limits[0].uncertainty / study.estimates[0].scale;
  for (const double target : {9 * unsure, 11 * unsure})
    for (const Group& group : groups_of(study, target)) {
      size_t usable = 0;
      for (const Candidate& c : group.candidates) usable += std::isfinite(c.errors[0]);
      EXPECT_EQ(usable, group.name == "step" && target < 10 * unsure ? 1U : 5U) << group.name;
    }
}

// Nothing is recommended for a quantity that has no limit under refinement.
TEST(Study, ATargetLeavesOutWhatHasNoLimit) {
  AccuracyStudy study = known_study();
  for (RefinementSeries& series : study.series) series.theories = {Theory{0, "a point load"}};
  evaluate(study);
  EXPECT_FALSE(study.estimates[0].has_limit);
  const Recommendation r = recommend(study, 1e-2);
  EXPECT_TRUE(r.names.empty());
  EXPECT_NE(r.sentence.find("limit"), std::string::npos);
}

TEST(Parameters, AreThoseOfTheScene) {
  const auto present = [](const std::string& name, Part part) {
    const Scene scene = read_scene(io::CaseFile(find_case(name)));
    Words out;
    for (const Parameter& each : parameters())
      if (each.absent(scene, part).empty()) out.push_back(each.name);
    return out;
  };
  EXPECT_EQ(
      present("plate_pendulum", Part::motion),
      (Words{"elements", "shape", "step", "adaptive", "rho_inf", "integrator", "quadrature"}));
  EXPECT_EQ(present("square_plate_twist", Part::motion),
            (Words{"elements", "shape", "quadrature", "load_steps"}));
  EXPECT_EQ(present("slider_crank_heated", Part::motion),
            (Words{"elements", "model", "step", "adaptive", "minimal_coordinates", "rho_inf",
                   "integrator"}));
  EXPECT_EQ(present("short_beam", Part::design),
            (Words{"design_mesh", "void", "sharpness", "band"}));
  EXPECT_EQ(present("four_bar", Part::design),
            (Words{"elements", "step", "loads", "design_mesh", "void", "sharpness", "band"}));
}

// "energy_momentum" needs mean forces, which linear springs have and torsion springs do not have.
TEST(Parameters, IntegratorsThatForceElementsSupport) {
  const auto reason = [](const std::string& spring) {
    const std::vector<std::string> change = {"spring=[{" + spring + "}]"};
    const Scene scene = read_scene(io::CaseFile(find_case("four_bar"), change));
    return parameter("integrator").absent(scene, Part::motion);
  };
  EXPECT_EQ(
      reason("type='linear', name='s', a='ground', point_a=[0.0, 0.0], b='shaft', stiffness=1.0"),
      "");
  EXPECT_NE(reason("type='torsion', name='s', b='shaft', stiffness=1.0").find("energy_momentum"),
            std::string::npos);
}

TEST(Parameters, LevelsOfOneParameterLeaveTheOthersAlone) {
  const io::CaseFile file(find_case("short_beam"));
  const Scene scene = read_scene(file);
  const std::vector<Level> levels = parameter("design_mesh").levels(scene, file);
  ASSERT_GE(levels.size(), 3u);
  for (const Level& level : levels) {
    const Scene finer = read_scene(io::CaseFile(find_case("short_beam"), level.overrides));
    const BodyDesign &a = scene.designs[0], &b = finer.designs[0];
    EXPECT_NEAR(b.grid.dx(), level.h * a.grid.dx(), 1e-12);
    EXPECT_NEAR(b.tdf.band, level.h * a.tdf.band, 1e-12);  // The band has as many cells as before.
    EXPECT_NEAR(b.tdf.sharpness, a.tdf.sharpness / level.h, 1e-9);
    EXPECT_EQ(b.min_thickness, a.min_thickness);
  }
}

// Every shipped case declares its measured quantities with at least three refinement series. A case
// of rigid bodies only has no mesh and needs two.
TEST(Parameters, OfShippedCases) {
  for (const std::string& name_of_case : shipped_cases()) {
    const PreparedCase prepared(read_scene(io::CaseFile(find_case(name_of_case))));
    const Scene& scene = prepared.scene();
    ASSERT_TRUE(scene.accuracy) << name_of_case;
    size_t refinements = 0;
    for (const std::string& name : scene.accuracy->refinements) {
      bool present = false;
      for (const Interest& interest : scene.accuracy->quantities)
        present = present || parameter(name).absent(scene, part_of(prepared, interest)).empty();
      EXPECT_TRUE(present) << name_of_case << ": " << name;
      refinements += present;
    }
    const bool has_mesh = scene.domain || !scene.bodies.empty();
    EXPECT_GE(refinements, has_mesh ? 3U : 2U) << name_of_case;
  }
}

// The series `model` replaces the beam model by the terms "ecm" and "inertia"; the elements of a
// beam are given by one number.
TEST(Parameters, ModelsOfBeams) {
  const std::string name = "slider_crank_heated";
  const io::CaseFile file(find_case(name));
  const Scene scene = read_scene(file);
  const std::vector<Level> levels = parameter("model").levels(scene, file);
  ASSERT_GE(levels.size(), 1u);
  for (const Level& level : levels) {
    const Scene other = read_scene(io::CaseFile(find_case(name), level.overrides));
    const std::set<std::string> terms(other.bodies[0].terms.begin(), other.bodies[0].terms.end());
    EXPECT_EQ(terms, (std::set<std::string>{"ecm", "inertia"}));
    EXPECT_NEAR(other.bodies[0].elements[0] * level.h, scene.bodies[0].elements[0], 1e-9);
  }
}

// Every level of `adaptive` is a readable case whose tolerance is smaller than that of the level
// before; every level of `minimal_coordinates` is a readable case that selects this integrator.
TEST(Parameters, StepsThatAdapt) {
  const std::string name = "slider_crank_heated";
  const io::CaseFile file(find_case(name));
  const Scene scene = read_scene(file);
  double last = 1;
  const std::vector<Level> adaptive = parameter("adaptive").levels(scene, file);
  ASSERT_GE(adaptive.size(), 3u);
  for (const Level& level : adaptive) {
    const Scene other = read_scene(io::CaseFile(find_case(name), level.overrides));
    ASSERT_TRUE(other.time.tolerance.has_value());
    EXPECT_LT(*other.time.tolerance, last);
    last = *other.time.tolerance;
  }
  const std::vector<Level> minimal = parameter("minimal_coordinates").levels(scene, file);
  ASSERT_GE(minimal.size(), 1u);
  for (const Level& level : minimal)
    EXPECT_EQ(read_scene(io::CaseFile(find_case(name), level.overrides)).time.integrator,
              "minimal_coordinates");
}

}  // namespace
}  // namespace flexmorph::cases
