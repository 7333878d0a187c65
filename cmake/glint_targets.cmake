# glint_add_library(name [REGISTERS] [LIGHT] [HEADERS core|cli|tests] [UNITY files] SRCS ... [NEEDS ...] [LINK ...])
#   A static library with our warnings. NEEDS: targets that it links, and without which neither it nor what
#   needs it is built: this is how a lean build gets leaner. REGISTERS: its files register what they have
#   (glint/core/registry.h, service.h), so programs link all of them. UNITY: so many files are compiled as one.
#   LIGHT: compiled at -O1, since nothing in it is waited for.
# glint_add_program(name SRCS ... [NEEDS ...] [LINK ...]): a program in bin/.
# glint_test_program(name SRCS ... [LINK ...]) and glint_add_test(file program [LABELS ...]): tests of a folder in a
#   program, each a test of CTest.
option(GLINT_UNITY "compile several files as one where that is faster" ON)

add_library(glint_warnings INTERFACE)
target_compile_options(
  glint_warnings
  INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wall
            -Wextra
            -Wconversion
            -Wno-sign-conversion
            -Wdouble-promotion
            -Wno-psabi
            -Wno-missing-field-initializers
            # GCC 12 reports these falsely in the standard library at -O3.
            -Wno-array-bounds
            -Wno-stringop-overflow
            -Werror>
)
if(GLINT_SANITIZE)  # ... and this one with sanitizers, in std::regex
  target_compile_options(glint_warnings INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-maybe-uninitialized>)
endif()
if(CMAKE_CXX_COMPILER_ID MATCHES Clang)  # it is here to fuzz: GCC's warnings are those that count
  target_compile_options(
    glint_warnings INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-w> "SHELL:-include ${CMAKE_SOURCE_DIR}/tests/fuzz/gcc_builtins.h"
  )
endif()
target_include_directories(glint_warnings INTERFACE ${CMAKE_SOURCE_DIR})

# Headers that nearly every file reads, compiled once: the standard library, fmt and JSON (core), with
# CLI11 (command lines), with Catch2 (tests). None is ours, so that no change of ours rebuilds everything.
# CLI11 costs every file that sees it 4 s at -O3, read or precompiled: it stays in few files.
set(GLINT_HEADERS
    <algorithm> <array> <cmath> <cstdint> <cstring> <filesystem> <functional> <map> <memory> <optional> <span>
    <sstream> <string> <string_view> <vector> <fmt/format.h> <nlohmann/json.hpp>
)
set(GLINT_HEADERS_cli <CLI/CLI.hpp>)
set(GLINT_HEADERS_tests <catch2/catch.hpp>)
foreach(kind core cli tests)
  if(kind STREQUAL tests AND NOT GLINT_TESTS)
    continue()
  endif()
  file(WRITE ${CMAKE_BINARY_DIR}/headers_${kind}.cpp "")
  add_library(glint_headers_${kind} OBJECT ${CMAKE_BINARY_DIR}/headers_${kind}.cpp)
  target_link_libraries(glint_headers_${kind} PRIVATE glint_warnings ${GLINT_FMT})
  target_precompile_headers(glint_headers_${kind} PRIVATE ${GLINT_HEADERS} ${GLINT_HEADERS_${kind}})
endforeach()

# Returns from the calling function, with a word, where a target is not there.
macro(glint_return_without name)
  foreach(needed ${ARGN})
    if(NOT TARGET ${needed})
      message(STATUS "without ${name}, which needs ${needed}")
      return()
    endif()
  endforeach()
endmacro()

function(glint_add_library name)
  cmake_parse_arguments(ARG "REGISTERS;LIGHT" "HEADERS;UNITY" "SRCS;NEEDS;LINK" ${ARGN})
  glint_return_without(${name} ${ARG_NEEDS})
  set(files ${name})
  if(ARG_REGISTERS)
    set(files ${name}_files)
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE $<LINK_LIBRARY:WHOLE_ARCHIVE,${files}>)
  endif()
  add_library(${files} STATIC ${ARG_SRCS})
  target_link_libraries(${files} PUBLIC ${ARG_NEEDS} ${ARG_LINK} glint_warnings)
  if(NOT ARG_HEADERS)
    set(ARG_HEADERS core)
  endif()
  target_precompile_headers(${files} REUSE_FROM glint_headers_${ARG_HEADERS})
  if(ARG_LIGHT)
    target_compile_options(${files} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  if(ARG_UNITY AND GLINT_UNITY)
    set_target_properties(${files} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${ARG_UNITY})
  endif()
endfunction()

function(glint_add_program name)
  cmake_parse_arguments(ARG "" "" "SRCS;NEEDS;LINK" ${ARGN})
  glint_return_without(${name} ${ARG_NEEDS})
  add_executable(${name} ${ARG_SRCS})
  target_link_libraries(${name} PRIVATE ${ARG_NEEDS} ${ARG_LINK} glint_warnings)
  set_property(GLOBAL APPEND PROPERTY GLINT_PROGRAMS ${name})  # target `programs` builds them all
endfunction()

# Seconds; sanitizers make tests up to ten times slower.
set(GLINT_TEST_TIMEOUT 900)
if(GLINT_SANITIZE)
  set(GLINT_TEST_TIMEOUT 9000)
endif()

# A program of one or more tests/a/x_test.cpp, which are compiled as one.
function(glint_test_program target)
  cmake_parse_arguments(ARG "" "" "SRCS;LINK" ${ARGN})
  set(source ${ARG_SRCS})
  list(LENGTH ARG_SRCS count)
  if(count GREATER 1)
    set(source ${CMAKE_CURRENT_BINARY_DIR}/joined/${target}.cpp)
    list(JOIN ARG_SRCS "," joined)
    add_custom_command(
      OUTPUT ${source}
      COMMAND ${CMAKE_COMMAND} -DOUTPUT=${source} -DROOT=${CMAKE_SOURCE_DIR} -DTESTS=${joined} -P
              ${CMAKE_SOURCE_DIR}/cmake/join_tests.cmake
      DEPENDS ${ARG_SRCS} ${CMAKE_SOURCE_DIR}/cmake/join_tests.cmake
      COMMENT "Joining tests of ${target}"
    )
  endif()
  add_executable(${target} ${source})
  # Types of a joined file may have members of its nameless namespace: no other file sees them.
  target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
  target_link_libraries(${target} PRIVATE ${ARG_LINK} glint_test_support glint_warnings)
  target_precompile_headers(${target} REUSE_FROM glint_headers_tests)
  if(NOT target MATCHES "^test_(glint_(render|cuda|train)|support)")  # others wait for libraries, not for themselves
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
endfunction()

# tests/a/b_test.cpp -> CTest name a/b: what `program` has of that file; LABELS default to "unit".
function(glint_add_test test program)
  cmake_parse_arguments(ARG "" "" "LABELS" ${ARGN})
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  string(REGEX REPLACE "_test\\.cpp$" "" path ${test})
  get_filename_component(file ${test} NAME_WE)
  add_test(
    NAME ${path}
    COMMAND ${program} --filenames-as-tags --warn NoTests "[#${file}]~[.]"
    WORKING_DIRECTORY ${CMAKE_SOURCE_DIR}
  )
  set_tests_properties(
    ${path}
    PROPERTIES LABELS "${ARG_LABELS}"
               TIMEOUT ${GLINT_TEST_TIMEOUT}
               # Not what this machine's user has there, such as weights of LPIPS.
               ENVIRONMENT "XDG_CACHE_HOME=${CMAKE_BINARY_DIR}/no_cache"
  )
endfunction()
