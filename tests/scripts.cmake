# cases/run.sh and tests/run.sh read their arguments before they install or build anything, and
# cases/run.sh knows the options of `flexmorph run`:
#   cmake -DPROGRAM=... -P scripts.cmake
cmake_minimum_required(VERSION 3.25)
cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH root)

# answers(<exit code> <words that the answer contains> <command>...): within ten seconds.
function(answers expected words)
  execute_process(COMMAND ${ARGN} TIMEOUT 10 RESULT_VARIABLE code OUTPUT_VARIABLE out
                  ERROR_VARIABLE err)
  string(FIND "${out}${err}" "${words}" at)
  if(NOT code STREQUAL expected OR at EQUAL -1)
    message(FATAL_ERROR "${ARGN}: exit code ${code}, expected ${expected} and '${words}':\n${out}${err}")
  endif()
endfunction()

answers(0 "The last line says" "${root}/tests/run.sh" --help)
answers(2 "unknown option '--nonsense'" "${root}/tests/run.sh" --nonsense)
answers(2 "'-R' needs a value" "${root}/tests/run.sh" -R)
answers(0 "name of a shipped case" "${root}/cases/run.sh" short_beam --help)
answers(2 "unknown option '--nonsense'" "${root}/cases/run.sh" short_beam --nonsense)
answers(2 "no case 'no_such_case'" "${root}/cases/run.sh" no_such_case)

execute_process(COMMAND "${PROGRAM}" run --help OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "--[a-z]+" options "${help}")
list(REMOVE_DUPLICATES options)
list(LENGTH options n)
if(n LESS 6)
  message(FATAL_ERROR "flexmorph run --help names few options: ${options}")
endif()
file(READ "${root}/cases/run.sh" script)
foreach(option ${options})
  if(NOT script MATCHES "[ |(]${option}[ =)*|]")
    message(FATAL_ERROR "cases/run.sh does not know ${option}, an option of flexmorph run")
  endif()
endforeach()
