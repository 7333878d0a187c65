# Debian packages, installed by scripts/setup.sh. OpenCV's CMake config comes only with all of
# libopencv-dev, so its modules are found one by one.
find_package(Threads REQUIRED)
find_package(TBB 2021 REQUIRED CONFIG)
find_package(OpenEXR 3.1 REQUIRED CONFIG)
find_package(nanoflann 1.4 REQUIRED CONFIG)
find_package(CLI11 REQUIRED CONFIG)
find_package(nlohmann_json 3.11 REQUIRED CONFIG)
find_package(tomlplusplus 3.3 REQUIRED CONFIG)
find_package(fmt 9 REQUIRED CONFIG)
find_package(Eigen3 3.4 REQUIRED CONFIG)  # products of matrices (baselines/deferred/mlp.cpp), eigenvalues (glint/scene/camera_path.cpp)
if(GLINT_TESTS)
  find_package(Catch2 2.13 REQUIRED CONFIG)
endif()

# A library as an archive where there is one: a bundle carries as few shared libraries as it can. Not in the
# Python module: Debian's archives are for programs.
function(glint_link_archive target name)
  find_library(GLINT_${name} NAMES lib${name}.a ${name} REQUIRED)
  find_library(GLINT_${name}_SHARED NAMES ${name} lib${name}.a REQUIRED)
  set(in_module $<STREQUAL:$<TARGET_PROPERTY:TYPE>,MODULE_LIBRARY>)
  target_link_libraries(${target} INTERFACE $<IF:${in_module},${GLINT_${name}_SHARED},${GLINT_${name}}>)
endfunction()

find_path(GLINT_PNG_INCLUDE png.h REQUIRED)
add_library(glint_z INTERFACE)
glint_link_archive(glint_z z)
add_library(glint_png INTERFACE)
target_include_directories(glint_png SYSTEM INTERFACE ${GLINT_PNG_INCLUDE})
glint_link_archive(glint_png png)
target_link_libraries(glint_png INTERFACE glint_z)

# SHA-256.
find_path(GLINT_NETTLE_INCLUDE nettle/sha2.h REQUIRED)
add_library(glint_nettle INTERFACE)
target_include_directories(glint_nettle SYSTEM INTERFACE ${GLINT_NETTLE_INCLUDE})
glint_link_archive(glint_nettle nettle)

# Pictures: libdeflate reads PNG, libpng writes it, libjpeg-turbo, libwebp. None has a CMake config here.
set(GLINT_IMAGE_CODECS glint_png)
foreach(codec deflate:libdeflate.h turbojpeg:turbojpeg.h webp:webp/decode.h)
  string(REPLACE ":" ";" codec ${codec})
  list(GET codec 0 name)
  list(GET codec 1 header)
  find_path(GLINT_${name}_INCLUDE ${header} REQUIRED)
  add_library(glint_${name} INTERFACE)
  target_include_directories(glint_${name} SYSTEM INTERFACE ${GLINT_${name}_INCLUDE})
  glint_link_archive(glint_${name} ${name})
  list(APPEND GLINT_IMAGE_CODECS glint_${name})
endforeach()

if(GLINT_LEAN)
  set(GLINT_FMT fmt::fmt-header-only)
  return()  # libraries that need what follows are left out (glint_targets.cmake)
endif()

if(GLINT_TESTS)
  find_package(CGAL 5.5 REQUIRED CONFIG)  # what distances to meshes are compared with
endif()
find_package(embree 3.13 REQUIRED CONFIG)
find_package(OpenMP REQUIRED COMPONENTS CXX)  # only to set how many threads oneDNN uses
find_package(Bullet REQUIRED)  # module mode: the config mode has relative include folders
find_package(TIFF QUIET MODULE)  # maps of other programs; without it they are refused by name
find_package(assimp 5.2 REQUIRED CONFIG)  # models of furniture
find_package(yaml-cpp 0.7 REQUIRED CONFIG)  # cameras of EasyVolcap
find_path(GLINT_OPENCV_INCLUDE opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
foreach(module core imgproc calib3d)
  find_library(GLINT_OPENCV_${module} opencv_${module} REQUIRED)
  add_library(opencv::${module} UNKNOWN IMPORTED)
  set_target_properties(
    opencv::${module}
    PROPERTIES IMPORTED_LOCATION ${GLINT_OPENCV_${module}} INTERFACE_INCLUDE_DIRECTORIES
                                                          ${GLINT_OPENCV_INCLUDE}
  )
endforeach()

add_library(bullet INTERFACE)
target_include_directories(bullet SYSTEM INTERFACE ${BULLET_INCLUDE_DIRS})
target_link_libraries(bullet INTERFACE ${BULLET_LIBRARIES})

# oneDNN's own config wants OpenCL's headers, which its CPU engine does not need.
find_path(GLINT_onednn_INCLUDE oneapi/dnnl/dnnl.hpp REQUIRED)
find_library(GLINT_onednn dnnl REQUIRED)
add_library(onednn UNKNOWN IMPORTED)
set_target_properties(
  onednn PROPERTIES IMPORTED_LOCATION ${GLINT_onednn} INTERFACE_INCLUDE_DIRECTORIES
                                                      ${GLINT_onednn_INCLUDE}
)

# Letters and lines: pango places them, cairo draws them, as pixels and as PDF.
find_package(PkgConfig REQUIRED)
pkg_check_modules(PANGOCAIRO REQUIRED pangocairo>=1.50 cairo-pdf>=1.16)
add_library(pangocairo INTERFACE)  # not its flags: a precompiled header has to have the same
target_include_directories(pangocairo SYSTEM INTERFACE ${PANGOCAIRO_INCLUDE_DIRS})
target_link_libraries(pangocairo INTERFACE ${PANGOCAIRO_LINK_LIBRARIES})

# Web server of the viewer: headers alone.
find_path(GLINT_BOOST_INCLUDE boost/beast/websocket.hpp)
if(GLINT_BOOST_INCLUDE)
  add_library(boost_beast INTERFACE)
  target_include_directories(boost_beast SYSTEM INTERFACE ${GLINT_BOOST_INCLUDE})
  target_link_libraries(boost_beast INTERFACE Threads::Threads)
endif()

# Meshes; its config forgets to look for Eigen, which is found above.
find_package(Open3D QUIET CONFIG)

set(GLINT_FMT fmt::fmt)
