# Compiler settings that hold for the whole project.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

# One instruction set for the whole project, but for one file that is chosen at run time
# (glint/render/raster_wide.cpp): AVX2 + FMA. No contraction: forward and backward passes must round alike. No -ffast-math.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-march=x86-64-v3>)
endif()
add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off> $<$<COMPILE_LANGUAGE:CXX>:-fno-math-errno>
                    $<$<COMPILE_LANGUAGE:CXX>:-fno-trapping-math>)

# Objects are found again from other folders too (base_dir), and with precompiled headers (sloppiness).
find_program(GLINT_CCACHE ccache)
if(GLINT_CCACHE)
  set(launcher ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_NOHASHDIR=1
               CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} ${GLINT_CCACHE}
  )
  set(CMAKE_CXX_COMPILER_LAUNCHER ${launcher})
  set(CMAKE_CUDA_COMPILER_LAUNCHER ${launcher})
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)
endif()

# __FILE__ from the root of the sources (glint/core/registry.h).
add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fmacro-prefix-map=${CMAKE_SOURCE_DIR}/=>)

add_link_options(-Wl,--as-needed)  # programs start with the libraries that they call

if(GLINT_SANITIZE)
  # A report ends the program: a test cannot pass after one.
  add_compile_options(-fsanitize=${GLINT_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=${GLINT_SANITIZE})
  if(GLINT_SANITIZE MATCHES thread)
    add_compile_definitions(GLINT_STD_THREADS)  # TSan does not understand TBB
  endif()
endif()

# CUDA is detected, never required. CMake 3.25 does not know nvcc's C++20 flag: two lines.
set(GLINT_HAS_CUDA OFF)
if(NOT GLINT_CUDA STREQUAL "OFF")
  if(NOT DEFINED CMAKE_CUDA_COMPILER AND EXISTS /usr/local/cuda/bin/nvcc)
    set(CMAKE_CUDA_COMPILER /usr/local/cuda/bin/nvcc)
  endif()
  include(CheckLanguage)
  check_language(CUDA)
  if(CMAKE_CUDA_COMPILER)
    if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
      set(CMAKE_CUDA_ARCHITECTURES 80)  # and PTX, which newer ones compile when they first run
    endif()
    enable_language(CUDA)
    set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION "-std=c++20")
    set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION "-std=c++20")
    set(CMAKE_CUDA_STANDARD 20)
    set(CMAKE_CUDA_RUNTIME_LIBRARY Static)
    set(GLINT_HAS_CUDA ON)
    if(NOT GLINT_CUDA_FMAD)
      add_compile_options($<$<COMPILE_LANGUAGE:CUDA>:-fmad=false>)
    endif()
  elseif(GLINT_CUDA STREQUAL "ON")
    message(FATAL_ERROR "GLINT_CUDA=ON, but no CUDA compiler was found; set CMAKE_CUDA_COMPILER")
  endif()
endif()
message(STATUS "CUDA: ${GLINT_HAS_CUDA}")
