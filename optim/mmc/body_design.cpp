#include "optim/mmc/body_design.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace flexmorph::mmc {
namespace {

/// The compliance a goal speaks of: the weighted sum, or the largest.
double judged_compliance(const BodyProblem& problem, LoadResponse& loads,
                         const CellFactors& factors) {
  if (problem.goal.over == Goal::Over::worst)
    return loads.individual(factors.stiffness, factors.mass).maxCoeff();
  LoadResponse::Value value;
  loads.evaluate(factors.stiffness, factors.mass, value);
  return value.f;
}

/// One cycle's design problem of one body.
class BodyDesigner {
 public:
  BodyDesigner(BodyProblem& problem, LoadResponse& loads, int cycle, const DesignSettings& settings,
               const IterationObserver& observe)
      : problem_(problem),
        loads_(loads),
        cycle_(cycle),
        settings_(settings),
        observe_(observe),
        ersatz_(ersatz_of(problem)) {}

  BodyOutcome go() {
    outcome_.body = problem_.body;
    outcome_.n_loads = loads_.n_loads();
    outcome_.n_right_hand_sides = loads_.n_right_hand_sides();
    const auto n_stages = static_cast<int>(problem_.stages.size());
    for (int stage = 0; stage < n_stages && going_; ++stage) run_stage(stage, n_stages);
    finish();
    outcome_.factorizations = loads_.factorizations();
    return std::move(outcome_);
  }
  bool stopped() const { return !going_; }  ///< by the observer

 private:
  void run_stage(int stage, int n_stages) {
    optim::Settings settings = settings_.optimizer;
    const int total = settings.max_iterations;
    settings.max_iterations = total * (stage + 1) / n_stages - total * stage / n_stages;
    if (settings.max_iterations < 1) return;
    MmcProblem state(problem_.grid, problem_.design, ersatz_, loads_,
                     problem_.stages[static_cast<size_t>(stage)], problem_.goal, problem_.places);
    const auto watch = [&](const optim::Iterate& iterate) { return see(state, iterate); };
    const optim::Result best = optim::make_optimizer(settings)->minimize(state, watch);
    outcome_.change = problem_.design.move_to(state.design_part(best.x));
    outcome_.kkt = best.kkt;
    outcome_.evaluations += best.evaluations;
    outcome_.stop = optim::to_string(best.stop) + (best.message.empty() ? "" : ": " + best.message);
    state.evaluate(best.x);
    outcome_.compliance = state.compliance();
    outcome_.volume = state.volume();
  }

  bool see(MmcProblem& state, const optim::Iterate& iterate) {
    ++outcome_.iterations;
    if (state.x() != *iterate.x) state.evaluate(*iterate.x);  // a trial came after it
    SharpDesign sharp;
    const bool wanted =
        settings_.sharp_every > 0 && outcome_.iterations % settings_.sharp_every == 0;
    if (wanted) sharp = sharp_design(problem_, state.components(), loads_);
    if (observe_)
      going_ = observe_({problem_, cycle_, outcome_.iterations,
                         outcome_.evaluations + iterate.evaluations, iterate, state, state.value(),
                         loads_, wanted ? &sharp : nullptr});
    return going_;
  }

  void finish() {
    outcome_.sharp = sharp_design(problem_, problem_.design.components(), loads_);
    const CellFactors sharp = ersatz_.sharp(outcome_.sharp.fractions);
    const VectorXd each = loads_.individual(sharp.stiffness, sharp.mass);
    outcome_.load_compliances.assign(each.data(), each.data() + each.size());
    outcome_.worst_compliance = each.maxCoeff();
    // The paper's comparison: the volume that was allowed (or came out), spread evenly.
    const bool given = problem_.goal.minimize == Goal::Minimize::compliance;
    const double volume = given ? problem_.goal.max_volume : outcome_.sharp.volume;
    const VectorXd even = VectorXd::Constant(problem_.grid.n_cells(), volume);
    outcome_.uniform_compliance = judged_compliance(problem_, loads_, {even, even});
  }

  BodyProblem& problem_;
  LoadResponse& loads_;
  int cycle_;
  const DesignSettings& settings_;
  const IterationObserver& observe_;
  Ersatz ersatz_;
  BodyOutcome outcome_;
  bool going_ = true;
};

}  // namespace

Ersatz ersatz_of(const BodyProblem& p) {
  return {p.grid, p.stages.back().alpha, p.solid, p.empty, p.outside};
}

VectorXd fractions_of(const BodyProblem& p, std::span<const Component> components) {
  VectorXd out =
      area_fractions(p.grid, components, p.stages.back().min_half_thickness, p.solid, p.empty);
  for (size_t c = 0; c < p.outside.size(); ++c)
    if (p.outside[c]) out[static_cast<Eigen::Index>(c)] = 0;
  return out;
}

SharpDesign sharp_design(const BodyProblem& problem, std::span<const Component> components,
                         LoadResponse& loads) {
  SharpDesign out;
  out.fractions = fractions_of(problem, components);
  const Ersatz ersatz = ersatz_of(problem);
  out.volume = out.fractions.sum() / ersatz.n_domain_cells();
  out.connectivity = connectivity(problem.grid, out.fractions, problem.places);
  out.compliance = judged_compliance(problem, loads, ersatz.sharp(out.fractions));
  return out;
}

fem::Factors dynamic_factors(const BodyProblem& problem, std::span<const Component> components) {
  CellFactors f =
      Ersatz::dynamic(fractions_of(problem, components), problem.stiffness_void, problem.mass_void);
  return {problem.grid, std::move(f.stiffness), std::move(f.mass)};
}

BodyOutcome design_body(BodyProblem& problem, LoadResponse& loads, int cycle,
                        const DesignSettings& settings, const IterationObserver& observe,
                        bool& going) {
  BodyDesigner designer(problem, loads, cycle, settings, observe);
  BodyOutcome outcome = designer.go();
  going = !designer.stopped();
  return outcome;
}

}  // namespace flexmorph::mmc
