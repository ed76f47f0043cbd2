#include "cases/process/processor.h"

#include <unistd.h>

#include <cstdlib>
#include <string_view>

#include "cases/process/environment.h"
#include "cases/process/mpi_at_load.h"
#include "geometry/base.h"
#include "geometry/vector_limit.h"

namespace flexmorph {

namespace {

/// Excludes vectors that are wider than FLEXMORPH_VECTORS permits.
void limit_vectors() {
  const char* said = std::getenv("FLEXMORPH_VECTORS");
  const std::string_view most = said ? said : "v4";
  if (most == "baseline")
    limit_vector_level(VectorLevel::baseline);
  else if (most == "v3")
    limit_vector_level(VectorLevel::v3);
  else if (most != "v4")
    throw Error::input("FLEXMORPH_VECTORS=" + std::string(most) +
                       ": the value is baseline, v3 or v4");
}

}  // namespace

void set_up_processor(int threads, char** argv) {
  limit_vectors();
  keep_mpi_off_at_load();
  if (!set_environment(threads)) return;
  execv("/proc/self/exe", argv);  // returns only on failure; the libraries then use their defaults
}

}  // namespace flexmorph
