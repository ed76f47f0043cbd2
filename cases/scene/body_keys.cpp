#include "cases/scene/body_keys.h"

#include "cases/scene/elements/row.h"
#include "cases/scene/materials/material.h"

namespace flexmorph::cases {
namespace {

using io::positive;

constexpr const char* kOfMaterial = "that of `material`; required without it";

const io::Key& kMaterial = material_key("body");

const io::Key& kDensity =
    io::key("body", "density")
        .number(positive("a density", "kg/m^3"))
        .otherwise_as(
            "that of `material`; required without it, except in a [static] analysis without "
            "gravity")
        .description("Density of the material.");
const io::Key& kYoungsModulus = io::key("body", "youngs_modulus")
                                    .number(positive("Young's modulus", "Pa"))
                                    .otherwise_as(kOfMaterial)
                                    .description("Young's modulus of the material.");
const io::Key& kPoissonRatio = io::key("body", "poisson_ratio")
                                   .number(io::between("Poisson's ratio", "", 0, 0.5))
                                   .otherwise_as(kOfMaterial)
                                   .description("Poisson's ratio of the material.");

}  // namespace

namespace body_keys {

const io::Key& kBodyName =
    io::key("body", "name")
        .text("the name of a body")
        .description("Name of the body in joints, loads and columns of tables.");
const io::Key& kElement = io::key("body", "element")
                              .word("an element",
                                    [] {
                                      io::Glossary rows;
                                      for (const ElementRow* row : element_rows())
                                        rows.emplace_back(row->name, row->sentence);
                                      return rows;
                                    })
                              .description("Kind of element of the body.");
const io::Key& kLength =
    io::key("body", "length")
        .number(positive("a length", "m"))
        .otherwise_as("the start value of `body.flow.length`; required without this drive")
        .description("Length from the root to the free end at the start.");
const io::Key& kThickness = io::key("body", "thickness")
                                .number(positive("a thickness", "m"))
                                .when("plates")
                                .description("Thickness of the plate.");
const io::Key& kLine =
    io::key("body", "line")
        .tables_of()
        .otherwise_as("a uniform mesh")
        .when("plates")
        .description(
            "A mesh line across the axis (m-line) with a given coordinate, or free to move.");
const io::Key& kFlow =
    io::key("body", "flow")
        .table()
        .when("`element = \"ale_ancf_plate\"`")
        .description("Material flow through the root of the plate, and the control of its mesh.");

}  // namespace body_keys

namespace flow_keys {

const io::Key& kSpeed =
    io::key("body.flow", "speed")
        .number(io::any_number("the speed of the material", "m/s"))
        .otherwise_as("required unless `length` is given")
        .description(
            "Speed at which material leaves the hub; with a negative speed it enters the hub.");
const io::Key& kLength = io::key("body.flow", "length")
                             .name_of("a drive")
                             .otherwise_as("required unless `speed` is given")
                             .description("Drive of the length of the body outside of the hub.");
const io::Key& kMesh =
    io::key("body.flow", "mesh")
        .word("a mesh control", {"split", "uniform"})
        .renames({{"even", "uniform"}})
        .otherwise_as(
            "`uniform` if the length changes by less than a factor of 4 and only "
            "welds or a mass at the free end act on the body, else `split`")
        .description(
            "`split` inserts and removes lines of nodes at the root; `uniform` "
            "keeps all elements equally long.");
const io::Key& kMaxLength = io::key("body.flow", "max_length")
                                .number(positive("a length", "m"))
                                .otherwise_as("no limit; required for `split`")
                                .when("`shape` is not \"q4\"")
                                .description(
                                    "Largest element length: `split` inserts lines of nodes, "
                                    "`uniform` chooses enough elements.");
const io::Key& kMinLength = io::key("body.flow", "min_length")
                                .number(positive("a length", "m"))
                                .otherwise_as("no limit; for `split`: 0.3 `max_length`")
                                .when("`shape` is not \"q4\"")
                                .description(
                                    "Smallest element length: `split` removes lines of nodes; for "
                                    "`uniform` shorter ones are an error.");
const io::Key& kReservoir =
    io::key("body.flow", "reservoir")
        .formerly("stored")
        .word("a model of the material reservoir", {"none", "coil", "rod"})
        .otherwise("none")
        .description(
            "Model of the material reservoir in a rigid body: none, a coil, "
            "or a rod that slides out.");
const io::Key& kReservoirAt =
    io::key("body.flow", "reservoir_at")
        .formerly("stored_at")
        .numbers(io::any_number("a location", "m"), 2, 2)
        .otherwise_as("the outlet")
        .when("`reservoir` is not \"none\"")
        .description(
            "Location of the coil, or of the front end of the rod, in the axes of the rigid body.");
const io::Key& kReservoirLength =
    io::key("body.flow", "reservoir_length")
        .formerly("stored_length")
        .number(io::positive("a length", "m"))
        .otherwise_as("the length that leaves until the body is longest")
        .when("`reservoir` is not \"none\"")
        .description("Length of the material in the reservoir at the start.");

}  // namespace flow_keys

const ElementRow* read_element(const io::Table& t) {
  return find_element(t.choice(body_keys::kElement));
}

void refuse_flow(const io::Table& t) {
  if (t.has(body_keys::kFlow))
    t.fail(body_keys::kFlow, "material flow needs element = \"ale_ancf_plate\"");
}

void read_material(const io::Table& t, bool has_density, Body& body) {
  std::optional<double> density, youngs_modulus, poisson_ratio;
  if (!has_density) density = 1;
  if (t.has(kMaterial)) {
    body.material = find_material(t.choice(kMaterial));
    density = body.material->density;
    youngs_modulus = body.material->youngs_modulus;
    poisson_ratio = body.material->poisson_ratio;
  }
  body.density = t.number(kDensity, density);
  body.youngs_modulus = t.number(kYoungsModulus, youngs_modulus);
  body.poisson_ratio = t.number(kPoissonRatio, poisson_ratio);
}

}  // namespace flexmorph::cases
