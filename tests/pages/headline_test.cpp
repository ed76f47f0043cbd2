// Shows that the verdict on a design and the sentence below it agree, for every kind of verdict.
#include "cases/output/headline.h"

#include <gtest/gtest.h>

#include "cases/scene/scene.h"
#include "tests/io/scratch.h"

namespace flexmorph::cases {
namespace {

using Kind = optim::Verdict::Kind;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Returns the verdict at the top of the page of a run with one design.
PageFact verdict_of(Kind kind, const std::string& stop, const std::string& status, int cycles) {
  const Scratch scratch;
  const std::vector<std::string> changes = {"cycle.max_cycles=6"};
  const Scene scene = read_scene(io::CaseFile(FLEXMORPH_SHORT_CASE, changes));
  RunFolder folder(scratch / "out", scene);
  RunResult result;
  result.info.status = status;
  result.design.cycles = cycles;
  mmc::BodyOutcome& outcome = result.design.outcomes.emplace_back();
  outcome.body = "plate";
  outcome.verdict = {kind, 2e-3, 0.01};
  outcome.stop = stop;
  return headline(scene, result, folder).front();
}

TEST(Headline, VerdictsAndTheirSentencesAgree) {
  const std::string change = "small change: the objective changed by 3.7e-04 over 15 iterations";
  struct Case {
    Kind kind;
    std::string stop, status, value;
  };
  const Case cases[] = {
      {Kind::unfinished, change, "done", "unfinished"},
      {Kind::unfinished, "iteration limit: 300 iterations", "done", "unfinished"},
      {Kind::unfinished, "interrupted after 12 iterations", "interrupted", "unfinished"},
      {Kind::stagnated, "plateau: " + optim::plateau_text(), "done", "stagnated"},
      {Kind::converged, "converged: KKT residual 9.1e-05", "done", "converged"},
      {Kind::evaluated, "evaluated: the design was not optimized", "done", "evaluated"}};
  for (const Case& c : cases) {
    const PageFact fact = verdict_of(c.kind, c.stop, c.status, 2);
    EXPECT_EQ(fact.value, c.value);
    const bool finished = c.kind == Kind::stagnated || c.kind == Kind::converged;
    EXPECT_EQ(contains(fact.note, "is finished"), finished) << fact.note;
    EXPECT_EQ(contains(fact.note, "converged"), c.kind == Kind::converged) << fact.note;
    const bool optimized = c.kind != Kind::evaluated;
    EXPECT_EQ(contains(fact.note, c.stop), c.kind == Kind::unfinished) << fact.note;
    EXPECT_EQ(contains(fact.note, "cycle"), optimized) << fact.note;
  }
}

}  // namespace
}  // namespace flexmorph::cases
