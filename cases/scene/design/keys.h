#pragma once

#include "io/case_files/key.h"

/// Keys of [[design]] that several source files use.
namespace flexmorph::cases::design_keys {

extern const io::Key &kCells, &kSolid, &kVoid, &kStrip, &kStripCells, &kMaxVolume, &kCoupling,
    &kLinkSupport;

}  // namespace flexmorph::cases::design_keys
