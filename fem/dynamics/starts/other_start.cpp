#include "fem/dynamics/starts/other_start.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "fem/solve/assembly.h"
#include "fem/solve/scaled_constraints.h"

namespace flexmorph::fem {
namespace {

constexpr double kTurns[] = {0.3, 1, 2.5};         // largest angle by which bodies are turned [rad]
constexpr int kTries = 12;                         // for each of them
constexpr int kManyUnknowns = 400, kFewTries = 2;  // for models above this number of unknowns
constexpr double kSame = 1e-6;  // difference of equal positions, in sizes of the model

/// Groups of bodies whose angles to each other are prescribed; -1 stands for the ground.
class AngleGroups {
 public:
  AngleGroups(Workspace& model, const State& x)
      : model_(model), parent_(model.bodies().size() + 1) {
    for (size_t k = 0; k < parent_.size(); ++k) parent_[k] = k;
    ConstraintRows rows;
    for (const auto& joint : model.joints()) {
      if (joint->belongs_to_body()) continue;
      joint->evaluate(x.t, x.q, x.v, rows);
      for (int row = 0; row < joint->size(); ++row) join(rows, row);
    }
  }
  /// Returns the number of the group of a body.
  size_t of(size_t body) const { return root(body); }
  /// Returns the number of the group of the ground.
  size_t ground() const { return root(model_.bodies().size()); }

 private:
  size_t root(size_t k) const {
    while (parent_[k] != k) k = parent_[k];
    return k;
  }
  /// Joins the bodies of a row that depends on axes only; a single one is joined with the ground.
  void join(const ConstraintRows& rows, int row) {
    std::vector<size_t> found;
    for (const auto& entry : rows.jacobian) {
      if (entry.row() != row) continue;
      size_t body = 0;
      while (body + 1 < model_.bodies().size() &&
             model_.bodies()[body + 1].first_dof <= entry.col())
        ++body;
      if (entry.col() < model_.bodies()[body].first_dof + 2) return;  // a position
      if (std::find(found.begin(), found.end(), body) == found.end()) found.push_back(body);
    }
    if (found.empty()) return;
    const size_t other = found.size() > 1 ? found[1] : model_.bodies().size();
    parent_[root(found[0])] = root(other);
  }

  const Workspace& model_;
  std::vector<size_t> parent_;
};

double angle_of(const Body& body, const State& x) {
  return std::atan2(x.q[body.first_dof + 3], x.q[body.first_dof + 2]);
}

/// Returns the sum of the angles by which bodies are turned from one state to another [rad].
double turned(const Model& model, const State& from, const State& to) {
  double out = 0;
  for (const Body& b : model.bodies())
    out += std::remainder(angle_of(b, to) - angle_of(b, from), 2 * std::numbers::pi);
  return out;
}

/// Returns true if no prescribed angle has changed by more than 90 degrees.
bool keeps_angles(const Model& model, const AngleGroups& groups, const State& guess,
                  const State& x) {
  std::vector<double> change;
  for (const Body& b : model.bodies()) change.push_back(angle_of(b, x) - angle_of(b, guess));
  std::vector<size_t> first(change.size() + 1, change.size());
  for (size_t k = 0; k < change.size(); ++k) {
    size_t& reference = first[groups.of(k)];
    const bool grounded = groups.of(k) == groups.ground();
    const double relative =
        change[k] - (grounded || reference == change.size() ? 0 : change[reference]);
    if ((grounded || reference < change.size()) && std::cos(relative) <= 0) return false;
    if (reference == change.size()) reference = k;
  }
  return true;
}

}  // namespace

int n_other_starts(const Model& model) {
  return static_cast<int>(std::size(kTurns)) *
         (model.n_dofs() > kManyUnknowns ? kFewTries : kTries);
}

std::optional<OtherStart> other_start(Workspace& model, const State& guess) {
  const AngleGroups groups(model, guess);
  const VectorXd scales = model.scales();
  const double size = model_size(scales, guess.q);
  std::mt19937_64 random(48);
  // std::uniform_real_distribution differs between libraries.
  const auto uniform = [&random] { return 2 * std::ldexp(double(random() >> 11), -53) - 1; };
  std::optional<OtherStart> out;
  std::vector<State> found;
  int tried = 0, assembled = 0;
  for (const double turn : kTurns) {
    for (int k = 0; k < n_other_starts(model) / int(std::size(kTurns)); ++k) {
      State x = guess;
      std::vector<double> by(model.bodies().size() + 1);
      for (double& each : by) each = turn * uniform();
      by[groups.ground()] = 0;
      for (size_t b = 0; b < model.bodies().size(); ++b) {
        const int at = model.bodies()[b].first_dof;
        const double angle = angle_of(model.bodies()[b], x) + by[groups.of(b)];
        x.q[at + 2] = std::cos(angle);
        x.q[at + 3] = std::sin(angle);
        for (int c = 0; c < 2; ++c) x.q[at + c] += 0.1 * turn * size * uniform();
      }
      ++tried;
      try {
        assemble(model, x);
      } catch (const Error&) {
        continue;
      }
      if (!keeps_angles(model, groups, guess, x)) continue;
      ++assembled;
      const auto is_same = [&](const State& y) {
        return scales.cwiseProduct(x.q - y.q).lpNorm<Eigen::Infinity>() <= kSame * size;
      };
      if (std::none_of(found.begin(), found.end(), is_same)) found.push_back(x);
    }
    if (!found.empty()) break;
  }
  const auto distance = [&](const State& x) { return scales.cwiseProduct(x.q - guess.q).norm(); };
  for (const State& x : found) {
    const double difference = out ? distance(x) - distance(out->x) : -size;
    if (difference < -kSame * size ||
        (difference <= kSame * size && turned(model, guess, x) > turned(model, guess, out->x)))
      out = OtherStart{x, tried, assembled, static_cast<int>(found.size())};
  }
  return out;
}

}  // namespace flexmorph::fem
