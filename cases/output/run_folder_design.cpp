#include <algorithm>
#include <filesystem>

#include "cases/output/run_folder.h"
#include "cases/results/schema.h"
#include "geometry/parts/outline_curves.h"
#include "io/drawings/exports.h"
#include "io/drawings/step.h"
#include "io/files.h"
#include "io/plots.h"
#include "optim/mmc/cycles/design_verification.h"

/// Members of RunFolder that write tables and pictures of designs and their loads.
namespace flexmorph::cases {
namespace {

/// Tolerance of the picture of the initial layout [cells].
constexpr double kCoarse = 0.05;

Box frame_of(const Grid& g) { return {{g.x0, g.y0}, {g.x0 + g.width, g.y0 + g.height}}; }

/// Adds the location of a support or load to a drawing: a point, a line, a box or a circle.
void add_location(const NodeRegion& location, io::DrawingLayer& out) {
  const Vec2 &a = location.box.lower, &b = location.box.upper;
  if (location.kind == NodeRegion::Kind::disc)
    out.rings.push_back({full_circle(location.disc.center, location.disc.radius)});
  else if (a == b)
    out.shapes.push_back({a});
  else if ((b - a).minCoeff() == 0)
    out.shapes.push_back({a, b});
  else
    out.rings.push_back(lines_of(corners_of(location.box)));
}

/// Returns drawing layers with the domain and, for a static plate, its supports and loads.
std::vector<io::DrawingLayer> drawn_besides(const Scene& scene, const mmc::BodyProblem& problem) {
  io::DrawingLayer domain{"DOMAIN"}, supports{"SUPPORTS"}, loads{"LOADS"};
  const std::vector<Region> region = {mmc::domain_of(problem)};
  for (CurvedRegion& r : curves_of(region, problem.export_tolerance)) {
    domain.rings.push_back(std::move(r.outer));
    for (CurveRing& hole : r.holes) domain.rings.push_back(std::move(hole));
  }
  if (!scene.domain) return {domain};
  for (const PlaneSupport& s : scene.domain->supports) add_location(s.location, supports);
  for (const StaticLoadCase& load : scene.domain->loads)
    for (const PlaneForce& f : load.forces) add_location(f.location, loads);
  return {domain, supports, loads};
}

}  // namespace

std::string components_name(const Scene& scene, const std::string& body) {
  return scene.designs.size() > 1 ? "components_" + body + ".csv" : "components.csv";
}

void RunFolder::write_loads(const std::string& body, const fem::EslSets& loads,
                            const mmc::BodyOutcome* outcome) {
  const std::vector<std::string> columns = {"time",          "root_column",  "weight",
                                            "strain_energy", "energy_ratio", "compliance",
                                            "force_x",       "force_y"};
  const auto known = std::find_if(load_sets_.begin(), load_sets_.end(),
                                  [&](const LoadSets& each) { return each.body == body; });
  LoadSets& kept = known != load_sets_.end() ? *known : load_sets_.emplace_back();
  kept = {body, {}, {}, outcome ? outcome->energy_ratios : std::vector<double>()};
  io::CsvWriter csv(folder_.file("loads/" + body + ".csv"), columns);
  for (size_t i = 0; i < loads.sets.size(); ++i) {
    const fem::EslSet& s = loads.sets[i];
    kept.time.push_back(s.time);
    kept.strain_energy.push_back(s.strain_energy);
    Vec2 force(0, 0);
    for (const fem::NodalForce& f : s.forces) force += f.force;
    io::Cell ratio, compliance;
    if (outcome) {
      ratio = outcome->energy_ratios[i];
      compliance = outcome->load_compliances[i];
    }
    csv.row({s.time, s.root_column, s.weight, s.strain_energy, ratio, compliance, force.x(),
             force.y()});
  }
}

void RunFolder::write_static_loads(const Domain& domain, std::span<const StaticLoad> loads) {
  std::vector<std::string> columns;
  for (const ResultQuantity<StaticLoad>& q : static_load_quantities()) columns.emplace_back(q.name);
  io::CsvWriter csv(folder_.file("loads/" + domain.name + ".csv"), columns);
  for (const StaticLoad& load : loads) {
    std::vector<io::Cell> row;
    for (const ResultQuantity<StaticLoad>& q : static_load_quantities())
      row.emplace_back(text_of(q.value(load)));
    csv.row(row);
  }
}

RunFolder::DesignPictures& RunFolder::pictures_of(const std::string& body) {
  for (DesignPictures& p : pictures_)
    if (p.body == body) return p;
  pictures_.emplace_back().body = body;
  return pictures_.back();
}

void RunFolder::write_start(const mmc::BodyProblem& problem) {
  if (!scene_.output.plots) return;
  std::string& svg = pictures_of(problem.body).start;
  svg = io::outline_svg(
      mmc::regions_of(problem, problem.design.components(), kCoarse * problem.grid.dx()),
      frame_of(problem.grid), 5);
  io::write_file(folder_.file("plots/start_" + problem.body + ".svg"), svg);
}

void RunFolder::write_design(const mmc::BodyProblem& problem, const mmc::BodyOutcome& outcome) {
  writer_.wait();  // pictures are written one at a time
  const std::string stem = scene_.designs.size() > 1 ? "_" + problem.body : "";
  if (!problem.part)
    io::write_components_csv(folder_.file(components_name(scene_, problem.body)),
                             problem.design.components());
  const std::vector<Region> regions = mmc::exported_regions(problem);
  const Box frame = frame_of(problem.grid);
  io::write_file(folder_.file("design" + stem + ".svg"), io::outline_svg(regions, frame));
  const io::LengthUnit& unit = scene_.output.unit;
  const double thickness = problem.section.thickness;
  const std::vector<CurvedRegion> curves = curves_of(regions, problem.export_tolerance);
  io::write_dxf(folder_.file("design" + stem + ".dxf"), curves, unit,
                drawn_besides(scene_, problem));
  io::write_stl(folder_.file("design" + stem + ".stl"), regions, thickness, unit);
  // An outline that touches itself is no valid solid; the other files contain it nevertheless.
  const std::string name = "design" + stem + ".step";
  const std::string why = io::write_step(folder_.file(name), curves, thickness);
  missing_.erase(name);
  if (!why.empty()) {
    missing_[name] = why;
    std::filesystem::remove(folder_.file(name));  // the solid of an earlier design
  }
  if (!scene_.output.plots) return;
  pictures_of(problem.body).result = io::outline_svg(regions, frame, 5);
  pictures_of(problem.body).outline = regions;
  const auto& crisp = outcome.crisp.fractions;
  io::write_png(folder_.file("plots/design" + stem + ".png"), problem.grid,
                {crisp.data(), static_cast<size_t>(crisp.size())});
}

std::string RunFolder::missing_exports() const {
  std::string out;
  for (const auto& [name, why] : missing_)
    out += (out.empty() ? "" : "; ") + name +
           " was not written, because OpenCASCADE cannot make a solid of the outline: " + why;
  return out;
}

void RunFolder::keep_outline(const mmc::BodyProblem& problem, const std::string& name) {
  const std::string stem = scene_.designs.size() > 1 ? "_" + problem.body : "";
  io::write_file(folder_.file(name + stem + ".svg"),
                 io::outline_svg(mmc::exported_regions(problem), frame_of(problem.grid)));
}

void RunFolder::write_cycles(std::span<const mmc::CycleVerdict> cycles,
                             std::span<const mmc::CorrectedCycle> corrected) {
  std::vector<std::string> columns = {"cycle",         "body",    "compliance", "crisp_compliance",
                                      "design_change", "measure", "best"};
  const size_t n = columns.size();
  if (!corrected.empty())
    for (const char* name : {"objective", "kkt", "angle", "radius", "predicted", "actual",
                             "accepted", "motions", "seconds"})
      columns.emplace_back(name);
  io::CsvWriter csv(folder_.file("cycles.csv"), columns);
  for (const mmc::CycleVerdict& c : cycles)
    for (const mmc::BodyVerdict& b : c.bodies) {
      std::vector<io::Cell> row = {c.cycle,         b.body,    b.compliance, b.crisp_compliance,
                                   b.design_change, c.measure, c.best};
      row.resize(columns.size());
      csv.row(row);
    }
  for (const mmc::CorrectedCycle& c : corrected) {
    std::vector<io::Cell> row(n);
    row[0] = c.cycle;
    row[1] = "of the motion";
    for (const io::Cell& cell : {io::Cell(c.value), io::Cell(c.kkt), io::Cell(c.angle),
                                 io::Cell(c.radius), io::Cell(c.predicted), io::Cell(c.actual),
                                 io::Cell(c.accepted), io::Cell(c.motions), io::Cell(c.seconds)})
      row.push_back(cell);
    csv.row(row);
  }
}

}  // namespace flexmorph::cases
