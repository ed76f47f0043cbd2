#pragma once

#include <functional>
#include <string>
#include <vector>

#include "fem/shapes/shape.h"

namespace flexmorph::fem {

/// How a temperature rises from 0 to its final value between `start` and `start` + `settle`,
/// u = (t - start)/settle in [0, 1]:
///
///   quartic   6u² - 8u³ + 3u⁴          fits what T says of its Fig. 4
///   cosine    (1 - cos πu)/2
///   quintic   10u³ - 15u⁴ + 6u⁵        the only one without a jump of the acceleration
///   linear    u
///   step      all of it from u = 0 on (at `start` = 0: from the first instant); settle is not used
enum class Profile { quartic, cosine, quintic, linear, step };

struct TemperatureRise {
  Profile profile = Profile::quartic;
  double rise = 0;    ///< final ΔT [K]
  double start = 0;   ///< [s]
  double settle = 1;  ///< [s]
};

/// "quartic", "cosine", "quintic", "linear", "step". @throws Error (input) naming them.
Profile profile_of(const std::string& name);

/// ΔT, its rate and its acceleration [K], [K/s], [K/s²]: 0 before `start`, constant after settling.
/// Where they jump they are those behind the jump.
/// @throws Error (input) for numbers that are not finite or settle <= 0.
std::function<Motion(double t)> make_temperature(const TemperatureRise& rise);

/// Times at which ΔT, its rate or its acceleration jumps [s]: see MotionSettings::kinks.
std::vector<double> kinks(const TemperatureRise& rise);

/// Is the acceleration of ΔT ever other than 0? Otherwise there is no thermal inertia force: jumps
/// of the temperature and of its rate carry none.
bool accelerates(const TemperatureRise& rise);

}  // namespace flexmorph::fem
