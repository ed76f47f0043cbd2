// Shows that the gradients of the motions of shipped scenes on coarse cells are correct: Taylor
// remainders are of order two in random directions of the scale factors and of the variables of the
// components. The motions contain different starts, insertions and removals of lines, and driven
// joints.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "fem/dynamics/gradients/motion_gradient.h"
#include "optim/mmc/problem/body_problem.h"
#include "tests/cases/scenes.h"
#include "tests/support/rates.h"

namespace flexmorph::cases {
namespace {

/// Maps the variables of a design to smoothed scale factors of its cells, with the void of dynamics
/// as an offset:
///
///   κ = κ_v + (1 - κ_v) κ_H,   the mass factor in the same form
class DesignChain {
 public:
  explicit DesignChain(const mmc::BodyProblem& problem)
      : problem_(problem),
        ersatz_(mmc::ersatz_of(problem)),
        tdf_(problem.grid, half_a_cell_thinner(problem)) {}

  fem::ScaleFactors factors(const VectorXd& x) {
    std::vector<Component> components;
    problem_.design.components(x, components);
    tdf_.evaluate(components);
    mmc::CellScaleFactors f;
    ersatz_.factors(tdf_.density(), tdf_.eroded(), f);
    const double k = problem_.stiffness_void, m = problem_.mass_void;
    return {problem_.grid, k + (1 - k) * f.stiffness.array(), m + (1 - m) * f.mass.array()};
  }

  /// Returns the gradient with respect to x from the gradient with respect to the scale factors.
  VectorXd pull_back(const VectorXd& x, const fem::ScaleFactorGradient& by) {
    factors(x);
    const VectorXd stiffness = (1 - problem_.stiffness_void) * by.stiffness,
                   mass = (1 - problem_.mass_void) * by.mass;
    VectorXd by_h, by_eroded, out;
    ersatz_.pull_back(tdf_.eroded(), stiffness, mass, by_h, by_eroded);
    tdf_.pull_back(by_h, by_eroded, out);
    problem_.design.scale_gradient(out);
    return out;
  }

 private:
  /// Returns the settings of the last band, eroded by half a cell, so that stiffness and mass have
  /// different derivatives.
  static TdfSettings half_a_cell_thinner(const mmc::BodyProblem& problem) {
    TdfSettings out = problem.bands.back();
    out.erosion = 0.5 * problem.grid.dx();
    return out;
  }

  const mmc::BodyProblem& problem_;
  mmc::Ersatz ersatz_;
  UnionTdf tdf_;
};

/// A shipped scene, made coarse and short. Its objectives are the strain energy, the deflection of
/// its first plate, and those given here.
struct Shipped {
  std::string name, scene;
  Changes changes;
  double end, step;      // [s]
  std::string joint;     // joint whose force on the first designed body is an objective
  std::string placed;    // body whose distance from its rigid motion is an objective; "": none
  size_t least_changes;  // least number of changes of the mesh
};
std::ostream& operator<<(std::ostream& out, const Shipped& s) { return out << s.name; }

/// A scene whose motion is computed on the cells of its designs.
class Designed {
 public:
  explicit Designed(const Shipped& shipped)
      : scene_(read(shipped.scene, shipped.changes)),
        problems_(build_problems(scene_)),
        mechanism_(build_mechanism(scene_, {.elements = {}, .refine = 1, .cells = 1})) {
    set_step(scene_, shipped.step, mechanism_.motion);
    fem::MotionSettings& motion = mechanism_.motion;
    motion.end = shipped.end;
    motion.alpha.tolerance = 1e-13;
    for (int i = 1; i <= 4; ++i) motion.stops.push_back(motion.end * i / 4);
    for (const mmc::BodyProblem& p : problems_) {
      chains_.emplace_back(p);
      x_.push_back(p.design.x());
      const auto& bodies = mechanism_.model.bodies();
      size_t b = 0;
      while (bodies[b].name != p.body) ++b;
      bodies_.push_back(b);
    }
    set(x_);
    add_objectives(shipped);
  }

  size_t n_designs() const { return problems_.size(); }
  size_t n_objectives() const { return objectives_.size(); }
  const VectorXd& x(size_t design) const { return x_[design]; }
  DesignChain& chain(size_t design) { return chains_[design]; }
  size_t body(size_t design) const { return bodies_[design]; }

  void set(const std::vector<VectorXd>& x) {
    for (size_t d = 0; d < x.size(); ++d) set(d, chains_[d].factors(x[d]));
  }
  void set(size_t design, fem::ScaleFactors factors) {
    fem::Model& model = mechanism_.model;
    model.set_factors(model.bodies()[bodies_[design]], std::move(factors));
  }
  VectorXd values() const {
    const std::vector<double> v = fem::motion_values(mechanism_.model, mechanism_.moving_roots,
                                                     mechanism_.motion, objectives_);
    return Eigen::Map<const VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
  }
  fem::MotionGradients gradients() const {
    return fem::motion_gradients(mechanism_.model, mechanism_.moving_roots, mechanism_.motion,
                                 objectives_);
  }

