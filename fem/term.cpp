#include "fem/term.h"

namespace flexmorph::fem {
namespace {

void unpack(const Batch& x, int lane, Local& out) {
  const auto rows = [&](const Lanes* from, LocalRows& to) {
    to.resize(x.n_shapes, x.dim);
    for (int k = 0; k < x.n_local(); ++k) to.data()[k] = from[k][lane];
  };
  rows(x.q, out.q);
  rows(x.v, out.v);
  rows(x.a, out.a);
}

}  // namespace

void Term::add_forces(const Batch& x, Lanes* force) const {
  Local local;
  LocalRows f;
  for (int lane = 0; lane < x.count; ++lane) {
    unpack(x, lane, local);
    f.setZero(x.n_shapes, x.dim);
    add_force(x.first + lane, local, f);
    for (int k = 0; k < x.n_local(); ++k) force[k][lane] += f.data()[k];
  }
}

void Term::add_tangents(const Batch& x, const Weights& w, Lanes* tangent) const {
  Local local;
  LocalTangent t;
  const int n = x.n_local();
  for (int lane = 0; lane < x.count; ++lane) {
    unpack(x, lane, local);
    t.setZero(n, n);
    add_tangent(x.first + lane, local, w, t);
    for (int row = 0; row < n; ++row)
      for (int column = 0; column < n; ++column) tangent[column * n + row][lane] += t(row, column);
  }
}

void Term::add_mean_force(int, const LocalStep&, LocalRows&) const {
  throw Error::input("the term '" + name() +
                     "' has no mean force: integrator \"energy_momentum\" cannot take it, "
                     "\"generalized_alpha\" can");
}

void Term::add_mean_tangent(int, const LocalStep&, const Weights&, LocalTangent&) const {
  throw Error::input("the term '" + name() + "' has no mean tangent");
}

void Term::add_free_force(int, const Local&, FreeForce&) const {
  throw Error::input("the term '" + name() + "' does not know free material lines");
}

void Term::add_free_tangent(int, const Local&, const Weights&, FreeTangent&) const {
  throw Error::input("the term '" + name() + "' does not know free material lines");
}

}  // namespace flexmorph::fem
