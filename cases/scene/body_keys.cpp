#include "cases/scene/body_keys.h"

#include "cases/scene/elements/row.h"

namespace flexmorph::cases {
namespace {

using io::positive;

const io::Key& kDensity = io::key("body", "density")
                              .number(positive("a density", "kg/m^3"))
                              .otherwise_as("[static] without gravity: it does not matter")
                              .says("Of the material.");
const io::Key& kYoungsModulus = io::key("body", "youngs_modulus")
                                    .number(positive("Young's modulus", "Pa"))
                                    .says("Young's modulus.");
const io::Key& kPoissonRatio = io::key("body", "poisson_ratio")
                                   .number(io::between("Poisson's ratio", "", 0, 0.5))
                                   .says("Poisson's ratio.");

}  // namespace

namespace body_keys {

const io::Key& kBodyName = io::key("body", "name")
                               .text("the name of a body")
                               .says("What joints, loads and columns of tables call it.");
const io::Key& kElement = io::key("body", "element")
                              .word("an element",
                                    [] {
                                      io::Glossary rows;
                                      for (const ElementRow* row : element_rows())
                                        rows.emplace_back(row->name, row->sentence);
                                      return rows;
                                    })
                              .says("What it is made of.");
const io::Key& kLength = io::key("body", "length")
                             .number(positive("a length", "m"))
                             .otherwise_as("where `body.flow.length` is a drive: as that starts")
                             .says("From the root to the free end, at the start.");
const io::Key& kThickness = io::key("body", "thickness")
                                .number(positive("a thickness", "m"))
                                .when("plates")
                                .says("Across its surface.");
const io::Key& kLine =
    io::key("body", "line")
        .tables_of()
        .otherwise_as("an even mesh that stays")
        .when("plates")
        .says("An m-line of the mesh that stands elsewhere, or is free to move.");
const io::Key& kFlow = io::key("body", "flow")
                           .table()
                           .when("`element = \"ale_ancf_plate\"`")
                           .says("How material leaves the body that carries the root.");

}  // namespace body_keys

namespace flow_keys {

const io::Key& kSpeed = io::key("body.flow", "speed")
                            .number(io::any_number("the speed of the material", "m/s"))
                            .otherwise_as("`length` is given")
                            .says("Material leaves the hub at this speed; negative: it enters.");
const io::Key& kLength = io::key("body.flow", "length")
                             .name_of("a drive")
                             .otherwise_as("`speed` is given")
                             .says("The drive of the length outside of the hub.");
const io::Key& kMesh =
    io::key("body.flow", "mesh")
        .word("a rule of the mesh", {"split", "even"})
        .otherwise_as("`even` where the length changes by less than a factor of 4, else `split`")
        .says("`split`: lines of nodes come and go; `even`: elements stay equal.");
const io::Key& kMaxLength = io::key("body.flow", "max_length")
                                .number(positive("a length", "m"))
                                .otherwise_as("no limit; `split` needs one")
                                .when("`shape` is not \"q4\"")
                                .says(
                                    "No element is longer: `split` inserts lines, `even` has "
                                    "enough `elements`.");
const io::Key& kMinLength =
    io::key("body.flow", "min_length")
        .number(positive("a length", "m"))
        .otherwise_as("no limit; of `split`: 0.3 `max_length`")
        .when("`shape` is not \"q4\"")
        .says("No element is shorter: `split` removes lines, `even` is refused.");
const io::Key& kStored =
    io::key("body.flow", "stored")
        .word("where material is before it leaves", {"none", "coil", "rod"})
        .otherwise("none")
        .says(
            "What a rigid body feels of it: nothing, a coil, or a rod that slides to the outlet.");
const io::Key& kStoredAt =
    io::key("body.flow", "stored_at")
        .numbers(io::any_number("a place", "m"), 2, 2)
        .otherwise_as("the outlet")
        .when("`stored` is not \"none\"")
        .says("Of the coil, or of the rod's front end, in the axes of the rigid body.");
const io::Key& kStoredLength = io::key("body.flow", "stored_length")
                                   .number(io::positive("a length", "m"))
                                   .otherwise_as("what leaves until the body is longest")
                                   .when("`stored` is not \"none\"")
                                   .says("Length of the material that is stored at the start.");

}  // namespace flow_keys

const ElementRow* read_element(const io::Table& t) {
  return find_element(t.choice(body_keys::kElement));
}

void refuse_flow(const io::Table& t) {
  if (t.has(body_keys::kFlow))
    t.fail(body_keys::kFlow, "material flows through \"ale_ancf_plate\" only");
}

void read_material(const io::Table& t, bool has_density, Body& body) {
  body.density = t.number(kDensity, has_density ? std::nullopt : std::optional<double>(1));
  body.youngs_modulus = t.number(kYoungsModulus);
  body.poisson_ratio = t.number(kPoissonRatio);
}

}  // namespace flexmorph::cases
