#pragma once

#include <string>

/// Files that are compiled into the program for pages (cases/cmake/page_assets.cmake).
namespace flexmorph::cases {

/// Returns the contents of a file of cases/output/page, of the glossary, or of the library of plots
/// ("dygraph.js", "dygraph.css", "dygraph.txt" with its licence). The files of the library are
/// empty if it was absent when the program was built.
std::string page_asset(const std::string& name);

}  // namespace flexmorph::cases
