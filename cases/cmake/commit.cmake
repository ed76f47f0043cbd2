# Writes the commit of the sources into a C++ file, if it has changed. A plus sign follows if files
# differ from the commit. Without git, or outside of a repository, the text is empty.
#   cmake -DSOURCE=... -DOUTPUT=... -P commit.cmake
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND git -C "${SOURCE}" describe --always --abbrev=12 --exclude=* --dirty=+
                OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT EXISTS "${SOURCE}/.git")
  set(commit "")  # the repository of a folder above is not that of these sources
endif()
file(CONFIGURE OUTPUT "${OUTPUT}" CONTENT [[
#include "cases/scene/version.h"

const char* const flexmorph::cases::kCommit = "@commit@";
]] @ONLY)
