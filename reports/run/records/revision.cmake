# Writes OUTPUT, a C++ file with the git revision of this build.
execute_process(
  COMMAND ${CMAKE_COMMAND} -E env GIT_OPTIONAL_LOCKS=0 git -C ${SOURCE_DIR} describe --always --dirty --abbrev=12
  OUTPUT_VARIABLE revision
  OUTPUT_STRIP_TRAILING_WHITESPACE
  ERROR_QUIET
  RESULT_VARIABLE failed
)
if(failed OR revision STREQUAL "")
  set(revision "unknown")
endif()
execute_process(
  COMMAND git -C ${SOURCE_DIR} log -1 --format=%ct
  OUTPUT_VARIABLE time
  OUTPUT_STRIP_TRAILING_WHITESPACE
  ERROR_QUIET
  RESULT_VARIABLE failed
)
if(failed OR NOT time MATCHES "^[0-9]+$")
  set(time 0)
endif()

set(content
    "#include \"reports/run/records/revision.h\"\n\nnamespace glint {\nconst char* git_revision() { return \"${revision}\"; }\nlong long git_time() { return ${time}; }\n}  // namespace glint\n"
)
set(previous "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} previous)
endif()
if(NOT previous STREQUAL content)
  file(WRITE ${OUTPUT} "${content}")
endif()
