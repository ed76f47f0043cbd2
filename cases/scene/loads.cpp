#include "fem/loads.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

#include "cases/scene/elements/row.h"
#include "cases/scene/joints/reading.h"
#include "cases/scene/tables.h"

namespace flexmorph::cases {
namespace {

using io::any_number;
using io::Table;

using Attached = std::optional<fem::AttachedForce>;

constexpr const char* kOnBodies = "loads on bodies";

const io::Key& force_key(const char* unit, const char* condition, const char* sentence) {
  return io::key("load", "force")
      .numbers_or_names(any_number("a force", unit), "a drive", 2, 3)
      .when(condition)
      .description(sentence);
}

const io::Key& size_key(const char* name, const char* condition, io::Quantity quantity,
                        const char* sentence) {
  return io::key("load", name)
      .number(std::move(quantity))
      .name_of("a drive")
      .when(condition)
      .description(sentence);
}

const LoadRow kPointForce = {
    .name = "point",
    .sentence = "A force at a material point of a plate or beam, or at a point of a rigid body.",
    .words = "force at a point",
    .at_point = true,
    .on_beams = true,
    .key =
        force_key("N", "`type = \"point\"`",
                  "Components of the force along the axes of the world; in space there are three."),
    .make =
        [](const BodyLoad& l, const Body&) {
          return l.turns ? fem::make_turning_point_force(l.point, l.law)
                         : fem::make_point_force(l.point, l.law);
        },
    .on_rigid =
        [](const BodyLoad& l, const std::string& name) {
          return fem::make_point_force(name, {l.body, l.point, 0, {}}, l.law, l.turns);
        },
    .attached = [](const BodyLoad& l, const VectorXd& force, const Body&, double) -> Attached {
      return fem::AttachedForce{l.point, false, force.head<2>(), 0};
    }};

const LoadRow kEdgeForce = {
    .name = "edge",
    .sentence = "A force per length along an edge of a plate.",
    .words = "force along",
    .at_edge = true,
    .key = force_key("N/m", "`type = \"edge\"`",
                     "Components of the force per length along the axes of the world; in space "
                     "there are three."),
    .make =
        [](const BodyLoad& l, const Body&) {
          return l.turns ? fem::make_turning_edge_load(l.edge, l.law)
                         : fem::make_edge_load(l.edge, l.law);
        },
    .attached = [](const BodyLoad& l, const VectorXd& force, const Body& body,
                   double longest) -> Attached {
      if (l.edge != "free_end") return {};
      return fem::AttachedForce{{longest, 0}, true, body.width * force.head<2>(), 0};
    }};

const LoadRow kSurfaceForce = {
    .name = "surface",
    .sentence = "A force per area of a plate.",
    .words = "force per area",
    .key = force_key(
        "N/m^2", "`type = \"surface\"`",
        "Components of the force per area along the axes of the world; in space there are three."),
    .make = [](const BodyLoad& l, const Body&) {
      return l.turns ? fem::make_turning_surface_load(l.law) : fem::make_surface_load(l.law);
    }};

/// The force per length is spread over the height of the beam, so that its resultant is on the
/// axis.
const LoadRow kLineForce = {
    .name = "line",
    .sentence = "A force per length along the whole beam.",
    .words = "force per length",
    .on_plates = false,
    .on_beams = true,
    .key = force_key("N/m", "`type = \"line\"`",
                     "Components of the force per length of the beam along the axes of the world."),
    .make = [](const BodyLoad& l, const Body& beam) {
      const fem::LoadLaw spread = l.law.times(1 / beam.width);
      return l.turns ? fem::make_turning_surface_load(spread) : fem::make_surface_load(spread);
    }};

const LoadRow kTorque = {
    .name = "torque",
    .sentence = "A moment on a rigid body, or on a cross-section of a plate or beam in the plane.",
    .words = "torque",
    .at_point = true,
    .follows = true,
    .in_plane = true,
    .on_beams = true,
    .key = size_key("torque", "`type = \"torque\"`", any_number("a torque", "N m"),
                    "Moment, positive counterclockwise."),
    .make = [](const BodyLoad& l, const Body&) { return fem::make_moment(l.point, l.law); },
    .on_rigid =
        [](const BodyLoad& l, const std::string& name) {
          return fem::make_torque(name, {l.body, {0, 0}, 0, {}}, l.law);
        }};

const LoadRow kPressure = {
    .name = "pressure",
    .sentence = "A pressure normal to the surface of a plate in space.",
    .words = "pressure",
    .follows = true,
    .in_space = true,
    .key = size_key("pressure", "`type = \"pressure\"`", any_number("a pressure", "N/m^2"),
                    "Pressure normal to the surface of the plate; it turns with the plate."),
    .make = [](const BodyLoad& l, const Body&) { return fem::make_pressure(l.law); }};

const LoadRow kEdgeMoment = {
    .name = "edge_moment",
    .sentence = "A moment per length about an edge of a plate in space.",
    .words = "moment at",
    .at_edge = true,
    .follows = true,
    .in_space = true,
    .key = size_key("moment", "`type = \"edge_moment\"`", any_number("a moment per length", "N"),
                    "Moment per length about the edge; it turns with the plate."),
    .make = [](const BodyLoad& l, const Body&) { return fem::make_edge_moment(l.edge, l.law); }};

const io::Key& kType = io::key("load", "type")
                           .word("a load",
                                 [] {
                                   io::Glossary rows;
                                   for (const LoadRow* row : load_rows())
                                     rows.emplace_back(row->name, row->sentence);
                                   return rows;
                                 })
                           .when(kOnBodies)
                           .description("Kind of the load.");
const io::Key& kBody =
    io::key("load", "body").name_of("a body").when(kOnBodies).description("Body that is loaded.");
const io::Key& kPoint =
    io::key("load", "point")
        .numbers(any_number("a material coordinate", "m"), 2, 2)
        .otherwise_as("[0, 0] on a rigid body; required on a plate or beam")
        .when("`type` is \"point\" or \"torque\"")
        .description("Loaded point: a material point, or a location in the axes of a rigid body.");
const io::Key& kTurns =
    io::key("load", "turns")
        .boolean()
        .otherwise(false)
        .when("loads that are forces")
        .description("True if the components of the force refer to axes that turn with the body.");
const io::Key& kEdge = io::key("load", "edge")
                           .text("an edge")
                           .when("`type` is \"edge\" or \"edge_moment\"")
                           .description(
                               "Loaded edge, or a line across the axis of a mesh that does not "
                               "change, such as `line 3`.");

/// Reads the name of the loaded body. Returns true for a rigid body, which only some kinds of loads
/// accept.
bool is_on_rigid_body(const Table& t, const Scene& scene, BodyLoad& load) {
  const std::vector<std::string> rigid = names_of(scene.rigid_bodies);
  if (load.row->on_rigid && t.says_one_of(kBody, rigid)) {
    load.body = t.choice(kBody, rigid);
    return true;
  }
  load.body = read_flexible(t, kBody, scene);
  return false;
}

void check_body(const Table& t, const LoadRow& row, const Body& body) {
  const bool is_beam = !body.row->spreads;
  if (is_beam ? !row.on_beams : !row.on_plates)
    t.fail(kType, is_beam ? "the load of a beam is \"point\", \"line\" or \"torque\""
                          : "this load acts on beams only");
  if (row.in_space && !body.in_space()) t.fail(kType, "this load acts on plates in space only");
  if (row.in_plane && body.in_space()) t.fail(kType, "this load acts on bodies in the plane only");
}

BodyLoad read_load(const Table& t, const Scene& scene) {
  BodyLoad load;
  const std::string type = t.choice(kType);
  load.row = *std::find_if(load_rows().begin(), load_rows().end(),
                           [&](const LoadRow* row) { return row->name == type; });
  const LoadRow& row = *load.row;
  int dim = 2;
  if (is_on_rigid_body(t, scene, load)) {
    load.point = t.has(kPoint) ? read_pair(t, kPoint) : Vec2(0, 0);
    if (row.follows && t.has(kPoint)) t.fail(kPoint, "a torque on a rigid body has no `point`");
  } else {
    const Body& body = scene.body(load.body);
    dim = body.dim();
    if (row.at_point) load.point = read_point(t, kPoint, body, scene.time.end);
    if (row.at_edge) load.edge = read_edge(t, kEdge, body, edge_names());
    check_body(t, row, body);
  }
  if (row.follows) {
    const std::vector<Law> law = {read_load_law(t, row.key, scene)};
    load.law = scene.load_law(law);
    load.size = load.law.now()[0];
  } else {
    load.law = scene.load_law(read_load_laws(t, row.key.counted(dim), scene));
    load.force = load.law.now();
    load.turns = t.boolean(kTurns);
  }
  if ((row.follows || load.turns) && scene.time.integrator == "energy_momentum")
    t.fail(kType, "a load that turns with the body needs time.integrator = \"generalized_alpha\"");
  return load;
}

}  // namespace

std::span<const LoadRow* const> load_rows() {
  static const std::array kRows = {&kPointForce, &kEdgeForce, &kSurfaceForce, &kLineForce,
                                   &kTorque,     &kPressure,  &kEdgeMoment};
  return kRows;
}

std::optional<fem::AttachedForce> attached_force(const BodyLoad& load, const Scene& scene,
                                                 double t) {
  const Body& body = scene.body(load.body);
  if (!load.row->attached || load.turns) return {};
  return load.row->attached(load, load.law.at(t), body, body.longest(scene.time.end));
}

std::vector<size_t> ordered_loads(const Scene& scene) {
  const auto key = [&](size_t i) {
    const BodyLoad& l = scene.loads[i];
    std::vector<double> numbers = {l.point.x(), l.point.y(), l.size, l.turns ? 1.0 : 0.0};
    numbers.insert(numbers.end(), l.force.begin(), l.force.end());
    return std::tuple(l.body, std::string(l.row->name), l.edge, std::move(numbers));
  };
  std::vector<size_t> out(scene.loads.size());
  std::iota(out.begin(), out.end(), size_t{0});
  std::ranges::stable_sort(out, {}, key);
  return out;
}

void read_loads(const Table& root, Scene& scene) {
  for (const Table& t : root.tables(tables::kLoad)) scene.loads.push_back(read_load(t, scene));
}

}  // namespace flexmorph::cases
