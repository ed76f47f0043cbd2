#pragma once

namespace flexmorph::fem {

/// Settings of time steps that adapt to their local error.
///
/// Every step may have the error ε = size · tolerance^{3/2}, where size is that of the model.
/// Methods of order 2 have local errors ∝ h³ and global errors ∝ h²; therefore the global error is
/// proportional to the tolerance. The same ε in all steps leads to a given sum of errors with the
/// smallest number of steps. For a motion of the size of the model the sum is about tolerance ·
/// size per radian.
struct AdaptiveStep {
  /// Tolerance, between 0 and 1.
  double tolerance = 1e-4;
  /// Length of the longest allowed step [s]; 0: a fiftieth of the run.
  double largest = 0;
  /// Length of the shortest allowed step [s]; the run fails if it needs a shorter one; 0: 1e-10 of
  /// the run.
  double smallest = 0;
  /// Length of the first step [s]; 0: it is estimated.
  double first = 0;
};

/// Controller that chooses the sizes of steps from the local errors of previous steps: a
/// proportional-integral controller (Gustafsson 1991, ACM Trans. Math. Softw. 17, 533-554) for
/// local errors ∝ h³, with limits on the growth. Within a dead band the step size does not change,
/// so that the factorization can be reused.
class StepControl {
 public:
  /// Creates the controller of a run.
  /// @param span  Length of the run [s].
  /// @throws Error (input) if the settings are invalid.
  StepControl(const AdaptiveStep& settings, double span);

  /// Returns the local error that a step may have, relative to the size of the model.
  double allowed() const { return allowed_; }
  /// Returns the largest allowed length of a step [s].
  double largest() const { return largest_; }
  /// Sets the first step to h [s], within the limits.
  void begin(double h);

  /// Returns the next step [s] if `left` seconds remain to an event time, at which a step must end;
  /// the step is at most `left`, and the last two steps before the event time are equal.
  double next(double left) const;
  /// Records an accepted step h [s] with its local error and the number of its Newton iterations.
  /// Many iterations prevent a growth of the step even if the error is small, because Newton's
  /// method is then close to failure.
  void accepted(double h, double error, int iterations);
  /// Records a step h [s] whose local error was above allowed(), and shortens the next one.
  /// @throws Error (numerical) if the next step, at time t [s], would be shorter than `smallest`.
  void rejected(double h, double error, double t);
  /// Records a step h [s] in which Newton's method failed, and shortens the next one.
  /// @throws Error (numerical) if the next step, at time t [s], would be shorter than `smallest`.
  void failed(double h, double t);

 private:
  void shorten(double h, double t, const char* why);

  double allowed_, largest_, smallest_;
  double request_ = 0;   // next step if no event time is near
  double last_ = 0;      // local error of the last step, relative to allowed_; 0: unknown
  bool shrunk_ = false;  // true if the last try was rejected
  double failed_ = 0;    // size of the last step in which Newton's method failed; 0: none
  int since_failed_ = 0;
};

}  // namespace flexmorph::fem