 private:
  void add_objectives(const Shipped& shipped) {
    using Times = fem::MotionObjective::Times;
    const fem::MovingRoot& growth = mechanism_.moving_roots.at(0);
    const Vec2 tip(scene_.body(growth.body).longest(scene_.time.end), 0);
    objectives_ = {
        {fem::measure_strain_energy(), Times::stops, 1},
        {fem::measure_deflection(growth.body, tip, growth.hub, growth.line), Times::steps, 8},
        {fem::measure_joint_force(shipped.joint, problems_[0].body), Times::steps, 4}};
    if (shipped.placed.empty()) return;
    const auto entry = [&](int c) {
      return [body_poses = mechanism_.motion.body_poses, name = shipped.placed, c](double t) {
        for (const fem::BodyPose& b : body_poses(t))
          if (b.body == name) return fem::Motion{b.frame.origin[c], 0, 0};
        throw Error::input("there is no '" + name + "'");
      };
    };
    objectives_.push_back(
        {fem::measure_location_error(shipped.placed, {entry(0), entry(1)}), Times::steps, 6});
  }

  Scene scene_;
  std::vector<mmc::BodyProblem> problems_;
  std::vector<DesignChain> chains_;
  std::vector<VectorXd> x_;
  std::vector<size_t> bodies_;  // index of the body in the model, for every design
  Mechanism mechanism_;
  std::vector<fem::MotionObjective> objectives_;
};

VectorXd random_vector(Eigen::Index n, std::mt19937& random) {
  std::normal_distribution<double> normal;
  return VectorXd::NullaryExpr(n, [&] { return normal(random); });
}

/// A line through the design, the objectives along it, and their derivatives according to the
/// gradient.
struct Direction {
  std::function<VectorXd(double)> values;
  VectorXd slopes;  // g · d of every objective
  VectorXd sizes;   // |g|, the expected size of g · d for random d
  double largest;   // length along the line above which higher orders may appear
};

/// Changes every scale factor by a random fraction of itself.
Direction along_factors(Designed& scene, const fem::MotionGradients& g, std::mt19937& random) {
  const auto n = static_cast<Eigen::Index>(scene.n_objectives());
  Direction out{{}, VectorXd::Zero(n), VectorXd::Zero(n), 0.1};
  std::vector<fem::ScaleFactors> at;
  std::vector<VectorXd> stiffness, mass;
  for (size_t d = 0; d < scene.n_designs(); ++d) {
    at.push_back(scene.chain(d).factors(scene.x(d)));
    stiffness.push_back(random_vector(at[d].stiffness.size(), random));
    mass.push_back(random_vector(at[d].mass.size(), random));
    for (Eigen::Index k = 0; k < n; ++k) {
      const fem::ScaleFactorGradient& by = g.of[static_cast<size_t>(k)].d_factors[scene.body(d)];
      const VectorXd by_stiffness = by.stiffness.cwiseProduct(at[d].stiffness),
                     by_mass = by.mass.cwiseProduct(at[d].mass);
      out.slopes[k] += by_stiffness.dot(stiffness[d]) + by_mass.dot(mass[d]);
      out.sizes[k] += by_stiffness.squaredNorm() + by_mass.squaredNorm();
    }
  }
  out.sizes = out.sizes.cwiseSqrt();
  out.values = [=, &scene](double s) {
    for (size_t d = 0; d < at.size(); ++d)
      scene.set(d, {at[d].grid, at[d].stiffness.array() * (1 + s * stiffness[d].array()),
                    at[d].mass.array() * (1 + s * mass[d].array())});
    return scene.values();
  };
  return out;
}

/// Changes the variables of all components.
Direction along_components(Designed& scene, const fem::MotionGradients& g, std::mt19937& random) {
  const auto n = static_cast<Eigen::Index>(scene.n_objectives());
  Direction out{{}, VectorXd::Zero(n), VectorXd::Zero(n), 0.01};
  std::vector<VectorXd> x, move;
  for (size_t d = 0; d < scene.n_designs(); ++d) {
    x.push_back(scene.x(d));
    move.push_back(random_vector(x[d].size(), random));
    for (Eigen::Index k = 0; k < n; ++k) {
      const VectorXd by =
          scene.chain(d).pull_back(x[d], g.of[static_cast<size_t>(k)].d_factors[scene.body(d)]);
      out.slopes[k] += by.dot(move[d]);
      out.sizes[k] += by.squaredNorm();
    }
  }
  out.sizes = out.sizes.cwiseSqrt();
  out.values = [=, &scene](double s) {
    std::vector<VectorXd> moved = x;
    for (size_t d = 0; d < x.size(); ++d) moved[d] += s * move[d];
    scene.set(moved);
    return scene.values();
  };
  return out;
}

/// Returns the part of a remainder over those three decades of steps whose order is nearest to two:
/// larger steps show higher orders, smaller ones round-off.
testing::Rate over_three_decades(const testing::Rate& all) {
  constexpr std::ptrdiff_t kPoints = 7;  // two points per decade
  testing::Rate best;
  for (std::ptrdiff_t i = 0; i + kPoints <= std::ssize(all.step); ++i) {
    const testing::Rate part{{all.step.begin() + i, all.step.begin() + i + kPoints},
                             {all.error.begin() + i, all.error.begin() + i + kPoints}};
    if (best.step.empty() || std::abs(part.order() - 2) < std::abs(best.order() - 2)) best = part;
  }
  return best;
}

/// Returns difference quotients of fourth order of all objectives. They are computed for three
/// steps, each twice as long as the one before, so that they share motions. Of neighbouring steps,
/// those two are averaged whose quotients differ least: larger steps contain higher orders, smaller
/// ones the round-off of the motion, which depends on the processor.
VectorXd difference_quotients(const Direction& d) {
  const double least_step = 0.0075 * d.largest;
  std::vector<VectorXd> central, all;
  for (const int k : {1, 2, 4, 8})
    central.push_back(d.values(k * least_step) - d.values(-k * least_step));
  for (size_t i = 0; i + 1 < central.size(); ++i)
    all.push_back((8 * central[i] - central[i + 1]) / (12 * (1 << i) * least_step));
  VectorXd out = all[0];
  for (Eigen::Index k = 0; k < out.size(); ++k) {
    double least = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i + 1 < all.size(); ++i) {
      const double difference = std::abs(all[i][k] - all[i + 1][k]);
      if (difference >= least) continue;
      least = difference;
      out[k] = 0.5 * (all[i][k] + all[i + 1][k]);
    }
  }
  return out;
}

void expect_gradient(const Direction& d, const VectorXd& there, const std::string& what) {
  std::vector<double> steps;
  for (int i = 0; i < 9; ++i) steps.push_back(d.largest * std::pow(10.0, -0.5 * i));
  std::vector<VectorXd> along;
  for (const double s : steps) along.push_back(d.values(s));
  const VectorXd differences = difference_quotients(d);
  for (Eigen::Index k = 0; k < there.size(); ++k) {
    const std::string where = what + ", objective " + std::to_string(k);
    testing::Rate remainder;
    for (size_t i = 0; i < steps.size(); ++i) {
      remainder.step.push_back(steps[i]);
      remainder.error.push_back(std::abs(along[i][k] - there[k] - steps[i] * d.slopes[k]));
    }
    EXPECT_NEAR(over_three_decades(remainder).order(), 2, 0.05) << where << '\n'
                                                                << remainder.table();
    EXPECT_NEAR(d.slopes[k], differences[k], 1e-6 * d.sizes[k]) << where;
  }
}

class EveryScene : public ::testing::TestWithParam<Shipped> {};

TEST_P(EveryScene, HasTaylorRemaindersOfOrderTwo) {
  Designed scene(GetParam());
  const fem::MotionGradients g = scene.gradients();
  EXPECT_GE(g.motion.events.size(), GetParam().least_changes);
  VectorXd there(static_cast<Eigen::Index>(g.of.size()));
  for (size_t k = 0; k < g.of.size(); ++k) there[static_cast<Eigen::Index>(k)] = g.of[k].value;
  // The seed avoids a case that occurs for about one random direction in sixty: the second
  // derivatives cancel, and the third ones appear.
  std::mt19937 random(7);
  expect_gradient(along_factors(scene, g, random), there, "factors");
  expect_gradient(along_components(scene, g, random), there, "components");
}

/// Returns changes for cells of 25 mm, four across the plate, overlapping components, and a wide
/// band. In this band two more decades of steps show the second order than in the default band.
Changes coarse(const std::string& design, int boxes, Changes more = {}) {
  for (const std::string& each :
       {".components=[" + std::to_string(boxes) + ", 2]", std::string(".half_length=0.03"),
        std::string(".half_thickness=0.012"), std::string(".band=[1.5, 1.0]")})
    more.push_back(design + each);
  return more;
}
Changes both(Changes a, const Changes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const std::string kCells = "design.cell=0.025";

INSTANTIATE_TEST_SUITE_P(
    Shipped, EveryScene,
    ::testing::Values(
        Shipped{"rotating_plate_v01", "rotating_plate_v01",
                coarse("design", 12, {kCells, "esl.every=0.25"}), 0.35, 5e-3, "plate.root", "", 2},
        Shipped{"rotating_plate_v05", "rotating_plate_v05",
                coarse("design", 20, {kCells, "esl.every=0.05"}), 0.15, 2.5e-3, "plate.root", "",
                3},
        Shipped{"four_bar", "four_bar", coarse("design", 8, {kCells}), 0.2, 4e-3, "rocker.root",
                "bearing", 0},
        Shipped{"steady_plate_v01", "rotating_plate_v01",
                coarse("design", 12, {kCells, "esl.every=0.25", "time.start=steady"}), 0.35, 5e-3,
                "plate.root", "", 2},
        Shipped{"steady_plate_v05", "rotating_plate_v05",
                coarse("design", 20, {kCells, "esl.every=0.05", "time.start=steady"}), 0.15, 2.5e-3,
                "plate.root", "", 3},
        Shipped{"steady_four_bar", "four_bar", coarse("design", 8, {kCells, "time.start=steady"}),
                0.2, 4e-3, "rocker.root", "bearing", 0},
        Shipped{"steady_crane", "telescopic_crane",
                coarse("design", 20, {kCells, "time.start=steady"}), 0.5, 1e-2, "arm.root", "load",
                2},
        Shipped{"steady_damped_four_bar", "four_bar",
                coarse("design", 4,
                       {"verify=", "design.cell=0.05", "time.start=steady",
                        "body.terms=[\"inertia\", \"membrane\", \"damping\"]",
                        "body.damping_time=1e-4"}),
                0.05, 5e-3, "rocker.root", "bearing", 0},
        Shipped{"damped_four_bar", "four_bar",
                coarse("design", 4,
                       {"verify=", "design.cell=0.05",
                        "body.terms=[\"inertia\", \"membrane\", \"damping\"]",
                        "body.damping_time=1e-4"}),
                0.05, 5e-3, "rocker.root", "bearing", 0},
        Shipped{"loaded_four_bar", "four_bar",
                coarse("design", 4,
                       {"verify=", "design.cell=0.05", "gravity=[\"f\", -9.81]",
                        "drive=[{name=\"turn\", formula=\"pi/2 + speed*(t - 2*tau + (t "
                        "+ 2*tau)*exp(-t/tau))\"}, {name=\"f\", formula=\"9*cos(30*t)\"}]",
                        "load=[{type=\"point\", body=\"coupler\", point=[0.2, 0.1], "
                        "force=[\"f\", 5.0], turns=true}, {type=\"torque\", "
                        "body=\"shaft\", torque=\"f\"}, {type=\"point\", "
                        "body=\"rocker\", point=[0.2, 0.05], force=[3.0, \"f\"]}]"}),
                0.05, 5e-3, "rocker.root", "bearing", 0},
        // The shaft slides on a curved rail and is held by a bushing. Stops are hit and left within
        // their onsets.
        Shipped{"sprung_four_bar", "four_bar",
                coarse("design", 4,
                       {"verify=", "design.cell=0.05", "time.start=rigid",
                        "joint.shaft_on_ground.type=path", "joint.shaft_on_ground.x=rail_x",
                        "joint.shaft_on_ground.y=rail_y",
                        "drive=[{name=\"turn\", formula=\"pi/2 + speed*(t - 2*tau + (t "
                        "+ 2*tau)*exp(-t/tau))\"}, {name=\"rail_x\", until=1.0, "
                        "formula=\"0.05*(t - 0.5)^2\"}, {name=\"rail_y\", until=1.0, "
                        "formula=\"0.4*(t - 0.5)\"}]",
                        "spring=[{type=\"bushing\", point_a=[0.55, 0.0], angle_a=0.3, b=\"shaft\", "
                        "stiffness=[2e3, 1e4], damping=[5.0, 10.0], torsion_stiffness=2.0, "
                        "torsion_damping=0.02}, {type=\"stop\", a=\"bearing\", b=\"coupler\", "
                        "point_b=[0.3, 0.0], most=-0.1, stiffness=50.0, damping=0.5, onset=0.5}, "
                        "{type=\"distance_stop\", a=\"crank\", b=\"rocker\", point_b=[0.2, "
                        "0.0], least=2.0, stiffness=3.0, onset=1.0}]"}),
                0.05, 5e-3, "rocker.root", "", 0},
        Shipped{"telescopic_crane", "telescopic_crane", coarse("design", 20, {kCells}), 0.5, 1e-2,
                "arm.root", "load", 2},
        Shipped{"motion_platform", "motion_platform",
                both(coarse("design.bar1", 18, {"design.bar1.cells=[35, 4]"}),
                     coarse("design.bar2", 18, {"design.bar2.cells=[35, 4]"})),
                0.1, 2.5e-3, "bar1.root", "platform", 2}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace flexmorph::cases
