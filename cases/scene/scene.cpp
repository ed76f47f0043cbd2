#include "cases/scene/scene.h"

#include <cmath>
#include <filesystem>

#include "cases/scene/elements/row.h"
#include "cases/scene/read.h"
#include "cases/scene/tables.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr int kMaxCount = 1'000'000'000;

const io::Key& kTitle = io::key("", "title")
                            .text("a title")
                            .otherwise_as("name of the case file")
                            .description("Title of the case.");

const io::Key& kDirectory = io::key("output", "directory")
                                .text("a folder")
                                .otherwise("")
                                .description(
                                    "Run folder, to which the run writes its files. Empty: `runs/` "
                                    "and the name of the case.");
const io::Key& kDesignEvery =
    io::key("output", "design_every")
        .integer("a number of iterations", 0, kMaxCount)
        .otherwise(1)
        .description("Number of iterations between two VTK files of the design; 0 writes none.");
const io::Key& kFieldsEvery =
    io::key("output", "fields_every")
        .integer("a number of iterations", 0, kMaxCount)
        .otherwise(25)
        .description(
            "Iterations between VTK files with displacement, energy and outlines; 0: only of the "
            "last one.");
const io::Key& kMotionEvery =
    io::key("output", "motion_every")
        .number(io::not_negative("a time", "s"))
        .otherwise(0.01)
        .description("Time between two VTK files of the motion; 0 writes none.");
const io::Key& kCrispEvery = io::key("output", "crisp_every")
                                 .formerly("sharp_every")
                                 .integer("a number of iterations", 0, kMaxCount)
                                 .otherwise(25)
                                 .description(
                                     "Number of iterations between evaluations of the crisp "
                                     "design; 0: only the final design.");
const io::Key& kVtk = io::key("output", "vtk")
                          .boolean()
                          .otherwise(true)
                          .description("True if the run writes VTK files for ParaView.");
const io::Key& kPlots = io::key("output", "plots")
                            .boolean()
                            .otherwise(true)
                            .description("True if the run draws plots for the report.");
const io::Key& kUnit = io::key("output", "unit")
                           .word("a unit of length", io::length_unit_names())
                           .otherwise("mm")
                           .description(
                               "Unit of length of design.dxf and .stl files. Files .step are in "
                               "mm, all other files in m.");
const io::Key& kTolerance =
    io::key("output", "tolerance")
        .number(io::positive("a tolerance", "m"))
        .otherwise_as("`min_feature` / 200; a hundredth of a cell if `min_feature` is 0")
        .description(
            "Allowed distance of the curves in design.dxf and .step files from the outlines of a "
            "design.");

const io::Key& kExpected =
    io::key("expect", "*")
        .table()
        .renames({{"sharp_compliance", "crisp_compliance"},
                  {"sharp_volume", "crisp_volume"},
                  {"sharp_ratio", "crisp_ratio"},
                  {"energy.error", "energy.error"},
                  {"energy.error.largest", "energy.error.largest"}})
        .description(
            "NAME: final or largest (`.largest`) value of a column, or a number of the design.");
const io::Key& kValue =
    io::key("expect.*", "value")
        .number(io::any_number("an expected value"))
        .otherwise_as("no value, only bounds")
        .description("Expected value; it needs one tolerance, `relative` or `absolute`.");
const io::Key& kRelative =
    io::key("expect.*", "relative")
        .number(io::not_negative("a tolerance"))
        .otherwise_as("with `value`: required unless `absolute` is given")
        .description("Allowed deviation from `value`, as a fraction of `value`.");
const io::Key& kAbsolute =
    io::key("expect.*", "absolute")
        .number(io::not_negative("a tolerance"))
        .otherwise_as("with `value`: required unless `relative` is given")
        .description("Allowed deviation from `value`, in the unit of `value`.");
const io::Key& kAtLeast = io::key("expect.*", "at_least")
                              .number(io::any_number("a bound"))
                              .otherwise_as("no lower bound")
                              .description("Lower bound of the result.");
const io::Key& kAtMost = io::key("expect.*", "at_most")
                             .number(io::any_number("a bound"))
                             .otherwise_as("no upper bound")
                             .description("Upper bound of the result.");

