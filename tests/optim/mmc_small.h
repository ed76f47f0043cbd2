#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "optim/mmc/cycles/esl_loop.h"
#include "optim/mmc/loads/compliance_evaluator.h"
#include "tests/support/disturbance.h"

/// A plate that is small enough for tests: 60 x 10 cells, 24 components, a few loads.
namespace flexmorph::mmc::test {

inline const Grid kGrid{.x0 = 0, .y0 = -0.05, .width = 0.6, .height = 0.1, .nx = 60, .ny = 10};
inline const fem::PlaneSection kSection{0.01, 1e8, 0.3, 2700};
inline const DesignScale kScale{.half_length = 0.05, .min_thickness = 0.006, .max_thickness = 0.03};

inline const Plate kPlate{kGrid, kSection, {}};

/// Returns the goal of the stiffest plate of a volume, by the sum or by the worst of its loads.
inline Goal least_compliance(double max_volume = 0.5, const ResponseRow& row = kComplianceSum) {
  return {&row, {Limit(kVolume, max_volume, false, kPlate)}};
}
/// Returns the goal of the lightest plate that is stiff enough.
inline Goal least_volume(double max_compliance, const ResponseRow& row = kComplianceSum) {
  return {&kVolume, {Limit(row, max_compliance, false, kPlate)}};
}

inline TdfSettings tdf_settings(double band_in_cells = 1.5) {
  TdfSettings s;
  s.band = band_in_cells * kGrid.dx();
  s.sharpness = 3.75 / kGrid.dx();
  s.erosion = 0.5 * kGrid.dx();
  s.min_half_thickness = kScale.min_thickness;
  return s;
}

/// Two columns of solid cells under the mass at the free end.
inline std::vector<std::vector<Vec2>> strip() { return {corners_of({{0.58, -0.05}, {0.6, 0.05}})}; }

/// Returns 12 x 1 boxes of two crossing components.
inline std::vector<Component> layout(double half_thickness = 0.008) {
  return crossing_layout(kGrid.x0, kGrid.y0, kGrid.width, kGrid.height, 12, 1,
                         testing::disturbed(half_thickness), kScale.half_length);
}

/// Returns the layout with every parameter changed at random by up to `amount` of its unit: 10 mm
/// for positions and lengths, 0.3 rad for angles, 3 mm for half-thicknesses.
inline std::vector<Component> random_layout(unsigned seed, double amount = 1) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-amount, amount);
  std::vector<Component> all = layout(0.01);
  for (Component& c : all) {
    const double x = uniform(engine), y = uniform(engine);
    c.center += 0.01 * Vec2(x, y);
    c.half_length += 0.01 * uniform(engine);
    c.angle += 0.3 * uniform(engine);
    for (double* thickness : {&c.c1, &c.c2, &c.c3}) *thickness += 0.003 * uniform(engine);
  }
  return all;
}

/// Returns a component from tip to tip.
inline Component bar(const Vec2& from, const Vec2& to, double half_thickness) {
  const Vec2 along = to - from;
  return {0.5 * (from + to), 0.5 * along.norm(), std::atan2(along.y(), along.x()),
          half_thickness,    half_thickness,     half_thickness};
}

/// Returns the plate held at its left edge with a unit force upwards at the middle of the right
/// edge.
inline ComplianceEvaluator tip_load() {
  std::vector<fem::HeldUnknown> held;
  for (int j = 0; j <= kGrid.ny; ++j)
    for (int c = 0; c < 2; ++c) held.push_back({kGrid.node(0, j), c});
  const std::vector<LoadCase> loads = {{"tip", 1, {{kGrid.node(60, 5), Vec2(0, 1)}}}};
  return {{kGrid, kSection, {}}, held, loads, false};
}

/// Returns the small plate with a solid strip as a design problem.
inline BodyProblem body_of(const Design& design, const std::vector<TdfSettings>& bands,
                           const Goal& goal = least_compliance()) {
  return {.body = "plate",
          .grid = kGrid,
          .section = kSection,
          .design = design,
          .solid = strip(),
          .bands = bands,
          .goal = goal};
}

/// Returns the change of the variables if everything moves by one cell (angles: the end of a
/// component moves by one cell).
inline VectorXd cells_of(const Design& design) {
  VectorXd scale = VectorXd::Ones(design.n_variables()), out(design.n_variables());
  design.scale_gradient(scale);
  for (Eigen::Index i = 0; i < out.size(); ++i)
    out[i] = kGrid.dx() / scale[i] / (i % Component::kParameters == 3 ? kScale.half_length : 1.0);
  return out;
}

/// Returns, of a few random directions of at most `unit`, the one with the largest second
/// derivative of f: along some directions the second derivatives of many nodes nearly cancel, and
/// the third order would dominate. Variables beyond those of `unit` (the bound of a worst case) are
/// not changed.
inline VectorXd bent_direction(const std::function<double(const VectorXd&)>& f, const VectorXd& x,
                               const VectorXd& unit, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  VectorXd best;
  double most = -1;
  for (int k = 0; k < 4; ++k) {
    VectorXd d(x.size());
    for (Eigen::Index i = 0; i < d.size(); ++i)
      d[i] = i < unit.size() ? unit[i] * uniform(engine) : 0;
    const double bend = std::abs(f(x + 1e-3 * d) + f(x - 1e-3 * d) - 2 * f(x));
    if (bend > most) most = bend, best = d;
  }
  return best;
}

/// Returns loads of a plate that rotates, grows out of its hub by n - 1 cells and swings:
/// accelerations of the rotating frame and of bending, a mass of 0.5 kg at the tip. The deformation
/// (from which `stiffness` loads are made) is smooth and zero at the root; it is not the static
/// solution for these accelerations.
inline fem::EslSets turning_plate(int n, double swing = 1) {
  const double omega = 2 * std::numbers::pi, speed = 0.5;
  fem::EslSets loads{kGrid, {}};
  for (int k = 0; k < n; ++k) {
    fem::EslSet set;
    set.time = 0.1 * (k + 1);
    set.weight = (1 + 0.5 * k) / n;
    set.root_column = n - 1 - k;
    set.strain_energy = 1;
    set.deformation.setZero(2 * kGrid.n_nodes());
    set.acceleration.resize(2 * kGrid.n_nodes());
    for (int i = 0; i <= kGrid.nx; ++i) {
      for (int j = 0; j <= kGrid.ny; ++j) {
        const Eigen::Index entry = 2 * kGrid.node(i, j);
        const Vec2 X = kGrid.node_position(i, j);
        const double x = X.x() - kGrid.dx() * set.root_column, s = x / kGrid.width;
        const double bend = swing * 60 * std::cos(25 * set.time) * s * s;
        set.acceleration.segment<2>(entry) =
            Vec2(-omega * omega * x, 2 * omega * speed - omega * omega * X.y() + bend);
        if (i > set.root_column) {
          set.deformation.segment<2>(entry) =
              1e-3 * Vec2(s * (1 + std::sin(3 * k + 9 * s)) - 20 * s * X.y(),
                          s * s * (2 + std::cos(4 * k + 7 * s)));
        }
      }
    }
    const int tip = kGrid.node(kGrid.nx, kGrid.ny / 2);
    set.forces.push_back({tip, -0.5 * set.acceleration.segment<2>(2 * tip)});
    loads.sets.push_back(std::move(set));
  }
  return loads;
}

}  // namespace flexmorph::mmc::test
