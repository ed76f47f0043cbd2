#include "fem/terms.h"
#include "fem/terms/density_term.h"
#include "fem/terms/sampling.h"

/// Complete example of a term: cords in a plate along its length, W = ½ k ε_mm².
namespace flexmorph::fem {

const TermRow& cords_row() {
  static const TermRow kRow{.name = "cords",
                            .sentence = "Cords along the plate, in its surface.",
                            .role = "cords",
                            .domains = {TermDomain::plane, TermDomain::space},
                            .required_in = {},
                            .keys = {{.name = "cord_stiffness",
                                      .noun = "a stiffness of cords",
                                      .unit = "N/m",
                                      .fallback = {},
                                      .sentence = "Force per width of the plate and per strain."}},
                            .columns = {},
                            .elastic =
                                [](const TermData& data) {
                                  StrainSquare stiffness = StrainSquare::Zero(3, 3);
                                  stiffness(0, 0) = number_of(cords_row(), "cord_stiffness", data);
                                  return std::vector<ElasticPart>{
                                      {std::make_shared<LinearDensity>(green_lagrange(), stiffness),
                                       sample_points(12, Tabulate::gradient)}};
                                },
                            .make = [](const TermData& data) -> std::unique_ptr<Term> {
                              return make_elastic_term("cords", cords_row().elastic(data));
                            }};
  return kRow;
}

}  // namespace flexmorph::fem
