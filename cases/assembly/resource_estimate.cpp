#include "cases/assembly/resource_estimate.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "cases/assembly/build.h"
#include "cases/scene/elements/row.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
constexpr double kBytesPerNumber = 8;

// Measured sizes in bytes, see estimate_resources(): the program with its libraries, a report, a
// number in a table; in a frame for ParaView the header, a point in the plane and a point in space;
// a cell and a component in a frame of a design, and in a frame with all its fields; a cell in its
// exports; a point in a picture of a body in space.
constexpr double kProgram = 56e6, kReport = 5e5, kCsvNumber = 17;
constexpr double kFrame = 1600, kPlanePoint = 19, kSpacePoint = 34;
constexpr double kDesignCell = 4, kDesignComponent = 35, kFieldsCell = 18, kOutlineComponent = 900,
                 kDesignExports = 250, kPicturePoint = 190;
// An entry of a tangent with its indices, in all copies that assembly and solvers keep.
constexpr double kBytesPerEntry = 40;
// A cell of a design: scale factors, topology description function and derivatives.
constexpr double kCell = 1500;
// Number of tangents whose memory a body meshed by cells needs.
constexpr double kCellCopies = 2;
// Number of copies of the load vectors of a design: its loads; and while it is computed also
// forces, displacements and solver work space, in the heat also thermal forces and the expansion at
// held edges.
constexpr double kLoadCopies = 2, kWorkCopies = 7, kHeatedWorkCopies = 18;
// Memory of the verification of the outline of a design by triangles.
constexpr double kOutlineMesh = 3e7;
// Memory of the triangles and size of the files of a part with n components, divided by n and by
// n²: many bars are thin bars, whose triangles are small. Fitted to runs with 48, 160 and 400.
constexpr double kPartMemory[] = {3e5, 2e3}, kPartFiles[] = {2e4, 500};

// A load of a link in design.inp, which contains its forces at all nodes of the part. Measured with
// parts of 11 000 and 15 000 triangles: 1.3 MB and 1.8 MB.
constexpr double kLinkLoad = 1.5e6;

/// Returns a size that grows with the number of components [bytes].
double part_bytes(const double (&of)[2], double n) { return of[0] * n + of[1] * n * n; }

double sum_of(const std::vector<ResourceItem>& shares) {
  double sum = 0;
  for (const ResourceItem& each : shares) sum += each.bytes;
  return sum;
}

/// Returns the numbers of elements along and across a body in a motion, multiplied by `finer`. They
/// include elements that are inserted while material flows in.
std::array<double, 2> elements_of(const Scene& scene, const Body& body, double finer) {
  double along = body.elements[0];
  if (body.flow && !body.has_uniform_mesh()) {
    const double grown = body.longest(scene.time.end) - body.length;
    along += std::max(
        0.0, grown / (body.on_cells() ? body.cell_length() : 0.75 * body.flow->max_length));
  }
  return {finer * along, body.row->across ? finer * body.elements[1] : 0};
}

/// Returns the number of unknowns at a node of a body: position and slopes.
double node_unknowns(const Body& body) {
  const double vectors = !body.row->across ? 2 : body.on_cells() ? 1 : body.shape == "h12" ? 3 : 4;
  return vectors * body.dim();
}

/// Returns the memory of tangent, factorization and element matrices of one moving body [bytes].
double moving_bytes(const Scene& scene, const Body& body, double finer) {
  const std::array<double, 2> n = elements_of(scene, body, finer);
  const double each = node_unknowns(body), rows = (n[0] + 1) * (n[1] + 1) * each;
  const double corners = body.row->across ? 4 : 2, neighbours = body.row->across ? 9 : 3;
  // The fill-in of planar meshes is about proportional to the logarithm of their width.
  const double narrow = std::min(n[0], n[1]) + 1;
  const double fill = neighbours * each * (1 + std::log2(1 + narrow));
  const double elements = n[0] * std::max(1.0, n[1]), size = corners * each;
  return rows * (neighbours * each * kBytesPerEntry + kBytesPerNumber * fill) +
         elements * kBytesPerNumber * size * size;
}

/// Returns the memory of two dense matrices of a body, see fem::thermal_matrices() [bytes].
double thermal_bytes(const Scene& scene, const Body& body) {
  const std::array<double, 2> n = elements_of(scene, body, 1);
  const double vectors = (n[0] + 1) * (n[1] + 1) * node_unknowns(body) / body.dim();
  return 2 * kBytesPerNumber * vectors * vectors;
}

