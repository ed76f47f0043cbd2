#include "cases/run/modes.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cases/check/ready.h"
#include "cases/output/kept_case.h"
#include "cases/output/page/html.h"
#include "cases/output/page/page.h"
#include "cases/output/surface.h"
#include "cases/results/mode_table.h"
#include "cases/scene/elements/row.h"
#include "io/files.h"
#include "io/json.h"
#include "io/screen.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

/// The drawn surface of a body, from which the displacement of its points follows.
struct Drawn {
  std::string name;
  io::QuadMesh mesh;
};

/// Returns the cells of the plate of a static scene that belong to its domain.
Drawn domain_surface(const PreparedCase& prepared, const fem::State& x) {
  const mmc::BodyProblem& problem = prepared.design_problems().front();
  const Grid& grid = problem.grid;
  Drawn out{prepared.scene().domain->name, {}};
  out.mesh.points.assign(x.q.begin(), x.q.end());
  for (int i = 0; i < grid.nx; ++i)
    for (int j = 0; j < grid.ny; ++j)
      if (problem.outside.empty() || problem.outside[static_cast<size_t>(grid.cell(i, j))] == 0)
        out.mesh.quads.push_back(
            {grid.node(i, j), grid.node(i + 1, j), grid.node(i + 1, j + 1), grid.node(i, j + 1)});
  return out;
}

/// Returns the surfaces of plates, beams and rigid bodies that have a size.
std::vector<Drawn> surfaces(const PreparedCase& prepared, const fem::Model& model,
                            const fem::State& x) {
  const Scene& scene = prepared.scene();
  if (scene.domain) return {domain_surface(prepared, x)};
  std::vector<Drawn> out;
  for (const Body& body : scene.bodies)
    out.push_back(
        {body.name,
         deformed_surface(*body.row, model.body(body.name), x, start_pose(scene, body)).mesh});
  for (const RigidBody& body : scene.rigid_bodies) {
    Drawn drawn{body.name, {}};
    for (const Vec2& corner : drawn_corners(body, model, x))
      drawn.mesh.points.insert(drawn.mesh.points.end(), {corner[0], corner[1]});
    if (drawn.mesh.points.empty()) continue;
    drawn.mesh.quads.push_back({0, 1, 2, 3});
    out.push_back(std::move(drawn));
  }
  return out;
}

/// Returns the displacements of all points of the surfaces for a change of the unknowns. Positions
/// are linear in the unknowns.
std::vector<std::vector<double>> displacements(const PreparedCase& prepared,
                                               const OperatingPoint& point,
                                               const std::vector<Drawn>& at, const VectorXd& dq) {
  fem::State moved = point.x;
  moved.q += dq;
  std::vector<std::vector<double>> out;
  const std::vector<Drawn> to = surfaces(prepared, point.model, moved);
  for (size_t b = 0; b < at.size(); ++b) {
    std::vector<double>& u = out.emplace_back(to[b].mesh.points);
    for (size_t i = 0; i < u.size(); ++i) u[i] -= at[b].mesh.points[i];
  }
  return out;
}

/// Returns the largest absolute value of a list of lists.
double largest_of(const std::vector<std::vector<double>>& all) {
  double out = 0;
  for (const auto& each : all)
    for (const double x : each) out = std::max(out, std::abs(x));
  return out;
}

/// Writes the shapes of all modes. The largest displacement of a shape is a tenth of the size of
/// the drawn mechanism.
void write_shapes(const PreparedCase& prepared, OperatingPoint& point, const ModeTable& table,
                  RunFolder& folder) {
  point.model.prepare(point.x);
  const std::vector<Drawn> at = surfaces(prepared, point.model, point.x);
  if (at.empty()) return;
  double low = 0, high = 0;
  for (const Drawn& drawn : at)
    for (const double x : drawn.mesh.points) low = std::min(low, x), high = std::max(high, x);
  io::Series index(folder.file("modes/modes.pvd"));
  for (size_t k = 0; k < table.found.modes.size(); ++k) {
    const fem::NaturalMode& mode = table.found.modes[k];
    auto real = displacements(prepared, point, at, mode.shape.real());
    auto imaginary = displacements(prepared, point, at, mode.shape.imag());
    const double largest = std::max(largest_of(real), largest_of(imaginary));
    const double scale = largest > 0 ? 0.1 * (high - low) / largest : 0;
    for (auto* part : {&real, &imaginary})
      for (auto& each : *part)
        for (double& u : each) u *= scale;
    for (size_t b = 0; b < at.size(); ++b) {
      const io::QuadMesh& mesh = at[b].mesh;
      const int part = static_cast<int>(b);
      const std::vector<double> number(mesh.quads.size(), part);
      const io::Field cells[] = {{"body", number}};
      std::vector<io::Field> points = {{"shape", real[b], mesh.dimension}};
      if (table.found.is_complex)
        points.push_back({"shape_imaginary", imaginary[b], mesh.dimension});
      const std::string file =
          numbered("mode_" + at[b].name + "_", static_cast<int>(k) + 1, ".vtu");
      io::write_quad_mesh(folder.file("modes/" + file), mesh, cells, points);
      index.add(static_cast<double>(k + 1), file, part);
    }
  }
}

