#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cases/stability/suites.h"
#include "cases/study/processes.h"

/// What became of a perturbed run: a verdict from its exit code, its message and its files.
namespace flexmorph::cases {

enum class Verdict {
  stable,    ///< it ended well, and every number of it holds what it must
  refused,   ///< it was refused or gave up, and said why
  degraded,  ///< it ended well, a bound is missed and one sentence says why
  wrong      ///< a crash, a hang, a NaN, or a number that cannot be true
};
std::string to_string(Verdict verdict);

/// Beyond it nobody should trust a motion: the share of energy that is missed [-].
constexpr double kLargestDefect = 0.1;

/// Figures of a run folder; absent where the run has none.
struct Figures {
  std::optional<double> energy_defect;   ///< largest |defect| / largest energy [-]
  std::optional<double> energy_growth;   ///< largest defect > 0 / largest energy [-]
  std::optional<double> position_drift;  ///< largest |Φ| [m]
  std::optional<double> velocity_drift;  ///< largest |Φ_t + Φ_q q̇| [m/s]
  std::optional<double> newton;          ///< Newton iterations per step or equilibrium
  std::optional<double> rejected;        ///< steps
  std::optional<double> condition;       ///< worst of motion, path and designs
  std::optional<double> area_ratio;      ///< smallest
};

/// What follows from the scene of a row for the numbers of its run.
///
/// The balance of energy is integrated by the trapezoidal rule along a method of second order: for
/// a motion of circular frequency ω its defect is (h ω)² of the energy that is moved, times a
/// constant of about one. Where h ω is above 0.3 the motion is not resolved and the bound ends at
/// 10 %. Rows of the constraints are solved to round-off at position level; at velocity level they
/// are only as good as the step: the same share of the fastest velocity.
struct Bounds {
  double step = 0;        ///< h [s]; 0: nothing moves
  double omega = 0;       ///< fastest of bending, spin, start [rad/s], see bounds_of()
  std::string fastest;    ///< what that is: "bending of 'plate'"
  double length = 1;      ///< of the scene [m]
  double mass = 0;        ///< of all bodies [kg]
  double rounding = 0;    ///< energy of stresses that are only round-off [J]
  bool undriven = false;  ///< nothing feeds energy in: it must not grow
  double h_omega() const { return step * omega; }
  double defect() const;                  ///< [-]
  double position() const;                ///< [m]
  double velocity(double kinetic) const;  ///< [m/s], from the largest kinetic energy [J]
};
Bounds bounds_of(const Scene& scene);

struct Judgement {
  Verdict verdict = Verdict::wrong;
  std::string reason;  ///< one sentence; of what was refused its message
  Figures figures;
};

/// A run that has ended, and all that is known about it.
struct Evidence {
  std::string folder;  ///< of the run; may be missing
  std::string words;   ///< what it said on the terminal
  std::string path;    ///< of its case file
  Ending ending;
  const Perturbation* row = nullptr;
  std::optional<Bounds> bounds;  ///< absent: the scene cannot be read
  std::string reference;         ///< folder of the unperturbed run; empty: none
  double largest_volume = 1;     ///< of designs [-]
};
Judgement judge(const Evidence& evidence);

/// The first place in the files of a folder that holds NaN or infinity: "motion.csv:14: nan";
/// empty: none. Words of people (warnings) do not count, numbers do.
std::string first_unreal(const std::string& folder);

/// A number of a run: a column of motion.csv or path.csv (its last value; with ".largest" its
/// largest size, with ".span" how far it moves), a figure of the first design ("compliance"), or
/// "events", the number of changes of the mesh. None where it is not there.
std::optional<double> quantity_in(const std::string& folder, const std::string& quantity);

/// Does a run that was refused or gave up say what is wrong and where? One that gave up by the
/// failure in its run.json (phase, cause, and a time, load factor or iteration); one that was not
/// begun by the place that its message begins with, of the case file or of an option.
bool names_cause(const Evidence& evidence);

}  // namespace flexmorph::cases
