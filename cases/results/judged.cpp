#include "cases/results/judged.h"

#include <algorithm>
#include <cmath>

#include "cases/assembly/verified_loads.h"
#include "cases/output/plots/stress.h"
#include "geometry/cpu_time.h"
#include "io/files.h"
#include "io/mesh_exports.h"

namespace flexmorph::cases {
namespace {

/// Displacement and stress of the worst load.
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

/// The last mesh of the judge with what it carries.
void write_meshes(const Scene& scene, const mmc::BodyProblem& problem,
                  std::span<const Region> regions, const verification::OutlineVerification& j,
                  RunFolder& folder) {
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

/// Round-off and the outline's own tolerance: not below by more than 1 %.
constexpr double kWithin = 0.99;

void find_narrow(const mmc::BodyProblem& problem, std::span<const Region> regions,
                 JudgedBody& out) {
  out.cell = std::min(problem.grid.dx(), problem.grid.dy());
  out.thickness = problem.widths.solid > 0 ? problem.widths.solid
                                           : 2 * problem.stages.back().min_half_thickness;
  // Discs side by side are one place: the narrowest stands for them.
  for (const NarrowPlace& p :
       mmc::narrow_places_of(problem, regions, kWithin * std::max(out.cell, out.thickness))) {
    const double wanted = p.solid ? out.thickness : out.cell;
    const bool known = std::any_of(out.narrow.begin(), out.narrow.end(), [&](const NarrowPlace& q) {
      return q.solid == p.solid && (q.center - p.center).norm() < 2 * wanted;
    });
    if (!known && p.width < kWithin * wanted) out.narrow.push_back(p);
  }
}

}  // namespace

std::vector<std::string> narrow_words(const JudgedBody& judged) {
  constexpr int kNamed = 4;
  std::vector<std::string> out;
  for (const bool solid : {true, false}) {
    std::string places;
    int n = 0;
    for (const NarrowPlace& p : judged.narrow) {
      if (p.solid != solid || ++n > kNamed) continue;
      places += (n == 1 ? ": " : ", ") + io::to_text(p.width, 3) + " m at (" +
                io::to_text(p.center.x(), 4) + ", " + io::to_text(p.center.y(), 4) + ")";
    }
    if (n == 0) continue;
    const std::string which = n == 1 ? "one " : std::to_string(n) + " ";
    const std::string what =
        solid ? (n == 1 ? "place is" : "places are") +
                    std::string(" narrower than twice design.min_thickness, ") +
                    io::to_text(judged.thickness, 3)
              : (n == 1 ? "gap is" : "gaps are") + std::string(" narrower than a cell, ") +
                    io::to_text(judged.cell, 3);
    out.push_back("body '" + judged.body + "', its outline: " + which + what + " m" + places +
                  (n > kNamed ? ", ..." : ""));
  }
  return out;
}

JudgedBody judge_body(const Scene& scene, const mmc::BodyProblem& problem,
                      const fem::EslSets* loads, const std::function<bool()>& go_on,
                      RunFolder& folder) {
  JudgedBody out;
  out.body = problem.body;
  const double clock = thread_seconds();
  try {
    const std::vector<Region> regions = mmc::exported_regions(problem);
    find_narrow(problem, regions, out);
    if (loads != nullptr) out.why_not = mmc::reason_not_verifiable(problem);
    if (!out.why_not.empty()) return out;
    const verification::Loads by_position = loads != nullptr
                                                ? mmc::loads_by_position(problem, *loads)
                                                : loads_by_position(scene, problem);
    const Grid& g = problem.grid;
    out.volume = area(regions) / (mmc::plate_of(problem).n_domain_cells() * g.dx() * g.dy());
    out.verdict = mmc::verify_design(problem, regions, by_position, go_on);
    write_meshes(scene, problem, regions, *out.verdict, folder);
  } catch (const Error& error) {
    out.verdict.reset();
    out.why_not = error.what();
  }
  out.seconds = thread_seconds() - clock;
  return out;
}

std::string judged_words(const JudgedBody& judged, double sharp_compliance) {
  const std::string head = judged.body + ": ";
  if (!judged.verdict) return head + "no body-fitted compliance: " + judged.why_not;
  const verification::OutlineVerification& j = *judged.verdict;
  if (!std::isfinite(j.compliance))
    return head + "body-fitted compliance infinite: load '" + j.unsupported_load +
           "' acts on nothing that is held";
  const double apart = 100 * (sharp_compliance / j.compliance - 1);
  std::string out =
      head + "body-fitted compliance " + io::to_text(j.compliance, 5) + " (error about " +
      io::to_text(100 * j.error, 2) + " %) at volume " + io::to_text(judged.volume, 4) +
      "; its cells say " + io::to_text(sharp_compliance, 5) + ", " +
      io::to_text(std::abs(apart), 2) + (apart < 0 ? " % less" : " % more") + "; largest stress " +
      io::to_text(j.largest_stress, 4) + " Pa at (" + io::to_text(j.largest_at.x(), 4) + ", " +
      io::to_text(j.largest_at.y(), 4) + ") m";
  if (j.mesh_loads.empty()) out += "; springs hold its far edge, so there is no design.inp";
  if (j.n_omitted_pieces > 0)
    out += "; " + std::to_string(j.n_omitted_pieces) + " of " + std::to_string(j.n_pieces) +
           " pieces are held by nothing";
  return out;
}

}  // namespace flexmorph::cases
