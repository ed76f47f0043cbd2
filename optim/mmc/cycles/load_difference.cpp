#include "optim/mmc/cycles/load_difference.h"

#include <algorithm>
#include <cmath>

#include "optim/mmc/loads/compliance_evaluator.h"
#include "optim/mmc/problem/finished_part.h"

namespace flexmorph::mmc {

LoadDifference load_difference(std::span<const double> made_for, std::span<const double> own,
                               std::span<const fem::EslSet> motion) {
  if (made_for.size() != motion.size() || own.size() != motion.size())
    throw Error::numerical("a design was made for " + std::to_string(made_for.size()) +
                           " loads, but its own motion has " + std::to_string(motion.size()) +
                           " loads");
  double largest = 0, sum = 0, loads = 0, geometric = 0;
  for (const fem::EslSet& set : motion) largest = std::max(largest, set.strain_energy);
  for (size_t i = 0; i < motion.size(); ++i) {
    const double energy = motion[i].strain_energy, weight = motion[i].weight;
    const double small = 0.5 * own[i];
    const bool at_rest = std::min(energy, small) < LoadDifference::kMinimum * largest;
    const double secant = at_rest ? 1 : energy / small;
    sum += weight * energy;
    loads += weight * std::abs(0.5 * made_for[i] * secant - energy);
    geometric += weight * std::abs(small - energy);
  }
  LoadDifference out;
  if (!(sum > 0)) return out;
  out.loads = loads / sum;
  out.geometric = geometric / sum;
  return out;
}

LoadDifference load_difference(const BodyProblem& problem, std::span<const double> made_for,
                               const fem::EslSets& motion) {
  const CellScaleFactors crisp =
      ersatz_of(problem).crisp(part_fractions(problem, problem.design.components()));
  const VectorXd own =
      ComplianceEvaluator(motion, problem.section, problem.compliance, crisp.stiffness, crisp.mass)
          .individual(crisp.stiffness, crisp.mass);
  LoadDifference out =
      load_difference(made_for, {own.data(), static_cast<size_t>(own.size())}, motion.sets);
  out.body = problem.body;
  return out;
}

}  // namespace flexmorph::mmc
