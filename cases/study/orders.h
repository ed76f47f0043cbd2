#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

/// Orders of convergence of a sequence of values, and what they say of its limit.
namespace flexmorph::cases {

/// A value at one level of a parameter; h (> 0) falls from coarse to fine.
struct LevelValue {
  double h = 0, value = 0;
};

/// How the values of a parameter approach their limit.
enum class Approach {
  power,  ///< Q(h) = Q* + C h^p
  fast    ///< faster than any power: the finest level stands for the limit
};

/// What is known of a scheme before it is measured.
struct Theory {
  double order = 0;    ///< 0: there is no limit; NaN: none is known
  std::string source;  ///< from where, or why there is none

  bool has_order() const { return order > 0; }
  bool has_no_limit() const { return order == 0; }
};

/// Orders of neighbouring triples differ by no more, or the series is not called converged.
inline constexpr double kOrderSpread = 0.3;
/// The finest order differs from theory by no more.
inline constexpr double kTheorySpread = 0.15;
/// Differences below so many parts of the scale are taken for rounding and Newton's tolerance.
inline constexpr double kFloor = 1e-7;
/// Where differences per ratio of h do not fall, as those of a logarithm, the limit is taken to lie
/// within what they add up to on a level so many times finer.
inline constexpr double kFarthest = 1000;
/// Differences that change their sign, or scatter: so many times the range of the last levels,
/// three where differences fall, else four; Eca & Hoekstra (2014), J. Comput. Phys. 262, 104-130.
inline constexpr double kSwing = 3;

/// The limit of a refinement series.
struct Limit {
  bool converged = false;      ///< orders agree: errors of single levels are known
  std::vector<double> orders;  ///< of triples of neighbours, coarse to fine; NaN: there is none
  double order = 0;            ///< of the finest triple above the floor, NaN: there is none
  double value = 0;            ///< extrapolated when converged, else that of the finest level
  double uncertainty = 0;      ///< of `value`, in its unit; infinite where nothing bounds it
  std::string sentence;        ///< what was found, in words

  bool bounded() const;
};

/// Order p that three values suggest: (h₁ᵖ - h₂ᵖ)/(h₂ᵖ - h₃ᵖ) = (Q₁ - Q₂)/(Q₂ - Q₃), steps of any
/// ratio. @return NaN where differences change sign, do not fall, or fall below `floor`
double order_of(const LevelValue& coarse, const LevelValue& middle, const LevelValue& fine,
                double floor);

/// Richardson's extrapolation with order p: Q* = Q₂ + (Q₂ - Q₁) h₂ᵖ/(h₁ᵖ - h₂ᵖ).
double extrapolated(const LevelValue& coarse, const LevelValue& fine, double order);

/// Returns the limit of a refinement series, coarse to fine. It is converged when the orders of the
/// two finest triples agree (kOrderSpread) and the finest is that of theory (kTheorySpread), where
/// there is one; or when all differences are below the floor. The uncertainty of an extrapolated
/// limit is its difference from the one before it, at most the extrapolation itself. Else the
/// finest level stands; its uncertainty is what first order (or the lower one that was seen) would
/// leave, at least the last difference, where differences per ratio of h fall; what a logarithm
/// would add (kFarthest) where they stay; that of kSwing where they change their sign or scatter;
/// infinite where they grow, and where theory knows of no limit. Source: Roache (1994), J. Fluids
/// Eng. 116, 405-413.
/// @param scale  of the values (> 0), see kFloor
Limit limit_of(std::span<const LevelValue> levels, Approach approach,
               const std::optional<Theory>& theory, double scale);

}  // namespace flexmorph::cases
