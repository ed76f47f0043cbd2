// Prints errors, numbers of steps and CPU seconds of constant and adaptive steps; started by hand:
//
//   adaptive_steps [part of a scene's name]...
//
// An error is the largest one at 40 stops, as a fraction of the model's size, relative to a
// reference with constant steps at least four times finer than the finest ones shown. Constant
// steps end at the stops, therefore there are at least 40 of them; adaptive steps are interpolated.
// "best equal" is the smallest number of constant steps with an error that is not larger,
// interpolated between the measured ones (linearly in the logarithms).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <optional>
#include <string>

#include "cases/assembly/build.h"
#include "tests/benchmark/cpu.h"
#include "tests/support/rigid_models.h"

namespace {

using namespace flexmorph;

/// The settings of a run: constant steps of a size, or adaptive steps.
struct Wish {
  double step = 1e-3;
  std::optional<fem::AdaptiveStep> adaptive;
  std::vector<double> stops;
};
struct Course {
  std::vector<Vec3> points;  // at the stops
  fem::MotionResult result;
  double seconds = 0;
};
using Problem = std::function<Course(const Wish&)>;

struct Scene {
  std::string name;
  double end = 1, size = 1;   // [s], [m]
  double shipped = 1e-3;      // step of the case [s]
  std::vector<double> steps;  // coarse to fine; the last one is the reference
  Problem problem;
};

struct Measured {
  double error = 0;
  int steps = 0;
  double seconds = 0;
};

double error(const Course& a, const Course& b) {
  double out = 0;
  for (size_t i = 0; i < a.points.size(); ++i)
    out = std::max(out, (a.points[i] - b.points[i]).norm());
  return out;
}

/// Returns the smallest number of constant steps with at most this error; zero steps if there is
/// none.
Measured best_equal(const std::vector<Measured>& equal, double error) {
  Measured out;
  for (size_t i = 0; i < equal.size(); ++i) {
    if (equal[i].error > error) continue;
    out = equal[i];
    if (i > 0 && equal[i - 1].error > error) {
      const double part =
          std::log(equal[i - 1].error / error) / std::log(equal[i - 1].error / out.error);
      const auto between = [part](double a, double b) { return a * std::pow(b / a, part); };
      out.steps = static_cast<int>(std::lround(between(equal[i - 1].steps, out.steps)));
      out.seconds = between(equal[i - 1].seconds, out.seconds);
    }
    break;
  }
  return out;
}

std::optional<Measured> measure(const char* what, const Scene& scene, const Wish& request,
                                const Course& exact) {
  try {
    const Course c = scene.problem(request);
    const fem::StepCounts& n = c.result.counts;
    const Measured out = {error(c, exact) / scene.size, n.steps, c.seconds};
    std::printf("  %-16s error %.2e, %5d steps (%d + %d repeated), %6d Newton, %5d factors, %.2f s",
                what, out.error, n.steps, n.inaccurate, n.rejected, n.newton, n.factorizations,
                c.seconds);
    return out;
  } catch (const Error& e) {
    std::printf("  %-16s %.60s\n", what, e.what());
    return {};
  }
}

void compare(const Scene& scene) {
  Wish request;
  for (int k = 1; k <= 40; ++k) request.stops.push_back(scene.end * k / 40);
  request.step = scene.steps.back();
  const Course exact = scene.problem(request);
  std::printf("%s (size %.2g m; reference %d steps)\n", scene.name.c_str(), scene.size,
              exact.result.counts.steps);
  char text[40];
  std::vector<Measured> equal;
  int shipped = 0;  // number of steps of the case
  for (size_t i = 0; i + 1 < scene.steps.size(); ++i) {
    request.step = scene.steps[i];
    std::snprintf(text, sizeof text, "step %.2e s", request.step);
    const auto m = measure(text, scene, request, exact);
    std::printf("\n");
    if (m) equal.push_back(*m);
  }
  shipped = static_cast<int>(std::lround(scene.end / scene.shipped));
  request.step = 1e-3;
  for (const double tolerance : {1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5}) {
    request.adaptive = fem::AdaptiveStep{};
    request.adaptive->tolerance = tolerance;
    std::snprintf(text, sizeof text, "tolerance %.0e", tolerance);
    const auto m = measure(text, scene, request, exact);
    if (!m) continue;
    const Measured best = best_equal(equal, m->error);
    if (best.steps > 0)
      std::printf("; / best equal: steps %.2f, CPU %.2f; / shipped: %.2f\n",
                  1.0 * m->steps / best.steps, m->seconds / best.seconds, 1.0 * m->steps / shipped);
    else
      std::printf("; no equal steps are as good\n");
  }
  std::fflush(stdout);
}

/// Returns a shipped case with changes. Its points are the observed points and the middles of the
/// free ends of plates.
Problem shipped_case(const std::string& name, const std::vector<std::string>& changes) {
  return [=](const Wish& request) {
    const cases::Scene scene = cases::read_scene(
        io::CaseFile(std::string(FLEXMORPH_CASES) + "/" + name + ".toml", changes));
    cases::Mechanism mechanism = cases::build_mechanism(scene);
    fem::MotionSettings& motion = mechanism.motion;
    motion.step = request.step;
    motion.adaptive = request.adaptive;
    motion.stops = request.stops;
    motion.balance = false;
    Course out;
    const auto see = [&](const fem::MotionStep& s) {
      if (!s.stop) return;
      for (const cases::Observe& o : scene.observed)
        out.points.push_back(fem::point_position(s.model.body(o.body), s.x, o.point));
      for (const fem::MovingRoot& g : mechanism.moving_roots) {
        const fem::Body& body = s.model.body(g.body);
        const fem::LineGrid& grid = fem::grid_of(body);
        out.points.push_back(
            fem::point_position(body, s.x, Vec2(grid.line_m(grid.n_m()).value, 0)));
      }
    };
    const double begin = cpu_seconds();
    out.result = fem::integrate(mechanism.model, mechanism.moving_roots, motion, see);
    out.seconds = cpu_seconds() - begin;
    return out;
  };
}

/// Moves a model of rigid bodies. The points are the first two unknowns of a body, its position.
Course move(fem::Workspace& model, const Wish& request, double end, fem::BodyPoses body_poses,
            const char* body) {
  fem::MotionSettings motion;
  motion.end = end;
  motion.step = request.step;
  motion.adaptive = request.adaptive;
  motion.stops = request.stops;
  motion.balance = false;
  motion.start = fem::Start::rigid;
  motion.body_poses = std::move(body_poses);
  Course out;
  const double begin = cpu_seconds();
  out.result = fem::integrate(model, {}, motion, [&](const fem::MotionStep& s) {
    const Vec2 p = s.x.q.segment<2>(s.model.body(body).first_dof);
    if (s.stop) out.points.emplace_back(p.x(), p.y(), 0);
  });
  out.seconds = cpu_seconds() - begin;
  return out;
}

/// Returns a block on a spring about the origin, released from the horizontal: a pendulum with an
/// elastic rod.
Problem spring_pendulum(double stiffness) {
  return [=](const Wish& request) {
    fem::Workspace model;
    testing::add_rigid(model, "bob", {2, {0, 0}, 0.02}, Vec2(0, -9.81));
    model.add_force_element(
        fem::make_spring("rod", {.point = {0, 0}}, {.body = "bob"}, {stiffness, 0, 1.0}));
    const auto body_poses = [](double) {
      fem::FrameMotion f;
      f.origin = {1, 0};
      return std::vector<fem::BodyPose>{{"bob", f, 0}};
    };
    return move(model, request, 3, body_poses, "bob");
  };
}

/// Returns a crank that rotates freely, a block that slides on a line through the crank's axis, and
/// an elastic rod between them.
Problem slider_crank(double stiffness) {
  return [=](const Wish& request) {
    fem::Workspace model;
    const Vec2 gravity(0, -9.81);
    testing::add_rigid(model, "crank", {1, {0.08, 0}, 0.003}, gravity);
    testing::add_rigid(model, "block", {0.5, {0, 0}, 0.001}, gravity);
    model.add_joint(fem::make_revolute("axis", {}, {.body = "crank"}));
    model.add_joint(fem::make_slider("guide", {}, {.body = "block"}));
    model.add_force_element(fem::make_spring("rod", {.body = "crank", .point = {0.15, 0}},
                                             {.body = "block"}, {stiffness, 0, 0.4}));
    const auto body_poses = [](double) {
      fem::FrameMotion crank, block;
      crank.angle = std::numbers::pi / 2;
      crank.angle_rate = 6;
      block.origin = {std::sqrt(0.4 * 0.4 - 0.15 * 0.15), 0};
      block.origin_rate = {-0.15 * 6, 0};
      return std::vector<fem::BodyPose>{{"crank", crank, 0}, {"block", block, 0}};
    };
    return move(model, request, 2, body_poses, "block");
  };
}

/// Returns steps that are halved from level to level, beginning with `coarse`, and the step of the
/// reference.
std::vector<double> halves(double coarse, int levels, double reference) {
  std::vector<double> out;
  for (int k = 0; k < levels; ++k) out.push_back(coarse / std::exp2(k));
  out.push_back(reference);
  return out;
}

std::vector<Scene> scenes() {
  std::vector<Scene> out;
  const std::vector<double> one = halves(0.025, 7, 6.25e-5), two = halves(0.05, 8, 6.25e-5);
  for (const char* k : {"1e4", "1e6", "1e8"}) {
    out.push_back({std::string("spring pendulum, k ") + k, 3, 1, 1e-3, halves(0.075, 8, 6.25e-5),
                   spring_pendulum(std::atof(k))});
    out.push_back(
        {std::string("free slider-crank, k ") + k, 2, 0.4, 1e-3, two, slider_crank(std::atof(k))});
  }
  const auto add = [&](const std::string& name, const char* file, double end, double size,
                       const std::vector<double>& steps, const std::vector<std::string>& changes) {
    out.push_back({name, end, size, 1e-3, steps, shipped_case(file, changes)});
  };
  const std::string stiff = "body.youngs_modulus=1e10";
  for (const char* v : {"v01", "v05"}) {
    const std::string plate = std::string("rotating_plate_") + v;
    add(plate, plate.c_str(), 1, 0.5, one, {});
    add(plate + ", E x 100", plate.c_str(), 1, 0.5, one, {stiff});
  }
  const std::string rigid = "time.start=rigid", rest = "time.start=hub_at_rest";
  const char* const slow = "rotating_plate_v01";
  add("rotating_plate_v01, rigid start", slow, 1, 0.5, one, {rigid});
  add("rotating_plate_v01, rigid start, E x 100", slow, 1, 0.5, one, {rigid, stiff});
  add("rotating_plate_v01, spin-up", slow, 1, 0.5, one, {rest});
  add("rotating_plate_v01, spin-up, E x 100", slow, 1, 0.5, one, {rest, stiff});
  const char* const hot = "slider_crank_heated";
  const std::string rod = "body.youngs_modulus=2e10", jump = "body.heat.profile=step";
  add("slider_crank_heated", hot, 2, 0.46, two, {});
  add("slider_crank_heated, E x 100", hot, 2, 0.46, two, {rod});
  add("slider_crank_heated, 4 s", hot, 4, 0.46, halves(0.1, 8, 1.25e-4), {"time.end=4"});
  add("slider_crank_heated, 4 s, E x 100", hot, 4, 0.46, halves(0.1, 8, 1.25e-4),
      {"time.end=4", rod});
  add("slider_crank_heated, temperature step", hot, 2, 0.46, two, {jump});
  add("slider_crank_heated, temperature step, E x 100", hot, 2, 0.46, two, {jump, rod});
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  flexmorph::benchmark::begin(argv);
  for (const Scene& scene : scenes()) {
    bool wanted = argc == 1;
    for (int i = 1; i < argc; ++i) wanted = wanted || scene.name.find(argv[i]) != std::string::npos;
    try {
      if (wanted) compare(scene);
    } catch (const Error& e) {  // the reference cannot be computed
      std::printf("%s: %s\n", scene.name.c_str(), e.what());
    }
  }
}
