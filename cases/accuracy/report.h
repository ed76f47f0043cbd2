#pragma once

#include <string>

#include "cases/accuracy/study.h"

/// What a study of accuracy says on the terminal and in its files.
namespace flexmorph::cases {

/// Returns tables and sentences for a terminal.
std::string accuracy_text(const AccuracyStudy& study);
/// Returns the text as Markdown.
std::string accuracy_markdown(const AccuracyStudy& study);
/// Writes a row per level and quantity, in full precision.
/// @throws Error (input) when the file cannot be written.
void write_accuracy_csv(const AccuracyStudy& study, const std::string& path);
/// Returns plots of the errors against CPU time with their Pareto front, and against the
/// parameters with the fitted orders.
std::string accuracy_svg(const AccuracyStudy& study);

/// Returns the indices of the points that no other point beats or equals in cost and error, by
/// rising cost. Points that are not finite are ignored.
std::vector<size_t> pareto_front(const std::vector<std::pair<double, double>>& cost_and_error);

}  // namespace flexmorph::cases
