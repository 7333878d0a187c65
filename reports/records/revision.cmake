# Writes OUTPUT, a C++ file with what identifies this build's code: the git revision, and a hash of
# the sources that results depend on (so that a change of a table's layout does not call for new
# training runs).
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

set(hashes "")
foreach(folder glint baselines metrics)
  file(GLOB_RECURSE sources LIST_DIRECTORIES false ${SOURCE_DIR}/${folder}/*.h
       ${SOURCE_DIR}/${folder}/*.cpp ${SOURCE_DIR}/${folder}/*.cu)
  foreach(source ${sources})
    file(SHA256 ${source} hash)
    string(APPEND hashes ${hash})
  endforeach()
endforeach()
string(SHA256 hash "${hashes}")
string(SUBSTRING ${hash} 0 16 hash)

set(content
    "#include \"reports/records/revision.h\"\n\nnamespace glint {\nconst char* git_revision() { return \"${revision}\"; }\nconst char* source_hash() { return \"${hash}\"; }\n}  // namespace glint\n"
)
set(previous "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} previous)
endif()
if(NOT previous STREQUAL content)
  file(WRITE ${OUTPUT} "${content}")
endif()
