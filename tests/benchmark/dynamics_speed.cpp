// Cost of the dynamics, by hand: CPU seconds of 1000 steps of the growing, rotating plate, 10 x 2
// elements, without and with a design (20 x 20 cells per element; limit 6 s on one core), and of
// one evaluation of force and tangent of one element.
//
//   OPENBLAS_NUM_THREADS=1 dynamics_speed
#include <cstdio>
#include <ctime>

#include "fem/dynamics/motion.h"
#include "tests/support/models.h"

namespace {

using namespace flexmorph;
using testing::RotatingPlate;
using testing::ShapeSet;

double cpu() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

const char* name(ShapeSet shapes) { return shapes == ShapeSet::h12 ? "h12" : "h16"; }

void run(const RotatingPlate& p, const char* design) {
  testing::Scene scene = testing::make_scene(p);
  const double start = cpu();
  const fem::MotionResult r =
      fem::integrate(scene.model, scene.growths, {}, [](const fem::MotionStep&) {});
  const double spent = cpu() - start;
  std::printf("v %.1f %s %-8s %8.2f s  %5d steps %6d Newton iterations %5d factorizations\n",
              p.speed, name(p.shapes), design, spent, r.counts.steps, r.counts.newton,
              r.counts.factorizations);
}

/// Mean CPU time [us] of f over enough repetitions for 0.2 s.
template <class F>
double microseconds(const F& f) {
  int n = 0;
  const double start = cpu();
  while (cpu() - start < 0.2)
    for (int k = 0; k < 20; ++k, ++n) f();
  return 1e6 * (cpu() - start) / n;
}

void evaluate(const RotatingPlate& p, const char* design) {
  testing::Scene scene = testing::make_scene(p);
  fem::Model& model = scene.model;
  model.prepare(0.05);
  const fem::State reference = model.reference();
  fem::State x =
      testing::SmoothMotion(reference.q, 0.01 * model.scales().cwiseInverse(), 1).state(0.05);
  x.lambda = reference.lambda;
  const int n = model.bodies()[0].element->n_elements();
  VectorXd f;
  fem::Constraints c;
  fem::SparseMatrix kkt;
  model.constraints(x, c);
  const double force = microseconds([&] { model.force(x, f); }) / n;
  const double tangent = microseconds([&] { model.kkt(x, c, {1, 1, 1}, 1, kkt); }) / n;
  const double prepare = microseconds([&] { model.prepare(0.05); });
  std::printf(
      "%s %-8s force %6.2f us, tangent %7.2f us per element, moving elements %7.1f us per step\n",
      name(p.shapes), design, force, tangent, prepare);
}

}  // namespace

int main() {
  for (const ShapeSet shapes : {ShapeSet::h12, ShapeSet::h16})
    for (const bool designed : {false, true}) {
      RotatingPlate p;
      p.speed = 0.5;
      p.shapes = shapes;
      if (designed) p.factors = testing::chequered(p);
      evaluate(p, designed ? "design" : "uniform");
    }
  for (const double speed : {0.1, 0.5})
    for (const ShapeSet shapes : {ShapeSet::h12, ShapeSet::h16})
      for (const bool designed : {false, true}) {
        RotatingPlate p;
        p.speed = speed;
        p.shapes = shapes;
        if (designed) p.factors = testing::chequered(p);
        run(p, designed ? "design" : "uniform");
      }
}
