# Every library that Flexmorph depends on, in the versions of Debian 12 or newer. All missing ones
# are named in one message with the command that installs them.

set(flexmorph_found "")
set(flexmorph_missing "")

# flexmorph_library(<name of its package files> <oldest version> <VARIABLE that is true when found>)
# records the outcome of a search.
function(flexmorph_library name oldest found)
  if(${found})
    list(APPEND flexmorph_found "${name} ${${name}_VERSION}")
  else()
    set(seen ${${name}_VERSION} ${${name}_CONSIDERED_VERSIONS})
    list(REMOVE_DUPLICATES seen)
    list(TRANSFORM seen PREPEND ", found ")
    list(APPEND flexmorph_missing "${name} (${oldest} or newer${seen})")
  endif()
  set(flexmorph_found "${flexmorph_found}" PARENT_SCOPE)
  set(flexmorph_missing "${flexmorph_missing}" PARENT_SCOPE)
endfunction()

# flexmorph_find(<name> <oldest version> <more arguments of find_package>...)
macro(flexmorph_find name oldest)
  find_package(${name} ${oldest} QUIET CONFIG ${ARGN})
  flexmorph_library(${name} ${oldest} ${name}_FOUND)
endmacro()

set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE TRUE)
set(CMAKE_POLICY_DEFAULT_CMP0167 NEW)  # CGAL 6 searches for Boost without setting this policy
flexmorph_find(Eigen3 3.4)
flexmorph_find(CGAL 5.5)
flexmorph_find(Boost 1.74)
flexmorph_find(VTK 9.1 COMPONENTS CommonCore CommonDataModel IOCore IOXML IOImage)
flexmorph_find(tomlplusplus 3.3)
flexmorph_find(CLI11 2.1)
flexmorph_find(nlohmann_json 3.11)
flexmorph_find(Spectra 1.0)

# The C++ header is in a separate package.
find_package(NLopt 2.7 QUIET CONFIG)
find_path(NLOPT_CXX_INCLUDE_DIR nlopt.hpp)
if(NOT NLOPT_CXX_INCLUDE_DIR)
  set(NLopt_FOUND FALSE)
endif()
flexmorph_library(NLopt 2.7 NLopt_FOUND)

# Ipopt has a pkg-config file only; it carries a define that the headers need.
find_package(PkgConfig QUIET)
if(PkgConfig_FOUND)
  pkg_check_modules(IPOPT QUIET IMPORTED_TARGET GLOBAL ipopt>=3.11)
  # For reading drawings: DXF, paths of SVG, and XML.
  pkg_check_modules(DXFLIB QUIET IMPORTED_TARGET GLOBAL dxflib>=3.26)
  pkg_check_modules(GEOM2 QUIET IMPORTED_TARGET GLOBAL 2geom>=1.2)
  # For offsets of outlines.
  pkg_check_modules(GEOS QUIET IMPORTED_TARGET GLOBAL geos>=3.11)
  pkg_check_modules(LIBXML QUIET IMPORTED_TARGET GLOBAL libxml-2.0>=2.9)
endif()
flexmorph_library(IPOPT 3.11 IPOPT_FOUND)
flexmorph_library(DXFLIB 3.26 DXFLIB_FOUND)
flexmorph_library(GEOM2 1.2 GEOM2_FOUND)
flexmorph_library(GEOS 3.11 GEOS_FOUND)
flexmorph_library(LIBXML 2.9 LIBXML_FOUND)

# SuiteSparse 5 has neither CMake nor pkg-config files.
find_path(SUITESPARSE_INCLUDE_DIR umfpack.h PATH_SUFFIXES suitesparse)
set(SUITESPARSE_FOUND TRUE)
add_library(SuiteSparse::SuiteSparse INTERFACE IMPORTED ${flexmorph_scope})
foreach(library cholmod umfpack klu amd colamd suitesparseconfig)
  find_library(SUITESPARSE_${library} ${library})
  if(SUITESPARSE_INCLUDE_DIR AND SUITESPARSE_${library})
    target_link_libraries(SuiteSparse::SuiteSparse INTERFACE ${SUITESPARSE_${library}})
  else()
    set(SUITESPARSE_FOUND FALSE)
  endif()
