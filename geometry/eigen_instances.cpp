#include <Eigen/Dense>
#include <Eigen/Sparse>

#define FLEXMORPH_INSTANCE template
#include "geometry/eigen_instances.h"
