#pragma once

#include <string>

namespace flexmorph::optim {

/// Convergence state of a design at the end of its optimization, with the numbers behind it.
struct Verdict {
  /// Convergence state of a design.
  enum class Kind {
    evaluated,   ///< The design was evaluated as it is; nothing was optimized.
    unfinished,  ///< The design still improved, or was not feasible.
    stagnated,   ///< The design is feasible and improved by less than kPlateau over kPlateauRows.
    converged    ///< The design is feasible and meets the KKT conditions.
  };
  static constexpr int kPlateauRows = 30;  ///< Number of rows (iterations) of a plateau.

  /// Improvement below which the last kPlateauRows rows are a plateau. It is relative to the
  /// objective if this is a logarithm, and to the value of the full domain if the objective is a
  /// volume or a mass.
  static constexpr double kPlateau = 1e-3;
  static constexpr int kImprovementRows = 20;  ///< Number of rows over which `improvement` counts.

  Kind kind = Kind::unfinished;  ///< State of the design.
  double kkt = 0;                ///< Scaled KKT residual of the design.

  /// Decrease of the objective of the best usable design over the last kImprovementRows rows,
  /// relative as in kPlateau; NaN if there were fewer rows, or no usable design before them.
  double improvement = 0;
};

/// Returns the text "the objective fell by less than 0.1 % over 30 iterations".
std::string plateau_text();
/// Returns "converged", "stagnated", "unfinished" or "evaluated".
std::string to_string(Verdict::Kind kind);
/// Returns the kind of a verdict with the numbers behind it as a text, for example: "unfinished:
/// the objective fell by 2.1 % over the last 20 iterations, KKT residual 4.0e-02".
std::string text_of(const Verdict& verdict);

}  // namespace flexmorph::optim
