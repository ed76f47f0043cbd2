#pragma once

namespace flexmorph::fem {

/// Steps that adapt to what they miss.
///
/// Every step may miss by ε = size · tolerance^{3/2}, size: of the model. Methods of order 2 have
/// local errors ∝ h³ and global ones ∝ h², so that the global error is proportional to the
/// tolerance; and the same ε for all steps is what reaches a given sum of errors in the fewest of
/// them. For a motion of the model's own size the sum is about tolerance · size per radian.
struct AdaptiveStep {
  double tolerance = 1e-4;
  double largest = 0;   ///< no step is longer [s]; 0: a fiftieth of the run
  double smallest = 0;  ///< a step that would have to be shorter fails [s]; 0: 1e-10 of the run
  double first = 0;     ///< length of the first step [s]; 0: estimated
};

/// Chooses step sizes from the local errors of the steps before: a proportional-integral controller
/// (Gustafsson 1991, ACM Trans. Math. Softw. 17, 533-554) for local errors ∝ h³, with limits on
/// growth, and a dead band, in which the step stays what it is and so does its factorization.
class StepControl {
 public:
  /// @param span  length of the run [s]
  /// @throws Error (input) for settings that make no sense.
  StepControl(const AdaptiveStep& settings, double span);

  /// Local error that a step may have, relative to the size of the model.
  double allowed() const { return allowed_; }
  double largest() const { return largest_; }
  /// The first step [s], within the limits.
  void begin(double h);

  /// The next step when there are `left` seconds to a time it must land on, at most that; the last
  /// two steps before it are equal.
  double next(double left) const;
  /// After an accepted step h with its local error and the Newton iterations that it took: one that
  /// took many is near to what Newton's method manages, whatever the error.
  void accepted(double h, double error, int iterations);
  /// After one whose error is above allowed().
  /// @throws Error (numerical) when the next one would have to be shorter than `smallest`, at t.
  void rejected(double h, double error, double t);
  /// After one that Newton's method did not solve. @throws Error likewise.
  void failed(double h, double t);

 private:
  void shorten(double h, double t, const char* why);

  double allowed_, largest_, smallest_;
  double wish_ = 0;      // the next step, where nothing is in the way
  double last_ = 0;      // local error of the last step, relative to the allowed one; 0: unknown
  bool shrunk_ = false;  // was the last try rejected?
  double failed_ = 0;    // the last step that Newton's method did not solve
  int since_failed_ = 0;
};

}  // namespace flexmorph::fem
