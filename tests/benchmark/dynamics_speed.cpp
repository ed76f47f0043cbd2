// Prints the cost of the dynamics; started by hand: CPU seconds of 1000 steps of the growing,
// rotating plate with 10 x 2 elements, without and with a design (20 x 20 cells per element; limit
// 6 s on one core), and of one evaluation of force and tangent of one element.
//
//   dynamics_speed [integrators]
//
// "integrators": prints error against CPU time of both integrators on a planar pendulum instead.
#include <cmath>
#include <cstdio>
#include <string>

#include "fem/dynamics/motion.h"
#include "fem/loads.h"
#include "fem/terms.h"
#include "tests/benchmark/cpu.h"
#include "tests/support/models.h"

namespace {

using namespace flexmorph;
using testing::RotatingPlate;
using testing::ShapeSet;

const char* name(ShapeSet shapes) { return shapes == ShapeSet::h12 ? "h12" : "h16"; }

void run(const RotatingPlate& p, const char* design) {
  testing::Scene scene = testing::make_scene(p);
  const double start = cpu_seconds();
  const fem::MotionResult r =
      fem::integrate(scene.model, scene.moving_roots, {}, [](const fem::MotionStep&) {});
  const double spent = cpu_seconds() - start;
  std::printf("v %.1f %s %-8s %8.2f s  %5d steps %6d Newton iterations %5d factorizations\n",
              p.speed, name(p.shapes), design, spent, r.counts.steps, r.counts.newton,
              r.counts.factorizations);
}

/// Returns the mean CPU time [us] of f over enough repetitions for 0.2 s.
template <class F>
double microseconds(const F& f) {
  int n = 0;
  const double start = cpu_seconds();
  while (cpu_seconds() - start < 0.2)
    for (int k = 0; k < 20; ++k, ++n) f();
  return 1e6 * (cpu_seconds() - start) / n;
}

void evaluate(const RotatingPlate& p, const char* design) {
  testing::Scene scene = testing::make_scene(p);
  fem::Workspace& model = scene.model;
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
  const double mean_force = microseconds([&] { model.mean_force(x, reference.q, x.q, f); }) / n;
  const double mean_tangent = microseconds([&] {
                                model.mean_kkt(x, reference.q, x.q, c, c, {1, 1, 1}, 1, kkt);
                              }) /
                              n;
  const double prepare = microseconds([&] { model.prepare(0.05); });
  std::printf(
      "%s %-8s force %6.2f us, tangent %7.2f us, mean force %6.2f us, mean tangent %7.2f us per "
      "element, moving elements %7.1f us per step\n",
      name(p.shapes), design, force, tangent, mean_force, mean_tangent, prepare);
}

/// Prints the final error against CPU time of a planar pendulum: 0.3 x 0.3 x 0.01 m, E 1e6, pinned
/// at a corner, released from the horizontal under gravity, 4 x 4 h16, 0.2 s. The reference is
/// generalized-alpha with rho_inf 0.9 and steps of 0.0125 ms, extrapolated.
void compare_integrators() {
  const Vec2 g(0, -9.81);
  const fem::PlaneSection section{0.01, 1e6, 0.3, 7810};
  std::vector<std::unique_ptr<fem::Term>> terms;
  terms.push_back(fem::make_inertia(section));
  terms.push_back(fem::make_membrane(section));
  terms.push_back(fem::make_gravity(section, g));
  fem::Workspace model;
  model.add_body(
      "plate",
      std::make_unique<fem::AncfPlate>(2, ShapeSet::h16, testing::uniform_lines(0, 0.3, 4),
                                       testing::uniform_lines(0, 0.3, 4)),
      section, std::move(terms));
  model.add_joint(fem::make_pin("pin", "plate", {0, 0}, [](double) { return fem::FrameMotion{}; }));
  const double end = 0.2;
  fem::StepCounts counts;
  double drift = 0;
  const auto run = [&](const fem::IntegratorSettings& settings, double h) {
    const auto integrator = fem::make_integrator(model, settings);
    fem::State x = model.reference();
    integrator->make_consistent(x);
    const double start = model.energies(x).total();
    const int n = static_cast<int>(std::lround(end / h));
    for (int k = 1; k <= n; ++k) integrator->advance(x, end * k / n, [](const fem::State&) {});
    counts = integrator->counts();
    const fem::Energies e = model.energies(x);
    drift = (e.total() - start) / e.kinetic;
    return x;
  };
  fem::IntegratorSettings alpha;
  alpha.alpha.rho_inf = 0.9;
  const fem::State coarse = run(alpha, 2.5e-5), fine = run(alpha, 1.25e-5);
  const VectorXd q = (4 * fine.q - coarse.q) / 3, v = (4 * fine.v - coarse.v) / 3,
                 scales = model.scales();
  fem::IntegratorSettings exact, loose;
  exact.name = loose.name = "energy_momentum";
  loose.energy_momentum.tolerance = 1e-7;
  const std::pair<const char*, fem::IntegratorSettings> rows[] = {
      {"generalized_alpha, rho 0.9", alpha},
      {"energy_momentum", exact},
      {"energy_momentum, tol 1e-7", loose}};
  for (const auto& [name, settings] : rows)
    for (const double h : {4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4}) {
      const double start = cpu_seconds();
      const fem::State x = run(settings, h);
      const double spent = cpu_seconds() - start;
      std::printf(
          "%-26s h %.2e: %6.2f s, error q %.2e m, v %.2e m/s, energy %+.1e, %5d Newton %5d "
          "factors\n",
          name, h, spent, (x.q - q).cwiseProduct(scales).lpNorm<Eigen::Infinity>(),
          (x.v - v).cwiseProduct(scales).lpNorm<Eigen::Infinity>(), drift, counts.newton,
          counts.factorizations);
    }
}

}  // namespace

int main(int argc, char** argv) {
  flexmorph::benchmark::begin(argv);
  if (argc > 1 && std::string(argv[1]) == "integrators") {
    compare_integrators();
    return 0;
  }
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
