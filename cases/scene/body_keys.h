#pragma once

#include "io/case_files/case_file.h"

/// Keys of [[body]] and [body.flow] that plates, beams and drives share.
namespace flexmorph::cases {

struct Body;
struct ElementRow;

namespace body_keys {
extern const io::Key &kBodyName, &kElement, &kTerms, &kLength, &kThickness, &kLine, &kFlow;
}  // namespace body_keys

namespace flow_keys {
extern const io::Key &kSpeed, &kLength, &kMesh, &kMaxLength, &kMinLength, &kStored, &kStoredAt,
    &kStoredLength;
}  // namespace flow_keys

/// Declares the numbers that terms read: rows of another table, which is not there before main().
void declare_term_keys();

/// The row that `element` names.
const ElementRow* read_element(const io::Table& t);
/// Of bodies out of which no material flows.
void refuse_flow(const io::Table& t);

/// Density, Young's modulus, Poisson's ratio.
/// @param has_density  without it the density does not matter: nothing moves and nothing weighs
void read_material(const io::Table& t, bool has_density, Body& body);

}  // namespace flexmorph::cases
