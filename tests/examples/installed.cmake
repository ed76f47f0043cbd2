# Installs a build and moves it. The program finds the cases it came with; the one in installed/ is
# built on the libraries, and run:
#   cmake -DBUILD=... -DWORK=... -DARGUMENTS=... -P installed.cmake
# BUILD: of Flexmorph. WORK: a folder for this alone. ARGUMENTS: of the program's first cmake.
file(REMOVE_RECURSE "${WORK}")
set(stop COMMAND_ERROR_IS_FATAL ANY)
foreach(component program development)
  execute_process(COMMAND ${CMAKE_COMMAND} --install "${BUILD}" --component ${component}
                          --prefix "${WORK}/tree" OUTPUT_QUIET ${stop})
endforeach()
file(RENAME "${WORK}/tree" "${WORK}/moved")
# Under a name that the source tree does not have.
file(RENAME "${WORK}/moved/share/flexmorph/cases/short_beam.toml"
            "${WORK}/moved/share/flexmorph/cases/a_moved_beam.toml")
execute_process(COMMAND "${WORK}/moved/bin/flexmorph" check a_moved_beam
                WORKING_DIRECTORY "${WORK}" ${stop})
execute_process(COMMAND ${CMAKE_COMMAND} -S "${CMAKE_CURRENT_LIST_DIR}/installed" -B "${WORK}/build"
                        "-DCMAKE_PREFIX_PATH=${WORK}/moved" ${ARGUMENTS} ${stop})
execute_process(COMMAND ${CMAKE_COMMAND} --build "${WORK}/build" ${stop})
execute_process(COMMAND "${WORK}/build/blade" ${stop})
