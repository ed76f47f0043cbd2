#include "cases/results/schema.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "cases/keys/book.h"
#include "geometry/text.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr const char* kNotUnique =
    "redundant joints, whose forces are not unique; the forces with the least sum of squares are "
    "given";

/// Returns names as a list, or std::monostate if there are none.
Value optional_list(const std::vector<std::string>& names) {
  return names.empty() ? Value() : Value(joined(names));
}

}  // namespace

Value optional_number(const std::optional<double>& number) {
  if (number && std::isfinite(*number)) return *number;
  return {};
}

std::span<const ResultQuantity<PointVariation>> point_quantities() {
  using T = PointVariation;
  static const ResultQuantity<T> kTable[] = {
      {"point", "", "name of the observed point",
       [](const T& t) { return t.name.empty() ? Value() : Value(t.name); }},
      {"mean", "m", "mean of the deflection over time",
       [](const T& t) -> Value { return t.designed.mean; }},
      {"rms", "m", "root mean square of the deflection about its mean",
       [](const T& t) -> Value { return t.designed.rms; }},
      {"peak_to_peak", "m", "largest deflection minus smallest deflection",
       [](const T& t) -> Value { return t.designed.peak_to_peak; }},
      {"largest", "m", "largest absolute deflection",
       [](const T& t) -> Value { return t.designed.largest; }},
      {"mean_ratio", "-", "`mean` divided by `mean` of uniform material",
       [](const T& t) -> Value { return t.designed.mean / t.uniform.mean; }},
      {"rms_ratio", "-", "`rms` divided by `rms` of uniform material",
       [](const T& t) -> Value { return t.rms_ratio(); }},
      {"peak_to_peak_ratio", "-", "`peak_to_peak` divided by `peak_to_peak` of uniform material",
       [](const T& t) -> Value { return t.peak_to_peak_ratio(); }},
      {"largest_ratio", "-", "`largest` divided by `largest` of uniform material",
       [](const T& t) -> Value { return t.designed.largest / t.uniform.largest; }}};
  return kTable;
}

std::span<const ResultQuantity<fem::MotionResult>> motion_quantities() {
  using R = fem::MotionResult;
  static const ResultQuantity<R> kTable[] = {
      {"steps", "-", "number of accepted time steps",
       [](const R& r) -> Value { return r.counts.steps; }},
      {"newton_iterations", "-", "number of iterations of Newton's method",
       [](const R& r) -> Value { return r.counts.newton; }},
      {"factorizations", "-", "number of factorizations of the system matrix",
       [](const R& r) -> Value { return r.counts.factorizations; }},
      {"rejected_steps", "-", "number of rejected steps, which were repeated",
       [](const R& r) -> Value { return r.counts.rejected; }},
      {"evaluations", "-", "number of evaluations of the accelerations by the explicit integrator",
       [](const R& r) { return r.counts.evaluations > 0 ? Value(r.counts.evaluations) : Value(); }},
      {"partitions", "-",
       "number of selections of independent coordinates by the explicit integrator",
       [](const R& r) { return r.counts.evaluations > 0 ? Value(r.counts.partitions) : Value(); }},
      {"largest_step", "s", "largest accepted time step",
       [](const R& r) -> Value { return r.largest_step; }},
      {"energy_error", "-", "largest error of the energy balance, relative to the largest energy",
       [](const R& r) -> Value { return r.energy_error; }},
      {"constraint_drift", "m", "largest violation of a constraint",
       [](const R& r) -> Value { return r.constraint_drift; }},
      {"velocity_drift", "m/s", "largest violation of the rate of a constraint",
       [](const R& r) -> Value { return r.velocity_drift; }},
      {"smallest_area_ratio", "-", "smallest ratio of deformed to undeformed area",
       [](const R& r) -> Value { return r.smallest_area_ratio; }},
      {"not_unique_forces", "", kNotUnique,
       [](const R& r) { return optional_list(r.redundant_joints); }},
      {"condition", "-", "estimated condition number of the last matrix (--condition)",
       [](const R& r) { return optional_number(r.condition); }}};
  return kTable;
}

std::span<const ResultQuantity<PathRecord>> path_quantities() {
  using P = PathRecord;
  static const ResultQuantity<P> kTable[] = {
      {"equilibria", "-", "number of equilibria of the path",
       [](const P& p) -> Value { return static_cast<int>(p.table.n_rows()); }},
      {"load_factor", "-", "load factor of the last equilibrium",
       [](const P& p) -> Value { return p.table.at(kFactorColumn).back(); }},
      {"strain_energy", "J", "strain energy of the last equilibrium",
       [](const P& p) -> Value { return p.table.at(kStrainColumn).back(); }},
      {"completed", "", "true if the path reached its end",
       [](const P& p) -> Value { return p.result.completed; }},
      {"rejected_steps", "-", "number of rejected steps, which were repeated",
       [](const P& p) -> Value { return p.result.rejected; }},
      {"newton_iterations", "-", "number of iterations of Newton's method",
       [](const P& p) -> Value { return p.result.iterations; }},
      {"not_unique_forces", "", kNotUnique,
       [](const P& p) { return optional_list(p.redundant_joints); }},
      {"condition", "-", "estimated condition number of the last matrix (--condition)",
       [](const P& p) { return optional_number(p.result.condition); }}};
  return kTable;
}

