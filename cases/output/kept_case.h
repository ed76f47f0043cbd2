#pragma once

#include <string>

#include "cases/output/run_folder.h"
#include "io/case_files/case_file.h"

namespace flexmorph::cases {

/// Writes case.toml so that the run folder runs again by itself: files that the case reads (CSV of
/// drives and references, components of starts) are copied into inputs/, and it reads them there.
/// @param file  of which a scene was read
/// @param explain  see io::CaseFile::explained()
/// @throws Error (input) for a file that cannot be read; Error (numerical) for one not written.
void keep_case(const io::CaseFile& file, bool explain, RunFolder& folder);

/// Is this the case that was kept in a folder, and are the files the same that it reads?
bool keeps_case(const std::string& folder, const io::CaseFile& file);

}  // namespace flexmorph::cases
