#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

/// Orders of convergence of a sequence of values, and estimates of its limit.
namespace flexmorph::cases {

/// A value at one level of a discretization parameter.
struct LevelValue {
  double h = 0, value = 0;  ///< Parameter h > 0, which decreases from coarse to fine, and value.
};

/// The kind of convergence of the values of a series to their limit.
enum class Approach {
  power,  ///< Power law: Q(h) = Q* + C h^p.
  fast    ///< Faster than any power: the value of the finest level is taken as the limit.
};

/// The theoretical order of convergence of a scheme.
struct Theory {
  double order = 0;    ///< Order of convergence; 0: there is no limit; NaN: no order is known.
  std::string source;  ///< Source of the order, or the reason why there is none.

  /// Tells whether an order is known.
  bool has_order() const { return order > 0; }
  /// Tells whether the values have no limit.
  bool has_no_limit() const { return order == 0; }
};

/// Largest difference between the orders of neighbouring triples of a converged series.
inline constexpr double kOrderSpread = 0.3;
/// Largest difference between the order of the finest triple and theory in a converged series.
inline constexpr double kTheorySpread = 0.15;
/// Ratio to the scale below which differences are attributed to rounding and Newton's tolerance.
inline constexpr double kFloor = 1e-7;
/// Refinement ratio for differences that do not decrease, as of a logarithm. The uncertainty of the
/// limit is then the change of the value between the finest level and a level finer by this ratio.
inline constexpr double kMaxExtrapolation = 1000;
/// Factor of the uncertainty of a series whose differences change sign or scatter. It multiplies
/// the range of the values on the last three levels if the differences decrease, else on the last
/// four. Source: Eca & Hoekstra (2014), J. Comput. Phys. 262, 104-130.
inline constexpr double kSwing = 3;

/// The estimated limit of a refinement series.
struct ExtrapolatedLimit {
  bool converged = false;      ///< True if the orders agree, so that errors of levels are known.
  std::vector<double> orders;  ///< Orders of triples of levels, coarse to fine; NaN: no order.
  double order = 0;            ///< Order of the finest triple above the floor; NaN: no order.
  double value = 0;            ///< Extrapolated limit if converged, else value of the finest level.
  double uncertainty = 0;      ///< Uncertainty of `value`, in its unit; infinite: no bound.
  std::string sentence;        ///< Explanation of the estimate as text.

  /// Tells whether the limit and its uncertainty are finite.
  bool bounded() const;
};

/// Returns the order p of three values, from (h₁ᵖ - h₂ᵖ)/(h₂ᵖ - h₃ᵖ) = (Q₁ - Q₂)/(Q₂ - Q₃); the
/// ratios of h may differ.
/// @param floor  differences up to this value have no order
/// @return NaN if the differences change sign, do not decrease, or are not above `floor`
double order_of(const LevelValue& coarse, const LevelValue& middle, const LevelValue& fine,
                double floor);

/// Returns Richardson's extrapolation with order p: Q* = Q₂ + (Q₂ - Q₁) h₂ᵖ/(h₁ᵖ - h₂ᵖ).
double extrapolated(const LevelValue& coarse, const LevelValue& fine, double order);

/// Returns the limit of a refinement series, coarse to fine.
///
/// The series is converged if the orders of the two finest triples agree (kOrderSpread) and the
/// order of the finest triple agrees with theory (kTheorySpread) if there is one; or if all
/// differences are below the floor. The uncertainty of the extrapolated limit is its difference
/// from the extrapolation of the previous triple, but at most the extrapolated change.
///
/// If the series is not converged, the limit is the value of the finest level. Its uncertainty
/// depends on the differences, divided by the logarithm of the ratio of h:
/// - If they decrease, it is the remainder at first order (or at a lower observed order), but at
///   least the last difference.
/// - If they are constant, it is the logarithmic change of kMaxExtrapolation.
/// - If they change sign or scatter, it is the range of kSwing.
/// - If they increase, if theory says that there is no limit, or if there are fewer than three
///   levels, it is infinite.
///
/// A series with Approach::fast is converged if its last difference is at most half of the largest
/// difference from the finest level. Its limit is the value of the finest level.
///
/// Source: Roache (1994), J. Fluids Eng. 116, 405-413.
/// @param scale  scale of the values (> 0), see kFloor
ExtrapolatedLimit limit_of(std::span<const LevelValue> levels, Approach approach,
                           const std::optional<Theory>& theory, double scale);

}  // namespace flexmorph::cases
