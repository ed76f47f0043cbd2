#include <map>

#include "fem/term.h"

namespace flexmorph::fem {

std::unique_ptr<Term> make_term(const std::string& name, const PlaneSection& section) {
  using Maker = std::unique_ptr<Term> (*)(const PlaneSection&);
  static const std::map<std::string, Maker> kTerms = {
      {"bending", [](const PlaneSection& s) { return make_bending(s); }},
      {"ecm", make_beam_ecm},
      {"gcm", make_beam_gcm},
      {"inertia", make_inertia},
      {"membrane", make_membrane},
      {"membrane_assumed", make_assumed_membrane}};
  const auto row = kTerms.find(name);
  if (row == kTerms.end()) {
    std::string known;
    for (const auto& [term, maker] : kTerms) known += (known.empty() ? "" : ", ") + term;
    throw Error::input("term '" + name + "' is unknown; known are: " + known);
  }
  return row->second(section);
}

}  // namespace flexmorph::fem
