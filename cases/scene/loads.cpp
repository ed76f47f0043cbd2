#include "fem/loads.h"

#include <algorithm>
#include <array>

#include "cases/scene/elements/row.h"
#include "cases/scene/joints/reading.h"
#include "cases/scene/tables.h"

namespace flexmorph::cases {
namespace {

using io::any_number;
using io::Table;

using Attached = std::optional<fem::AttachedForce>;

constexpr const char* kOnBodies = "on bodies";

const io::Key& force_key(const char* unit, const char* condition) {
  return io::key("load", "force")
      .numbers_or_names(any_number("a force", unit), "a drive", 2, 3)
      .when(condition)
      .says("Along the axes of the world; three entries in space.");
}

const io::Key& size_key(const char* name, const char* condition, io::Quantity quantity,
                        const char* sentence) {
  return io::key("load", name)
      .number(std::move(quantity))
      .name_of("a drive")
      .when(condition)
      .says(sentence);
}

constexpr const char* kWithPlate = "Turns with the plate, in space.";

const LoadRow kPointForce = {
    .name = "point",
    .sentence = "A force at a material point, or at a point of a rigid body.",
    .words = "force at a point",
    .at_point = true,
    .on_beams = true,
    .key = force_key("N", "point"),
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
    .sentence = "A force per length along an edge.",
    .words = "force along",
    .at_edge = true,
    .key = force_key("N/m", "edge"),
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

const LoadRow kSurfaceForce = {.name = "surface",
                               .sentence = "A force per area.",
                               .words = "force per area",
                               .key = force_key("N/m^2", "surface"),
                               .make = [](const BodyLoad& l, const Body&) {
                                 return l.turns ? fem::make_turning_surface_load(l.law)
                                                : fem::make_surface_load(l.law);
                               }};

/// The force per length is spread over the height of the beam, so that its resultant is on the
/// axis.
const LoadRow kLineForce = {.name = "line",
                            .sentence = "A force per length along all of a beam.",
                            .words = "force per length",
                            .on_plates = false,
                            .on_beams = true,
                            .key = force_key("N/m", "line"),
                            .make = [](const BodyLoad& l, const Body& beam) {
                              const fem::LoadLaw spread = l.law.times(1 / beam.width);
                              return l.turns ? fem::make_turning_surface_load(spread)
                                             : fem::make_surface_load(spread);
                            }};

const LoadRow kTorque = {
    .name = "torque",
    .sentence = "A moment on a rigid body, or on the line across a body in the plane.",
    .words = "torque",
    .at_point = true,
    .follows = true,
    .in_plane = true,
    .on_beams = true,
    .key = size_key("torque", "torque", any_number("a torque", "N m"), "Counter-clockwise."),
    .make = [](const BodyLoad& l, const Body&) { return fem::make_moment(l.point, l.law); },
    .on_rigid =
        [](const BodyLoad& l, const std::string& name) {
          return fem::make_torque(name, {l.body, {0, 0}, 0, {}}, l.law);
        }};

const LoadRow kPressure = {
    .name = "pressure",
    .sentence = "A pressure across the surface of a plate in space.",
    .words = "pressure",
    .follows = true,
    .in_space = true,
    .key = size_key("pressure", "pressure", any_number("a pressure", "N/m^2"), kWithPlate),
    .make = [](const BodyLoad& l, const Body&) { return fem::make_pressure(l.law); }};

const LoadRow kEdgeMoment = {
    .name = "edge_moment",
    .sentence = "A moment per length of an edge of a plate in space, about the edge.",
    .words = "moment at",
    .at_edge = true,
    .follows = true,
    .in_space = true,
    .key = size_key("moment", "moment", any_number("a moment per length", "N"), kWithPlate),
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
                           .says("Its kind.");
const io::Key& kBody =
    io::key("load", "body").name_of("a body").when(kOnBodies).says("The loaded body.");
const io::Key& kPoint =
    io::key("load", "point")
        .numbers(any_number("a material coordinate", "m"), 2, 2)
        .otherwise_as("[0, 0] of a rigid body")
        .when("point, torque")
        .says("Where: a material point, or a place in the axes of a rigid body.");
const io::Key& kTurns = io::key("load", "turns")
                            .boolean()
                            .otherwise(false)
                            .when("forces")
                            .says("Its entries are along axes that turn with the body.");
const io::Key& kEdge = io::key("load", "edge")
                           .text("an edge")
                           .when("edge, edge_moment")
                           .says("An edge, or an m-line of a mesh that stays: `line 3`.");

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
    t.fail(kType, is_beam ? "a beam is loaded by \"point\", \"line\" or \"torque\""
                          : "this load acts on a beam");
  if (row.in_space && !body.in_space()) t.fail(kType, "this load acts on a plate in space");
  if (row.in_plane && body.in_space()) t.fail(kType, "this load acts in the plane");
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
    if (row.follows && t.has(kPoint)) t.fail(kPoint, "a torque turns all of a rigid body");
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
    t.fail(kType, "a load that follows the body needs integrator = \"generalized_alpha\"");
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

void read_loads(const Table& root, Scene& scene) {
  for (const Table& t : root.tables(tables::kLoad)) scene.loads.push_back(read_load(t, scene));
}

}  // namespace flexmorph::cases
