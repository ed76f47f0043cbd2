#pragma once

#include <string>

namespace flexmorph::optim {

/// Says how far a design has come when its optimization ends, with the numbers behind it.
struct Verdict {
  enum class Kind {
    evaluated,   ///< the design was evaluated as it is: nothing was optimized
    unfinished,  ///< the design still improved, or was not feasible
    stagnated,   ///< the design is feasible and improved by less than kPlateau over kPlateauRows
    converged    ///< the design is feasible and meets the KKT conditions
  };
  static constexpr int kPlateauRows = 30;      ///< iterations of a plateau
  /// Improvement over them, a part of the objective; of a volume or a mass, of that of the full
  /// domain.
  static constexpr double kPlateau = 1e-3;
  static constexpr int kImprovementRows = 20;  ///< iterations of `improvement`

  Kind kind = Kind::unfinished;
  double kkt = 0;  ///< scaled KKT residual of the design
  /// Part by which the objective of the best usable design fell over the last kImprovementRows
  /// iterations; NaN where there were fewer, or no usable design before.
  double improvement = 0;
};

/// "the objective fell by less than 0.1 % over 30 iterations".
std::string plateau_words();
/// "converged", "stagnated", "unfinished" or "evaluated".
std::string to_string(Verdict::Kind kind);
/// The kind of a verdict and the numbers behind it: "unfinished: the objective fell by 2.1 % over
/// the last 20 iterations, KKT residual 4.0e-02".
std::string words_of(const Verdict& verdict);

}  // namespace flexmorph::optim
