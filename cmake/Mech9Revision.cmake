# Writes version.f90 with the revision of the sources by git, where they are a repository of their own; the file stays as it is where
# nothing in it changes. It is included when configuring, and run after each commit (src/base/CMakeLists.txt):
#   cmake -D GIT_EXECUTABLE=... -D PROJECT_SOURCE_DIR=... -D PROJECT_VERSION=... -D MECH9_SUNDIALS_VERSION=... -D MECH9_VERSION_FILE=... -P ...
string(REGEX MATCH "^([0-9]+)[.]([0-9]+)[.]([0-9]+)" numbers "${PROJECT_VERSION}")
set(PROJECT_VERSION_MAJOR "${CMAKE_MATCH_1}")
set(PROJECT_VERSION_MINOR "${CMAKE_MATCH_2}")
set(PROJECT_VERSION_PATCH "${CMAKE_MATCH_3}")
set(MECH9_REVISION "")
set(MECH9_GIT_LOG "")
if(GIT_EXECUTABLE)
  # of this project's own repository only, not of one that happens to hold its sources
  execute_process(
    COMMAND "${GIT_EXECUTABLE}" rev-parse --show-prefix
    WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}"
    OUTPUT_VARIABLE prefix OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed AND prefix STREQUAL "")
    execute_process(
      COMMAND "${GIT_EXECUTABLE}" describe --always --dirty --abbrev=10
      WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}"
      OUTPUT_VARIABLE MECH9_REVISION OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    execute_process(
      COMMAND "${GIT_EXECUTABLE}" rev-parse --git-path logs/HEAD
      WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}"
      OUTPUT_VARIABLE MECH9_GIT_LOG OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    get_filename_component(MECH9_GIT_LOG "${MECH9_GIT_LOG}" ABSOLUTE BASE_DIR "${PROJECT_SOURCE_DIR}")
    if(NOT EXISTS "${MECH9_GIT_LOG}")
      set(MECH9_GIT_LOG "")
    endif()
  endif()
endif()
configure_file("${PROJECT_SOURCE_DIR}/src/base/version.f90.in" "${MECH9_VERSION_FILE}" @ONLY)