Output read_output(const io::Table& t) {
  Output output;
  output.directory = t.string(kDirectory);
  output.design_every = t.integer(kDesignEvery);
  output.fields_every = t.integer(kFieldsEvery);
  output.motion_every = t.number(kMotionEvery);
  output.crisp_every = t.integer(kCrispEvery);
  output.vtk = t.boolean(kVtk);
  output.plots = t.boolean(kPlots);
  output.unit = *io::find_length_unit(t.choice(kUnit));
  if (t.has(kTolerance)) output.tolerance = t.number(kTolerance);
  return output;
}

/// Checks the tolerance of exported curves. The number of vertices of polygons grows with
/// 1/√tolerance, and curves with an error of more than a cell do not represent the design.
void check_tolerance(const io::Table& t, const Scene& scene) {
  constexpr double kMinCell = 1e-4;  // [cells]
  if (!t.has(kTolerance)) return;
  for (const BodyDesign& design : scene.designs) {
    const double cell = std::min(design.grid.dx(), design.grid.dy());
    if (scene.output.tolerance < kMinCell * cell || scene.output.tolerance > cell)
      t.fail(kTolerance, "a tolerance of exported curves lies between " + io::to_text(kMinCell) +
                             " cells and one cell of each design; the cell of '" + design.body +
                             "' measures " + io::to_text(cell) + " m");
  }
}

Expectation read_expectation(const io::Table& t) {
  Expectation expected;
  expected.location = t.location();
  const auto bound = [&](const io::Key& key) -> std::optional<double> {
    if (!t.has(key)) return {};
    return t.number(key);
  };
  expected.at_least = bound(kAtLeast);
  expected.at_most = bound(kAtMost);
  if (t.has(kValue)) {
    expected.value = t.number(kValue);
    if (t.has(kRelative) == t.has(kAbsolute))
      t.fail("a `value` needs exactly one tolerance, `relative` or `absolute`");
    expected.tolerance =
        t.has(kRelative) ? t.number(kRelative) * std::abs(*expected.value) : t.number(kAbsolute);
  }
  if (!expected.value && !expected.at_least && !expected.at_most)
    t.fail("an expected result needs a `value` with a tolerance, `at_least` or `at_most`");
  return expected;
}

}  // namespace

double export_tolerance(const Scene& scene, const BodyDesign& design) {
  constexpr double kOfFeature = 1.0 / 200, kOfCell = 0.01;
  if (scene.output.tolerance > 0) return scene.output.tolerance;
  return design.widths.solid > 0 ? kOfFeature * design.widths.solid : kOfCell * design.grid.dx();
}

TdfSettings BodyDesign::at_band(size_t index) const {
  TdfSettings settings = tdf;
  settings.band =
      tdf.kind == TdfSettings::Kind::paper ? band.at(index) : band.at(index) * grid.dx();
  return settings;
}

int Esl::count(double end) const { return static_cast<int>(std::floor(end / every + 1e-6)); }

bool Expectation::holds(double found) const {
  // NaN never satisfies an expectation.
  return !std::isnan(found) && (!value || std::abs(found - *value) <= tolerance) &&
         (!at_least || found >= *at_least) && (!at_most || found <= *at_most);
}

fem::TermDomain Body::term_domain() const {
  return in_space() ? fem::TermDomain::space : row->in_plane;
}

double Body::length_at(double time) const {
  if (!flow) return length;
  return flow->motion ? flow->motion(time).value : length + flow->speed * time;
}

double Body::longest(double end) const {
  return flow && flow->motion ? flow->longest : std::max(length, length_at(end));
}

double Body::shortest(double end) const {
  return flow && flow->motion ? flow->shortest : std::min(length, length_at(end));
}

std::vector<double> Body::start_lines(double root, int count) const {
  std::vector<double> out;
  for (int i = 0; i <= count; ++i) out.push_back(root + length * i / count);
  for (const BodyLine& line : lines)
    if (line.at) out[static_cast<size_t>(line.index)] = *line.at;
  return out;
}

bool Scene::has_eulerian_lines() const {
  return std::any_of(bodies.begin(), bodies.end(),
                     [](const Body& b) { return b.has_eulerian_lines(); });
}

