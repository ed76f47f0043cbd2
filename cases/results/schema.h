#pragma once

#include <cmath>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <variant>

#include "cases/results/run_result.h"

/// Tables of the numbers of run.json: name, unit, meaning and accessor of each number. run.json,
/// [expect] and the reference in cases/docs/keys.md are generated from these tables.
namespace flexmorph::cases {

/// The value of a number: std::monostate if a run has no such number, nullptr if it is unknown.
using Value = std::variant<std::monostate, std::nullptr_t, bool, int, double, std::string>;

/// Returns a number, or std::monostate if it is absent or not finite.
Value optional_number(const std::optional<double>& number);

/// A named number (or flag, or text) of a component of a result.
template <class Source>
struct ResultQuantity {
  const char *name, *unit, *meaning;  ///< Name in run.json, unit, and meaning as text.
  Value (*value)(const Source&);      ///< Returns the value of the number.
};

/// Returns the numbers of the outcome of a design.
std::span<const ResultQuantity<mmc::BodyOutcome>> design_quantities();
/// Returns the values of a design iteration, which are the first columns of history.csv.
std::span<const ResultQuantity<mmc::IterationReport>> iteration_quantities();
/// Returns the numbers of the outcome of a design whose widths are limited.
std::span<const ResultQuantity<mmc::BodyOutcome>> length_scale_quantities();
/// Returns the numbers of the verification of an outline.
std::span<const ResultQuantity<VerifiedOutline>> outline_quantities();
/// Returns the numbers of a load case of a static plate.
std::span<const ResultQuantity<StaticLoad>> static_load_quantities();
/// Returns the numbers of the difference between the loads of a design and of its motion.
std::span<const ResultQuantity<mmc::LoadDifference>> load_difference_quantities();
/// Returns the numbers of the deflection of a point.
std::span<const ResultQuantity<PointVariation>> point_quantities();
/// Returns the numbers of a motion.
std::span<const ResultQuantity<fem::MotionResult>> motion_quantities();
/// Returns the numbers of a path of equilibria.
std::span<const ResultQuantity<PathRecord>> path_quantities();
/// Returns the numbers of a design cycle.
std::span<const ResultQuantity<mmc::CycleVerdict>> cycle_quantities();
/// Returns the numbers of a corrected cycle.
std::span<const ResultQuantity<mmc::CorrectedCycle>> corrected_cycle_quantities();
/// Returns the numbers of an optimality certificate.
std::span<const ResultQuantity<mmc::OptimalityCertificate>> certificate_quantities();

/// Returns a value as text: numbers in full precision, and an empty text if there is no value.
std::string text_of(const Value& value);
/// Returns a value as JSON: "infinite" for an infinite number, null for NaN and for no value.
nlohmann::ordered_json json_of(const Value& value);

/// Returns all tables as Markdown, for cases/docs/keys.md.
std::string results_as_markdown();

/// Replaces the references of keys and of results in the text of cases/docs/keys.md and returns the
/// text.
/// @throws Error (input) for a text without the lines that mark the references
std::string with_references(const std::string& text);

}  // namespace flexmorph::cases
