#include "cases/results/parts/part_comparison.h"

#include <algorithm>
#include <cmath>

#include "cases/results/run_result.h"
#include "cases/scene/scene.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using Number = std::optional<double>;

/// A view of one body of a result.
struct BodyView {
  const RunResult& result;
  size_t i;

  const mmc::BodyProblem& problem() const { return result.design.problems[i]; }
  const mmc::BodyOutcome& outcome() const { return result.design.outcomes[i]; }
  const verification::OutlineVerification* outline() const {
    const std::vector<VerifiedOutline>& all = result.design.outlines;
    return i < all.size() && all[i].verification ? &*all[i].verification : nullptr;
  }
};

/// Returns a number if it is finite, else nothing.
Number finite(double value) { return std::isfinite(value) ? Number(value) : std::nullopt; }

/// A row of the table of numbers of a body: name, unit, meaning and accessors.
struct Row {
  const char *name, *unit, *words;
  Number (*value)(const BodyView&);
  Number (*uniform)(const BodyView&) = nullptr;
};

template <class Get>
Number of_outline(const BodyView& v, const Get& get) {
  return v.outline() ? finite(get(*v.outline())) : std::nullopt;
}

double allowed(const BodyView& v) {
  return mmc::allowed_volume(v.problem().goal).value_or(v.outcome().crisp.volume);
}

Number mass(const BodyView& v, double volume) {
  const double mass = mmc::part_mass_of(v.problem(), volume);
  return mass > 0 ? Number(mass) : std::nullopt;
}

constexpr Row kRows[] = {
    {"mass", "kg", "mass", [](const BodyView& v) { return mass(v, v.outcome().crisp.volume); },
     [](const BodyView& v) { return mass(v, allowed(v)); }},
    {"crisp_volume", "-", "volume fraction",
     [](const BodyView& v) { return finite(v.outcome().crisp.volume); },
     [](const BodyView& v) { return finite(allowed(v)); }},
    {"crisp_compliance", "J", "compliance on the design mesh",
     [](const BodyView& v) { return finite(v.outcome().crisp.compliance); },
     [](const BodyView& v) { return finite(v.outcome().uniform_compliance); }},
    {"body_fitted.compliance", "J", "body-fitted compliance",
     [](const BodyView& v) { return of_outline(v, [](const auto& o) { return o.compliance; }); }},
    {"body_fitted.largest_stress", "Pa", "largest body-fitted von Mises stress",
     [](const BodyView& v) {
       return of_outline(v, [](const auto& o) { return o.largest_stress; });
     }},
    {"body_fitted.largest_displacement", "m", "largest body-fitted displacement under all loads",
     [](const BodyView& v) -> Number {
       if (!v.outline() || v.outline()->largest_displacements.empty()) return {};
       return finite(std::ranges::max(v.outline()->largest_displacements));
     }},
    {"min_feature", "m", "smallest width of material",
     [](const BodyView& v) -> Number {
       const auto& features = v.outcome().crisp.features;
       return features ? finite(features->solid) : std::nullopt;
     }},
    {"min_gap", "m", "smallest width of a gap",
     [](const BodyView& v) -> Number {
       const auto& features = v.outcome().crisp.features;
       return features ? finite(features->gap) : std::nullopt;
     }},
    {"pieces", "-", "connected regions of material",
     [](const BodyView& v) -> Number { return 1.0 + v.outcome().crisp.connectivity.islands; }}};

/// Returns the statistics of a column of a motion; nothing if there is no such motion or column.
std::optional<Variation> variation(const std::optional<MotionRecord>& motion,
                                   const std::string& column) {
  const std::vector<double>* values = motion ? motion->table.find(column) : nullptr;
  if (!values || values->size() < 2) return {};
  return variation_of(motion->time(), *values);
}

/// A column with the deflections of a point, and the name of the point in messages.
struct Deflection {
  std::string body, column, point;
};

