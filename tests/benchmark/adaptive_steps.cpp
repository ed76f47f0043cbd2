// Error against steps and CPU seconds, fixed steps and adaptive ones, by hand:
//
//   OPENBLAS_NUM_THREADS=1 adaptive_steps
//
// Errors are the largest at 40 stops, against fixed steps eight times finer than the finest shown.
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>

#include "fem/dynamics/motion.h"
#include "tests/benchmark/cpu.h"
#include "tests/support/models.h"
#include "tests/support/rigid_models.h"

namespace {

using namespace flexmorph;
using testing::RotatingPlate;

struct Course {
  std::vector<Vec2> points;  // at the stops
  fem::MotionResult result;
  double seconds = 0;
};
using Problem = std::function<Course(fem::MotionSettings)>;

double error(const Course& a, const Course& b) {
  double out = 0;
  for (size_t i = 0; i < a.points.size(); ++i)
    out = std::max(out, (a.points[i] - b.points[i]).norm());
  return out;
}

std::vector<double> stops(double end) {
  std::vector<double> out;
  for (int k = 1; k <= 40; ++k) out.push_back(end * k / 40);
  return out;
}

void compare(const char* name, double end, double size, std::vector<double> steps,
             const Problem& problem) {
  fem::MotionSettings settings;
  settings.end = end;
  settings.balance = false;
  settings.stops = stops(end);
  settings.step = steps.back() / 8;
  const Course exact = problem(settings);
  std::printf("%s (size %.2g m; reference %d steps)\n", name, size, exact.result.counts.steps);
  const auto show = [&](const std::string& what, const Course& c) {
    const fem::StepCounts& n = c.result.counts;
    std::printf(
        "  %-18s error %.2e, %5d steps (%d + %d repeated), %6d Newton, %5d factors, %.2f s\n",
        what.c_str(), error(c, exact) / size, n.steps, n.inaccurate, n.rejected, n.newton,
        n.factorizations, c.seconds);
  };
  char text[40];
  for (const double h : steps) {
    settings.step = h;
    std::snprintf(text, sizeof text, "step %.1e s", h);
    try {
      show(text, problem(settings));
    } catch (const Error& e) {
      std::printf("  %-18s %.60s\n", text, e.what());
    }
  }
  settings.step = 1e-3;
  for (const double tolerance : {1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5}) {
    settings.adaptive = fem::AdaptiveStep{};
    settings.adaptive->tolerance = tolerance;
    std::snprintf(text, sizeof text, "tolerance %.0e", tolerance);
    try {
      show(text, problem(settings));
    } catch (const Error& e) {
      std::printf("  %-18s %.60s\n", text, e.what());
    }
  }
}

Problem rotating_plate(double speed, double stiffness, fem::Start start) {
  return [=](fem::MotionSettings settings) {
    RotatingPlate p;
    p.speed = speed;
    p.section.youngs_modulus *= stiffness;
    testing::Scene scene = testing::make_scene(p);
    settings.start = start;
    Course out;
    const double begin = benchmark::cpu();
    out.result =
        fem::integrate(scene.model, scene.growths, settings, [&](const fem::MotionStep& s) {
          if (s.stop) out.points.push_back(testing::in_hub(p, s.model, s.x, p.tip()));
        });
    out.seconds = benchmark::cpu() - begin;
    return out;
  };
}

/// A block on a spring about the origin, from the horizontal: a pendulum whose rod gives.
Problem spring_pendulum(double stiffness) {
  return [=](fem::MotionSettings settings) {
    const fem::RigidSection section{2, {0, 0}, 0.02};
    fem::Model model;
    testing::add_rigid(model, "bob", section, Vec2(0, -9.81));
    model.add_link(
        fem::make_spring("rod", {.point = {0, 0}}, {.body = "bob"}, {stiffness, 0, 1.0}));
    settings.start = fem::Start::rigid;
    settings.placement = [](double) {
      fem::FrameMotion f;
      f.origin = {1, 0};
      return std::vector<fem::Placed>{{"bob", f, 0}};
    };
    Course out;
    const double begin = benchmark::cpu();
    out.result = fem::integrate(model, {}, settings, [&](const fem::MotionStep& s) {
      if (s.stop) out.points.push_back(s.x.q.segment<2>(s.model.body("bob").first_dof));
    });
    out.seconds = benchmark::cpu() - begin;
    return out;
  };
}

/// A crank that turns freely, a block that slides on a line through its axis, and a rod that gives
/// between them.
Problem slider_crank(double stiffness, double damping) {
  return [=](fem::MotionSettings settings) {
    fem::Model model;
    const Vec2 gravity(0, -9.81);
    testing::add_rigid(model, "crank", {1, {0.08, 0}, 0.003}, gravity);
    testing::add_rigid(model, "block", {0.5, {0, 0}, 0.001}, gravity);
    model.add_joint(fem::make_revolute("axis", {}, {.body = "crank"}));
    model.add_joint(fem::make_slider("guide", {}, {.body = "block"}));
    model.add_link(fem::make_spring("rod", {.body = "crank", .point = {0.15, 0}}, {.body = "block"},
                                    {stiffness, damping, 0.4}));
    settings.start = fem::Start::rigid;
    settings.placement = [](double) {
      fem::FrameMotion crank, block;
      crank.angle = std::numbers::pi / 2;
      crank.angle_rate = 6;
      block.origin = {std::sqrt(0.4 * 0.4 - 0.15 * 0.15), 0};
      block.origin_rate = {-0.15 * 6, 0};
      return std::vector<fem::Placed>{{"crank", crank, 0}, {"block", block, 0}};
    };
    Course out;
    const double begin = benchmark::cpu();
    out.result = fem::integrate(model, {}, settings, [&](const fem::MotionStep& s) {
      if (s.stop) out.points.push_back(s.x.q.segment<2>(s.model.body("block").first_dof));
    });
    out.seconds = benchmark::cpu() - begin;
    return out;
  };
}

}  // namespace

int main() {
  const std::vector<double> steps = {8e-3, 4e-3, 2e-3, 1e-3, 5e-4};
  compare("spring pendulum, k 1e4", 3, 1, steps, spring_pendulum(1e4));
  compare("spring pendulum, k 1e6", 3, 1, steps, spring_pendulum(1e6));
  compare("spring pendulum, k 1e8", 3, 1, steps, spring_pendulum(1e8));
  compare("slider-crank, k 1e4", 2, 0.4, steps, slider_crank(1e4, 0));
  compare("slider-crank, k 1e6", 2, 0.4, steps, slider_crank(1e6, 0));
  compare("slider-crank, k 1e8", 2, 0.4, steps, slider_crank(1e8, 0));
  for (const double speed : {0.1, 0.5}) {
    char name[60];
    for (const double stiffness : {1.0, 100.0}) {
      std::snprintf(name, sizeof name, "rotating plate, v %.1f, E x %.0f", speed, stiffness);
      compare(name, 1, 0.5, steps, rotating_plate(speed, stiffness, fem::Start::prestretched));
    }
  }
  compare("rotating plate, v 0.1, rigid start", 1, 0.5, steps,
          rotating_plate(0.1, 1, fem::Start::rigid));
  compare("rotating plate, v 0.1, E x 100, rigid start", 1, 0.5, steps,
          rotating_plate(0.1, 100, fem::Start::rigid));
}
