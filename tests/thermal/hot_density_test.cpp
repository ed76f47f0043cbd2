// Shows that terms of hot bodies equal their densities: for every elastic row the heated closed
// form has the forces, tangents, energies and powers of the heated density.
#include <gtest/gtest.h>

#include <cmath>

#include "fem/model/body_term.h"
#include "fem/terms/density_term.h"
#include "tests/support/sections.h"
#include "tests/thermal/hot_models.h"

namespace flexmorph::fem {
namespace {

TEST(HotRows, AreTheirDensities) {
  for (const TermRow* row : term_rows()) {
    if (!row->elastic) continue;
    for (const TermDomain domain : row->domains) {
      const auto element = testing::element_in(domain);
      const BodyTerm closed =
          make_heated(make_term(row->name, kSoftSection), testing::moving_heat());
      const BodyTerm generic =
          make_heated(make_elastic_term(row->name, row->elastic({kSoftSection, {}, {}})),
                      testing::moving_heat());
      const Local x = testing::state_of(*element, 1);
      VectorXd force[2];
      LocalTangent tangent[2];
      double energy[2], power[2];
      int i = 0;
      for (const BodyTerm* of : {&closed, &generic}) {
        const BodyTerm& term = *of;
        term.heated->heat_to(0.4);
        term->prepare(*element, {}, true);
        force[i] = testing::force_of(*term, 1, x);
        tangent[i].setZero(x.q.size(), x.q.size());
        term->add_tangent(1, x, {1, 0, 0}, tangent[i]);
        energy[i] = term->strain_energy(1, x);
        power[i++] = term.heated->heat_power(1, x);
      }
      const auto largest = [](const auto& m) { return m.template lpNorm<Eigen::Infinity>(); };
      EXPECT_LT(largest((force[1] - force[0]).eval()), 1e-12 * largest(force[0])) << row->name;
      EXPECT_LT(largest((tangent[1] - tangent[0]).eval()), 1e-10 * largest(tangent[0]))
          << row->name;
      EXPECT_NEAR(energy[1] / energy[0], 1, 1e-12) << row->name;
      EXPECT_NEAR(power[1], power[0], 1e-11 * std::abs(power[0])) << row->name;
    }
  }
}

}  // namespace
}  // namespace flexmorph::fem