/// Adds the largest deflection of a point and its root mean square about the mean.
void add_deflections(const Deflection& of_point, const RunResult& parts, const RunResult* design,
                     std::vector<ComparedNumber>& out) {
  const auto& [body, column, point] = of_point;
  const auto part = variation(parts.motions.assessed(), column),
             uniform = variation(parts.motions.assessed_uniform(), column),
             other = design ? variation(design->motions.assessed(), column) : std::nullopt;
  if (!part) return;
  const auto add = [&, body = body, column = column](const char* ending, const std::string& words,
                                                     double Variation::*which) {
    const auto of = [&](const std::optional<Variation>& v) {
      return v ? Number((*v).*which) : std::nullopt;
    };
    out.push_back({body, column.substr(body.size() + 1) + ending, "m", words, of(part), of(other),
                   of(uniform)});
  };
  add(".largest", "largest deflection of " + point, &Variation::largest);
  add(".rms", "root mean square of the deflection of " + point + " about its mean",
      &Variation::rms);
}

/// Adds the deflections of the tip and of the observed points of a body.
void add_motion(const std::string& body, const RunResult& parts, const RunResult* design,
                std::vector<ComparedNumber>& out) {
  if (!parts.motions.assessed()) return;
  add_deflections({body, body + kDeflectionEnding, "the tip"}, parts, design, out);
  const Series& table = parts.motions.assessed()->table;
  for (const size_t c : table.of_group(ColumnGroup::across)) {
    const std::string& column = table.columns[c].name;
    if (!column.starts_with(body + ".")) continue;
    const size_t begin = body.size() + 1;
    const std::string name = column.substr(begin, column.size() - begin - kAcrossEnding.size());
    add_deflections({body, column, "point '" + name + "'"}, parts, design, out);
  }
}

Number strain_integral(const std::optional<MotionRecord>& motion) {
  return motion ? Number(motion->strain_integral()) : std::nullopt;
}

std::string percent(const Number& value, const Number& from) {
  if (!value || !from || *from == 0) return "";
  const double change = 100 * (*value / *from - 1);
  return (change >= 0 ? "+" : "") + io::to_text(change, 3) + " %";
}

}  // namespace

std::vector<ComparedNumber> compared_numbers(const Scene& scene, const RunResult& parts,
                                             const RunResult* design) {
  std::vector<ComparedNumber> out;
  for (size_t i = 0; i < parts.design.outcomes.size(); ++i) {
    const BodyView part{parts, i};
    for (const Row& row : kRows) {
      ComparedNumber number{part.outcome().body, row.name, row.unit, row.words,
                            row.value(part),     {},       {}};
      if (design && i < design->design.outcomes.size())
        number.design = row.value(BodyView{*design, i});
      if (row.uniform) number.uniform = row.uniform(part);
      if (number.part || number.design) out.push_back(std::move(number));
    }
    add_motion(part.outcome().body, parts, design, out);
  }
  if (!scene.domain && parts.motions.assessed())
    out.push_back({"", "strain_energy_integral", "J s",
                   "time integral of the strain energy of the motion",
                   strain_integral(parts.motions.assessed()),
                   design ? strain_integral(design->motions.assessed()) : std::nullopt,
                   strain_integral(parts.motions.assessed_uniform())});
  return out;
}

std::vector<std::vector<std::string>> comparison_rows(const PartComparison& comparison) {
  std::vector<std::vector<std::string>> out = {
      {"body", "quantity", "part", "design", "part vs. design", "uniform", "part vs. uniform"}};
  const auto text = [](const Number& n) { return n ? io::to_text(*n, 5) : std::string(); };
  for (const ComparedNumber& n : comparison.numbers)
    out.push_back({n.body, n.words + " [" + n.unit + "]", text(n.part), text(n.design),
                   percent(n.part, n.design), text(n.uniform), percent(n.part, n.uniform)});
  return out;
}

}  // namespace flexmorph::cases
