#include <algorithm>
#include <cmath>
#include <locale>
#include <ranges>
#include <sstream>

#include "geometry/registry.h"
#include "geometry/text.h"
#include "optim/makers.h"

namespace flexmorph::optim {
namespace {

const OptimizerRow kMma{"mma", make_mma}, kGcmma{"gcmma", make_mma},
    kNloptMma{"nlopt_mma", make_nlopt}, kNloptCcsaq{"nlopt_ccsaq", make_nlopt},
    kIpopt{"ipopt", make_ipopt};

Registry<OptimizerRow>& registry() {
  static Registry<OptimizerRow> all("optimizer",
                                    [](const OptimizerRow& row) -> std::string { return row.name; },
                                    {&kMma, &kGcmma, &kNloptMma, &kNloptCcsaq, &kIpopt});
  return all;
}

std::string number(double value) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << value;
  return text.str();
}

void check_setting(bool holds, const std::string& what) {
  if (!holds) throw Error::input("optimizer: " + what);
}

}  // namespace

std::string to_string(Stop stop) {
  switch (stop) {
    case Stop::converged:
      return "converged";
    case Stop::plateau:
      return "plateau";
    case Stop::iteration_limit:
      return "iteration limit";
    case Stop::evaluation_limit:
      return "limit of state solves";
    case Stop::observer:
      return "observer";
    case Stop::stalled:
      return "stalled";
    case Stop::failed:
      return "failed";
  }
  return "unknown";
}

void register_optimizer(const OptimizerRow& row) {
  if (!row.make) throw Error::input("optimizer '" + std::string(row.name) + "' has no make()");
  registry().add(row);
}

std::vector<std::string> optimizer_names() {
  std::vector<std::string> names;
  for (const OptimizerRow* row : registry().rows()) names.emplace_back(row->name);
  std::ranges::sort(names);
  return names;
}

std::unique_ptr<Optimizer> make_optimizer(const Settings& settings) {
  const OptimizerRow* row = registry().find(settings.name);
  if (row == nullptr) {
    throw Error::input("optimizer '" + settings.name +
                       "' is unknown; the available optimizers are: " + joined(optimizer_names()));
  }
  check_setting(settings.max_iterations >= 1, "max_iterations is at least 1");
  check_setting(settings.kkt_tolerance >= 0, "kkt_tolerance is not negative");
  check_setting(settings.feasibility > 0, "feasibility is positive");
  check_setting(settings.change_tolerance >= 0, "change_tolerance is not negative");
  check_setting(settings.rest.rows >= 0 && settings.rest.objective >= 0 && settings.rest.kkt >= 0,
                "rows and tolerances of the stopping window must not be negative");
  check_setting(settings.move_limit > 0 && std::isfinite(settings.move_limit),
                "move_limit is positive");
  return row->make(settings);
}

Options with_defaults(const Settings& settings, const Options& defaults) {
  Options options = defaults;
  for (const auto& [name, value] : settings.options) {
    const auto known = options.find(name);
    if (known == options.end())
      throw Error::input(
          "optimizer '" + settings.name + "': option '" + name +
          "' is unknown; the available options are: " + joined(std::views::keys(defaults)));
    if (!std::isfinite(value)) {
      throw Error::input("optimizer '" + settings.name + "': option '" + name + "' is not finite");
    }
    known->second = value;
  }
  return options;
}

void check_option(const Settings& settings, const std::string& option, double value, double low,
                  double high) {
  if (value >= low && value <= high) return;
  throw Error::input("optimizer '" + settings.name + "': option '" + option + "' = " +
                     number(value) + ": it lies between " + number(low) + " and " + number(high));
}

}  // namespace flexmorph::optim
