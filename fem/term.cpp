#include "fem/term.h"

namespace flexmorph::fem {

Local local_of(const Batch& x, int lane) {
  Local out;
  const auto rows = [&](const Lanes* from, LocalRows& to) {
    to.resize(x.n_shapes, x.dim);
    for (int k = 0; k < x.n_local(); ++k) to.data()[k] = from[k][lane];
  };
  rows(x.q, out.q);
  rows(x.v, out.v);
  rows(x.a, out.a);
  return out;
}

}  // namespace flexmorph::fem
