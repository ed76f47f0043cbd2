# Installs the libraries of a build, and builds and runs the program in installed/ on them:
#   cmake -DBUILD=... -DWORK=... -DARGUMENTS=... -P installed.cmake
# BUILD: of Flexmorph. WORK: a folder for this alone. ARGUMENTS: of the program's first cmake.
file(REMOVE_RECURSE "${WORK}")
set(stop COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --install "${BUILD}" --component development
                        --prefix "${WORK}/tree" OUTPUT_QUIET ${stop})
# What is installed may be moved.
file(RENAME "${WORK}/tree" "${WORK}/moved")
execute_process(COMMAND ${CMAKE_COMMAND} -S "${CMAKE_CURRENT_LIST_DIR}/installed" -B "${WORK}/build"
                        "-DCMAKE_PREFIX_PATH=${WORK}/moved" ${ARGUMENTS} ${stop})
execute_process(COMMAND ${CMAKE_COMMAND} --build "${WORK}/build" ${stop})
execute_process(COMMAND "${WORK}/build/blade" ${stop})
