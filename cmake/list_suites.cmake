# Run after a test program is linked: asks it for its suites and writes a file for CTest in which each suite is a test.
# A process a suite, not one a test: starting a process under a sanitizer takes longer than most tests.
# Wants PROGRAM, ROOM (the tests are ROOM.Suite), OUTPUT, LABEL, FILTER (gtest's) and EMULATOR (of a cross-compiled
# program: a command and its arguments); the last three may be empty.
execute_process(COMMAND ${EMULATOR} ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listing COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE ";" "," listing "${listing}")
string(REPLACE "\n" ";" lines "${listing}")
set(text "")
set(command "")
foreach(word IN LISTS EMULATOR PROGRAM)
  string(APPEND command " [=[${word}]=]")
endforeach()
foreach(line IN LISTS lines)
  # "Suite." and "Suite/Type.  # TypeParam = ..." stand at the margin, tests are indented.
  if(line MATCHES "^([A-Za-z0-9_/]+)\\.( .*)?$")
    set(suite ${CMAKE_MATCH_1})
    string(APPEND text "add_test([=[${ROOM}.${suite}]=]${command} \"--gtest_filter=${suite}.*${FILTER}\")\n"
      "set_tests_properties([=[${ROOM}.${suite}]=] PROPERTIES TIMEOUT 900 LABELS \"${LABEL}\")\n")
  endif()
endforeach()
file(WRITE ${OUTPUT} "${text}")
