#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cases/accuracy/values.h"
#include "cases/study/orders.h"

/// The parameters of accuracy: what of a case can be made finer or coarser.
namespace flexmorph::cases {

/// One setting of a parameter.
struct Level {
  double h = 1;                        ///< relative to the case itself; falls from coarse to fine
  std::string name;                    ///< "16 x 16 elements"
  std::vector<std::string> overrides;  ///< KEY=VALUE; empty: the case as it is
};

/// A row of the table of parameters. Each has a refinement series, which case files call a ladder.
struct Parameter {
  std::string name;
  std::string group;  ///< parameters of a group share the limit of the one named like the group
  Approach approach = Approach::power;
  double cost_exponent = 0;  ///< run time ~ h^-cost_exponent, a first guess
  bool has_limit = true;     ///< do the levels of the parameter have a limit of their own?
  /// Returns why a scene does not have the parameter in this part; empty: it has it.
  std::string (*absent)(const Scene& scene, Part part) = nullptr;
  /// Returns the levels of the scene, coarse to fine; the scene itself is one of them where it can
  /// be. Some may be refused when they are read.
  std::vector<Level> (*levels)(const Scene& scene, const io::CaseFile& file) = nullptr;
  std::optional<Theory> (*theory)(const Scene& scene, Part part,
                                  const std::string& quantity) = nullptr;
  bool is_setting = true;  ///< false: another model, which is never recommended
};

const std::vector<Parameter>& parameters();
/// Returns the rows of the table that are about designs.
std::vector<Parameter> design_parameters();
/// Returns the row of that name. @throws Error (input) for an unknown name.
const Parameter& parameter(const std::string& name);

/// Returns a level; where it is the case itself, without overrides.
Level make_level(double h, const std::string& name, bool is_case,
                 const std::vector<std::string>& overrides);
/// Returns a theory that knows of no order, and why.
Theory no_order(const std::string& why);
/// Returns "[1, 2]".
std::string list_of(const std::vector<double>& values);

}  // namespace flexmorph::cases
