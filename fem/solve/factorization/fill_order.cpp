#include "fem/solve/factorization/fill_order.h"

#include <cholmod.h>

#include "geometry/base.h"

namespace flexmorph::fem {

std::vector<int> fill_order(std::span<const int> starts, std::span<const int> neighbours,
                            std::span<const int> groups) {
  const std::size_t n = groups.size();
  cholmod_common common;
  cholmod_start(&common);
  common.print = 0;
  cholmod_sparse pattern{};
  pattern.nrow = pattern.ncol = n;
  pattern.nzmax = neighbours.size();
  // read only, although CHOLMOD's interface is not const
  pattern.p = const_cast<int*>(starts.data());
  pattern.i = const_cast<int*>(neighbours.data());
  pattern.stype = 1;
  pattern.itype = CHOLMOD_INT;
  pattern.xtype = CHOLMOD_PATTERN;
  pattern.dtype = CHOLMOD_DOUBLE;
  pattern.sorted = pattern.packed = 1;
  std::vector<int> order(n);
  const bool done = cholmod_camd(&pattern, nullptr, 0, const_cast<int*>(groups.data()),
                                 order.data(), &common) != 0;
  cholmod_finish(&common);
  if (!done) throw Error::numerical("linear solver: CHOLMOD cannot order the unknowns");
  return order;
}

}  // namespace flexmorph::fem
