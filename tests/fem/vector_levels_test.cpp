// Shows that the vector kernels for all instruction sets of this processor give the same forces and
// tangents to round-off.
#include <gtest/gtest.h>

#include "fem/elements/ancf_plate.h"
#include "fem/model/workspace.h"
#include "fem/terms.h"
#include "geometry/vector_limit.h"
#include "tests/support/models.h"

namespace flexmorph::fem {
namespace {

/// Restores the vector level of the processor at the end of a test.
struct AllLevels {
  ~AllLevels() { limit_vector_level(VectorLevel::v4); }
};

class EveryLevel : public ::testing::TestWithParam<std::tuple<int, const char*>> {};

TEST_P(EveryLevel, GivesTheSameForcesAndTangents) {
  const auto [dim, membrane] = GetParam();
  const PlaneSection section{0.01, 1e8, 0.3, 2700};
  std::vector<std::string> names{"inertia", membrane};
  if (dim == 3) names.emplace_back("bending");
  Workspace model;
  model.add_body(
      "plate",
      std::make_unique<AncfPlate>(dim, AncfPlate::ShapeSet::h16, testing::uniform_lines(0, 1, 5),
                                  testing::uniform_lines(0, 0.3, 2)),
      section, make_terms(names, section, {}));
  State x = model.reference();
  x.q += 0.02 * VectorXd::Random(x.q.size()).cwiseQuotient(model.scales());
  x.v = VectorXd::Random(x.q.size());
  x.a = VectorXd::Random(x.q.size());
  const AllLevels afterwards;
  VectorXd first;
  SparseMatrix first_tangent;
  for (const VectorLevel level : {VectorLevel::baseline, VectorLevel::v3, VectorLevel::v4}) {
    limit_vector_level(level);
    EXPECT_LE(vector_level(), level);
    VectorXd force;
    SparseMatrix tangent;
    Constraints none;
    model.force(x, force);
    model.constraints(x, none);
    model.kkt(x, none, {1, 10, 100}, 1, tangent);
    if (first.size() == 0) first = force, first_tangent = tangent;
    ASSERT_GT(first.norm(), 0);
    EXPECT_LT((force - first).norm(), 1e-12 * first.norm());  // sums of some hundred products
    EXPECT_LT((tangent - first_tangent).norm(), 1e-12 * first_tangent.norm());
  }
}

INSTANTIATE_TEST_SUITE_P(VectorLevels, EveryLevel,
                         ::testing::Combine(::testing::Values(2, 3),
                                            ::testing::Values("membrane", "membrane_assumed")));

}  // namespace
}  // namespace flexmorph::fem
