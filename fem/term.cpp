#include "fem/term.h"

namespace flexmorph::fem {

Local local_of(const Batch& x, int lane) {
  Local out;
  const auto rows = [&](const Pack* from, LocalRows& to) {
    to.resize(x.n_shapes, x.dim);
    for (int k = 0; k < x.n_local(); ++k) to.data()[k] = from[k][lane];
  };
  rows(x.q, out.q);
  rows(x.v, out.v);
  rows(x.a, out.a);
  return out;
}

void add_force_of_lane(const Term& term, const Batch& x, int lane, Pack* force) {
  LocalRows f;
  f.setZero(x.n_shapes, x.dim);
  term.add_force(x.first + lane, local_of(x, lane), f);
  for (int k = 0; k < x.n_local(); ++k) force[k][lane] += f.data()[k];
}

void add_tangent_of_lane(const Term& term, const Batch& x, int lane, const Weights& w,
                         Pack* tangent) {
  const int n = x.n_local();
  LocalTangent t;
  t.setZero(n, n);
  term.add_tangent(x.first + lane, local_of(x, lane), w, t);
  for (int row = 0; row < n; ++row)
    for (int column = 0; column < n; ++column) tangent[column * n + row][lane] += t(row, column);
}

}  // namespace flexmorph::fem
