#pragma once

#include <string>

#include "cases/accuracy/study.h"

/// Output of an accuracy study on the terminal and in files.
namespace flexmorph::cases {

/// Returns the tables and messages of a study as text for a terminal.
std::string accuracy_text(const AccuracyStudy& study);
/// Returns the tables and messages of a study as Markdown.
std::string accuracy_markdown(const AccuracyStudy& study);
/// Writes a CSV file with a row per level and quantity, in full precision.
/// @throws Error (input) when the file cannot be written.
void write_accuracy_csv(const AccuracyStudy& study, const std::string& path);
/// Returns plots as SVG: the errors against CPU time with their Pareto front, and the errors
/// against the discretization parameters with the fitted orders.
std::string accuracy_svg(const AccuracyStudy& study);

/// Returns the indices of the points of the Pareto front in the order of increasing cost. No other
/// point is at most equal to them in both cost and error. Points that are not finite are ignored.
std::vector<size_t> pareto_front(const std::vector<std::pair<double, double>>& cost_and_error);

}  // namespace flexmorph::cases
