#include "optim/mmc/motion_certificate.h"

#include <algorithm>
#include <cmath>

#include "geometry/cpu_time.h"
#include "optim/kkt.h"

namespace flexmorph::mmc {

MotionState motion_state_of(const std::vector<Part>& parts, MotionResponse& motion) {
  std::vector<MotionRow> objectives, limits;
  for (size_t b = 0; b < parts.size(); ++b) {
    const Goal& goal = parts[b].problem.motion_goal;
    objectives.push_back({goal.objective, b});
    for (const Limit& limit : goal.limits)
      if (limit.row->of_motion) limits.push_back({limit.row, b});
  }
  return {motion, objectives, limits};
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
    p.follow_sharp_volume();
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
  Whole moved(parts, &state), loaded(parts);
  optim::Problem& problem = moved.problem();
  const VectorXd x = problem.start(), lower = problem.lower(), upper = problem.upper();
  const optim::Response of_motion = problem.evaluate(x);
  const optim::KktPoint point = optim::kkt_point(of_motion, x, lower, upper, kActiveLimits);

  MotionCertificate out;
  out.objective = parts.front().problem.motion_goal.objective->words;
  out.value = std::exp(of_motion.f);
  out.kkt = point.residual;
  out.angle = angle_between(of_motion.df, loaded.problem().evaluate(x).df);
  out.move_limit = move_limit;
  out.left = left_within(of_motion, x, lower, upper, point.lambda, move_limit);
  std::vector<VectorXd> fractions;
  std::vector<MotionRow> rows;
  for (size_t b = 0; b < parts.size(); ++b) {
    const BodyProblem& p = parts[b].problem;
    fractions.push_back(fractions_of(p, p.design.components()));
    const MotionRow row{p.motion_goal.objective, b};
    if (std::none_of(rows.begin(), rows.end(), [&](const MotionRow& r) { return row.same_as(r); }))
      rows.push_back(row);
    out.bodies.push_back(
        {p.body, moved.states[b].components(), moved.states[b].objective_slopes() / out.value});
  }
  for (const double each : motion.sharp(rows, fractions)) out.sharp_value += each;
  out.seconds = cpu_seconds() - begin;
  return out;
}

}  // namespace flexmorph::mmc
