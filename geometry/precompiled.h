#pragma once

// Headers that nearly every file includes, parsed once for all of them (the top CMakeLists.txt
// passes this header to the compiler). Every file still includes the headers that it uses,
// therefore everything compiles without this one, too.

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