/// Returns the refinement factor of the finest mesh in any motion of the scene.
double finest(const Scene& scene) {
  if (!scene.verify) return 1;
  if (!scene.verify->mesh) return scene.verify->refine;
  double out = 1;
  for (const Body& body : scene.bodies)
    for (const size_t c : {0u, 1u})
      out = std::max(out, double((*scene.verify->mesh)[c]) / body.elements[c]);
  return out;
}

double columns_of(const Scene& scene) {
  double out = 6;
  out += 4.0 * static_cast<double>(scene.bodies.size());
  out += 3.0 * static_cast<double>(scene.rigid_bodies.size() + scene.observed.size());
  for (const Joint& joint : scene.joints) out += joint.named ? 3 : 0;
  for (const MeasureRequest& m : scene.measures)
    out += 2.0 * static_cast<double>(m.quantities.size());
  return out;
}

/// Returns the number of points in pictures and frames of a body without a design.
double drawn_points(const Scene& scene, const Body& body) {
  const std::array<double, 2> n = elements_of(scene, body, 1);
  return (n[0] * body.row->drawn[0] + 1) * (std::max(1.0, n[1]) * body.row->drawn[1] + 1);
}

/// Returns the size of the ParaView files of one snapshot [bytes].
double frame_bytes(const Scene& scene) {
  double out = 0;
  for (const Body& body : scene.bodies) {
    double points = 0;
    for (const BodyDesign& d : scene.designs)
      if (d.body == body.name) points = (d.grid.nx + 1.0) * (d.grid.ny + 1.0);
    if (points == 0) points = drawn_points(scene, body);
    out += kFrame + points * (body.in_space() ? kSpacePoint : kPlanePoint);
  }
  return out + kFrame * static_cast<double>(scene.rigid_bodies.size());
}

void add_course(const Scene& scene, ResourceEstimate& out) {
  const TimeSpan& time = scene.time;
  if (scene.statics) {
    const bool load = scene.statics->path == fem::StaticSettings::Path::load;
    out.steps = load ? scene.statics->steps : scene.statics->max_steps;
    out.step_key = load ? "static.steps" : "static.max_steps";
    return;
  }
  const bool adaptive = time.tolerance.has_value();
  const double longest = time.largest_step > 0 ? time.largest_step : time.end / 50;
  out.steps = std::ceil(time.end / (adaptive ? longest : time.step) - 1e-9);
  out.step_key = adaptive ? "time.largest_step" : "time.step";
  // A step must end at the time of every frame, which can increase the number of steps.
  const bool frames = scene.output.vtk && scene.output.motion_every > 0;
  if (const double n = frames ? time.end / scene.output.motion_every : 0; n > out.steps) {
    out.steps = std::floor(n);
    out.step_key = "output.motion_every";
  }
}

void add_motions(const Scene& scene, ResourceEstimate& out) {
  for (const Body& body : scene.bodies)
    out.memory.push_back({"the mesh of '" + body.name + "'", "body." + body.name + ".elements",
                          moving_bytes(scene, body, 1)});
  for (const Body& body : scene.bodies)
    if (body.heat && body.heat->force)
      out.memory.push_back({"the thermal force of '" + body.name + "'",
                            "body." + body.name + ".elements", thermal_bytes(scene, body)});
  if (scene.verifies_on_cells()) {
    const Scene cells = on_cells(scene, scene.verify->cells);
    double bytes = 0;
    for (const Body& body : cells.bodies) bytes += kCellCopies * moving_bytes(cells, body, 1);
    out.memory.push_back({"the verification mesh", "verify.cells", bytes});
  } else if (const double finer = finest(scene); finer > 1) {
    double bytes = 0;
    for (const Body& body : scene.bodies) bytes += moving_bytes(scene, body, finer);
    out.memory.push_back(
        {"the verification mesh", scene.verify->mesh ? "verify.mesh" : "verify.refine", bytes});
  }
  const double numbers = out.motions * out.steps * columns_of(scene);
  out.memory.push_back({"the table of steps", out.step_key, 2 * kBytesPerNumber * numbers});
  out.disk.push_back({"the table of steps", out.step_key, kCsvNumber * numbers});
  if (scene.in_space() && scene.output.plots)
    out.disk.push_back({"pictures of '" + scene.bodies[0].name + "'",
                        "body." + scene.bodies[0].name + ".elements",
                        kPicturePoint * drawn_points(scene, scene.bodies[0])});
  if (!scene.output.vtk) return;
  const bool path = scene.statics.has_value();
  const double every = scene.output.motion_every;
  out.frames = path ? out.steps : every > 0 ? std::floor(scene.time.end / every) + 1 : 0;
  out.disk.push_back({"frames of the motion", path ? out.step_key : "output.motion_every",
                      out.frames * frame_bytes(scene)});
}

