#pragma once

namespace flexmorph::cases {

/// Text of paraview.py in a run folder: a Python script for ParaView that opens the results of the
/// folder and colours them. The script takes the folder in which it is stored.
extern const char* const kParaViewScript;

}  // namespace flexmorph::cases
