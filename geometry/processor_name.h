#pragma once

#include <string>

/// Names that say on which processor and with which instructions results were computed.
namespace flexmorph {

/// Returns the name of the processor; the name of its architecture if the system gives no other.
std::string processor_name();

/// Returns the name of the instruction set that kernels use (vector_level()): "baseline", "v3" or
/// "v4".
std::string vector_level_name();

}  // namespace flexmorph
