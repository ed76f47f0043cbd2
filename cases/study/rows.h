#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "cases/study/study.h"

/// The rows of a study: a row is a command line, a run folder, and the results that are read from
/// this folder. All studies run, print and collect their rows by these functions.
namespace flexmorph::cases {

/// Returns the arguments of the program that run a row.
/// @param resume  true if a run of the same case in the folder is continued
std::vector<std::string> row_arguments(const StudyOptions& options, const Variant& variant,
                                       bool resume);

/// Returns the command line of a row for a shell. It may be executed again and again: a row that is
/// complete is not computed again, and an interrupted row is continued.
/// @throws Error (input) for settings with line ends or tabulators
std::string row_command(const StudyOptions& options, const Variant& variant);

/// Tells whether a row needs no further run: it is complete, or it failed with exit code 3. A row
/// that reached its time limit is run again if the limit is larger now, and so is a row whose files
/// could not be written.
bool is_answered(const StudyOptions& options, const Variant& variant, const VariantResult& result);

/// Reads the result of a row. The status is "another case" if the folder has the run of another
/// case. In a study that keeps failures, a row without results that is refused has failed.
VariantResult collected_row(const StudyOptions& options, const Variant& variant);

/// Moves the run of another case out of the folder of a row, so that the row can be run there.
void free_folder(const StudyOptions& options, const Variant& variant);

/// Creates a folder of a study.
/// @throws Error (input) when the folder cannot be created.
void make_folder(const std::string& path);

/// Returns a text with the number of rows of each status, the names of the rows that are not
/// complete, and origin_note(). It is empty if all rows are complete and have one origin.
/// @param keeps_failures  true if failed rows count as complete
std::string rows_note(std::span<const VariantResult> rows, bool keeps_failures = false);

/// Returns a warning that names the origins (version, commit, processor, kernels) of the rows if
/// they differ; empty otherwise.
std::string origin_note(std::span<const VariantResult> rows);

/// Writes a table with a line per row: folder relative to that of the table, status, exit code,
/// origin, times, memory and message.
/// @throws Error (input) when the file cannot be written.
void write_rows(std::span<const VariantResult> rows, const std::string& path);

/// Returns the exit code of a study: 4 if a row is not complete, so that the study has to be called
/// again; 3 if a row failed; 0 otherwise.
int exit_code_of(const StudyOptions& options, std::span<const VariantResult> rows);

/// Runs, collects or prints rows as run_variants() does, and writes no table.
StudyOutcome run_rows(const StudyOptions& options, std::span<const Variant> variants,
                      const ResultsChanged& changed);

/// Reads the results of all rows that exist, and runs none.
StudyOutcome collect_rows(const StudyOptions& options, std::span<const Variant> variants,
                          const ResultsChanged& changed);

/// Returns the command lines of all rows, or the script of a job array that runs the rows without
/// results. The folder of the study is created, because the script and the rows write into it.
std::string rows_text(const StudyOptions& options, std::span<const Variant> variants);

/// Runs the rows without results on several machines through GNU parallel. Without a shared disk
/// the files that the case reads are sent to a temporary folder of the machine, and the folder of
/// the row returns; it takes its place in the study when it is whole.
/// @throws Error (input) if GNU parallel is missing, and without a shared disk for files outside of
///         the working directory.
StudyOutcome run_on_hosts(const StudyOptions& options, std::span<const Variant> variants,
                          const ResultsChanged& changed);

}  // namespace flexmorph::cases
