# Writes a source file with the files of cases/output/page, the glossary, and the library of plots as
# texts of the program.
#
#   cmake -DOUTPUT=<source file> -DFILES=<name=path|name=path...> -P page_assets.cmake
#
# A name without a path gives an empty text.

cmake_minimum_required(VERSION 3.25)
string(REPLACE "|" ";" files "${FILES}")
set(entries "")
foreach(entry ${files})
  string(REGEX MATCH "^([^=]*)=(.*)$" whole "${entry}")
  set(name "${CMAKE_MATCH_1}")
  set(text "")
  if(NOT "${CMAKE_MATCH_2}" STREQUAL "")
    file(READ "${CMAKE_MATCH_2}" text)
  endif()
  # The comment that names a map of the source would make browsers ask for another file.
  string(REGEX REPLACE "/[/*]# sourceMappingURL=[^\n*]*(\\*/)?" "" text "${text}")
  if("${text}" MATCHES "\\)_page_\"")
    message(FATAL_ERROR "${name}: the text contains the delimiter of the texts in page_assets.cpp")
  endif()
  string(APPEND entries "      {\"${name}\", R\"_page_(${text})_page_\"},\n")
endforeach()
# Every compiler that is used accepts texts longer than the 65536 characters of the standard.
file(WRITE "${OUTPUT}" "#include \"cases/output/page/assets.h\"

#include <map>

#pragma GCC diagnostic ignored \"-Woverlength-strings\"

namespace flexmorph::cases {

std::string page_asset(const std::string& name) {
  static const std::map<std::string, std::string> kAssets = {
${entries}  };
  return kAssets.at(name);
}

}  // namespace flexmorph::cases
")
