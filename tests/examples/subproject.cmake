# Shows that a project can add the sources of Flexmorph by add_subdirectory(): it is configured
# without the tests of Flexmorph, a program that uses its headers is built and run, and the targets
# of the libraries have the names of an installed Flexmorph:
#   cmake -DSOURCE=... -DWORK=... -DARGUMENTS=... -P subproject.cmake
# WORK: a folder for this test only. ARGUMENTS: arguments of the project's first cmake.
file(REMOVE_RECURSE "${WORK}")
set(stop COMMAND_ERROR_IS_FATAL ANY)
file(WRITE "${WORK}/CMakeLists.txt" "cmake_minimum_required(VERSION 3.25)
project(user LANGUAGES C CXX)
enable_testing()
add_subdirectory(\"${SOURCE}\" flexmorph EXCLUDE_FROM_ALL)
add_executable(headers headers.cpp)
target_link_libraries(headers PRIVATE flexmorph::options Eigen3::Eigen)
add_executable(whole EXCLUDE_FROM_ALL headers.cpp)
target_link_libraries(whole PRIVATE flexmorph::flexmorph)
add_executable(parts EXCLUDE_FROM_ALL headers.cpp)
target_link_libraries(parts PRIVATE flexmorph::cases)
")
file(WRITE "${WORK}/headers.cpp" "#include <cstdio>
#include \"geometry/base.h\"
int main() {
  const flexmorph::Vec2 v(3, 4);
  std::printf(\"%g\", v.norm());
}
")
execute_process(COMMAND ${CMAKE_COMMAND} -S "${WORK}" -B "${WORK}/build" ${ARGUMENTS}
                OUTPUT_QUIET ${stop})
execute_process(COMMAND ${CMAKE_COMMAND} --build "${WORK}/build" OUTPUT_QUIET ${stop})
execute_process(COMMAND "${WORK}/build/headers" OUTPUT_VARIABLE printed ${stop})
if(NOT printed STREQUAL 5)
  message(FATAL_ERROR "the program printed '${printed}'")
endif()
execute_process(COMMAND ${CMAKE_CTEST_COMMAND} --test-dir "${WORK}/build" -N
                OUTPUT_VARIABLE tests ${stop})
if(NOT tests MATCHES "Total Tests: 0")
  message(FATAL_ERROR "the tests of Flexmorph belong to the project:\n${tests}")
endif()
