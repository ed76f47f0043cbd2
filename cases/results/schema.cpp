#include "cases/results/schema.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "cases/keys/book.h"
#include "io/files.h"

namespace flexmorph::cases {
Value optional_number(const std::optional<double>& number) {
  if (number && std::isfinite(*number)) return *number;
  return {};
}

std::span<const Quantity<PointVariation>> point_quantities() {
  using T = PointVariation;
  static const Quantity<T> kTable[] = {
      {"point", "", "name of the observed point",
       [](const T& t) { return t.name.empty() ? Value() : Value(t.name); }},
      {"mean", "m", "mean over time of the deflection",
       [](const T& t) -> Value { return t.designed.mean; }},
      {"rms", "m", "root mean square about the mean",
       [](const T& t) -> Value { return t.designed.rms; }},
      {"peak_to_peak", "m", "largest less smallest deflection",
       [](const T& t) -> Value { return t.designed.peak_to_peak; }},
      {"largest", "m", "largest size of the deflection",
       [](const T& t) -> Value { return t.designed.largest; }},
      {"mean_ratio", "-", "mean over that of uniform material",
       [](const T& t) -> Value { return t.designed.mean / t.uniform.mean; }},
      {"rms_ratio", "-", "rms over that of uniform material",
       [](const T& t) -> Value { return t.rms_ratio(); }},
      {"peak_to_peak_ratio", "-", "peak_to_peak over that of uniform material",
       [](const T& t) -> Value { return t.peak_to_peak_ratio(); }},
      {"largest_ratio", "-", "largest over that of uniform material",
       [](const T& t) -> Value { return t.designed.largest / t.uniform.largest; }}};
  return kTable;
}

std::span<const Quantity<fem::MotionResult>> motion_quantities() {
  using R = fem::MotionResult;
  static const Quantity<R> kTable[] = {
      {"steps", "-", "accepted time steps", [](const R& r) -> Value { return r.counts.steps; }},
      {"newton_iterations", "-", "iterations of Newton's method",
       [](const R& r) -> Value { return r.counts.newton; }},
      {"factorizations", "-", "factorizations of the system matrix",
       [](const R& r) -> Value { return r.counts.factorizations; }},
      {"rejected_steps", "-", "steps that were repeated",
       [](const R& r) -> Value { return r.counts.rejected; }},
      {"evaluations", "-", "evaluations of accelerations, of the explicit integrator",
       [](const R& r) { return r.counts.evaluations > 0 ? Value(r.counts.evaluations) : Value(); }},
      {"partitions", "-", "choices of independent coordinates, of the explicit integrator",
       [](const R& r) { return r.counts.evaluations > 0 ? Value(r.counts.partitions) : Value(); }},
      {"largest_step", "s", "largest accepted step",
       [](const R& r) -> Value { return r.largest_step; }},
      {"energy_defect", "-", "largest defect of the energy balance, relative to the largest energy",
       [](const R& r) -> Value { return r.energy_defect; }},
      {"constraint_drift", "m", "largest violation of a constraint",
       [](const R& r) -> Value { return r.constraint_drift; }},
      {"velocity_drift", "m/s", "largest violation of the rate of a constraint",
       [](const R& r) -> Value { return r.velocity_drift; }},
      {"smallest_area_ratio", "-", "smallest ratio of deformed to undeformed area",
       [](const R& r) -> Value { return r.smallest_area_ratio; }},
      {"condition", "-", "estimated condition of the last matrix (--condition)",
       [](const R& r) { return optional_number(r.condition); }}};
  return kTable;
}

std::span<const Quantity<PathRecord>> path_quantities() {
  using P = PathRecord;
  static const Quantity<P> kTable[] = {
      {"equilibria", "-", "equilibria of the path",
       [](const P& p) -> Value { return static_cast<int>(p.table.n_rows()); }},
      {"load_factor", "-", "load factor of the last equilibrium",
       [](const P& p) -> Value { return p.table.at(kFactorColumn).back(); }},
      {"strain_energy", "J", "strain energy of the last equilibrium",
       [](const P& p) -> Value { return p.table.at(kStrainColumn).back(); }},
      {"completed", "", "whether the path reached its end",
       [](const P& p) -> Value { return p.result.completed; }},
      {"rejected_steps", "-", "steps that were repeated",
       [](const P& p) -> Value { return p.result.rejected; }},
      {"newton_iterations", "-", "iterations of Newton's method",
       [](const P& p) -> Value { return p.result.iterations; }},
      {"condition", "-", "estimated condition of the last matrix (--condition)",
       [](const P& p) { return optional_number(p.result.condition); }}};
  return kTable;
}

std::span<const Quantity<mmc::CycleVerdict>> cycle_quantities() {
  using V = mmc::CycleVerdict;
  static const Quantity<V> kTable[] = {
      {"cycle", "-", "number of the cycle, from 1", [](const V& v) -> Value { return v.cycle; }},
      {"objective", "J", "sum of the compliances of the bodies",
       [](const V& v) -> Value { return v.objective; }},
      {"measure", "J s or m", "what cycles are compared by (cycle.compare_by)",
       [](const V& v) -> Value { return v.measure; }},
      {"violation", "-",
       "largest part by which a crisp design is beyond its limits; null: loose loads",
       [](const V& v) { return std::isfinite(v.violation) ? Value(v.violation) : Value(nullptr); }},
      {"best", "", "whether this cycle is the best so far",
       [](const V& v) -> Value { return v.best; }}};
  return kTable;
}

std::span<const Quantity<mmc::CorrectedCycle>> corrected_cycle_quantities() {
  using C = mmc::CorrectedCycle;
  static const Quantity<C> kTable[] = {
      {"cycle", "-", "number of the cycle; 0 is the design before",
       [](const C& c) -> Value { return c.cycle; }},
      {"objective", "", "objective J of the motion", [](const C& c) -> Value { return c.value; }},
      {"kkt", "-", "KKT residual of log J", [](const C& c) -> Value { return c.kkt; }},
      {"angle", "rad", "angle between the gradients of J and of the loads' compliance",
       [](const C& c) -> Value { return c.angle; }},
      {"radius", "-", "radius of the trust region", [](const C& c) -> Value { return c.radius; }},
      {"predicted", "-", "predicted relative decrease of J",
       [](const C& c) -> Value { return c.predicted; }},
      {"actual", "-", "actual relative decrease of J",
       [](const C& c) { return std::isfinite(c.actual) ? Value(c.actual) : Value(nullptr); }},
      {"accepted", "", "whether the design is kept",
       [](const C& c) -> Value { return c.accepted; }},
      {"motions", "-", "motions with their adjoints so far",
       [](const C& c) -> Value { return c.motions; }},
      {"seconds", "s", "CPU time so far", [](const C& c) -> Value { return c.seconds; }}};
  return kTable;
}

std::span<const Quantity<mmc::MotionCertificate>> certificate_quantities() {
  using C = mmc::MotionCertificate;
  static const Quantity<C> kTable[] = {
      {"objective", "", "what J is", [](const C& c) -> Value { return c.objective; }},
      {"value", "", "J of the regularized design",
       [](const C& c) -> Value { return c.regularized.value; }},
      {"kkt", "-", "KKT residual of log J under the limits of the regularized design",
       [](const C& c) -> Value { return c.regularized.kkt; }},
      {"angle", "rad", "angle between the gradients of J and of the loads' compliance",
       [](const C& c) -> Value { return c.regularized.angle; }},
      {"left", "-", "largest relative decrease of J within the move limit, to first order",
       [](const C& c) -> Value { return c.regularized.left; }},
      {"violation", "-", "largest violation of a limit of the regularized design",
       [](const C& c) -> Value { return c.regularized.violation; }},
      {"sharp_value", "", "J of the crisp design, which is what the outlines enclose",
       [](const C& c) -> Value { return c.crisp.value; }},
      {"sharp_kkt", "-", "`kkt` of the crisp design, by shape derivatives of its outlines",
       [](const C& c) -> Value { return c.crisp.kkt; }},
      {"sharp_angle", "rad", "`angle` of the crisp design",
       [](const C& c) -> Value { return c.crisp.angle; }},
      {"sharp_left", "-", "`left` of the crisp design",
       [](const C& c) -> Value { return c.crisp.left; }},
      {"sharp_violation", "-", "largest violation of a limit of the crisp design",
       [](const C& c) -> Value { return c.crisp.violation; }},
      {"move_limit", "-", "this move limit", [](const C& c) -> Value { return c.move_limit; }},
      {"seconds", "s", "CPU time", [](const C& c) -> Value { return c.seconds; }}};
  return kTable;
}

std::string text_of(const Value& value) {
  return std::visit(
      [](const auto& v) -> std::string {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, std::monostate> || std::is_same_v<T, std::nullptr_t>)
          return "";
        else if constexpr (std::is_same_v<T, bool>)
          return v ? "1" : "0";
        else if constexpr (std::is_same_v<T, std::string>)
          return v;
        else
          return io::to_text(v);
      },
      value);
}

