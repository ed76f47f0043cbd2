#include "cases/run/design_problem.h"

#include <algorithm>
#include <cmath>

#include "cases/run/motion_run.h"
#include "geometry/text.h"
#include "optim/mmc/cycles/optimality_certificate.h"
#include "optim/mmc/cycles/usability.h"
#include "optim/mmc/problem/finished_part.h"

namespace flexmorph::cases {
namespace {

/// Names of the parameters of a component, as in components.csv.
constexpr const char* kParameterNames[Component::kParameters] = {"X0", "Y0", "half_length", "angle",
                                                                 "c1", "c2", "c3"};

/// Returns the indices of the bodies that are designed together.
/// @throws Error (input) for an unknown body, or if the case has several bodies and none is named
std::vector<size_t> chosen(const std::vector<mmc::BodyProblem>& all,
                           const DesignProblemSettings& settings) {
  if (all.empty()) throw Error::input("this case has no [[design]]");
  std::vector<std::string> names;
  for (const mmc::BodyProblem& p : all) names.push_back(p.body);
  const auto found = std::find(names.begin(), names.end(), settings.body);
  if (found == names.end() && !settings.body.empty())
    throw Error::input("body '" + settings.body +
                       "' is not designed; the designed bodies are: " + joined(names));
  std::vector<size_t> out;
  for (size_t k = 0; k < all.size(); ++k) {
    const bool named = found != names.end() && names[k] == settings.body;
    const bool shares = found != names.end() && all[k].shares_mass &&
                        all[static_cast<size_t>(found - names.begin())].shares_mass;
    const bool together = settings.of_motion || (settings.body.empty() && all[k].shares_mass);
    if (named || shares || together || all.size() == 1) out.push_back(k);
  }
  if (out.empty())
    throw Error::input("this case designs several bodies; name one of them: " + joined(names));
  return out;
}

/// Computes the equivalent static loads of the motion with the start designs, one entry per design.
std::vector<fem::EslSets> first_loads(const PreparedCase& prepared,
                                      const DesignProblemSettings& settings) {
  MotionRequest request;
  for (const mmc::BodyProblem& p : prepared.design_problems())
    request.factors.push_back(mmc::dynamic_factors(p, p.design.components()));
  request.loads = true;
  request.keep_running = settings.keep_running;
  return run_motion(prepared, request).loads;
}

mmc::Formulation formulation(const mmc::BodyProblem& problem, DesignStage stage) {
  if (stage == DesignStage::coarse) return mmc::nominal(problem, 0);
  if (stage == DesignStage::eroded) return mmc::eroded(problem);
  return mmc::last_formulation(problem);
}

}  // namespace

/// The bodies with their start designs and their loads.
struct DesignProblem::Loaded {
  const PreparedCase& prepared;
  DesignProblemSettings settings;
  std::vector<mmc::BodyProblem> problems;
  std::vector<std::unique_ptr<mmc::ComplianceEvaluator>> loads;
  std::vector<mmc::Subproblem> parts;
  std::unique_ptr<SceneMotion> motion;

