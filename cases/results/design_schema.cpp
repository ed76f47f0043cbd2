#include <cmath>

#include "cases/results/schema.h"

/// Tables of the numbers of designs in run.json.
namespace flexmorph::cases {
namespace {

/// Returns a width of an outline. It is infinite if nothing bounds it, and unknown if the outlines
/// could not be united.
Value width(const mmc::BodyOutcome& o, double Features::*which) {
  if (o.sharp.features) return (*o.sharp.features).*which;
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
      {"symmetry", "", "mirrored in the middle line along y (x), along x (y), in both, or none",
       [](const O& o) -> Value { return to_string(o.symmetry); }},
      {"min_feature", "m", "smallest width of material of the outline",
       [](const O& o) { return width(o, &Features::solid); }},
      {"min_gap", "m", "smallest width of a gap of the outline",
       [](const O& o) { return width(o, &Features::gap); }},
      {"iterations", "-", "design iterations", [](const O& o) -> Value { return o.iterations; }},
      {"start", "-", "number of the start that the design comes from",
       [](const O& o) -> Value { return o.start; }},
      {"state_solves", "-", "evaluations of the static problem",
       [](const O& o) -> Value { return o.evaluations; }},
      {"kkt", "-", "KKT residual of the design problem",
       [](const O& o) { return o.of_part ? Value() : Value(o.kkt); }},
      {"factorizations", "-", "factorizations of the stiffness matrix",
       [](const O& o) -> Value { return o.factorizations; }},
      {"worst_compliance", "J", "largest compliance of a load, of the crisp design",
       [](const O& o) -> Value { return o.worst_compliance; }},
      {"condition", "-", "estimated condition of the stiffness matrix (--condition)",
       [](const O& o) { return optional_number(o.condition); }},
      {"loads", "-", "number of load sets", [](const O& o) -> Value { return o.n_loads; }},
      {"right_hand_sides", "-", "right-hand sides per state solve",
       [](const O& o) -> Value { return o.n_right_hand_sides; }},
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

std::span<const Quantity<mmc::BodyOutcome>> length_scale_quantities() {
  using O = mmc::BodyOutcome;
  static const Quantity<O> kTable[] = {
      {"min_feature_wanted", "m", "width of material that was asked for",
       [](const O& o) -> Value { return o.length_scale->wanted.solid; }},
      {"min_gap_wanted", "m", "width of gaps that was asked for",
       [](const O& o) -> Value { return o.length_scale->wanted.gap; }},
      {"removed", "-", "components that carried nothing and were removed",
       [](const O& o) -> Value { return o.length_scale->removed; }},
      {"widened", "-", "narrow places of the part with its fillets that a disc widened",
       [](const O& o) -> Value { return o.sharp.widened; }},
      {"reached", "", "whether the outline is one piece with these widths, within a hundredth",
       [](const O& o) -> Value { return o.reaches_length_scale(); }}};
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
      {"curve_tolerance", "m", "how far curves of .dxf and .step may be off the outline",
       [](const O& o) -> Value { return o.curve_tolerance; }},
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

std::span<const Quantity<StaticLoad>> static_load_quantities() {
  using L = StaticLoad;
  static const Quantity<L> kTable[] = {
      {"load", "", "name of the load case", [](const L& l) -> Value { return l.name; }},
      {"weight", "-", "weight of the load case", [](const L& l) -> Value { return l.weight; }},
      {"compliance", "J", "compliance of the crisp design, on its cells",
       [](const L& l) -> Value { return l.compliance; }},
      {"active", "", "whether this is within 1 % of the largest compliance",
       [](const L& l) -> Value { return l.active; }},
      {"strain_energy", "J", "strain energy, half the compliance, by `source`",
       [](const L& l) -> Value { return l.strain_energy; }},
      {"largest_displacement", "m", "largest displacement of the material, by `source`",
       [](const L& l) -> Value { return l.largest_displacement; }},
      {"largest_stress", "Pa",
       "largest von Mises stress by `source`: of an outline away from supports and loads, of cells "
       "at their centres",
       [](const L& l) -> Value { return l.largest_stress; }},
      {"source", "", "`outline`: its verification; `cells`: those of the crisp design",
       [](const L& l) -> Value { return l.source; }}};
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

}  // namespace flexmorph::cases