nlohmann::ordered_json json_of(const Value& value) {
  return std::visit(
      [](const auto& v) -> nlohmann::ordered_json {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, std::monostate>)
          return nullptr;
        else if constexpr (std::is_same_v<T, double>) {
          if (std::isinf(v)) return "infinite";
          if (std::isnan(v)) return nullptr;
          return v;
        } else
          return v;
      },
      value);
}

namespace {

template <class Source>
void append_table(const std::string& title, std::span<const Quantity<Source>> table,
                  std::string& out) {
  out += (out.empty() ? "#### " : "\n#### ") + title + "\n\n| name | unit | meaning |\n";
  out += "| --- | --- | --- |\n";
  for (const Quantity<Source>& q : table)
    out += "| `" + std::string(q.name) + "` | " + q.unit + " | " + q.meaning + " |\n";
}

}  // namespace

std::string results_as_markdown() {
  std::string out;
  append_table("`results`: an entry per designed body", design_quantities(), out);
  append_table("`results[].length_scale`: widths of the outline", length_scale_quantities(), out);
  append_table("`results[].body_fitted`: verification of the outline", outline_quantities(), out);
  append_table("`results[].load_cases`, `loads/`: an entry per load case of a plate at rest",
               static_load_quantities(), out);
  append_table("`results[].load_difference`: loads against the motion with the design",
               load_difference_quantities(), out);
  append_table(
      "`results[].tip`, `results[].points`: deflections of the tip and of every observed point in "
      "the motion",
      point_quantities(), out);
  append_table("`motion`: a motion", motion_quantities(), out);
  append_table("`static`: a path of equilibria", path_quantities(), out);
  append_table("`cycles`: an entry per cycle", cycle_quantities(), out);
  append_table("`corrected_cycles`: an entry per corrected cycle", corrected_cycle_quantities(),
               out);
  append_table("`certificate`", certificate_quantities(), out);
  return out;
}

std::string with_references(const std::string& text) {
  return with_section(with_section(text, "keys", keys_as_markdown()), "results",
                      results_as_markdown());
}

}  // namespace flexmorph::cases
