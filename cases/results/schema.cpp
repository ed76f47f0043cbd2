#include "cases/results/schema.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "cases/keys/book.h"

namespace flexmorph::cases {
namespace {

/// A width of an outline: infinite where nothing bounds it, unknown where outlines could not be
/// united.
Value width(const mmc::BodyOutcome& o, double Features::*which) {
  if (o.sharp.features) return (*o.sharp.features).*which;
  return nullptr;
}

Value optional_number(const std::optional<double>& number) {
  if (number && std::isfinite(*number)) return *number;
  return {};
}

/// Numbers that only a bounded compliance has.
template <class T>
Value where_bounded(const VerifiedOutline& o, const T& value) {
  if (!o.verification || !std::isfinite(o.verification->compliance)) return {};
  return value(*o.verification);
}
/// Numbers that only a verification has.
template <class T>
Value where_verified(const VerifiedOutline& o, const T& value) {
  if (!o.verification) return {};
  return value(*o.verification);
}
using Verification = verification::OutlineVerification;

}  // namespace

std::span<const Quantity<mmc::BodyOutcome>> design_quantities() {
  using O = mmc::BodyOutcome;
  static const Quantity<O> kTable[] = {
      {"compliance", "J", "compliance of the regularized design under its loads",
       [](const O& o) -> Value { return o.compliance; }},
      {"volume", "-", "volume fraction of the regularized design",
       [](const O& o) -> Value { return o.volume; }},
      {"sharp_compliance", "J", "compliance of the crisp design under its loads",
       [](const O& o) -> Value { return o.sharp.compliance; }},
      {"sharp_volume", "-", "volume fraction of the crisp design",
       [](const O& o) -> Value { return o.sharp.volume; }},
      {"uniform_compliance", "J", "compliance of uniform material of this volume",
       [](const O& o) -> Value { return o.uniform_compliance; }},
      {"compliance_ratio", "-", "sharp_compliance over uniform_compliance",
       [](const O& o) -> Value { return o.sharp.compliance / o.uniform_compliance; }},
      {"sharp_ratio", "-", "sharp_compliance over compliance",
       [](const O& o) -> Value { return o.sharp.compliance / o.compliance; }},
      {"connected", "", "whether one piece of material joins supports and loads",
       [](const O& o) -> Value { return o.sharp.connectivity.connected; }},
      {"islands", "-", "pieces of material besides the one that joins supports and loads",
       [](const O& o) -> Value { return o.sharp.connectivity.islands; }},
      {"min_feature", "m", "smallest width of material of the outline",
       [](const O& o) { return width(o, &Features::solid); }},
      {"min_gap", "m", "smallest width of a gap of the outline",
       [](const O& o) { return width(o, &Features::gap); }},
      {"iterations", "-", "design iterations", [](const O& o) -> Value { return o.iterations; }},
      {"start", "-", "number of the start that the design comes from",
       [](const O& o) -> Value { return o.start; }},
      {"state_solves", "-", "evaluations of the static problem",
       [](const O& o) -> Value { return o.evaluations; }},
      {"kkt", "-", "KKT residual of the design problem", [](const O& o) -> Value { return o.kkt; }},
      {"factorizations", "-", "factorizations of the stiffness matrix",
       [](const O& o) -> Value { return o.factorizations; }},
      {"worst_compliance", "J", "largest compliance of a load, of the crisp design",
       [](const O& o) -> Value { return o.worst_compliance; }},
      {"condition", "-", "estimated condition of the stiffness matrix (--condition)",
       [](const O& o) { return optional_number(o.condition); }},
      {"loads", "-", "number of load sets", [](const O& o) -> Value { return o.n_loads; }},
      {"right_hand_sides", "-", "right-hand sides per state solve",
       [](const O& o) -> Value { return o.n_right_hand_sides; }},
      {"component_changes", "-", "components that were removed, split or inserted",
       [](const O& o) -> Value { return static_cast<int>(o.events.size()); }},
      {"stop", "", "why the optimizer stopped", [](const O& o) -> Value { return o.stop; }},
      {"verdict", "", "converged, stagnated, unfinished or evaluated",
       [](const O& o) -> Value { return optim::to_string(o.verdict.kind); }},
      {"improvement", "-", "part by which the objective fell over the last 20 iterations",
       [](const O& o) -> Value {
         if (std::isnan(o.verdict.improvement)) return {};
         return o.verdict.improvement;
       }}};
  return kTable;
}

std::span<const Quantity<mmc::CleanUp>> clean_up_quantities() {
  using C = mmc::CleanUp;
  static const Quantity<C> kTable[] = {
      {"min_feature_wanted", "m", "width of material that was asked for",
       [](const C& c) -> Value { return c.wanted.solid; }},
      {"min_feature_before", "m", "smallest width of material before",
       [](const C& c) -> Value { return c.before.solid; }},
      {"min_gap_wanted", "m", "width of gaps that was asked for",
       [](const C& c) -> Value { return c.wanted.gap; }},
      {"min_gap_before", "m", "smallest width of a gap before",
       [](const C& c) -> Value { return c.before.gap; }},
      {"pieces_before", "-", "pieces of the outline before",
       [](const C& c) -> Value { return c.pieces_before; }},
      {"pieces", "-", "pieces of the outline after it",
       [](const C& c) -> Value { return c.pieces_after; }},
      {"compliance_before", "J", "compliance of the crisp design before",
       [](const C& c) -> Value { return c.compliance_before; }},
      {"compliance_cost", "-", "relative change of this compliance",
       [](const C& c) -> Value { return c.compliance_after / c.compliance_before - 1; }},
      {"patches", "-", "components that were added over narrow places",
       [](const C& c) -> Value { return c.patches; }},
      {"dropped", "-", "components that were removed at narrow places",
       [](const C& c) -> Value { return c.dropped; }},
      {"idle", "-", "unloaded components that were removed",
       [](const C& c) -> Value { return c.idle; }},
      {"stubs", "-", "unloaded ends of components that were removed",
       [](const C& c) -> Value { return c.stubs; }},
      {"joined", "-", "components that were merged with collinear ones",
       [](const C& c) -> Value { return c.joined; }},
      {"born", "-", "bars that were inserted across the void",
       [](const C& c) -> Value { return c.born; }},
      {"rounds", "-", "rounds of the post-processing",
       [](const C& c) -> Value { return c.rounds; }},
      {"torn_gaps", "-", "gaps below the size of a cell that are left",
       [](const C& c) -> Value { return c.torn; }},
      {"reached", "", "whether all widths are as asked for",
       [](const C& c) -> Value { return c.reached(); }},
      {"given_up", "", "whether it would have cost too much compliance and was taken back",
       [](const C& c) -> Value { return c.given_up; }}};
  return kTable;
}

std::span<const Quantity<VerifiedOutline>> outline_quantities() {
  using O = VerifiedOutline;
  using V = Verification;
  static const Quantity<O> kTable[] = {
      {"not_judged", "", "why there is no verification",
       [](const O& o) { return o.verification ? Value() : Value(o.why_not); }},
      {"compliance", "J", "compliance of the exported outline",
       [](const O& o) {
         return where_verified(o, [](const V& v) -> Value { return v.compliance; });
       }},
      {"volume", "-", "part of the domain that the outline covers",
       [](const O& o) { return o.verification ? Value(o.volume) : Value(); }},
      {"islands", "-", "pieces of the outline less one",
       [](const O& o) {
         return where_verified(o, [](const V& v) -> Value { return v.n_pieces - 1; });
       }},
      {"held_by_nothing", "-", "pieces that no support holds",
       [](const O& o) {
         return where_verified(o, [](const V& v) -> Value { return v.n_omitted_pieces; });
       }},
      {"triangles", "-", "six-node triangles of the last mesh",
       [](const O& o) {
         return where_verified(
             o, [](const V& v) -> Value { return static_cast<int>(v.mesh.triangles.size()); });
       }},
      {"seconds", "s", "CPU time",
       [](const O& o) { return where_verified(o, [](const V& v) -> Value { return v.seconds; }); }},
      {"loose_load", "", "load that acts on material that nothing holds",
       [](const O& o) {
         return where_verified(o, [](const V& v) -> Value {
           return std::isfinite(v.compliance) ? Value() : Value(v.unsupported_load);
         });
       }},
      {"error", "-", "estimated relative error of this compliance",
       [](const O& o) { return where_bounded(o, [](const V& v) -> Value { return v.error; }); }},
      {"converged", "", "whether the error is below its tolerance",
       [](const O& o) {
         return where_bounded(o, [](const V& v) -> Value { return v.converged; });
       }},
      {"meshes", "-", "meshes that were solved",
       [](const O& o) { return where_bounded(o, [](const V& v) -> Value { return v.meshes; }); }},
      {"largest_stress", "Pa", "largest von Mises stress away from supports and loads",
       [](const O& o) {
         return where_bounded(o, [](const V& v) -> Value { return v.largest_stress; });
       }},
      {"largest_stress_load", "-", "number of its load, from 1", [](const O& o) {
         return where_bounded(o, [](const V& v) -> Value { return v.largest_load + 1; });
       }}};
  return kTable;
}

std::span<const Quantity<mmc::LoadDifference>> load_difference_quantities() {
  using D = mmc::LoadDifference;
  static const Quantity<D> kTable[] = {
      {"loads", "-", "part of the energy by which its loads differ from those of its own motion",
       [](const D& d) -> Value { return d.loads; }},
      {"geometric", "-",
       "part by which energies of small displacements differ from those of the motion",
       [](const D& d) -> Value { return d.geometric; }}};
  return kTable;
}

std::span<const Quantity<TipVariation>> tip_quantities() {
  using T = TipVariation;
  static const Quantity<T> kTable[] = {
      {"mean", "m", "mean over time of the tip deflection",
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
      {"value", "", "J of the regularized design", [](const C& c) -> Value { return c.value; }},
      {"sharp_value", "", "J of the crisp design",
       [](const C& c) -> Value { return c.sharp_value; }},
      {"kkt", "-", "KKT residual of log J under the limits of the design",
       [](const C& c) -> Value { return c.kkt; }},
      {"angle", "rad", "angle between the gradients of J and of the loads' compliance",
       [](const C& c) -> Value { return c.angle; }},
      {"left", "-", "largest relative decrease of J within the move limit, to first order",
       [](const C& c) -> Value { return c.left; }},
      {"move_limit", "-", "this move limit", [](const C& c) -> Value { return c.move_limit; }},
      {"seconds", "s", "CPU time", [](const C& c) -> Value { return c.seconds; }}};
  return kTable;
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
  append_table("`results[].clean_up`: length-scale post-processing", clean_up_quantities(), out);
  append_table("`results[].body_fitted`: verification of the outline", outline_quantities(), out);
  append_table("`results[].load_difference`: loads against the motion with the design",
               load_difference_quantities(), out);
  append_table("`results[].tip`: tip deflection in the motion", tip_quantities(), out);
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
