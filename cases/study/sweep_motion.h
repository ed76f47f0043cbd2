#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cases/study/study.h"
#include "io/plots.h"

/// What a sweep shows of scenes that are not designed: the observed quantities of all variants, one
/// over the other.
namespace flexmorph::cases {

/// Columns of motion.csv (or of path.csv of a static analysis) by name, the first against which the
/// others are drawn; empty when there is no such file. A reference has the same form.
struct Motions {
  std::string label;
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;

  const std::vector<double>* column(const std::string& name) const;
};
/// Of a run folder. @throws Error (input) when a file cannot be parsed.
Motions read_motions(const std::string& directory, const std::string& label);
/// The deflection of a body's tip in the motion of its design.
struct Deflection {
  std::vector<double> time, value;  // [s], [m]
  double largest() const;           ///< size [m]
};
/// Returns the deflection on the mesh that verifies the design where there is one; none for a body
/// without a tip. @throws Error (input) when a file cannot be parsed.
std::optional<Deflection> deflection_of(const VariantResult& run, const std::string& body);
/// Of a file of the same form. @throws Error (input) when it cannot be read.
Motions read_reference(const std::string& path);

/// A panel per column that is not constant, a curve per variant; points of the reference where it
/// has that column.
io::Figure motion_figure(const std::string& title, std::span<const Motions> variants,
                         const Motions& reference);

/// What the runs of a sweep came to, against the numbers that were varied: a panel per column that
/// differs between runs, T Fig. 15. `change` is that of the value at the end of the run against the
/// first of its curve [%] where that is not zero, else the value at the end.
/// @param label   of the numbers
/// @param number  of every variant
/// @param curve   what else was varied: variants of the same one make a curve
io::Figure final_figure(const std::string& title, const std::string& label,
                        std::span<const Motions> variants, std::span<const double> number,
                        std::span<const std::string> curve);

/// A row per variant and observed column: smallest, largest and last value.
std::vector<std::vector<std::string>> motion_table(std::span<const Motions> variants,
                                                   std::span<const VariantResult> runs);

}  // namespace flexmorph::cases