endforeach()
if(SUITESPARSE_FOUND)
  target_include_directories(SuiteSparse::SuiteSparse INTERFACE ${SUITESPARSE_INCLUDE_DIR})
  file(STRINGS "${SUITESPARSE_INCLUDE_DIR}/SuiteSparse_config.h" lines
       REGEX "define SUITESPARSE_(MAIN|SUB|SUBSUB)_VERSION +[0-9]+")
  string(REGEX MATCHALL "[0-9]+" SUITESPARSE_VERSION "${lines}")
  list(JOIN SUITESPARSE_VERSION "." SUITESPARSE_VERSION)
  if(SUITESPARSE_VERSION VERSION_LESS 5.12)
    set(SUITESPARSE_FOUND FALSE)
  endif()
endif()
flexmorph_library(SUITESPARSE 5.12 SUITESPARSE_FOUND)

# Only a few libraries of OpenCASCADE are needed; its own package file requires its compiler flags
# and all libraries.
find_path(OCCT_INCLUDE_DIR STEPControl_Writer.hxx PATH_SUFFIXES opencascade)
set(OCCT_FOUND TRUE)
add_library(OpenCASCADE::step INTERFACE IMPORTED ${flexmorph_scope})
# Version 7.8 has TKDESTEP where earlier ones have TKSTEP and TKSTEPBase.
find_library(OCCT_step NAMES TKDESTEP TKSTEP)
find_library(OCCT_step_base NAMES TKDESTEP TKSTEPBase)
foreach(library step step_base TKXSBase TKPrim TKTopAlgo TKBRep TKG3d TKMath TKernel)
  find_library(OCCT_${library} ${library})
  if(OCCT_INCLUDE_DIR AND OCCT_${library})
    target_link_libraries(OpenCASCADE::step INTERFACE ${OCCT_${library}})
  else()
    set(OCCT_FOUND FALSE)
  endif()
endforeach()
if(OCCT_FOUND)
  target_include_directories(OpenCASCADE::step INTERFACE ${OCCT_INCLUDE_DIR})
  file(STRINGS "${OCCT_INCLUDE_DIR}/Standard_Version.hxx" line
       REGEX "define OCC_VERSION_COMPLETE +\"")
  string(REGEX MATCH "[0-9.]+" OCCT_VERSION "${line}")
  if(OCCT_VERSION VERSION_LESS 7.6)
    set(OCCT_FOUND FALSE)
  endif()
endif()
flexmorph_library(OCCT 7.6 OCCT_FOUND)

# The library of plots in pages may be absent: its script, its style and its licence.
find_file(DYGRAPHS_js dygraph.min.js PATHS /usr/share/javascript/dygraphs NO_DEFAULT_PATH)
find_file(DYGRAPHS_css dygraph.min.css PATHS /usr/share/javascript/dygraphs NO_DEFAULT_PATH)
find_file(DYGRAPHS_txt copyright PATHS /usr/share/doc/libjs-dygraphs NO_DEFAULT_PATH)
foreach(kind js css txt)
  # Nothing of the library is used without its licence.
  if(NOT DYGRAPHS_js OR NOT DYGRAPHS_css OR NOT DYGRAPHS_txt)
    set(DYGRAPHS_${kind} "")
  endif()
endforeach()

