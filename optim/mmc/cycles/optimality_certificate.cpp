#include "optim/mmc/cycles/optimality_certificate.h"

#include <algorithm>
#include <cmath>

#include "geometry/cpu_time.h"
#include "optim/kkt.h"
#include "optim/mmc/problem/finished_part.h"

namespace flexmorph::mmc {

namespace {

/// Returns the goals that the bodies have for their motion.
template <class Bodies, class Problem>
std::vector<const Goal*> goals_of(const Bodies& bodies, Problem problem_of) {
  std::vector<const Goal*> out;
  for (const auto& b : bodies) out.push_back(&problem_of(b).motion_goal);
  return out;
}

}  // namespace

MotionState motion_state_of(std::span<const Subproblem> parts, MotionResponse& motion) {
  return {motion, goals_of(
                      parts, [](const Subproblem& p) -> auto& { return p.problem; })};
}

double crisp_objective(std::span<const BodyProblem> problems, MotionResponse& motion) {
  const auto goals = goals_of(
      problems, [](const BodyProblem& p) -> auto& { return p; });
  std::vector<VectorXd> fractions;
  for (const BodyProblem& p : problems)
    fractions.push_back(part_fractions(p, p.design.components()));
  const std::vector<MotionRow> rows = motion_objectives(goals);
  const std::vector<double> each = motion.crisp(rows, fractions);
  double out = 0;
  for (size_t k = 0; k < rows.size(); ++k) out += rows[k].weight * each[k];
  return out;
}

double left_within(const optim::ProblemValues& r, const VectorXd& x, const VectorXd& lower,
                   const VectorXd& upper, const VectorXd& lambda, double move_limit) {
  VectorXd slope = r.df;
  double out = 0;
  if (lambda.size() > 0) {
    slope += r.dg.transpose() * lambda;
    out -= lambda.dot(r.g);
  }
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    const double down = std::max(-move_limit, lower[j] - x[j]),
                 up = std::min(move_limit, upper[j] - x[j]);
    out -= std::min(slope[j] * down, slope[j] * up);
  }
  return std::max(0.0, out);
}

double angle_between(const VectorXd& a, const VectorXd& b) {
  const double sizes = a.norm() * b.norm();
  return sizes > 0 ? std::acos(std::clamp(a.dot(b) / sizes, -1.0, 1.0)) : 0;
}

namespace {

/// Computes the optimality of the designs in the representation that the formulations define.
CertifiedDesign certified(CombinedProblem& moved, std::span<const Subproblem> parts,
                          std::span<const Formulation> formulations, double move_limit) {
  optim::Problem& problem = moved.problem();
  const VectorXd x = problem.start(), lower = problem.lower(), upper = problem.upper();
  const optim::ProblemValues of_motion = problem.evaluate(x);
  const optim::KktPoint point = optim::kkt_point(of_motion, x, lower, upper, kActiveLimits);
  CombinedProblem loaded = CombinedProblem::smooth(parts, moved.designs(), formulations);
  CertifiedDesign out;
  out.value = std::exp(of_motion.f);
  out.kkt = point.residual;
  out.angle = angle_between(of_motion.df, loaded.problem().evaluate(x).df);
  out.left = left_within(of_motion, x, lower, upper, point.lambda, move_limit);
  if (of_motion.g.size() > 0) out.violation = std::max(0.0, of_motion.g.maxCoeff());
  return out;
}

}  // namespace

OptimalityCertificate certify(std::span<const LoadedBody> bodies, MotionResponse& motion,
                              double move_limit) {
  const double begin = cpu_seconds();
  const std::vector<Subproblem> parts(bodies.begin(), bodies.end());
  std::vector<Formulation> regularized, crisp;
  for (const Subproblem& p : parts) {
    regularized.push_back(last_formulation(p.problem));
    Formulation& c = crisp.emplace_back(regularized.back());
    c.crisp = true;
  }
  OptimalityCertificate out;
  out.objective = objective_text(parts.front().problem.motion_goal);
  out.move_limit = move_limit;
  MotionState state = motion_state_of(parts, motion);
  CombinedProblem moved(parts, designs_of(parts), regularized, state);
  out.regularized = certified(moved, parts, regularized, move_limit);
  for (size_t b = 0; b < parts.size(); ++b)
    out.bodies.push_back({parts[b].problem.body, moved.states[b].components(),
                          moved.states[b].objective_gradient() / out.regularized.value});
  MotionState crisp_state = motion_state_of(parts, motion);
  CombinedProblem crisp_moved(parts, designs_of(parts), crisp, crisp_state);
  out.crisp = certified(crisp_moved, parts, crisp, move_limit);
  out.seconds = cpu_seconds() - begin;
  return out;
}

}  // namespace flexmorph::mmc
