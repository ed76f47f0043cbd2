# Runs one test of watchdog_subjects.cpp and checks the exit code and the messages of the watchdog:
#   cmake -DPROGRAM=... -DSUBJECT=... -P watchdog_test.cmake
# A process that is left behind would keep the output open, and execute_process would wait for it.
set(ENV{FLEXMORPH_TEST_SECONDS} 2)
execute_process(COMMAND ${PROGRAM} --gtest_filter=Subject.${SUBJECT} TIMEOUT 20
                RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
set(code_Passes 0)
set(says_Passes "^$")
set(code_Hangs 1)
set(says_Hangs "The test Subject.Hangs has taken more than 2 s and is killed.*Killed: process")
set(code_LeavesAProcess 1)
set(says_LeavesAProcess "The test left a process behind; it is killed: process [0-9]+: sleep 1000")
set(code_IgnoresTheEnd 1)
set(says_IgnoresTheEnd "The test Subject.IgnoresTheEnd has taken more than 2 s.*: sleep 1000")
set(code_EndsByASignal 139)
set(says_EndsByASignal "Subject.EndsByASignal was ended by signal 11")
if(NOT code STREQUAL code_${SUBJECT} OR NOT err MATCHES "${says_${SUBJECT}}")
  message(FATAL_ERROR "exit code ${code}, standard error:\n${err}\nstandard output:\n${out}")
endif()
