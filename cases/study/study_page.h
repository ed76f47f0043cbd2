#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cases/study/study.h"
#include "io/plots.h"

/// Pages of studies: a table of all runs that can be sorted, with small pictures of their designs
/// and links to their pages, and plots.
namespace flexmorph::cases {

/// The contents of the page of a study.
struct StudyPage {
  std::string title;                              ///< Title of the page.
  std::vector<std::string> notes;                 ///< Paragraphs below the title.
  std::vector<std::vector<std::string>> summary;  ///< Table above the runs; may be empty.

  /// Header, and a row per run and designed body in the order of the runs, as result_rows().
  std::vector<std::vector<std::string>> rows;
  std::vector<std::vector<std::string>> settings;         ///< Settings that differ; may be empty.
  std::vector<std::pair<std::string, io::Figure>> plots;  ///< Names and figures of the plots.
};

/// Writes the page of a study.
/// @param runs  results of the runs; the page refreshes itself until all of them have ended
/// @param path  path of the page; links to the pages of the runs are relative to its folder
/// @throws Error (numerical) when the file cannot be written.
void write_study_page(const StudyPage& study, std::span<const VariantResult> runs,
                      const std::string& path);

/// Returns a small picture of a design from the text of its design.svg; empty for other texts.
std::string thumbnail(const std::string& svg);

}  // namespace flexmorph::cases
