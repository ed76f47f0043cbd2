#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cases/accuracy/values.h"
#include "cases/study/orders.h"

/// The discretization parameters of accuracy studies, which make a case finer or coarser.
namespace flexmorph::cases {

/// One level of a refinement series: a setting of a discretization parameter.
struct Level {
  double h = 1;      ///< Parameter relative to the case [-]; it decreases from coarse to fine.
  std::string name;  ///< Name of the level, as "16 x 16 elements".
  std::vector<std::string> overrides;  ///< Overrides "KEY=VALUE"; empty means the unchanged case.
};

/// A row of the table of discretization parameters. Every parameter has a refinement series, which
/// case files call "refinement series".
struct Parameter {
  std::string name;  ///< Name of the parameter.

  /// Name of the group. All parameters of a group have the limit of its leading parameter, which
  /// has the name of the group.
  std::string group;

  Approach approach = Approach::power;  ///< Kind of convergence.
  double cost_exponent = 0;  ///< Estimated exponent of the run time, which is ~ h^-cost_exponent.
  bool has_limit = true;     ///< True if the levels of the parameter have a limit of their own.

  /// Returns the reason why a scene does not have the parameter in this subproblem; empty if it
  /// does.
  std::string (*absent)(const Scene& scene, Part part) = nullptr;

  /// Returns the levels of the scene, coarse to fine. If possible, the unchanged scene is one of
  /// the levels. Some levels may be refused when their case is read.
  std::vector<Level> (*levels)(const Scene& scene, const io::CaseFile& file) = nullptr;

  /// Returns the theoretical order of convergence of a quantity; nothing if there is no theory.
  std::optional<Theory> (*theory)(const Scene& scene, Part part,
                                  const std::string& quantity) = nullptr;

  bool is_setting = true;  ///< True for a setting; false for another model, never recommended.
};

/// Returns the table of all discretization parameters.
const std::vector<Parameter>& parameters();
/// Returns the rows of the table for parameters of designs.
std::vector<Parameter> design_parameters();
/// Returns the row of the table with the given name.
/// @throws Error (input) for an unknown name.
const Parameter& parameter(const std::string& name);

/// Returns a level; it has no overrides if it is the unchanged case.
/// @param h        parameter relative to the case [-]
/// @param is_case  true if the level is the unchanged case
Level make_level(double h, const std::string& name, bool is_case,
                 const std::vector<std::string>& overrides);
/// Returns a theory without an order of convergence, with the reason.
Theory no_order(const std::string& why);
/// Returns numbers as a list of a case file: "[1, 2]".
std::string list_of(const std::vector<double>& values);

}  // namespace flexmorph::cases
