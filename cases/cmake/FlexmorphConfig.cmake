# find_package(Flexmorph): targets flexmorph::geometry, io, fem, thermal, optim, verification, mmc. They
# are static, so that the libraries they stand on are found again here.
get_property(languages GLOBAL PROPERTY ENABLED_LANGUAGES)
if(NOT "C" IN_LIST languages)
  set(Flexmorph_FOUND FALSE)
  set(Flexmorph_NOT_FOUND_MESSAGE "VTK's package files probe for C: project(... LANGUAGES C CXX)")
  return()
endif()
set(FLEXMORPH_TESTS OFF)
include("${CMAKE_CURRENT_LIST_DIR}/dependencies.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/Flexmorph.cmake")
