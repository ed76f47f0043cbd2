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

namespace {

/// What the motion says of the designs as the parts see them.
CertifiedDesign certified(Whole& moved, std::vector<Part>& parts, double move_limit) {
  optim::Problem& problem = moved.problem();
  const VectorXd x = problem.start(), lower = problem.lower(), upper = problem.upper();
  const optim::Response of_motion = problem.evaluate(x);
  const optim::KktPoint point = optim::kkt_point(of_motion, x, lower, upper, kActiveLimits);
  Whole loaded = Whole::smooth(parts);
  CertifiedDesign out;
  out.value = std::exp(of_motion.f);
  out.kkt = point.residual;
  out.angle = angle_between(of_motion.df, loaded.problem().evaluate(x).df);
  out.left = left_within(of_motion, x, lower, upper, point.lambda, move_limit);
  if (of_motion.g.size() > 0) out.violation = std::max(0.0, of_motion.g.maxCoeff());
  return out;
}

/// The parts with the crisp picture of their designs: limits of the volume are those of the case.
std::vector<Part> crisp_parts(std::vector<Part>& parts) {
  std::vector<Part> out;
  for (Part& p : parts) {
    Part& crisp = out.emplace_back(LoadedBody{p.problem, p.loads});
    crisp.tdf = p.tdf;
    crisp.crisp.emplace(p.problem);
    if (p.widths) crisp.widths.emplace(p.problem, p.problem.widths);
  }
  return out;
}

}  // namespace

MotionCertificate certify(std::vector<Part>& parts, MotionResponse& motion, double move_limit) {
  const double begin = cpu_seconds();
  MotionCertificate out;
  out.objective = objective_words(parts.front().problem.motion_goal);
  out.move_limit = move_limit;
  MotionState state = motion_state_of(parts, motion);
  Whole moved(parts, state);
  out.regularized = certified(moved, parts, move_limit);
  for (size_t b = 0; b < parts.size(); ++b)
    out.bodies.push_back({parts[b].problem.body, moved.states[b].components(),
                          moved.states[b].objective_slopes() / out.regularized.value});
  std::vector<Part> crisp = crisp_parts(parts);
  MotionState crisp_state = motion_state_of(crisp, motion);
  Whole crisp_moved(crisp, crisp_state);
  out.crisp = certified(crisp_moved, crisp, move_limit);
  out.seconds = cpu_seconds() - begin;
  return out;
}

}  // namespace flexmorph::mmc
