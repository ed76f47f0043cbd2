#include "fem/terms.h"
#include "fem/terms/densities.h"
#include "fem/terms/membrane.h"
#include "fem/terms/sampling.h"

namespace flexmorph::fem {

std::vector<ElasticPart> membrane_parts(const PlaneSection& section, Strains strains) {
  return {{std::make_shared<MembraneDensity>(section),
           strains == Strains::assumed ? sample_assumed() : sample_points(12, Tabulate::gradient)}};
}

namespace {

template <Strains kStrains>
TermRow row(const char* name, const char* sentence, const std::vector<TermDomain>& domains) {
  return {.name = name,
          .sentence = sentence,
          .role = "membrane",
          .domains = domains,
          .required_in = {TermDomain::space},
          .designable = kStrains == Strains::displacement,
          .on_cells = kStrains == Strains::displacement,
          .eulerian_lines = kStrains == Strains::displacement,
          .keys = {},
          .columns = {},
          .elastic = [](const TermData& d) { return membrane_parts(d.section, kStrains); },
          .make = [](const TermData& d) { return make_membrane(d.section, kStrains); }};
}

}  // namespace

const TermRow& membrane_row() {
  static const TermRow kRow =
      row<Strains::displacement>("membrane", "Membrane forces, without assumed strains.",
                                 {TermDomain::plane, TermDomain::space});
  return kRow;
}

const TermRow& membrane_assumed_row() {
  static const TermRow kRow =
      row<Strains::assumed>("membrane_assumed",
                            "Membrane forces with assumed strains. Thin plates, and slender plates "
                            "in the plane, do not lock with this term.",
                            {TermDomain::plane, TermDomain::space});
  return kRow;
}

}  // namespace flexmorph::fem
