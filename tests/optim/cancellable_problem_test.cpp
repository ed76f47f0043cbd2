// Shows that a cancelled problem is no longer evaluated, whatever the optimizer does, and that the
// best design so far is returned.
#include "optim/cancellable_problem.h"

#include <gtest/gtest.h>

#include <cmath>

#include "optim/optimizer.h"
#include "tests/optim/problems.h"

namespace flexmorph::optim::test {
namespace {

class EveryCancelled : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Cancelled, EveryCancelled, ::testing::ValuesIn(optimizer_names()),
                         [](const auto& info) { return info.param; });

TEST_P(EveryCancelled, EvaluatesNoFurtherDesigns) {
  for (const int last : {1, 2, 7}) {
    Analytic problem = cantilever();
    CancellableProblem cancellable(problem, [&] { return problem.evaluations < last; });
    Settings settings;
    settings.name = GetParam();
    const Result result = make_optimizer(settings)->minimize(cancellable, {});
    EXPECT_EQ(problem.evaluations, last);
    EXPECT_TRUE(std::isfinite(result.response.f));
    EXPECT_EQ(result.x.size(), problem.n_variables());
  }
}

}  // namespace
}  // namespace flexmorph::optim::test
