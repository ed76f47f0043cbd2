#pragma once

#include "io/case_files/case_file.h"

/// Keys of [[body]] and [body.flow] that the readers of plates, beams and drives share.
namespace flexmorph::cases {

struct Body;
struct ElementRow;

namespace body_keys {
extern const io::Key &kBodyName, &kElement, &kTerms, &kLength, &kThickness, &kLine, &kFlow;
}  // namespace body_keys

namespace flow_keys {
extern const io::Key &kSpeed, &kLength, &kMesh, &kMaxLength, &kMinLength, &kReservoir,
    &kReservoirAt, &kReservoirLength;
}  // namespace flow_keys

/// Declares the keys of the numbers that terms read. They are declared on demand because the table
/// of terms may not be initialized before main().
void declare_term_keys();

/// Returns the row that the key `element` of a [[body]] names.
const ElementRow* read_element(const io::Table& t);
/// Throws if a body of a kind without material flow has a [body.flow].
/// @throws Error (input) located in the file
void refuse_flow(const io::Table& t);

/// Reads density, Young's modulus and Poisson's ratio.
/// @param has_density  false in a static analysis without gravity: the density then has no effect
///                     and may be missing
void read_material(const io::Table& t, bool has_density, Body& body);

}  // namespace flexmorph::cases
