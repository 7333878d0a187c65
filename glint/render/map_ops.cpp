// SPDX-License-Identifier: MIT
#include "glint/render/map_ops.h"

#include "glint/core/kernel.h"
#include "glint/render/depth_modes.h"
#include "glint/render/map_kernels.h"

namespace glint {

namespace {
constexpr std::size_t kPixelGrain = 4096;  // pixels a block
}

void expected_depth_map(const RasterOutput& output, Image& depth) {
  fit(depth, output.alpha.size(), 1);
  run_kernel(
      depth.num_pixels(),
      kPixelGrain,
      ExpectedDepth{output.depth_sum.on_device(), output.alpha.on_device(), depth.on_device()}
  );
}

void expected_depth_map_vjp(
    const RasterOutput& output, const Image& dL_ddepth, RasterOutputGradient& dL_doutput
) {
  run_kernel(
      dL_ddepth.num_pixels(),
      kPixelGrain,
      ExpectedDepthVjp{
          output.depth_sum.on_device(),
          output.alpha.on_device(),
          dL_ddepth.on_device(),
          dL_doutput.depth_sum.on_device(),
          dL_doutput.alpha.on_device()}
  );
}

void add_depth_estimates(const RasterOutput& output, MapSet& maps) {
  expected_depth_map(output, maps["behind_expected"]);
  maps["behind_median"] = output.depth_median;
}

void add_depth_modes(Rasterizer& rasterizer, MapSet& maps) {
  rasterizer.depth_modes(DepthModeSettings{}, maps["first_mode"], maps["last_mode"]);
  maps["alpha"] = rasterizer.output().alpha;
}

void plane_depth_map(
    const Camera& camera, const Image& distance, const Image& normal, Image& depth
) {
  fit(depth, distance.size(), 1);
  run_kernel(
      depth.num_pixels(),
      kPixelGrain,
      PlaneDepth{
          pinhole_of<float>(camera), distance.on_device(), normal.on_device(), depth.on_device()}
  );
}

void plane_depth_map_vjp(
    const Camera& camera,
    const Image& distance,
    const Image& normal,
    const Image& dL_ddepth,
    Image& dL_ddistance,
    Image& dL_dnormal
) {
  run_kernel(
      dL_ddepth.num_pixels(),
      kPixelGrain,
      PlaneDepthVjp{
          pinhole_of<float>(camera),
          distance.on_device(),
          normal.on_device(),
          dL_ddepth.on_device(),
          dL_ddistance.on_device(),
          dL_dnormal.on_device()}
  );
}

void clear_image(Image& image, ImageSize size, int channels) {
  fit(image, size, channels);
  image.array().fill(0.0f);
}

void clear_gradient(ImageSize size, int features, RasterOutputGradient& dL_doutput) {
  clear_image(dL_doutput.features, size, features);
  clear_image(dL_doutput.normal, size, 3);
  clear_image(dL_doutput.alpha, size, 1);
  clear_image(dL_doutput.depth_sum, size, 1);
}

void color_gradient(const Image& dL_dcolor, int features, RasterOutputGradient& dL_doutput) {
  clear_gradient(dL_dcolor.size(), features, dL_doutput);
  add_color(dL_dcolor, dL_doutput.features);
}

Image unit_normals(const Image& normal) {
  Image result(normal.width(), normal.height(), 3);
  run_kernel(normal.num_pixels(), kPixelGrain, UnitNormals{normal.on_device(), result.on_device()});
  return result;
}

void copy_color(const Image& features, Image& color) {
  fit(color, features.size(), 3);
  run_kernel(
      color.num_pixels(),
      kPixelGrain,
      CopyColor{features.on_device(), features.channels(), color.on_device()}
  );
}

void add_color(const Image& color, Image& features) {
  run_kernel(
      color.num_pixels(),
      kPixelGrain,
      AddColor{color.on_device(), features.channels(), features.on_device()}
  );
}

}  // namespace glint
