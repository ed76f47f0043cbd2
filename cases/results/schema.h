#pragma once

#include <cmath>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <variant>

#include "cases/results/run_result.h"

/// The numbers of run.json: name, unit, meaning and accessor of each. run.json, [expect] and the
/// reference in cases/README.md are made from these tables.
namespace flexmorph::cases {

/// A value of a number; std::monostate where a run has no such number, nullptr where it is unknown.
using Value = std::variant<std::monostate, std::nullptr_t, bool, int, double, std::string>;

/// Returns a number, or nothing where it is absent or not finite.
Value optional_number(const std::optional<double>& number);

/// A number (or flag, or word) that a part of a result has.
template <class Source>
struct Quantity {
  const char *name, *unit, *meaning;
  Value (*value)(const Source&);
};

std::span<const Quantity<mmc::BodyOutcome>> design_quantities();
/// Of designs whose widths are limited.
std::span<const Quantity<mmc::BodyOutcome>> length_scale_quantities();
std::span<const Quantity<VerifiedOutline>> outline_quantities();
std::span<const Quantity<StaticLoad>> static_load_quantities();
std::span<const Quantity<mmc::LoadDifference>> load_difference_quantities();
std::span<const Quantity<PointVariation>> point_quantities();
std::span<const Quantity<fem::MotionResult>> motion_quantities();
std::span<const Quantity<PathRecord>> path_quantities();
std::span<const Quantity<mmc::CycleVerdict>> cycle_quantities();
std::span<const Quantity<mmc::CorrectedCycle>> corrected_cycle_quantities();
std::span<const Quantity<mmc::MotionCertificate>> certificate_quantities();

/// A value as text, empty where there is none; numbers in full precision.
std::string text_of(const Value& value);
/// A value as JSON: "infinite" of an infinite number, null of one that is not a number.
nlohmann::ordered_json json_of(const Value& value);

/// All tables as Markdown, for cases/README.md.
std::string results_as_markdown();

/// Replaces the references of keys and of results in the text of cases/README.md.
/// @throws Error (input) for a file without the lines that mark them
std::string with_references(const std::string& text);

}  // namespace flexmorph::cases
