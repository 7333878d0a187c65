# glint_pick_lean(list): a file x_lean.cpp stands in for x.cpp in a lean build, and is for none other.
# glint_add_library(name [OBJECT] [HEADERS core|cli|tests] SRCS ... [LINK ...]): a library folder::name with our warnings.
# glint_add_program(name SRCS ... [LINK ...]): a program in bin/.
# glint_add_test(SRC file [LABELS ...] [LINK ...]): one test program per file, named by its path.
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
target_include_directories(glint_warnings INTERFACE ${CMAKE_SOURCE_DIR})

# Headers that nearly every file reads, compiled once: the standard library, fmt and JSON (core), with
# CLI11 (programs), with Catch2 (tests). None is ours, so that no change of ours rebuilds everything.
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

function(glint_pick_lean list)
  set(sources ${${list}})
  if(GLINT_LEAN)
    foreach(source ${sources})
      if(source MATCHES "_lean\\.cpp$")
        string(REPLACE "_lean.cpp" ".cpp" replaced ${source})
        list(REMOVE_ITEM sources ${replaced})
      endif()
    endforeach()
  else()
    list(FILTER sources EXCLUDE REGEX "_lean\\.cpp$")
  endif()
  set(${list} ${sources} PARENT_SCOPE)
endfunction()

function(glint_add_library name)
  cmake_parse_arguments(ARG "OBJECT" "HEADERS" "SRCS;LINK" ${ARGN})
  if(ARG_OBJECT)
    add_library(${name} OBJECT ${ARG_SRCS})
  else()
    add_library(${name} STATIC ${ARG_SRCS})
  endif()
  target_link_libraries(${name} PUBLIC ${ARG_LINK} glint_warnings)
  if(NOT ARG_HEADERS)
    set(ARG_HEADERS core)
  endif()
  target_precompile_headers(${name} REUSE_FROM glint_headers_${ARG_HEADERS})
endfunction()

function(glint_add_program name)
  cmake_parse_arguments(ARG "" "" "SRCS;LINK" ${ARGN})
  add_executable(${name} ${ARG_SRCS})
  target_link_libraries(${name} PRIVATE ${ARG_LINK} glint_warnings)
  target_precompile_headers(${name} REUSE_FROM glint_headers_cli)
  set_property(GLOBAL APPEND PROPERTY GLINT_PROGRAMS ${name})  # target `programs` builds them all
endfunction()

# tests/a/b_test.cpp -> program test_a_b, CTest name a/b; LABELS default to "unit".
function(glint_add_test)
  cmake_parse_arguments(ARG "" "SRC" "LABELS;LINK" ${ARGN})
  string(REGEX REPLACE "_test\\.cpp$" "" path ${ARG_SRC})
  string(REPLACE "/" "_" target test_${path})
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  add_executable(${target} ${ARG_SRC})
  target_link_libraries(${target} PRIVATE ${ARG_LINK} glint_catch_main glint_warnings)
  target_precompile_headers(${target} REUSE_FROM glint_headers_tests)
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  add_test(NAME ${path} COMMAND ${target} WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
  set_tests_properties(
    ${path}
    PROPERTIES LABELS "${ARG_LABELS}"
               TIMEOUT 600
               # Not what this machine's user has there, such as weights of LPIPS.
               ENVIRONMENT "XDG_CACHE_HOME=${CMAKE_BINARY_DIR}/no_cache"
  )
endfunction()
