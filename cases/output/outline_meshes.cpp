#include "cases/output/outline_meshes.h"

#include "io/drawings/mesh_exports.h"

namespace flexmorph::cases {
namespace {

/// Writes displacement and stress under the worst load to a VTK file.
void write_fields(const std::string& path, const verification::OutlineVerification& j) {
  const std::vector<double> mises = mises_of(j);
  std::vector<double> piece(j.mesh.piece.begin(), j.mesh.piece.end());
  const auto view = [](const auto& values) {
    return std::span<const double>(values.data(), static_cast<std::size_t>(values.size()));
  };
  const io::Field cells[] = {{"piece", piece}};
  const io::Field points[] = {{"displacement", view(j.displacement), 2},
                              {"von_mises", mises},
                              {"stress_xx_yy_xy", view(j.stress), 3}};
  io::write_part_mesh(path, j.mesh, cells, points);
}

}  // namespace

void write_outline_meshes(const Scene& scene, const mmc::BodyProblem& problem,
                          std::span<const Region> regions,
                          const verification::OutlineVerification& j, RunFolder& folder) {
  const std::string stem = "design" + (scene.designs.size() > 1 ? "_" + problem.body : "");
  io::PlateModel model{j.mesh,
                       j.omitted_triangles,
                       problem.section.thickness,
                       problem.section.youngs_modulus,
                       problem.section.poisson_ratio,
                       {}};
  for (const verification::MeshLoad& c : j.mesh_loads) {
    io::MeshLoad& load = model.loads.emplace_back();
    load.name = c.name;
    for (std::size_t k = 0; k < c.held.size(); ++k)
      load.held.push_back({c.held[k].node, c.held[k].component, c.prescribed[k]});
    for (const fem::NodalForce& f : c.forces) load.forces.push_back({f.node, f.force});
  }
  if (!model.loads.empty()) io::write_inp(folder.file(stem + ".inp"), model);
  io::write_msh(folder.file(stem + ".msh"), j.mesh);
  if (scene.output.vtk && j.displacement.size() > 0) write_fields(folder.file(stem + ".vtu"), j);
  io::write_geo(folder.file(stem + ".geo"), regions, problem.grid.dx());
}

}  // namespace flexmorph::cases