bool Scene::has_heat() const {
  return std::any_of(bodies.begin(), bodies.end(),
                     [](const Body& b) { return b.heat.has_value(); });
}

const Body& Scene::body(const std::string& body_name) const {
  for (const Body& each : bodies)
    if (each.name == body_name) return each;
  throw Error::input("there is no body '" + body_name + "' in this scene");
}

void Scene::refuse(const std::string& key_path, const std::string& why) const {
  throw Error::input((file ? file->where(key_path) : key_path) + ": " + why);
}

std::string Verify::words() const {
  if (cells == 1) return "the cells of the designs";
  if (cells > 1)
    return std::to_string(cells) + " x " + std::to_string(cells) +
           " elements per cell of the designs";
  if (!mesh) return std::to_string(refine) + " times the elements in each direction";
  return std::to_string((*mesh)[0]) + " x " + std::to_string((*mesh)[1]) + " elements";
}

fem::Motion Body::length_motion(double t) const {
  if (flow && flow->motion) return flow->motion(t);
  return {length_at(t), flow ? flow->speed : 0, 0};
}

std::function<fem::Motion(double)> Scene::motion_of(const Law& law) const {
  if (law.drive.empty()) return [value = law.value](double) { return fem::Motion{value, 0, 0}; };
  return std::find_if(drives.begin(), drives.end(),
                      [&](const Drive& d) { return d.name == law.drive; })
      ->motion;
}

fem::LoadLaw Scene::load_law(std::span<const Law> laws) const {
  VectorXd constant(static_cast<Eigen::Index>(laws.size()));
  for (size_t c = 0; c < laws.size(); ++c) constant[static_cast<Eigen::Index>(c)] = laws[c].value;
  const auto is_driven = [](const Law& law) { return !law.drive.empty(); };
  if (std::none_of(laws.begin(), laws.end(), is_driven)) return constant;
  std::vector<fem::LoadLaw::Component> out;
  for (const Law& law : laws)
    out.emplace_back([motion = motion_of(law)](double t) { return motion(t).value; });
  return out;
}

bool Scene::follows_trajectory(const Law& law) const {
  return std::any_of(drives.begin(), drives.end(),
                     [&](const Drive& d) { return d.from_trajectory && d.name == law.drive; });
}

bool is_whole(double ratio) {
  return std::abs(ratio - std::round(ratio)) <= 1e-6 * std::max(1.0, std::abs(ratio));
}

std::vector<std::string> overrides_of_files(const io::CaseFile& file) {
  const io::Table root = file.root();
  std::vector<std::string> out = overrides_of_drive_files(root);
  for (std::string& each : overrides_of_start_files(root)) out.push_back(std::move(each));
  for (std::string& each : overrides_of_outline(root)) out.push_back(std::move(each));
  if (!root.has(tables::kAccuracy)) return out;
  for (std::string& each : overrides_of_reference_files(root.table(tables::kAccuracy)))
    out.push_back(std::move(each));
  return out;
}

namespace {

Scene read_parts(const io::CaseFile& file, const Follow& follow) {
  const io::Table root = file.root();
  Scene scene;
  scene.file = file;
  scene.name = std::filesystem::path(file.path()).stem().string();
  scene.title = root.string(kTitle, scene.name);
  read_constants(root);  // numbers of all tables may name them
  if (root.has(tables::kDomain))
    read_static(root, scene);
  else
    read_motion(root, follow, scene);
  const io::Table output = root.table_or_empty(tables::kOutput);
  scene.output = read_output(output);
  read_designs(root, scene);
  check_tolerance(output, scene);
  if (root.has(tables::kAccuracy)) scene.accuracy = read_accuracy(root.table(tables::kAccuracy));
  if (root.has(tables::kExpect)) {
    const io::Table expect = root.table(tables::kExpect);
    for (const std::string& key : expect.keys())
      scene.expect[key] = read_expectation(expect.table(kExpected.named(key)));
  }
  file.finish();
  return scene;
}

}  // namespace

Scene read_scene(const io::CaseFile& file, const Follow& follow) {
  try {
    return read_parts(file, follow);
  } catch (const Error& error) {
    if (error.kind() != Error::Kind::input) throw;
    throw Error::input(file.with_others(error.what()));
  }
}

}  // namespace flexmorph::cases
