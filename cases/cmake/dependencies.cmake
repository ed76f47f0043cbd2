# Every library Flexmorph stands on, in the versions of Debian 12 or newer. All that are missing are
# named in one message, with the command that installs them.

set(flexmorph_found "")
set(flexmorph_missing "")

# flexmorph_library(<name of its package files> <oldest version> <VARIABLE that is true when found>)
# notes the outcome of a search.
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
flexmorph_find(Eigen3 3.4)
flexmorph_find(CGAL 5.5)
flexmorph_find(Boost 1.74)
flexmorph_find(VTK 9.1 COMPONENTS CommonCore CommonDataModel IOXML IOImage)
flexmorph_find(tomlplusplus 3.3)
flexmorph_find(CLI11 2.1)
flexmorph_find(nlohmann_json 3.11)

# The C++ header is a package of its own.
find_package(NLopt 2.7 QUIET CONFIG)
find_path(NLOPT_CXX_INCLUDE_DIR nlopt.hpp)
if(NOT NLOPT_CXX_INCLUDE_DIR)
  set(NLopt_FOUND FALSE)
endif()
flexmorph_library(NLopt 2.7 NLopt_FOUND)

# Ipopt has a pkg-config file only; it carries a define that the headers need. GiNaC likewise.
find_package(PkgConfig QUIET)
if(PkgConfig_FOUND)
  pkg_check_modules(IPOPT QUIET IMPORTED_TARGET GLOBAL ipopt>=3.11)
  pkg_check_modules(GINAC QUIET IMPORTED_TARGET GLOBAL ginac>=1.8)
endif()
flexmorph_library(IPOPT 3.11 IPOPT_FOUND)
flexmorph_library(GINAC 1.8 GINAC_FOUND)

# SuiteSparse 5 has neither CMake nor pkg-config files.
find_path(SUITESPARSE_INCLUDE_DIR umfpack.h PATH_SUFFIXES suitesparse)
set(SUITESPARSE_FOUND TRUE)
add_library(SuiteSparse::SuiteSparse INTERFACE IMPORTED)
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

# Of the tests. CalculiX judges exported designs; valijson, headers alone, judges cases by their schema; SUNDIALS judges our integrators; its own package file would ask for PETSc and MPI,
# which the serial libraries do not need.
if(FLEXMORPH_TESTS)
  flexmorph_find(GTest 1.12)
  find_program(FLEXMORPH_CCX ccx)
  flexmorph_library(calculix-ccx 2.20 FLEXMORPH_CCX)
  find_path(VALIJSON_INCLUDE_DIR valijson/validator.hpp)
  flexmorph_library(valijson 1.0 VALIJSON_INCLUDE_DIR)
  find_path(SUNDIALS_INCLUDE_DIR ida/ida.h)
  set(SUNDIALS_FOUND TRUE)
  add_library(SUNDIALS::ida INTERFACE IMPORTED)
  foreach(library ida nvecserial sunlinsolklu sunmatrixsparse generic)
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
    endif()
  endif()
  flexmorph_library(SUNDIALS 6 SUNDIALS_FOUND)
endif()

# The reference BLAS, which would be found otherwise, is three times slower.
set(BLA_VENDOR OpenBLAS)
find_package(BLAS QUIET)
if(BLAS_FOUND)
  list(APPEND flexmorph_found OpenBLAS)
else()
  list(APPEND flexmorph_missing OpenBLAS)
endif()

# Part of the compiler.
find_package(OpenMP 4.5 QUIET COMPONENTS CXX)
flexmorph_library(OpenMP 4.5 OpenMP_CXX_FOUND)

if(flexmorph_missing)
  list(JOIN flexmorph_missing "\n  " missing)
  file(STRINGS "${CMAKE_CURRENT_LIST_DIR}/packages.txt" packages REGEX "^[^#]")
  list(JOIN packages " " packages)
  message(FATAL_ERROR
    "Libraries are missing:\n  ${missing}\n"
    "cases/run.sh installs all of them. By hand, on Debian 12:\n"
    "  apt-get install --no-install-recommends ${packages}\n")
endif()
list(JOIN flexmorph_found ", " found)
message(STATUS "Libraries: ${found}")
