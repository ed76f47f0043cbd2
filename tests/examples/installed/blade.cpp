// A blade with cords turns with a hub: how much longer it gets, beside a rod.
// Then it is designed to be stiff with half of its first moment. Fails where either is wrong.
#include <cmath>
#include <cstdio>

#include "fem/dynamics/mesh_changes/growth.h"
#include "fem/elements/ancf_plate.h"
#include "fem/solve/statics.h"
#include "optim/mmc/loads/compliance_evaluator.h"
#include "optim/mmc/problem/mmc_problem.h"
#include "parts.h"

using namespace flexmorph;

const fem::PlaneSection section{0.01, 1e8, 0, 2700};  // thickness, E, Poisson ratio, density
const double length = 0.6, width = 0.1, cords = 5e5, omega = 0.1;

/// At low speed u = ρ h ω² L³ / 3 (E h + k), to the first order in the strain.
bool turns_like_a_rod() {
  std::vector<std::unique_ptr<fem::Term>> terms;
  terms.push_back(fem::make_inertia(section));
  terms.push_back(fem::make_membrane(section));
  terms.push_back(fem::cords_row().make({section, {{"cord_stiffness", cords}}, {}}));
  fem::Workspace model;
  const std::vector<fem::MaterialLine> m{{0, {}}, {0.2, {}}, {0.4, {}}, {length, {}}};
  const std::vector<fem::MaterialLine> n{{-width / 2, {}}, {width / 2, {}}};
  model.add_body("blade", std::make_unique<fem::AncfPlate>(2, fem::AncfPlate::ShapeSet::h16, m, n),
                 section, std::move(terms));
  const auto hub = [](double) { return fem::FrameMotion{}; };
  model.add_joint(fem::make_weld("hub", "blade", "root", hub, fem::WeldMode::edge));
  fem::State x = model.reference();
  const VectorXd spin = VectorXd::Constant(model.n_dofs(), omega * omega);
  fem::solve_rotating_equilibrium(model, spin, VectorXd::Zero(model.n_dofs()), x);
  const double u = fem::point_motion(model.body("blade"), x, {length, 0}).position.x() - length;
  const double h = section.thickness, stiffness = section.youngs_modulus * h + cords;
  const double u_rod = section.density * h * omega * omega * std::pow(length, 3) / 3 / stiffness;
  std::printf("longer by %.4e m, a rod by %.4e m\n", u, u_rod);
  return std::abs(u / u_rod - 1) < 1e-3;
}

bool gets_stiffer() {
  const Grid grid{.x0 = 0, .y0 = -width / 2, .width = length, .height = width, .nx = 60, .ny = 10};
  const mmc::Plate plate{grid, section, {}};
  std::vector<fem::HeldUnknown> held;
  for (int i = 0; i <= 2 * grid.ny + 1; ++i) held.push_back({grid.node(0, i / 2), i % 2});
  const std::vector<mmc::LoadCase> tip{{"tip", 1, {{grid.node(grid.nx, grid.ny / 2), {0, 1}}}}};
  mmc::ComplianceEvaluator loads({grid, section, {}}, held, tip, false);
  const auto start = crossing_layout(0, -width / 2, length, width, 6, 1, 0.01, 0.06);
  const mmc::Design design(grid, start, {});
  const mmc::Ersatz ersatz(grid, 1e-3, {}, {});
  const double bound = 0.25 * plate.full_mass() * length;  // half of a full blade's
  const mmc::Goal goal{&mmc::kComplianceSum, {{mmc::kFirstMoment, bound, false, plate}}};
  mmc::MmcProblem problem({plate, design, ersatz, loads}, {.band = 0.015, .sharpness = 375}, goal);
  const double before = problem.evaluate(problem.start()).f;
  const auto best = optim::make_steepest_descent({.max_iterations = 40})->minimize(problem, {});
  std::printf("log of compliance %.4f, was %.4f\n", best.response.f, before);
  return best.response.f < before && best.response.g[0] < 1e-2;
}

int main() { return turns_like_a_rod() && gets_stiffer() ? 0 : 1; }
