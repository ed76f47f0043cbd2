#include "cases/scene/version.h"

#include <Eigen/Core>

namespace flexmorph::cases {

const char* const kVersion = FLEXMORPH_VERSION;
const char* const kCasesFolder = FLEXMORPH_CASES;

std::vector<std::pair<std::string, std::string>> library_versions() {
  const std::string eigen = std::to_string(EIGEN_WORLD_VERSION) + "." +
                            std::to_string(EIGEN_MAJOR_VERSION) + "." +
                            std::to_string(EIGEN_MINOR_VERSION);
  return {{"Eigen", eigen},           {"SuiteSparse", FLEXMORPH_SUITESPARSE},
          {"CGAL", FLEXMORPH_CGAL},   {"VTK", FLEXMORPH_VTK},
          {"NLopt", FLEXMORPH_NLOPT}, {"Ipopt", FLEXMORPH_IPOPT}};
}

}  // namespace flexmorph::cases
