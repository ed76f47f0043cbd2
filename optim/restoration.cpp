#include "optim/restoration.h"

#include "optim/kkt.h"

namespace flexmorph::optim {

VectorXd restored(const Point& point, const VectorXd& lower, const VectorXd& upper, double limit) {
  const ProblemValues& r = point.response;
  const VectorXd down = (lower - point.x).cwiseMax(-limit);
  const VectorXd up = (upper - point.x).cwiseMin(limit);
  VectorXd d = VectorXd::Zero(point.x.size());
  VectorXd free = VectorXd::Ones(point.x.size());
  constexpr int kPasses =
      20;  // each pass fixes at least one more entry at its bound, or is the last
  for (int pass = 0; pass < kPasses; ++pass) {
    const VectorXd held = d.cwiseProduct(VectorXd::Ones(d.size()) - free);
    const MatrixXd A = r.dg * free.asDiagonal();
    const VectorXd lambda = nonnegative_minimum(A * A.transpose(), r.g + r.dg * held);
    const VectorXd wanted = held - A.transpose() * lambda;
    d = wanted.cwiseMax(down).cwiseMin(up);
    if (d == wanted) break;
    free = (d.array() == wanted.array()).select(free, 0.0);
  }
  return point.x + d;
}

}  // namespace flexmorph::optim