std::span<const ResultQuantity<mmc::CycleVerdict>> cycle_quantities() {
  using V = mmc::CycleVerdict;
  static const ResultQuantity<V> kTable[] = {
      {"cycle", "-", "number of the cycle, from 1", [](const V& v) -> Value { return v.cycle; }},
      {"objective", "J", "sum of the compliances of the bodies",
       [](const V& v) -> Value { return v.objective; }},
      {"measure", "J s or m", "quantity by which the cycles are compared (cycle.compare_by)",
       [](const V& v) -> Value { return v.measure; }},
      {"violation", "-",
       "largest relative violation of a limit by a crisp design; null: a load has no support",
       [](const V& v) { return std::isfinite(v.violation) ? Value(v.violation) : Value(nullptr); }},
      {"best", "", "true if this cycle is the best one so far",
       [](const V& v) -> Value { return v.best; }}};
  return kTable;
}

std::span<const ResultQuantity<mmc::CorrectedCycle>> corrected_cycle_quantities() {
  using C = mmc::CorrectedCycle;
  static const ResultQuantity<C> kTable[] = {
      {"cycle", "-", "number of the cycle; 0 is the design before the corrections",
       [](const C& c) -> Value { return c.cycle; }},
      {"objective", "", "objective J of the motion", [](const C& c) -> Value { return c.value; }},
      {"kkt", "-", "KKT residual of log J", [](const C& c) -> Value { return c.kkt; }},
      {"angle", "rad", "angle between the gradients of J and of the compliance under the loads",
       [](const C& c) -> Value { return c.angle; }},
      {"radius", "-", "radius of the trust region", [](const C& c) -> Value { return c.radius; }},
      {"predicted", "-", "predicted relative decrease of J",
       [](const C& c) -> Value { return c.predicted; }},
      {"actual", "-", "actual relative decrease of J",
       [](const C& c) { return std::isfinite(c.actual) ? Value(c.actual) : Value(nullptr); }},
      {"accepted", "", "true if the design was accepted",
       [](const C& c) -> Value { return c.accepted; }},
      {"motions", "-", "number of motions so far, each with its adjoint solution",
       [](const C& c) -> Value { return c.motions; }},
      {"seconds", "s", "CPU time so far", [](const C& c) -> Value { return c.seconds; }}};
  return kTable;
}

std::span<const ResultQuantity<mmc::OptimalityCertificate>> certificate_quantities() {
  using C = mmc::OptimalityCertificate;
  static const ResultQuantity<C> kTable[] = {
      {"objective", "", "name of the objective J of the motion",
       [](const C& c) -> Value { return c.objective; }},
      {"value", "", "J of the regularized design",
       [](const C& c) -> Value { return c.regularized.value; }},
      {"kkt", "-", "KKT residual of log J under the limits of the regularized design",
       [](const C& c) -> Value { return c.regularized.kkt; }},
      {"angle", "rad", "angle between the gradients of J and of the compliance under the loads",
       [](const C& c) -> Value { return c.regularized.angle; }},
      {"left", "-",
       "predicted decrease: largest relative decrease of J within the move limit, to first order",
       [](const C& c) -> Value { return c.regularized.left; }},
      {"violation", "-", "largest violation of a limit of the regularized design",
       [](const C& c) -> Value { return c.regularized.violation; }},
      {"crisp_value", "", "J of the crisp design, which the outlines enclose",
       [](const C& c) -> Value { return c.crisp.value; }},
      {"crisp_kkt", "-",
       "`kkt` of the crisp design, computed with shape derivatives of its outlines",
       [](const C& c) -> Value { return c.crisp.kkt; }},
      {"crisp_angle", "rad", "`angle` of the crisp design",
       [](const C& c) -> Value { return c.crisp.angle; }},
      {"crisp_left", "-", "`left` of the crisp design",
       [](const C& c) -> Value { return c.crisp.left; }},
      {"crisp_violation", "-", "largest violation of a limit of the crisp design",
       [](const C& c) -> Value { return c.crisp.violation; }},
      {"move_limit", "-", "move limit of the predicted decrease",
       [](const C& c) -> Value { return c.move_limit; }},
      {"seconds", "s", "CPU time of the certificate",
       [](const C& c) -> Value { return c.seconds; }}};
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
void append_table(const std::string& title, std::span<const ResultQuantity<Source>> table,
                  std::string& out) {
  out += (out.empty() ? "#### " : "\n#### ") + title + "\n\n| name | unit | meaning |\n";
  out += "| --- | --- | --- |\n";
  for (const ResultQuantity<Source>& q : table)
    out += "| `" + std::string(q.name) + "` | " + q.unit + " | " + q.meaning + " |\n";
}

}  // namespace

std::string results_as_markdown() {
  std::string out;
  append_table("`results`: an entry per designed body", design_quantities(), out);
  append_table("`results[].length_scale`: widths of the outline", length_scale_quantities(), out);
  append_table("`results[].body_fitted`: verification of the outline", outline_quantities(), out);
  append_table("`results[].load_cases`, `loads/`: an entry per load case of a static plate",
               static_load_quantities(), out);
  append_table(
      "`results[].load_difference`: difference between the loads and the motion with the design",
      load_difference_quantities(), out);
  append_table(
      "`results[].tip`, `results[].points`: deflections of the tip and of every observed point in "
      "the motion",
      point_quantities(), out);
  append_table("`motion`: numbers of the motion", motion_quantities(), out);
  append_table("`static`: numbers of the path of equilibria", path_quantities(), out);
  append_table("`cycles`: an entry per cycle", cycle_quantities(), out);
  append_table("`corrected_cycles`: an entry per corrected cycle", corrected_cycle_quantities(),
               out);
  append_table("`certificate`: optimality certificate", certificate_quantities(), out);
  return out;
}

std::string with_references(const std::string& text) {
  return with_section(with_section(text, "keys", keys_as_markdown()), "results",
                      results_as_markdown());
}

}  // namespace flexmorph::cases
