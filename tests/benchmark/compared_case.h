#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cases/scene/scene.h"
#include "fem/esl_set.h"
#include "optim/mmc/problem/body_problem.h"
#include "optim/verification/verification.h"

/// A case whose problem several methods solve, and the judge of what they come to.
namespace flexmorph::benchmark {

/// The problem of a case's only design under loads that stay as they are: those of a plate at rest,
/// or the equivalent static loads of the motion with the case's first layout.
struct ComparedCase {
  cases::Scene scene;
  mmc::BodyProblem problem;
  fem::EslSets sets;  ///< of the motion; a plate at rest has none
  std::unique_ptr<mmc::ComplianceEvaluator> loads;
  verification::Loads by_position;

  /// @param path  of a case file, or the name of a shipped case
  /// @throws Error from the case, or from its motion
  explicit ComparedCase(const std::string& path, std::span<const std::string> changes = {});
  ComparedCase(const ComparedCase&) = delete;
  ComparedCase& operator=(const ComparedCase&) = delete;

  double domain_area() const;  ///< [m²]
};

/// An outline as it is judged.
struct ComparedDesign {
  std::vector<Region> regions;
  verification::OutlineVerification verdict;
  double volume = 0;   ///< part of the domain
  double feature = 0;  ///< smallest width of material that no given region makes [m]
  double gap = 0;      ///< likewise of the void
  double seconds = 0;  ///< CPU, of the design alone
};
/// Tighter than a run's judge: two methods may differ by less than that one's error.
constexpr double kVerificationTolerance = 0.001;
ComparedDesign compared(const ComparedCase& of, std::vector<Region> regions, double seconds);

/// The program's own design, as a run makes it.
ComparedDesign design_by_components(ComparedCase& of);

}  // namespace flexmorph::benchmark
