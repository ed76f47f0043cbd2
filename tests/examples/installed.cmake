# Shows that an installed and moved build works: the program finds its cases; the examples, built
# against the installed tree, static and shared, find them, too, and compute the value of the
# program:
#   cmake -DBUILD=... -DWORK=... -DARGUMENTS=... -P installed.cmake
# BUILD: build folder of Flexmorph. WORK: a folder for this test only. ARGUMENTS: arguments of the
# examples' first cmake.
file(REMOVE_RECURSE "${WORK}")
set(stop COMMAND_ERROR_IS_FATAL ANY)
foreach(component program library development)
  execute_process(COMMAND ${CMAKE_COMMAND} --install "${BUILD}" --component ${component}
                          --prefix "${WORK}/tree" OUTPUT_QUIET ${stop})
endforeach()
file(RENAME "${WORK}/tree" "${WORK}/moved")
# The case gets a name that does not exist in the source tree.
file(RENAME "${WORK}/moved/share/flexmorph/cases/plate_pendulum.toml"
            "${WORK}/moved/share/flexmorph/cases/a_moved_pendulum.toml")
set(moved "a_moved_pendulum")
set(changes time.end=0.01)
execute_process(COMMAND "${WORK}/moved/bin/flexmorph" run ${moved} --set ${changes} --quiet
                        -o "${WORK}/run" WORKING_DIRECTORY "${WORK}" ${stop})
file(STRINGS "${WORK}/run/motion.csv" rows)
list(GET rows 0 columns)
string(REPLACE "," ";" columns "${columns}")
list(FIND columns energy.kinetic at)
list(GET rows -1 last)
string(REPLACE "," ";" last "${last}")
list(GET last ${at} expected)
string(SUBSTRING "${expected}" 0 8 expected)
# A template with a name that does not exist in the source tree is a kind of its own.
file(RENAME "${WORK}/moved/share/flexmorph/cases/templates/arm.toml"
            "${WORK}/moved/share/flexmorph/cases/templates/moved-arm.toml")
execute_process(COMMAND "${WORK}/moved/bin/flexmorph" new my_arm --kind moved-arm
                WORKING_DIRECTORY "${WORK}" OUTPUT_QUIET ${stop})
execute_process(COMMAND "${WORK}/moved/bin/flexmorph" check my_arm.toml
                WORKING_DIRECTORY "${WORK}" OUTPUT_QUIET ${stop})
foreach(kind static shared)
  set(build "${WORK}/build-${kind}")
  set(is_shared OFF)
  if(kind STREQUAL shared)
    set(is_shared ON)
  endif()
  execute_process(COMMAND ${CMAKE_COMMAND} -S "${WORK}/moved/share/flexmorph/examples" -B "${build}"
                          "-DCMAKE_PREFIX_PATH=${WORK}/moved" -DSHARED=${is_shared} ${ARGUMENTS}
                  OUTPUT_QUIET ${stop})
  execute_process(COMMAND ${CMAKE_COMMAND} --build "${build}" OUTPUT_QUIET ${stop})
  execute_process(COMMAND "${build}/compose" "${WORK}/boom-${kind}" ${stop})
  execute_process(COMMAND "${build}/own_parts" ${stop})
  # A static program needs the path of the case; a shared library finds the case by its name.
  set(case ${moved})
  if(kind STREQUAL static)
    set(case "${WORK}/moved/share/flexmorph/cases/${moved}.toml")
  endif()
  execute_process(COMMAND "${build}/move_case" ${case} energy.kinetic ${changes}
                  OUTPUT_VARIABLE printed ${stop})
  string(REGEX MATCH " ([^ ]+)\n$" found "${printed}")
  if(NOT CMAKE_MATCH_1 MATCHES "^${expected}")
    message(FATAL_ERROR "move_case (${kind}) ends with ${CMAKE_MATCH_1}, the program with ${expected}")
  endif()
endforeach()
