#pragma once

#include <string>

#include "cases/accuracy/study.h"

/// What a study of accuracy says: on the terminal and in its files.
namespace flexmorph::cases {

/// Tables and sentences for a terminal.
std::string accuracy_text(const AccuracyStudy& study);
/// The same as Markdown.
std::string accuracy_markdown(const AccuracyStudy& study);
/// A row per level and quantity, in full precision; what a clock measured comes last.
/// @throws Error (input) when it cannot be written.
void write_accuracy_csv(const AccuracyStudy& study, const std::string& path);
/// Errors against CPU time with their Pareto front, and against the knobs with the fitted orders.
std::string accuracy_svg(const AccuracyStudy& study);

}  // namespace flexmorph::cases
