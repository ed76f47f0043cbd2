#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cases/scene/scene.h"
#include "fem/esl_set.h"
#include "optim/mmc/problem/body_problem.h"
#include "optim/verification/verification.h"

/// A case whose problem is solved by several methods, and the verification of their results.
namespace flexmorph::benchmark {

/// The problem of the only design of a case under fixed loads: those of a static plate, or the
/// equivalent static loads of the motion with the first layout of the case.
struct ComparedCase {
  cases::Scene scene;
  mmc::BodyProblem problem;
  fem::EslSets sets;  ///< Loads of the motion; empty for a static plate.
  std::unique_ptr<mmc::ComplianceEvaluator> loads;
  verification::Loads by_position;

  /// @param path  path of a case file, or name of a shipped case
  /// @throws Error from the case or its motion
  explicit ComparedCase(const std::string& path, std::span<const std::string> changes = {});
  ComparedCase(const ComparedCase&) = delete;
  ComparedCase& operator=(const ComparedCase&) = delete;

  double domain_area() const;  ///< Returns the area of the domain [m²].
};

/// An outline with its verification.
struct ComparedDesign {
  std::vector<Region> regions;
  verification::OutlineVerification verdict;
  double volume = 0;   ///< Fraction of the domain.
  double feature = 0;  ///< Smallest width of material that no given region causes [m].
  double gap = 0;      ///< Smallest gap that no given region causes [m].
  double seconds = 0;  ///< CPU time of the design only [s].
};
/// The tolerance is smaller than in a run, because two methods may differ by less than the error of
/// a run.
constexpr double kVerificationTolerance = 0.001;
ComparedDesign compared(const ComparedCase& of, std::vector<Region> regions, double seconds);

/// Returns the program's own design, made as in a run.
ComparedDesign design_by_components(ComparedCase& of);

}  // namespace flexmorph::benchmark
