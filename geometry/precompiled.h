#pragma once

// What nearly every file includes, parsed once for all of them (the top CMakeLists.txt gives it to
// the compiler). Files still name what they use: without this header everything compiles as well.

#include <Eigen/Core>
#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#define FLEXMORPH_INSTANCE extern template
#include "geometry/eigen_instances.h"
#undef FLEXMORPH_INSTANCE