/// Returns the first of the designs with the largest number of cells.
const BodyDesign& largest_design(const Scene& scene) {
  return *std::ranges::max_element(scene.designs, {},
                                   [](const BodyDesign& d) { return 1.0 * d.grid.nx * d.grid.ny; });
}

void add_design(const Scene& scene, const BodyDesign& d, ResourceEstimate& out) {
  const Grid& g = d.grid;
  const std::string path = "design" + (scene.designs.size() > 1 ? "." + d.body : ""),
                    cell = path +
                           (scene.file && scene.file->gives(path + ".cells") ? ".cells" : ".cell");
  const double cells = 1.0 * g.nx * g.ny, n = 2.0 * (g.nx + 1) * (g.ny + 1);
  const std::string name = "the design of '" + d.body + "'";
  // The factorization is banded for moving bodies, and uses nested dissection for static plates.
  const double narrow = std::min(g.nx, g.ny);
  const double factor = scene.domain ? n * 24 * std::log2(1 + narrow) : n * (2.0 * g.ny + 5);
  // Designs that are computed one after the other use the same memory.
  const bool counts = d.shares_mass || &d == &largest_design(scene);
  out.memory.push_back({name, cell, (counts ? kBytesPerNumber * factor : 0) + kCell * cells});
  if (counts)
    out.memory.push_back({"the outline of '" + d.body + "'", cell,
                          kOutlineMesh + part_bytes(kPartMemory, d.n_components())});
  const double copies = kLoadCopies + (!counts            ? 0
                                       : scene.has_heat() ? kHeatedWorkCopies
                                                          : kWorkCopies);
  if (scene.esl)
    out.memory.push_back({"the loads of '" + d.body + "'", "esl.every",
                          kBytesPerNumber * copies * n * scene.esl->count(scene.time.end)});
  const double components = d.n_components();
  out.disk.push_back({"exports of '" + d.body + "'", cell,
                      kDesignExports * cells + part_bytes(kPartFiles, components)});
  if (scene.esl && d.link)
    out.disk.push_back({"the loads of '" + d.body + "'", "esl.every",
                        kLinkLoad * scene.esl->count(scene.time.end)});
  const double every = scene.output.vtk ? scene.output.design_every : 0;
  const double iterations = out.iterations / static_cast<double>(scene.designs.size());
  const double frames = every > 0 ? std::ceil(iterations / every) : 0;
  const double fields_every = std::max(every, 1.0 * scene.output.fields_every);
  const double with_fields =
      every == 0 ? 0 : 1 + (scene.output.fields_every > 0 ? iterations / fields_every : 0);
  out.disk.push_back({"frames of the design of '" + d.body + "'", "optimizer.max_iterations",
                      frames * (kFrame + kDesignCell * cells + kDesignComponent * components) +
                          with_fields * (kFieldsCell * cells + kOutlineComponent * components)});
}