void write_csv(const ModeTable& table, RunFolder& folder) {
  std::vector<std::string> columns = {"mode", "frequency", "damping_ratio", "real", "imaginary"};
  for (const std::string& body : table.bodies) columns.push_back(body + ".kinetic_share");
  io::CsvWriter csv(folder.file("modes.csv"), columns);
  for (size_t k = 0; k < table.found.modes.size(); ++k) {
    const fem::NaturalMode& mode = table.found.modes[k];
    std::vector<io::Cell> row = {static_cast<int>(k) + 1, mode.frequency(), damping_of(mode),
                                 mode.eigenvalue.real(), mode.eigenvalue.imag()};
    for (const double share : mode.kinetic_share) row.emplace_back(share);
    csv.row(row);
  }
}

void write_json(const Scene& scene, const ModeTable& table, RunFolder& folder) {
  nlohmann::ordered_json out;
  out["case"] = scene.name;
  out["status"] = "done";
  if (!scene.domain) out[scene.statics ? "load_factor" : "time"] = table.time;
  out["state"] = table.state;
  out["degrees_of_freedom"] = table.found.degrees_of_freedom;
  out["rigid_modes"] = table.found.n_rigid();
  out["complex"] = table.found.is_complex;
  out["remarks"] = mode_remarks(table);
  out["modes"] = nlohmann::ordered_json::array();
  for (const fem::NaturalMode& mode : table.found.modes) {
    nlohmann::ordered_json each;
    each["frequency"] = mode.frequency();
    each["damping_ratio"] = damping_of(mode);
    each["eigenvalue"] = {mode.eigenvalue.real(), mode.eigenvalue.imag()};
    for (size_t b = 0; b < table.bodies.size(); ++b)
      each["kinetic_share"][table.bodies[b]] = mode.kinetic_share[b];
    out["modes"].push_back(std::move(each));
  }
  folder.write_text("modes.json", io::json_text(out));
}

void write_report(const Scene& scene, const ModeTable& table, const std::string& heading,
                  RunFolder& folder) {
  Page page;
  page.title = scene.title;
  page.status = "done";
  for (const std::string& each : mode_remarks(table)) page.notes.push_back(each + ".");
  page.sections.push_back({"modes", heading, text_table(mode_rows(table))});
  folder.write_text("report.html", page_html(page));
}

std::string directory_of(const ModesOptions& options, const Scene& scene) {
  if (!options.directory.empty()) return options.directory;
  const std::string& set = scene.output.directory;
  return (set.empty() ? "runs/" + scene.name : set) + "_modes";
}

}  // namespace

std::string modes_of_case(const ModesOptions& options) {
  const auto [file, prepared, overrides] =
      ready_case(options.case_name, options.overrides, options.directory);
  const Scene& scene = prepared.scene();
  OperatingPoint point = operating_point(prepared, options.time, options.stopped);
  const ModeTable table = mode_table(scene, options.time, point, options.count);
  const std::string directory = directory_of(options, scene);
  Scene undesigned = scene;  // the folder has no history of a design
  undesigned.designs.clear();
  RunFolder folder(directory, undesigned);
  keep_case(file, false, folder);
  write_csv(table, folder);
  const std::string at = scene.statics ? "load factor " + io::to_text(options.time)
                                       : "t = " + io::to_text(options.time) + " s";
  const std::string heading =
      "Natural modes" + (scene.domain ? "" : " at " + at) + ": " + table.state;
  write_json(scene, table, folder);
  write_report(scene, table, heading, folder);
  if (scene.output.vtk) write_shapes(prepared, point, table, folder);
  folder.finish();
  std::string out = scene.title + "\n" + heading + "\n\n" +
                    io::fitted_table(mode_rows(table), io::screen_width(), "modes.csv");
  out += "\n";
  for (const std::string& each : mode_remarks(table)) out += each + "\n";
  if (!folder.moved_to().empty())
    out += "The earlier run in this folder was moved to " + folder.moved_to() + "\n";
  return out + "Tables and shapes are in " + directory + "\n";
}

}  // namespace flexmorph::cases
