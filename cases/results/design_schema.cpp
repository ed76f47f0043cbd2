#include <cmath>

#include "cases/results/schema.h"

/// Tables of the numbers of designs in run.json.
namespace flexmorph::cases {
namespace {

/// Returns a width of an outline. It is infinite if nothing bounds it, and unknown if the outlines
/// could not be united.
Value width(const mmc::BodyOutcome& o, double Features::*which) {
  if (o.crisp.features) return (*o.crisp.features).*which;
  return nullptr;
}

/// Returns a number that exists only if there is a verification with a finite compliance.
template <class T>
Value where_bounded(const VerifiedOutline& o, const T& value) {
  if (!o.verification || !std::isfinite(o.verification->compliance)) return {};
  return value(*o.verification);
}
/// Returns a number that exists only if there is a verification.
template <class T>
Value where_verified(const VerifiedOutline& o, const T& value) {
  if (!o.verification) return {};
  return value(*o.verification);
}
using Verification = verification::OutlineVerification;

/// Returns a number of the crisp design of an iteration; no value if it was not evaluated.
template <class T>
Value where_crisp(const mmc::IterationReport& r, const T& value) {
  if (r.crisp == nullptr) return {};
  return value(*r.crisp);
}

}  // namespace

std::span<const ResultQuantity<mmc::IterationReport>> iteration_quantities() {
  using R = mmc::IterationReport;
  static const ResultQuantity<R> kTable[] = {
      {"body", "", "name of the designed body", [](const R& r) -> Value { return r.problem.body; }},
      {"cycle", "-", "number of the design cycle, from 1",
       [](const R& r) -> Value { return r.cycle; }},
      {"iteration", "-", "number of the iteration in the cycle, from 1",
       [](const R& r) -> Value { return r.iteration; }},
      {"evaluations", "-", "number of evaluations in the cycle so far",
       [](const R& r) -> Value { return r.evaluations; }},
      {"scaled_objective", "-", "objective as the optimizer scales it, often a logarithm",
       [](const R& r) -> Value { return r.iterate.response->f; }},
      {"compliance", "J", "compliance of the regularized design under its loads",
       [](const R& r) { return optional_number(r.state.compliance()); }},
      {"volume", "-", "volume fraction of the regularized design",
       [](const R& r) -> Value { return r.state.volume(); }},
      {"violation", "-", "largest value of a constraint, at least 0",
       [](const R& r) -> Value { return r.iterate.violation; }},
      {"kkt", "-", "KKT residual of the iteration",
       [](const R& r) -> Value { return r.iterate.kkt; }},
      {"change", "-", "largest change of a scaled variable in the iteration",
       [](const R& r) -> Value { return r.iterate.change; }},
      {"band", "-", "half-width of the band of the Heaviside function in cells",
       [](const R& r) -> Value { return r.state.band() / r.problem.grid.dx(); }},
      {"crisp_compliance", "J", "compliance of the crisp design, where it was evaluated",
       [](const R& r) {
         return where_crisp(r, [](const mmc::CrispDesign& c) -> Value { return c.compliance; });
       }},
      {"crisp_volume", "-", "volume fraction of the crisp design, where it was evaluated",
       [](const R& r) {
         return where_crisp(r, [](const mmc::CrispDesign& c) -> Value { return c.volume; });
       }},
      {"connected", "", "true if material connects every load to a support, where it was evaluated",
       [](const R& r) {
         return where_crisp(
             r, [](const mmc::CrispDesign& c) -> Value { return c.connectivity.connected; });
       }},
      {"min_feature", "m", "smallest width of material of the crisp design, where it was evaluated",
       [](const R& r) {
         return where_crisp(r, [](const mmc::CrispDesign& c) {
           return c.features ? optional_number(c.features->solid) : Value();
         });
       }},
  };
  return kTable;
}

std::span<const ResultQuantity<mmc::BodyOutcome>> design_quantities() {
  using O = mmc::BodyOutcome;
  static const ResultQuantity<O> kTable[] = {
      {"compliance", "J", "compliance of the regularized design under its loads",
       [](const O& o) -> Value { return o.compliance; }},
      {"volume", "-", "volume fraction of the regularized design",
       [](const O& o) -> Value { return o.volume; }},
      {"crisp_compliance", "J", "compliance of the crisp design under its loads",
       [](const O& o) -> Value { return o.crisp.compliance; }},
      {"crisp_volume", "-", "volume fraction of the crisp design",
       [](const O& o) -> Value { return o.crisp.volume; }},
      {"uniform_compliance", "J", "compliance of uniform material of equal volume",
       [](const O& o) -> Value { return o.uniform_compliance; }},
      {"compliance_ratio", "-", "crisp_compliance divided by uniform_compliance",
       [](const O& o) -> Value { return o.crisp.compliance / o.uniform_compliance; }},
      {"crisp_ratio", "-", "crisp_compliance divided by compliance",
       [](const O& o) -> Value { return o.crisp.compliance / o.compliance; }},
      {"connected", "", "true if material connects every load to a support",
       [](const O& o) -> Value { return o.crisp.connectivity.connected; }},
      {"islands", "-", "number of connected regions of material minus one",
       [](const O& o) -> Value { return o.crisp.connectivity.islands; }},
      {"symmetry", "",
       "symmetry about a line x = constant (x), a line y = constant (y), both, or none",
       [](const O& o) -> Value { return to_string(o.symmetry); }},
      {"min_feature", "m", "smallest width of material of the crisp design",
       [](const O& o) { return width(o, &Features::solid); }},
      {"min_gap", "m", "smallest width of a gap of the crisp design",
       [](const O& o) { return width(o, &Features::gap); }},
      {"iterations", "-", "number of design iterations",
       [](const O& o) -> Value { return o.iterations; }},
      {"start", "-", "number of the start from which the design was optimized",
       [](const O& o) -> Value { return o.start; }},
      {"state_solves", "-", "number of evaluations of the static problem",
       [](const O& o) -> Value { return o.evaluations; }},
      {"kkt", "-", "KKT residual of the design problem",
       [](const O& o) { return o.of_part ? Value() : Value(o.kkt); }},
      {"factorizations", "-", "number of factorizations of stiffness matrices of designs",
       [](const O& o) -> Value { return o.factorizations; }},
      {"worst_compliance", "J", "largest compliance of the crisp design under one load",
       [](const O& o) -> Value { return o.worst_compliance; }},
      {"condition", "-", "estimated condition number of the stiffness matrix (--condition)",
       [](const O& o) { return optional_number(o.condition); }},
      {"loads", "-", "number of load sets", [](const O& o) -> Value { return o.n_loads; }},
      {"right_hand_sides", "-", "number of right-hand sides per state solve",
       [](const O& o) -> Value { return o.n_right_hand_sides; }},
      {"stop", "", "reason why the optimizer stopped", [](const O& o) -> Value { return o.stop; }},
      {"verdict", "", "state of the design: converged, stagnated, unfinished or evaluated",
       [](const O& o) -> Value { return optim::to_string(o.verdict.kind); }},
      {"improvement", "-", "relative decrease of the objective over the last 20 iterations",
       [](const O& o) -> Value {
         if (std::isnan(o.verdict.improvement)) return {};
         return o.verdict.improvement;
       }}};
  return kTable;
}

std::span<const ResultQuantity<mmc::BodyOutcome>> length_scale_quantities() {
  using O = mmc::BodyOutcome;
  static const ResultQuantity<O> kTable[] = {
      {"min_feature_wanted", "m", "required smallest width of material",
       [](const O& o) -> Value { return o.length_scale->wanted.solid; }},
      {"min_gap_wanted", "m", "required smallest width of gaps",
       [](const O& o) -> Value { return o.length_scale->wanted.gap; }},
      {"removed", "-", "number of unloaded components that were removed",
       [](const O& o) -> Value { return o.length_scale->removed; }},
      {"widened", "-",
       "number of narrow locations of the finished part that were widened by a disc",
       [](const O& o) -> Value { return o.crisp.widened; }},
      {"given_width", "m",
       "smallest width of material that solid regions or borders of the domain determine, if it is "
       "below the required one",
       [](const O& o) -> Value {
         return o.crisp.given_width ? Value(*o.crisp.given_width) : Value();
       }},
      {"reached", "",
       "true if the outline is one connected region with the required widths, within 1 %",
       [](const O& o) -> Value { return o.reaches_length_scale(); }}};
  return kTable;
}

std::span<const ResultQuantity<VerifiedOutline>> outline_quantities() {
  using O = VerifiedOutline;
  using V = Verification;
  static const ResultQuantity<O> kTable[] = {
      {"not_verified", "", "reason why the outline was not verified",
       [](const O& o) { return o.verification ? Value() : Value(o.why_not); }},
      {"compliance", "J", "compliance of the exported outline",
       [](const O& o) {
         return where_verified(o, [](const V& v) -> Value { return v.compliance; });
       }},
      {"volume", "-", "fraction of the domain that the outline covers",
       [](const O& o) { return o.verification ? Value(o.volume) : Value(); }},
      {"curve_tolerance", "m",
       "largest allowed distance of the curves in .dxf and .step files from the outline",
       [](const O& o) -> Value { return o.curve_tolerance; }},
      {"islands", "-", "number of connected regions of the outline minus one",
       [](const O& o) {
         return where_verified(o, [](const V& v) -> Value { return v.n_connected_regions - 1; });
       }},
      {"held_by_nothing", "-", "number of connected regions without a support",
       [](const O& o) {
         return where_verified(o, [](const V& v) -> Value { return v.n_omitted_regions; });
       }},
      {"triangles", "-", "number of six-node triangles of the last mesh",
       [](const O& o) {
         return where_verified(
             o, [](const V& v) -> Value { return static_cast<int>(v.mesh.triangles.size()); });
       }},
      {"seconds", "s", "CPU time of the verification",
       [](const O& o) { return where_verified(o, [](const V& v) -> Value { return v.seconds; }); }},
      {"loose_load", "", "name of a load that acts on material without a support",
       [](const O& o) {
         return where_verified(o, [](const V& v) -> Value {
           return std::isfinite(v.compliance) ? Value() : Value(v.unsupported_load);
         });
       }},
      {"error", "-", "estimated relative error of the compliance of the outline",
       [](const O& o) { return where_bounded(o, [](const V& v) -> Value { return v.error; }); }},
      {"converged", "", "true if the estimated error is below its tolerance",
       [](const O& o) {
         return where_bounded(o, [](const V& v) -> Value { return v.converged; });
       }},
      {"meshes", "-", "number of meshes that were solved",
       [](const O& o) { return where_bounded(o, [](const V& v) -> Value { return v.meshes; }); }},
      {"largest_stress", "Pa", "largest von Mises stress away from supports and loads",
       [](const O& o) {
         return where_bounded(o, [](const V& v) -> Value { return v.largest_stress; });
       }},
      {"largest_stress_load", "-", "number of the load that causes the largest stress, from 1",
       [](const O& o) {
         return where_bounded(o, [](const V& v) -> Value { return v.largest_load + 1; });
       }}};
  return kTable;
}

std::span<const ResultQuantity<StaticLoad>> static_load_quantities() {
  using L = StaticLoad;
  static const ResultQuantity<L> kTable[] = {
      {"load", "", "name of the load case", [](const L& l) -> Value { return l.name; }},
      {"weight", "-", "weight of the load case", [](const L& l) -> Value { return l.weight; }},
      {"compliance", "J", "compliance of the crisp design on the design mesh",
       [](const L& l) -> Value { return l.compliance; }},
      {"active", "", "true if the compliance is within 1 % of the largest compliance of all loads",
       [](const L& l) -> Value { return l.active; }},
      {"strain_energy", "J",
       "strain energy (half the compliance), computed with the model `source`",
       [](const L& l) -> Value { return l.strain_energy; }},
      {"largest_displacement", "m",
       "largest displacement of the material, computed with the model `source`",
       [](const L& l) -> Value { return l.largest_displacement; }},
      {"largest_stress", "Pa",
       "largest von Mises stress, computed with the model `source`: away from supports and loads "
       "(`outline`), or at the centres of cells (`cells`)",
       [](const L& l) -> Value { return l.largest_stress; }},
      {"source", "",
       "model of energy, displacement and stress: `outline` (mesh of the outline) or `cells` "
       "(design mesh)",
       [](const L& l) -> Value { return l.source; }}};
  return kTable;
}

std::span<const ResultQuantity<mmc::LoadDifference>> load_difference_quantities() {
  using D = mmc::LoadDifference;
  static const ResultQuantity<D> kTable[] = {
      {"loads", "-",
       "relative energy difference of the loads of the design from the loads of its own motion",
       [](const D& d) -> Value { return d.loads; }},
      {"geometric", "-",
       "relative difference of the energies at small displacements from the energies of the motion",
       [](const D& d) -> Value { return d.geometric; }}};
  return kTable;
}

}  // namespace flexmorph::cases
