#include "fem/terms.h"
#include "fem/terms/density_term.h"

namespace flexmorph::fem {
namespace {

/// Material damping of Kelvin and Voigt, proportional to the stiffness:
///
///   s_v = τ D ė,   P = τ ∫ ė·D ė dA
///
///   e, D  strains and stiffness of an elastic term of the body, W = ½ e·D e: ε and h C of the
///         membrane, κ and D of bending, ... so that the whole stress is D (e + τ ė)
///   τ     damping time [s]: a mode of angular frequency ω has the damping ratio ζ = τ ω/2
///
/// ė are rates of strains, which do not change in rigid motions. Therefore rigid motions are not
/// damped. (With rates of the unknowns times the stiffness matrix they would be damped, because K
/// q̇ of a rotating body is not zero.)
///
/// Source: García-Vallejo, Valverde & Domínguez (2005), Nonlinear Dynamics 42, 347-369, who apply
/// this damping of the strains to beams.
class KelvinVoigt final : public DissipationDensity {
 public:
  KelvinVoigt(const LinearDensity& elastic, double time)
      : strain_(&elastic.strain()), viscosity_(time * elastic.stiffness()) {}
  const StrainMeasure& strain() const override { return *strain_; }
  void stress(const StrainVector&, const StrainVector& rate, StrainVector& stress,
              StrainSquare* by_strain, StrainSquare* by_rate) const override {
    stress = viscosity_ * rate;
    if (by_strain) by_strain->setZero(stress.size(), stress.size());
    if (by_rate) *by_rate = viscosity_;
  }

 private:
  const StrainMeasure* strain_;
  StrainSquare viscosity_;  // τ D
};

std::vector<DissipativePart> parts_of(const TermData& data, double time) {
  std::vector<DissipativePart> out;
  for (const TermRow* row : data.terms) {
    if (!row->elastic) continue;
    for (const ElasticPart& part : row->elastic(data)) {
      const auto* linear = dynamic_cast<const LinearDensity*>(part.density.get());
      if (!linear)
        throw Error::input("term 'damping' needs a constant stiffness, and '" + row->name +
                           "' does not have a constant stiffness");
      out.push_back({std::make_shared<KelvinVoigt>(*linear, time), part.sampling});
    }
  }
  if (out.empty())
    throw Error::input("term 'damping' acts on elastic terms, but the body has no elastic term");
  return out;
}

}  // namespace

const TermRow& damping_row() {
  static const TermRow kRow{
      .name = "damping",
      .sentence =
          "Material damping of Kelvin and Voigt: the stresses are proportional to the rates of all "
          "strains.",
      .role = "damping",
      .domains = {TermDomain::plane, TermDomain::space, TermDomain::beam},
      .required_in = {},
      .acts_on_elastic = true,
      .eulerian_lines = false,
      .keys = {{.name = "damping_time",
                .noun = "a damping time",
                .unit = "s",
                .low_open = true,
                .fallback = {},
                .sentence =
                    "Modes of angular frequency ω have the damping ratio ω/2 times this time."}},
      .columns = {"energy.dissipated"},
      .make = [](const TermData& data) -> std::unique_ptr<Term> {
        const double time = number_of(damping_row(), "damping_time", data);
        return make_dissipative_term("damping", parts_of(data, time));
      }};
  return kRow;
}

}  // namespace flexmorph::fem
