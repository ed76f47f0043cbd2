#pragma once

#include <string>
#include <vector>

/// Pages of results: one HTML file each, which contains its style, its scripts and its data and
/// needs no other file.
namespace flexmorph::cases {

/// A number at the top of a page.
struct PageFact {
  std::string name, value;  ///< Name, and value with its unit.
  std::string note;         ///< Small text below the value; may be empty.
  std::string meaning;      ///< Sentence that explains the name; may be empty.
};

/// A section of a page.
struct PageSection {
  std::string id;       ///< Anchor of the section: lower-case letters and hyphens.
  std::string heading;  ///< Heading as text.
  std::string html;     ///< Contents as HTML.
};

/// The contents of a page.
struct Page {
  std::string title;                  ///< Title as text.
  std::string status;                 ///< Status of the run or the study as text.
  bool good = true;                   ///< False if the status is highlighted as a problem.
  bool open = false;                  ///< True if a good status has an open point.
  bool refreshes = false;             ///< True while the page is written again and again.
  std::vector<PageFact> facts;        ///< Numbers at the top.
  std::vector<std::string> notes;     ///< Notes below the numbers, as text.
  std::vector<std::string> warnings;  ///< Warnings, as text.
  std::vector<PageSection>
      sections;      ///< Sections in their order; those without contents are left out.
  std::string data;  ///< Data of the scripts as JSON; empty: there are none.
};

/// Returns a page as HTML.
/// @throws Error (numerical) when the data cannot be compressed.
std::string page_html(const Page& page);

}  // namespace flexmorph::cases
