#pragma once

#include <string>

#include "cases/output/run_folder.h"
#include "io/case_files/case_file.h"

namespace flexmorph::cases {

/// Writes case.toml so that the run can be repeated from the run folder alone: the files that the
/// case reads (CSV files of drives and references, components files of initial layouts, drawings)
/// are copied into inputs/, and case.toml refers to these copies.
/// @param file     case file from which a scene was read
/// @param explain  see io::CaseFile::explained()
/// @throws Error (input) for a file that cannot be read; Error (numerical) for one not written.
void keep_case(const io::CaseFile& file, bool explain, RunFolder& folder);

/// Returns true if a folder contains exactly this case, and copies of the files that it reads with
/// unchanged contents.
bool keeps_case(const std::string& folder, const io::CaseFile& file);

}  // namespace flexmorph::cases
