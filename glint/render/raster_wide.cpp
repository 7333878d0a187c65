// SPDX-License-Identifier: MIT
// The only file that is compiled for AVX-512 (glint/CMakeLists.txt). What it defines for the linker
// must be of Float16: a function that other files have as well could replace theirs, on processors
// that cannot run it (tests/glint/render/wide_symbols_test.sh).
#include "glint/render/raster_wide.h"

#if defined(__AVX512F__) && defined(__AVX512DQ__)
#include "glint/core/simd16.h"

namespace glint {

extern template class Array<float>;
extern template class BasicImage<float>;

namespace {

void forward(const TileContext& tile, RasterSaved& saved, RasterOutput& out) {
  with_pass_code(tile.has, [&]<class Code>() { forward_tile<Float16, Code>(tile, saved, out); });
}
void backward(
    const TileContext& tile,
    RasterSaved& saved,
    const RasterOutput& out,
    const RasterOutputGradient& dL_dout
) {
  with_pass_code(tile.has, [&]<class Code>() {
    backward_tile<Float16, Code>(tile, saved, out, dL_dout);
  });
}

}  // namespace

const WideTiles kWideTiles{forward, backward};

}  // namespace glint

#else

namespace glint {
const WideTiles kWideTiles{};
}

#endif
