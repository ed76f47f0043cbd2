#include "optim/mmc/motion_certificate.h"

#include <algorithm>
#include <cmath>

#include "geometry/cpu_time.h"
#include "optim/kkt.h"

namespace flexmorph::mmc {

namespace {

/// What the designs ask of their motion.
template <class Bodies, class Problem>
std::vector<const Goal*> goals_of(const Bodies& bodies, Problem problem_of) {
  std::vector<const Goal*> out;
  for (const auto& b : bodies) out.push_back(&problem_of(b).motion_goal);
  return out;
}

}  // namespace

MotionState motion_state_of(const std::vector<Part>& parts, MotionResponse& motion) {
  return {motion, goals_of(
                      parts, [](const Part& p) -> auto& { return p.problem; })};
}

double sharp_objective(std::span<const BodyProblem> problems, MotionResponse& motion) {
  const auto goals = goals_of(
      problems, [](const BodyProblem& p) -> auto& { return p; });
  std::vector<VectorXd> fractions;
  for (const BodyProblem& p : problems) fractions.push_back(fractions_of(p, p.design.components()));
  const std::vector<MotionRow> rows = motion_objectives(goals);
  const std::vector<double> each = motion.sharp(rows, fractions);
  double out = 0;
  for (size_t k = 0; k < rows.size(); ++k) out += rows[k].weight * each[k];
  return out;
}

double left_within(const optim::Response& r, const VectorXd& x, const VectorXd& lower,
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

std::vector<Part> parts_at_end(std::span<const LoadedBody> bodies) {
  std::vector<Part> out(bodies.begin(), bodies.end());
  for (Part& p : out) {
    p.problem.design = p.problem.design.without_symmetry();
    p.next = p.problem.design;
    p.tdf = &p.problem.stages.back();
    follow_crisp(p);
    if (p.problem.widths.any()) p.widths.emplace(p.problem, p.problem.widths);
  }
  return out;
}

double angle_between(const VectorXd& a, const VectorXd& b) {
  const double sizes = a.norm() * b.norm();
  return sizes > 0 ? std::acos(std::clamp(a.dot(b) / sizes, -1.0, 1.0)) : 0;
}

MotionCertificate certify(std::vector<Part>& parts, MotionResponse& motion, double move_limit) {
  const double begin = cpu_seconds();
  MotionState state = motion_state_of(parts, motion);
  Whole moved(parts, state), loaded = Whole::smooth(parts);
  optim::Problem& problem = moved.problem();
  const VectorXd x = problem.start(), lower = problem.lower(), upper = problem.upper();
  const optim::Response of_motion = problem.evaluate(x);
  const optim::KktPoint point = optim::kkt_point(of_motion, x, lower, upper, kActiveLimits);

  MotionCertificate out;
  out.objective = objective_words(parts.front().problem.motion_goal);
  out.value = std::exp(of_motion.f);
  out.kkt = point.residual;
  out.angle = angle_between(of_motion.df, loaded.problem().evaluate(x).df);
  out.move_limit = move_limit;
  out.left = left_within(of_motion, x, lower, upper, point.lambda, move_limit);
  std::vector<BodyProblem> problems;
  for (size_t b = 0; b < parts.size(); ++b) {
    problems.push_back(parts[b].problem);
    out.bodies.push_back({problems.back().body, moved.states[b].components(),
                          moved.states[b].objective_slopes() / out.value});
  }
  out.sharp_value = sharp_objective(problems, motion);
  out.seconds = cpu_seconds() - begin;
  return out;
}

}  // namespace flexmorph::mmc