/// Returns the memory that libraries and reserve_blas() have mapped but do not use [bytes]. It
/// counts if the address space is limited.
double unused_mapped() {
  std::ifstream status("/proc/self/statm");
  double mapped = 0, used = 0;
  status >> mapped >> used;
  return (mapped - used) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// Returns the memory limit of the process and of its control group [bytes]; infinite without
/// limits.
double allowed_memory() {
  double out = kUnlimited;
  if (rlimit limit{}; getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
    out = std::max(0.0, static_cast<double>(limit.rlim_cur) - unused_mapped());
  std::ifstream group("/sys/fs/cgroup/memory.max");
  if (double most = 0; group >> most) out = std::min(out, most);  // not a number: no limit
  return out;
}

/// Refuses items whose total exceeds the available amount.
/// @throws Error (input) at the key of the largest item.
void refuse_more(const Scene& scene, const std::vector<ResourceItem>& shares, double there,
                 const std::string& what, const std::string& where) {
  const double bytes = sum_of(shares);
  if (!(bytes > there)) return;
  const ResourceItem& most = *std::ranges::max_element(shares, {}, &ResourceItem::bytes);
  scene.refuse(most.key, "the run needs about " + bytes_text(bytes) + what + ", including " +
                             bytes_text(most.bytes) + " for " + most.what + "; " + where +
                             bytes_text(there));
}

}  // namespace

double ResourceEstimate::memory_bytes() const { return sum_of(memory); }

double ResourceEstimate::disk_bytes() const { return sum_of(disk); }

ResourceEstimate estimate_resources(const Scene& scene) {
  ResourceEstimate out;
  out.memory.push_back({"the program", "title", kProgram});
  out.disk.push_back({"the report", "title", kReport});
  out.iterations = 1.0 * scene.optimizer.max_iterations * static_cast<double>(scene.designs.size());
  if (!scene.domain) out.iterations *= scene.cycle.max_cycles;
  for (const BodyDesign& d : scene.designs)
    out.iterations += 1.0 * (d.starts - 1) * scene.optimizer.max_iterations;
  if (!scene.domain) {
    if (!scene.designs.empty()) out.motions = scene.verify ? 4 : 2;
    add_course(scene, out);
    add_motions(scene, out);
  }
  for (const BodyDesign& d : scene.designs) add_design(scene, d, out);
  return out;
}

Machine this_machine(const std::string& directory) {
  namespace fs = std::filesystem;
  Machine out{kUnlimited, kUnlimited};
  const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
  if (pages > 0 && size > 0) out.memory = static_cast<double>(pages) * static_cast<double>(size);
  out.memory = std::min(out.memory, allowed_memory());
  std::error_code code;
  fs::path folder = fs::absolute(directory.empty() ? "." : directory, code);
  while (!fs::exists(folder, code) && folder.has_relative_path()) folder = folder.parent_path();
  if (const fs::space_info space = fs::space(folder, code); !code && space.capacity > 0)
    out.disk = static_cast<double>(space.available);
  return out;
}

void require_disk(const Scene& scene, const Machine& machine) {
  const ResourceEstimate resource_estimate = estimate_resources(scene);
  if (resource_estimate.steps > kMaxSteps)
    scene.refuse(resource_estimate.step_key,
                 io::to_text(resource_estimate.steps, 3) +
                     " steps are needed; the largest number of steps is " +
                     io::to_text(kMaxSteps, 3));
  refuse_more(scene, resource_estimate.memory, machine.memory, " of memory", "this machine has ");
  refuse_more(scene, resource_estimate.disk, machine.disk, " of disk space",
              "the free disk space is ");
}

std::string out_of_memory_text(const ResourceEstimate& resource_estimate) {
  return "the memory is exhausted: the estimated memory of the run is " +
         bytes_text(resource_estimate.memory_bytes()) +
         " (within a factor of 1.5), and the available memory is " +
         bytes_text(this_machine().memory);
}

std::string bytes_text(double bytes) {
  static const char* const kUnits[] = {"kB", "MB", "GB", "TB", "PB"};
  double size = bytes / 1e3;
  size_t unit = 0;
  for (; size >= 1e3 && unit + 1 < std::size(kUnits); ++unit) size /= 1e3;
  return io::to_text(size, size >= 10 ? 3 : 2) + " " + kUnits[unit];
}

double read_duration(const std::string& option, const std::string& text) {
  double number = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  const std::string unit(rest, end);
  const double factor = unit.empty() || unit == "s" ? 1
                        : unit == "min"             ? 60
                        : unit == "h"               ? 3600
                        : unit == "d"               ? 86400
                                                    : 0;
  if (error != std::errc() || factor == 0 || !(number > 0) || !std::isfinite(number))
    throw Error::input(option + " " + text + ": this is a time such as 120s, 2min, 1.5h or 30d");
  return number * factor;
}

std::string duration_text(double seconds) {
  const auto number = [](double x) {
    return x < 99.5 ? io::to_text(x, 2) : std::to_string(std::lround(x));
  };
  if (seconds < 120) return number(seconds) + " s";
  if (seconds < 7200) return number(seconds / 60) + " min";
  if (seconds < 172800) return number(seconds / 3600) + " h";
  return io::to_text(seconds / 86400, 3) + " days";
}

}  // namespace flexmorph::cases
