// Shows that energies, forces and the powers of the balance are consistent: for any motion, a
// solution or not,
//
//   d(T + U + V)/dt = (M q̈ + F) · q̇ + feed + inflow,
//
// with material that flows through driven and free lines at the root and inside, with uniform
// material and varying scale factors, for every term. The flow of energy through a line is the
// energy density of the term.
#include "fem/dynamics/balance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fem/loads.h"
#include "fem/terms.h"
#include "tests/support/energy_rate.h"
#include "tests/support/models.h"
#include "tests/support/space_plates.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::ShapeSet;
using testing::swinging_line;

const PlaneSection kSofterSection{0.01, 1e6, 0.3, 2700};

/// Returns lines at 0.1, 0.21, 0.3 and 0.45 m: d driven, f free, | fixed.
std::vector<MaterialLine> lines(const std::string& kinds) {
  const double at[] = {0.1, 0.21, 0.3, 0.45};
  std::vector<MaterialLine> out;
  for (size_t i = 0; i < kinds.size(); ++i)
    out.push_back(kinds[i] == 'd' ? swinging_line(at[i], 0.02, 1.3 + 0.4 * static_cast<double>(i))
                                  : MaterialLine{at[i], {}, kinds[i] == 'f'});
  return out;
}

struct MovingTerms {
  std::string lines;
  std::string terms;  ///< the letters m, a, b, i, g, s select terms in model_of()
  bool designed = false;
  ShapeSet shapes = ShapeSet::h16;
  int dim = 3;
};
void PrintTo(const MovingTerms& c, std::ostream* out) {
  *out << c.lines << ' ' << c.terms << (c.designed ? " designed" : "")
       << (c.shapes == ShapeSet::h12 ? " h12" : "") << ' ' << c.dim << 'd';
}

Workspace model_of(const MovingTerms& c) {
  VectorXd load = VectorXd::LinSpaced(c.dim, 3, 5);
  std::vector<std::unique_ptr<Term>> terms;
  for (const char term : c.terms) {
    if (term == 'm') terms.push_back(make_membrane(kSofterSection));
    if (term == 'a') terms.push_back(make_assumed_membrane(kSofterSection));
    // With this number of points the quadrature error of the rational bending energy is negligible.
    if (term == 'b') terms.push_back(make_bending(kSofterSection, c.designed ? 8 : 15));
    if (term == 'i') terms.push_back(make_inertia(kSofterSection));
    if (term == 'g') terms.push_back(make_gravity(kSofterSection, load));
    if (term == 's') terms.push_back(make_surface_load(2 * load));
  }
  Workspace model;
  Body& body = model.add_body("plate",
                              std::make_unique<AncfPlate>(c.dim, c.shapes, lines(c.lines),
                                                          testing::uniform_lines(-0.05, 0.07, 2)),
                              kSofterSection, std::move(terms));
  if (c.designed) model.set_factors(body, testing::random_factors(5));
  return model;
}

class AnyMotion : public ::testing::TestWithParam<MovingTerms> {};

TEST_P(AnyMotion, ChangesTheEnergyByThePowers) {
  Workspace model = model_of(GetParam());
  const testing::SmoothMotion motion = testing::any_motion(model);
  for (const double time : {0.3, 0.9}) {
    const auto [rate, work, p] = testing::energy_rate(model, motion, time);
    EXPECT_NEAR(work + p.total(), rate, 1e-8 * (std::abs(work) + std::abs(p.feed)));
    // A free root with strain energy only has no power, because its motion is an unknown.
    if (GetParam().lines == "f|||" && GetParam().terms == "mb")
      EXPECT_EQ(p.total(), 0);
    else
      EXPECT_GT(std::abs(p.feed) + std::abs(p.inflow), 1e-4 * std::abs(rate));
  }
}
INSTANTIATE_TEST_SUITE_P(
    Scenes, AnyMotion,
    ::testing::Values(
        // Driven root: each term alone, then several together.
        MovingTerms{"d|||", "m"}, MovingTerms{"d|||", "a"}, MovingTerms{"d|||", "b"},
        MovingTerms{"d|||", "i"}, MovingTerms{"d|||", "g"}, MovingTerms{"d|||", "s"},
        MovingTerms{"d|||", "abigs"}, MovingTerms{"d|||", "mbig", false, ShapeSet::h12},
        MovingTerms{"d|||", "migs", false, ShapeSet::h16, 2},
        // A moving end, and moving inner lines, where the bending strain is
        // discontinuous.
        MovingTerms{"|||d", "abig"}, MovingTerms{"dd|d", "mbig"},
        // Free lines: the root, several lines, and a line next to driven ones.
        MovingTerms{"f|||", "mb"}, MovingTerms{"f|||", "i"}, MovingTerms{"f|||", "g"},
        MovingTerms{"f|||", "mbig"}, MovingTerms{"f|||", "mig", false, ShapeSet::h12, 2},
        MovingTerms{"f|ff", "mbig"}, MovingTerms{"df|d", "mbig"}));
// With varying scale factors the strain energy at the root jumps when the boundary of a cell
// passes; therefore the differences remain inside a cell.
INSTANTIATE_TEST_SUITE_P(Designed, AnyMotion,
                         ::testing::Values(MovingTerms{"d|||", "m", true},
                                           MovingTerms{"d|||", "a", true},
                                           MovingTerms{"d|||", "b", true},
                                           MovingTerms{"d|||", "ig", true},
                                           MovingTerms{"d|||", "migs", true, ShapeSet::h12, 2}));

// Membrane strains are continuous across a moving inner n-line; therefore the flow power alone
// closes the energy balance there.
TEST(FlowPower, OfMembranesIsThatOfAnInnerNLine) {
  for (const bool assumed : {false, true}) {
    std::vector<std::unique_ptr<Term>> terms;
    terms.push_back(assumed ? make_assumed_membrane(kSofterSection)
                            : make_membrane(kSofterSection));
    auto across = testing::uniform_lines(-0.05, 0.07, 2);
    across[1] = swinging_line(0.01, 0.02, 1.7);
    Workspace model;
    model.add_body("plate", std::make_unique<AncfPlate>(3, ShapeSet::h16, lines("|d|"), across),
                   kSofterSection, std::move(terms));
    model.prepare(0.0);
    const State rest = model.reference();
    const testing::SmoothMotion motion(rest.q, 0.02 * model.scales().cwiseInverse(), 7);
    const auto state = [&](double t) {
      const State x = motion.state(t);
      model.prepare(x);
      return x;
    };
    const double rate =
        first_difference([&](double dt) { return model.energies(state(0.3 + dt)).strain; }, 1e-3);
    const State x = state(0.3);
    VectorXd force;
    model.force(x, force);
    const double work = force.dot(x.v), feed = model.flow_power(x);
    EXPECT_NEAR(work + feed, rate, 1e-8 * (std::abs(work) + std::abs(feed)));
    EXPECT_GT(std::abs(feed), 1e-3 * std::abs(rate));
  }
}

TEST(Powers, RefuseNLinesThatMove) {
  Workspace model;
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_membrane(kSofterSection));
  auto across = testing::uniform_lines(-0.05, 0.07, 1);
  across[0] = swinging_line(-0.05, 0.01, 1);
  model.add_body("plate", std::make_unique<AncfPlate>(2, ShapeSet::h16, lines("||||"), across),
                 kSofterSection, std::move(terms));
  model.prepare(0.3);
  State x = model.reference();
  x.t = 0.3;
  EXPECT_THROW(powers(model, x), Error);
}

}  // namespace
}  // namespace flexmorph::fem
