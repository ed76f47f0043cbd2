#pragma once

#include <regex>
#include <string>

#include "tests/cases/program.h"

namespace flexmorph::test {

/// Returns the text of the page of a run without its date, its times and the number of threads.
inline std::string page_without_times(std::string page) {
  const size_t run = page.find("<section id=\"run\">");
  if (run != std::string::npos) page.erase(run, page.find("</section>", run) - run);
  std::string out;
  for (const std::string& line : lines_of(page))
    if (line.size() > 10'000 || !std::regex_search(line, std::regex("seconds|CPU|wall")))
      out += line + "\n";
  return out;
}

}  // namespace flexmorph::test
