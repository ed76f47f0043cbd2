# Shows that cases/run.sh and tests/run.sh read their arguments before they install or build
# anything, that cases/run.sh accepts the options of `flexmorph run`, and that both report missing
# prerequisites before they begin:
#   cmake -DPROGRAM=... -P scripts.cmake
cmake_minimum_required(VERSION 3.25)
cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH root)

# answers(<exit code> <text that the output contains> <command>...): expects this within a minute;
# otherwise the folder ${work} of the tests below is removed, and the test fails.
function(answers expected words)
  execute_process(COMMAND ${ARGN} TIMEOUT 60 RESULT_VARIABLE code OUTPUT_VARIABLE out
                  ERROR_VARIABLE err)
  string(FIND "${out}${err}" "${words}" at)
  if(NOT code STREQUAL expected OR at EQUAL -1)
    if(work)
      file(REMOVE_RECURSE "${work}")
    endif()
    message(FATAL_ERROR "${ARGN}: exit code ${code}, expected ${expected} and '${words}':\n${out}${err}")
  endif()
endfunction()

answers(0 "The last line says" "${root}/tests/run.sh" --help)
answers(2 "unknown option '--nonsense'" "${root}/tests/run.sh" --nonsense)
answers(2 "'-R' needs a value" "${root}/tests/run.sh" -R)
answers(2 "unknown option '--nonsense'" "${root}/tests/bare_root.sh" --nonsense)
answers(0 "It needs root, debootstrap, git" "${root}/tests/bare_root.sh" --help)
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

# A copy of the files that the scripts read, in a folder whose name has a space, and replacements of
# system commands: `dpkg-query` reports packages as $INSTALLED says, `df` reports $FREE kB, `ctest`
# prints its arguments and one passed test, and `cmake` does nothing.
set(work "$ENV{TMPDIR}")
if(NOT work)
  set(work /tmp)
endif()
string(RANDOM LENGTH 8 name)
set(work "${work}/flexmorph scripts ${name}")
set(tree "${work}/a tree")
file(COPY "${root}/cases/run.sh" "${root}/cases/short_beam.toml" DESTINATION "${tree}/cases")
file(COPY "${root}/cases/cmake/setup.sh" "${root}/cases/cmake/packages.txt"
     DESTINATION "${tree}/cases/cmake")
file(COPY "${root}/tests/run.sh" "${root}/tests/packages.txt" "${root}/tests/skips.txt"
     DESTINATION "${tree}/tests")

# command(<name> <lines of a shell script>): puts a command before those of the system.
function(command name text)
  file(WRITE "${work}/bin/${name}" "#!/bin/sh\n${text}\n")
  file(CHMOD "${work}/bin/${name}" PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
endfunction()
command(df "printf 'Filesystem 1024-blocks Used Available Capacity Mounted on\\n/dev/a 9 9 %s 9%% /a b\\n' $FREE")
command(dpkg-query "[ \"$INSTALLED\" = all ] && echo 'installed '")
command(id "echo 1000")
command(cmake ":")
command(ctest "echo \"arguments: $*\"; echo 'Total Tests: 1'; echo '1/1 Test #1: A.B ...   Passed    0.01 sec'")
set(with ${CMAKE_COMMAND} -E env "PATH=${work}/bin:$ENV{PATH}")
set(ready ${with} INSTALLED=all FREE=9000000)
set(tests_run "${tree}/tests/run.sh")
set(cases_run "${tree}/cases/run.sh")

answers(0 "1 passed, 0 failed, 0 skipped" ${ready} ${tests_run})
answers(0 "20000 -LE benchmark|service|long|attack|unit"
        ${ready} ${tests_run} -LE attack -LE unit)
answers(0 "20000 -R B -L unit|service -LE attack" ${ready} ${tests_run} -L unit -R B -L service -LE attack)
answers(1 "apt-get install --no-install-recommends g++ cmake" ${with} INSTALLED=no FREE=9000000
        ${cases_run} short_beam)
answers(1 "libspectra-dev libgtest-dev" ${with} INSTALLED=no FREE=9000000 ${tests_run})
file(REMOVE_RECURSE "${tree}/build")  # existing build output reduces the required space
answers(1 "3 MB are free in ${tree}, and 4000 MB are needed" ${with} INSTALLED=all FREE=3000 ${tests_run})
answers(1 "3 MB are free in ${tree}, and 2000 MB are needed" ${with} INSTALLED=all FREE=3000
        ${cases_run} short_beam)
answers(77 "only root can make a root folder" ${ready} "${root}/tests/bare_root.sh")
set(cache "${tree}/build/CMakeCache.txt")
file(WRITE "${cache}" "CMAKE_GENERATOR:INTERNAL=Unix Makefiles\nCMAKE_HOME_DIRECTORY:INTERNAL=${tree}\n")
answers(1 "the generator 'Unix Makefiles'" ${ready} ${tests_run})
file(WRITE "${cache}" "CMAKE_GENERATOR:INTERNAL=Ninja\nCMAKE_HOME_DIRECTORY:INTERNAL=${root}\n")
answers(1 "rm -rf '${tree}/build'" ${ready} ${cases_run} short_beam)
file(WRITE "${cache}" "CMAKE_GENERATOR:INTERNAL=Ninja\nCMAKE_HOME_DIRECTORY:INTERNAL=${tree}\n")
answers(0 "1 passed, 0 failed, 0 skipped" ${ready} ${tests_run})

# jobs(<expected> <cores> <available kB> <cpu.max of the group> <memory.max of the root>)
function(jobs expected cores memory cpu bytes)
  set(system "${work}/system")
  file(WRITE "${system}/proc/meminfo" "MemTotal: 99 kB\nMemAvailable:   ${memory} kB\n")
  file(WRITE "${system}/proc/self/cgroup" "0::/outer/inner\n")
  file(WRITE "${system}/sys/fs/cgroup/outer/inner/cpu.max" "max 100000\n")
  file(WRITE "${system}/sys/fs/cgroup/outer/cpu.max" "${cpu}\n")
  file(WRITE "${system}/sys/fs/cgroup/memory.max" "${bytes}\n")
  answers(0 "jobs ${expected}." sh -euc "root=\"$1\" system_root=\"$2\" && . \"$1/cases/cmake/setup.sh\"
          echo \"jobs $(parallel_jobs ${cores}).\"" sh "${tree}" "${system}")
endfunction()
jobs(8 8 24000000 "max 100000" max)
jobs(2 8 24000000 "150000 100000" max)
jobs(4 8 5000000 "max 100000" max)
jobs(3 8 24000000 "max 100000" 4000000000)
jobs(1 8 900000 "max 100000" max)
file(REMOVE_RECURSE "${work}")
