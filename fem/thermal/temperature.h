#pragma once

#include <functional>
#include <string>
#include <vector>

#include "fem/shapes/shape.h"

namespace flexmorph::fem {

/// Profile of a temperature that rises from 0 to its final value between `start` and `start` +
/// `duration`, u = (t - start)/duration in [0, 1]:
///
///   quartic   6u² - 8u³ + 3u⁴          agrees with the description of Fig. 4 in T
///   cosine    (1 - cos πu)/2
///   quintic   10u³ - 15u⁴ + 6u⁵        the only one without a jump of the acceleration
///   linear    u
///   step      full value from u = 0 on (at `start` = 0: from the first instant); settle is not
///   used
enum class Profile { quartic, cosine, quintic, linear, step };

/// A rise of the temperature by a given amount.
struct TemperatureRise {
  Profile profile = Profile::quartic;  ///< Shape of the rise in time.
  double rise = 0;                     ///< Final ΔT [K].
  double start = 0;                    ///< Time at which the rise begins [s].
  double duration = 1;                 ///< Duration of the rise [s].
};

/// Returns the profile of a name: "quartic", "cosine", "quintic", "linear", "step".
/// @throws Error (input) that lists the names.
Profile profile_of(const std::string& name);

/// Returns the function of ΔT, its rate and its acceleration [K], [K/s], [K/s²]: 0 before `start`,
/// constant after the rise. Where they jump, it gives the values after the jump.
/// @throws Error (input) for numbers that are not finite or duration <= 0.
std::function<Motion(double t)> make_temperature(const TemperatureRise& rise);

/// Returns the times at which ΔT, its rate or its acceleration jumps [s], see
/// MotionSettings::discontinuities.
std::vector<double> discontinuities(const TemperatureRise& rise);

/// Returns true if the acceleration of ΔT is ever other than 0. Otherwise there is no thermal
/// inertia force, because jumps of the temperature and of its rate cause none.
bool accelerates(const TemperatureRise& rise);

}  // namespace flexmorph::fem
