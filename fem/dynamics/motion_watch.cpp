#include "fem/dynamics/motion_watch.h"

#include <algorithm>

#include "fem/dynamics/motion_failures.h"

namespace flexmorph::fem {
namespace {

constexpr int kMaterialEvery = 10;  // number of steps between checks of the area ratio
constexpr int kJointsEvery = 25;    // number of steps between checks of the joints of rigid bodies
constexpr double kNearlyDependent = 1e6, kSingular = 1e3;  // condition numbers

}  // namespace

MotionWatch::MotionWatch(Workspace& model, const MotionSettings& settings, MotionResult& result)
    : model_(model), settings_(settings), result_(result) {
  const auto is_rigid = [](const Body& b) { return b.element->is_rigid(); };
  if (std::any_of(model.bodies().begin(), model.bodies().end(), is_rigid)) joints_.emplace(model);
}

void MotionWatch::begin(const Energies& e) {
  if (settings_.balance && settings_.energy_round_off)
    growth_.begin(e, *settings_.energy_round_off);
}

void MotionWatch::archive(Archive& memory) {
  multipliers_.archive(memory, model_);
  memory(growth_, since_material_, since_joints_, was_near_);
}

void MotionWatch::see(const State& x, const Energies& e, const Powers& p, double energy_error,
                      double h, bool at_stop, int steps) {
  // Otherwise Newton's method would fail later without a reason in its message, see EnergyGrowth.
  if (growth_.is_watched()) {
    growth_.see(x.t, e, p, energy_error);
    if (growth_.is_too_large())
      throw gained_energy(settings_, x.t, steps, energy_error, growth_.gain(),
                          model_.n_constraints() > 0);
  }
  if (at_stop || ++since_material_ == kMaterialEvery) see_material(x, steps);
  if (joints_ && ++since_joints_ == kJointsEvery) see_joints(x);
  double& smallest = result_.smallest_step;
  smallest = smallest > 0 ? std::min(smallest, h) : h;
  result_.largest_step = std::max(result_.largest_step, h);
}

void MotionWatch::see_equal(const State& x, double h, double meant) {
  multipliers_.see(model_, x, h);
  if (multipliers_.found()) result_.alternation = multipliers_.found();
  if (h > 0.75 * meant) return;
  CutSteps& cut = result_.cut;
  if (cut.number++ == 0) cut = {1, x.t - h, h};
  cut.shortest = std::min(cut.shortest, h);
}

void MotionWatch::see_drift(const State& x) {
  Constraints c;
  model_.constraints(x, c);
  if (c.value.size() == 0) return;
  result_.constraint_drift = std::max(result_.constraint_drift, c.value.lpNorm<Eigen::Infinity>());
  VectorXd rate = c.rate;
  for (const auto& entry : c.jacobian) rate[entry.row()] += entry.value() * x.v[entry.col()];
  result_.velocity_drift = std::max(result_.velocity_drift, rate.lpNorm<Eigen::Infinity>());
}

// A St. Venant-Kirchhoff material that has collapsed or turned inside out has equilibria, but they
// are physically meaningless. Therefore the motion is stopped.
void MotionWatch::see_material(const State& x, int steps) {
  since_material_ = 0;
  const double ratio = model_.smallest_area_ratio(x);
  result_.smallest_area_ratio = std::min(result_.smallest_area_ratio, ratio);
  if (!(ratio > 0)) throw collapsed(x.t, steps, ratio);
}

std::optional<Error> MotionWatch::with_joints(const Error& error, const State& x) {
  if (!joints_ || error.kind() != Error::Kind::numerical) return {};
  const Conditioning now = joints_->look(x);
  if (now.condition < kSingular) return {};
  return Error::numerical(std::string(error.what()) +
                          " The mechanism may be at a dead centre: " + describe(now));
}

void MotionWatch::see_joints(const State& x) {
  since_joints_ = 0;
  const Conditioning now = joints_->look(x);
  std::vector<Conditioning>& all = result_.near_singular;
  const bool near = now.condition > kNearlyDependent;
  if (near && !was_near_)
    all.push_back(now);
  else if (near && now.condition > all.back().condition)
    all.back() = now;
  was_near_ = near;
}

}  // namespace flexmorph::fem