# Libraries for tests only. Without GoogleTest there are no tests; other missing libraries leave out
# the tests that need them: CalculiX solves exported designs, valijson (headers only) checks cases
# against their schema, IDA of SUNDIALS integrates scenes. The package file of SUNDIALS would
# require PETSc and MPI, which the serial libraries do not need.
if(FLEXMORPH_TESTS)
  set(flexmorph_absent "")
  flexmorph_find(GTest 1.12)
  find_program(FLEXMORPH_CCX ccx)
  find_path(VALIJSON_INCLUDE_DIR valijson/validator.hpp)
  find_path(SUNDIALS_INCLUDE_DIR ida/ida.h)
  set(SUNDIALS_FOUND TRUE)
  add_library(SUNDIALS::ida INTERFACE IMPORTED)
  # Version 7 has sundials_core where version 6 has sundials_generic.
  find_library(SUNDIALS_core NAMES sundials_core sundials_generic)
  foreach(library ida nvecserial sunlinsolklu sunmatrixsparse core)
    find_library(SUNDIALS_${library} sundials_${library})
    if(SUNDIALS_INCLUDE_DIR AND SUNDIALS_${library})
      target_link_libraries(SUNDIALS::ida INTERFACE ${SUNDIALS_${library}})
    else()
      set(SUNDIALS_FOUND FALSE)
    endif()
  endforeach()
  if(SUNDIALS_FOUND)
    target_link_libraries(SUNDIALS::ida INTERFACE SuiteSparse::SuiteSparse)
    target_include_directories(SUNDIALS::ida INTERFACE ${SUNDIALS_INCLUDE_DIR})
    file(STRINGS "${SUNDIALS_INCLUDE_DIR}/sundials/sundials_config.h" line
         REGEX "define SUNDIALS_VERSION +\"")
    string(REGEX MATCH "[0-9.]+" SUNDIALS_VERSION "${line}")
    if(SUNDIALS_VERSION VERSION_LESS 6)
      set(SUNDIALS_FOUND FALSE)
    elseif(SUNDIALS_VERSION VERSION_GREATER_EQUAL 7)
      # Its headers include those of MPI if it was built with MPI.
      find_package(MPI QUIET COMPONENTS C)
      if(MPI_C_FOUND)
        target_link_libraries(SUNDIALS::ida INTERFACE MPI::MPI_C)
      else()
        set(SUNDIALS_FOUND FALSE)
      endif()
    endif()
  endif()
  foreach(name FLEXMORPH_CCX VALIJSON_INCLUDE_DIR SUNDIALS_FOUND)
    if(NOT ${name})
      string(REGEX REPLACE "FLEXMORPH_|_INCLUDE_DIR|_FOUND" "" name ${name})
      list(APPEND flexmorph_absent ${name})
    endif()
  endforeach()
  if(flexmorph_absent)
    list(JOIN flexmorph_absent ", " absent)
    message(STATUS "Tests that need these are skipped: ${absent}")
  endif()
endif()

# The reference BLAS, which would be found otherwise, is three times slower.
set(BLA_VENDOR OpenBLAS)
find_package(BLAS QUIET)
if(BLAS_FOUND)
  list(APPEND flexmorph_found OpenBLAS)
else()
  list(APPEND flexmorph_missing OpenBLAS)
endif()

# OpenMP is part of the compiler.
find_package(OpenMP 4.5 QUIET COMPONENTS CXX)
flexmorph_library(OpenMP 4.5 OpenMP_CXX_FOUND)

if(flexmorph_missing)
  list(JOIN flexmorph_missing "\n  " missing)
  file(STRINGS "${CMAKE_CURRENT_LIST_DIR}/packages.txt" packages REGEX "^[^#]")
  if(FLEXMORPH_TESTS)
    list(APPEND packages libgtest-dev)
  endif()
  list(FILTER packages EXCLUDE REGEX " optional$")
  list(TRANSFORM packages REPLACE " *[|].*" "")
  list(JOIN packages " " packages)
  message(FATAL_ERROR
    "Libraries are missing:\n  ${missing}\n"
    "cases/run.sh and tests/run.sh install all of them. By hand, on Debian 12 or newer:\n"
    "  apt-get install --no-install-recommends ${packages}\n")
endif()
list(JOIN flexmorph_found ", " found)
message(STATUS "Libraries: ${found}")
