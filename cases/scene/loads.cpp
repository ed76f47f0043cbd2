#include "fem/loads.h"

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
      .numbers(any_number("a force", unit), 2, 3)
      .when(condition)
      .says("Constant in the world; three entries in space.");
}

const io::Key& size_key(const char* name, io::Quantity quantity) {
  return io::key("load", name)
      .number(std::move(quantity))
      .when(name)
      .says("Turns with the plate, in space.");
}

const LoadRow kPointForce = {
    .name = "point",
    .sentence = "A force at a material point.",
    .words = "force at a point",
    .at_point = true,
    .at_edge = false,
    .follows = false,
    .key = force_key("N", "point"),
    .make = [](const BodyLoad& l) { return fem::make_point_force(l.point, l.force); },
    .attached = [](const BodyLoad& l, const Body&, double) -> Attached {
      return fem::AttachedForce{l.point, false, l.force.head<2>(), 0};
    }};

const LoadRow kEdgeForce = {
    .name = "edge",
    .sentence = "A force per length along an edge.",
    .words = "force along",
    .at_point = false,
    .at_edge = true,
    .follows = false,
    .key = force_key("N/m", "edge"),
    .make = [](const BodyLoad& l) { return fem::make_edge_load(l.edge, l.force); },
    .attached = [](const BodyLoad& l, const Body& body, double longest) -> Attached {
      if (l.edge != "free_end") return {};
      return fem::AttachedForce{{longest, 0}, true, body.width * l.force.head<2>(), 0};
    }};

const LoadRow kSurfaceForce = {
    .name = "surface",
    .sentence = "A force per area.",
    .words = "force per area",
    .at_point = false,
    .at_edge = false,
    .follows = false,
    .key = force_key("N/m^2", "surface"),
    .make = [](const BodyLoad& l) { return fem::make_surface_load(l.force); }};

const LoadRow kPressure = {.name = "pressure",
                           .sentence = "A pressure across the surface of a plate in space.",
                           .words = "pressure",
                           .at_point = false,
                           .at_edge = false,
                           .follows = true,
                           .key = size_key("pressure", any_number("a pressure", "N/m^2")),
                           .make = [](const BodyLoad& l) { return fem::make_pressure(l.size); }};

const LoadRow kEdgeMoment = {
    .name = "edge_moment",
    .sentence = "A moment per length of an edge of a plate in space, about the edge.",
    .words = "moment at",
    .at_point = false,
    .at_edge = true,
    .follows = true,
    .key = size_key("moment", any_number("a moment per length", "N")),
    .make = [](const BodyLoad& l) { return fem::make_edge_moment(l.edge, l.size); }};

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
const io::Key& kPoint = io::key("load", "point")
                            .numbers(any_number("a material coordinate", "m"), 2, 2)
                            .when("point")
                            .says("The material point that it acts at.");
const io::Key& kEdge = io::key("load", "edge")
                           .text("an edge")
                           .when("edge, edge_moment")
                           .says("An edge, or an m-line of a mesh that stays: `line 3`.");

BodyLoad read_load(const Table& t, const Scene& scene) {
  BodyLoad load;
  const std::string type = t.choice(kType);
  load.row = *std::find_if(load_rows().begin(), load_rows().end(),
                           [&](const LoadRow* row) { return row->name == type; });
  const LoadRow& row = *load.row;
  load.body = read_flexible(t, kBody, scene);
  const Body& body = scene.body(load.body);
  if (row.at_point) load.point = read_point(t, kPoint, body, scene.time.end);
  if (row.at_edge) load.edge = read_edge(t, kEdge, body, edge_names());
  if (!body.row->spreads && !row.at_point) t.fail(kType, "loads on a beam act at points");
  if (row.follows && !body.in_space()) t.fail(kType, "this load acts on a plate in space");
  if (row.follows && scene.time.integrator == "energy_momentum")
    t.fail(kType, "a load that follows the plate needs integrator = \"generalized_alpha\"");
  if (row.follows) {
    load.size = t.number(row.key);
  } else {
    const auto force = t.numbers(row.key.counted(body.dim()));
    load.force = Eigen::Map<const VectorXd>(force.data(), body.dim());
  }
  return load;
}

}  // namespace

std::span<const LoadRow* const> load_rows() {
  static const std::array kRows = {&kPointForce, &kEdgeForce, &kSurfaceForce, &kPressure,
                                   &kEdgeMoment};
  return kRows;
}

std::optional<fem::AttachedForce> attached_force(const BodyLoad& load, const Scene& scene) {
  const Body& body = scene.body(load.body);
  if (!load.row->attached) return {};
  return load.row->attached(load, body, body.longest(scene.time.end));
}

void read_loads(const Table& root, Scene& scene) {
  for (const Table& t : root.tables(tables::kLoad)) scene.loads.push_back(read_load(t, scene));
}

}  // namespace flexmorph::cases
