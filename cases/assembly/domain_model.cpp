#include "cases/assembly/domain_model.h"

#include "cases/assembly/static_conditions.h"
#include "fem/elements/ancf_plate.h"
#include "fem/terms.h"

namespace flexmorph::cases {
namespace {

/// Scale factors of cells outside of the domain. Their own frequencies are a thousand times those
/// of a cell of the domain.
constexpr double kOutsideStiffness = 1e-6, kOutsideMass = 1e-12;

/// Returns fixed lines at equal distances.
std::vector<fem::MaterialLine> lines(double from, double step, int n) {
  std::vector<fem::MaterialLine> out;
  for (int i = 0; i <= n; ++i) out.push_back({from + i * step, {}, false});
  return out;
}

/// Returns the scale factors of the cells, 1 inside of the domain.
fem::ScaleFactors factors(const Grid& grid, const std::vector<signed char>& outside) {
  fem::ScaleFactors out{grid, VectorXd::Ones(grid.n_cells()), VectorXd::Ones(grid.n_cells())};
  for (size_t cell = 0; cell < outside.size(); ++cell) {
    if (outside[cell] == 0) continue;
    out.stiffness[static_cast<Eigen::Index>(cell)] = kOutsideStiffness;
    out.mass[static_cast<Eigen::Index>(cell)] = kOutsideMass;
  }
  return out;
}

}  // namespace

fem::Workspace domain_model(const PreparedCase& prepared) {
  const Scene& scene = prepared.scene();
  const Domain& domain = *scene.domain;
  if (!(domain.density > 0))
    scene.refuse("domain.density", "natural frequencies need the density of the plate");
  const mmc::BodyProblem& problem = prepared.design_problems().front();
  const Grid& grid = problem.grid;
  const fem::PlaneSection section{domain.thickness, domain.youngs_modulus, domain.poisson_ratio,
                                  domain.density};
  const std::vector<std::string> terms = {"inertia", "membrane"};
  fem::Model model;
  fem::Body& plate =
      model.add_body(domain.name,
                     std::make_unique<fem::AncfPlate>(2, fem::AncfPlate::ShapeSet::q4,
                                                      lines(grid.x0, grid.dx(), grid.nx),
                                                      lines(grid.y0, grid.dy(), grid.ny)),
                     section, fem::make_terms(terms, section, {}));
  if (!problem.outside.empty()) model.set_factors(plate, factors(grid, problem.outside));
  std::vector<fem::Held> held;
  for (const fem::HeldUnknown& each : static_conditions(scene, grid, problem.outside).held)
    held.push_back({fem::HoldLocation::at(
                        grid.node_position(each.node / (grid.ny + 1), each.node % (grid.ny + 1))),
                    fem::NodeVector::r,
                    {each.component},
                    {}});
  if (!held.empty())
    model.add_joint(fem::make_hold(domain.name + ".held", domain.name, std::move(held)));
  return fem::Workspace(std::move(model));
}

}  // namespace flexmorph::cases
