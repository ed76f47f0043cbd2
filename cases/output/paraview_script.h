#pragma once

namespace flexmorph::cases {

/// paraview.py of a run folder: Python for ParaView that opens what the folder has, coloured. It
/// finds the folder by its own place.
extern const char* const kParaViewScript;

}  // namespace flexmorph::cases