  Loaded(const PreparedCase& of, DesignProblemSettings given)
      : prepared(of), settings(std::move(given)) {
    const std::vector<mmc::BodyProblem>& all = prepared.design_problems();
    const std::vector<size_t> bodies = chosen(all, settings);
    const bool moves = !prepared.scene().domain;
    if (settings.of_motion && !moves)
      throw Error::input("this case has no motion, therefore it has no responses of a motion");
    std::vector<fem::EslSets> sets;
    if (moves) sets = first_loads(prepared, settings);
    for (const size_t k : bodies) {
      const mmc::BodyProblem& p = problems.emplace_back(all[k]);
      if (!moves) {
        loads.push_back(build_static_loads(prepared.scene(), p));
        continue;
      }
      const mmc::CellScaleFactors factors =
          mmc::ersatz_of(p).crisp(mmc::part_fractions(p, p.design.components()));
      loads.push_back(std::make_unique<mmc::ComplianceEvaluator>(sets[k], p.section, p.compliance,
                                                                 factors.stiffness, factors.mass));
    }
    for (size_t k = 0; k < problems.size(); ++k)
      parts.emplace_back(mmc::LoadedBody{problems[k], *loads[k]});
    if (!settings.of_motion) return;
    const auto always = [] { return true; };
    motion = std::make_unique<SceneMotion>(prepared,
                                           SceneMotion::Settings{settings.cell, settings.step, 0},
                                           settings.keep_running ? settings.keep_running : always);
  }
};

DesignProblem::DesignProblem(const PreparedCase& prepared, const DesignProblemSettings& settings)
    : DesignProblem(std::make_shared<const Loaded>(prepared, settings), settings.stage, {}) {}

DesignProblem::DesignProblem(std::shared_ptr<const Loaded> loaded, DesignStage stage,
                             std::vector<mmc::Design> designs)
    : loaded_(std::move(loaded)), stage_(stage) {
  const std::vector<mmc::Subproblem>& parts = loaded_->parts;
  for (const mmc::BodyProblem& p : loaded_->problems)
    formulations_.push_back(formulation(p, stage));
  if (designs.empty()) designs = mmc::designs_of(parts);
  if (!loaded_->motion) {
    combined_ = std::make_unique<mmc::CombinedProblem>(parts, std::move(designs), formulations_);
    return;
  }
  motion_ = std::make_unique<mmc::MotionState>(mmc::motion_state_of(parts, *loaded_->motion));
  combined_ =
      std::make_unique<mmc::CombinedProblem>(parts, std::move(designs), formulations_, *motion_);
}

DesignProblem DesignProblem::at(DesignStage stage, const VectorXd& x) const {
  if (x.size() != combined_->problem().n_variables())
    throw Error::input("a design of this problem has " +
                       std::to_string(combined_->problem().n_variables()) + " variables, not " +
                       std::to_string(x.size()));
  return {loaded_, stage, combined_->designs_at(x)};
}

/// Returns the limits of the designs that were evaluated last for which crisp and regularized
/// values may differ.
std::vector<DesignProblem::RegularizedLimit> DesignProblem::regularized_limits() const {
  std::vector<RegularizedLimit> out;
  for (size_t b = 0; b < loaded_->problems.size(); ++b) {
    const mmc::MmcProblem& state = combined_->states[b];
    const std::vector<mmc::Limit>& limits = state.goal().limits;
    for (size_t k = 0; k < limits.size(); ++k) {
      const mmc::Limit& limit = limits[k];
      const std::optional<VectorXd> values = state.values(*limit.row);
      const bool is_shared = loaded_->problems.size() > 1 && loaded_->problems[b].shares_mass;
      if (!values || limit.row->of_motion || is_shared) continue;
      for (Eigen::Index l = 0; l < values->size(); ++l)
        out.push_back({combined_->row_of(b, k) + l, limit.at_least ? -1.0 : 1.0,
                       limit.row->per_load || !limit.row->full, (*values)[l] / limit.value});
    }
  }
  return out;
}

optim::ProblemValues DesignProblem::evaluate(const VectorXd& x) {
  optim::Problem& of_crisp = combined_->problem();
  if (stage_ != DesignStage::last) return of_crisp.evaluate(x);
  const auto ratio = [](const RegularizedLimit& limit, double g) {
    const double part = limit.is_logarithm ? std::exp(limit.sign * g) : 1 + limit.sign * g;
    return part / limit.part;
  };
  if (!ratios_) {
    const optim::ProblemValues start = of_crisp.evaluate(of_crisp.start());
    ratios_.emplace();
    for (const RegularizedLimit& limit : regularized_limits())
      ratios_->push_back(ratio(limit, start.g[limit.row]));
  }
  optim::ProblemValues out = of_crisp.evaluate(x);
  size_t next = 0;
  for (const RegularizedLimit& limit : regularized_limits()) {
    const double at_start = (*ratios_)[next++], part = at_start * limit.part;
    if (!limit.is_logarithm) out.dg.row(limit.row) *= at_start / ratio(limit, out.g[limit.row]);
    out.g[limit.row] = limit.sign * (limit.is_logarithm ? std::log(part) : part - 1);
  }
  return out;
}

std::vector<std::string> DesignProblem::bodies() const {
  std::vector<std::string> out;
  for (const mmc::BodyProblem& p : loaded_->problems) out.push_back(p.body);
  return out;
}

std::vector<std::string> DesignProblem::variable_names() const {
  std::vector<std::string> out;
  for (size_t b = 0; b < loaded_->problems.size(); ++b) {
    const std::string body = loaded_->problems[b].body + ".";
    const int n = combined_->designs()[b].n_variables();
    for (int i = 0; i < n; ++i)
      out.push_back(body + std::to_string(i / Component::kParameters + 1) + "." +
                    kParameterNames[i % Component::kParameters]);
    if (combined_->states[b].n_variables() > n) out.push_back(body + "bound");
  }
  return out;
}

std::vector<std::string> DesignProblem::constraint_names() {
  std::vector<std::string> out(static_cast<size_t>(combined_->problem().n_constraints()));
  for (size_t b = 0; b < loaded_->problems.size(); ++b) {
    const mmc::MmcProblem& state = combined_->states[b];
    const std::string body = loaded_->problems.size() > 1 ? loaded_->problems[b].body + "." : "";
    const auto each_load = [&](size_t first, const mmc::ResponseRow& row, const std::string& name) {
      if (!row.per_load) return void(out.at(first) = name);
      for (int l = 0; l < loaded_->loads[b]->n_loads(); ++l)
        out.at(first + static_cast<size_t>(l)) = name + "." + std::to_string(l + 1);
    };
    const std::vector<mmc::Limit>& limits = state.goal().limits;
    for (size_t k = 0; k < limits.size(); ++k)
      each_load(static_cast<size_t>(combined_->row_of(b, k)), *limits[k].row,
                body + std::string(limits[k].row->name));
    if (state.goal().objective->per_load)  // only the problem of one body has such an objective
      each_load(static_cast<size_t>(state.row_of(limits.size())), *state.goal().objective, "bound");
  }
  int widths = 0;
  for (std::string& name : out)
    if (name.empty()) name = "width." + std::to_string(++widths);
  return out;
}

std::vector<std::vector<Component>> DesignProblem::components(const VectorXd& x) const {
  std::vector<std::vector<Component>> out;
  for (const mmc::Design& design : combined_->designs_at(x)) out.push_back(design.components());
  return out;
}

std::vector<mmc::CrispDesign> DesignProblem::crisp(const VectorXd& x) const {
  std::vector<mmc::CrispDesign> out;
  const std::vector<std::vector<Component>> all = components(x);
  for (size_t b = 0; b < all.size(); ++b)
    out.push_back(mmc::crisp_design(loaded_->problems[b], all[b], *loaded_->loads[b]));
  return out;
}

std::vector<double> DesignProblem::crisp_violations(
    const std::vector<mmc::CrispDesign>& designs) const {
  std::vector<double> out;
  for (size_t b = 0; b < designs.size(); ++b)
    out.push_back(mmc::crisp_violation(loaded_->problems[b], designs[b]));
  return out;
}

std::vector<mmc::BodyOutcome> DesignProblem::design(const optim::Settings& optimizer,
                                                    const mmc::IterationObserver& observe,
                                                    std::vector<mmc::BodyProblem>& designed) const {
  if (loaded_->motion)
    throw Error::input(
        "the stages of a cycle design bodies under loads, not for the motion itself");
  const Scene& scene = loaded_->prepared.scene();
  designed = loaded_->problems;
  std::vector<mmc::LoadedBody> bodies;
  for (size_t b = 0; b < designed.size(); ++b) bodies.push_back({designed[b], *loaded_->loads[b]});
  const mmc::DesignSettings settings{scene.output.crisp_every, optimizer, false, nullptr,
                                     loaded_->settings.keep_running};
  bool is_running = true;
  return mmc::design_bodies(bodies, 1, settings, observe, is_running);
}

}  // namespace flexmorph::cases
