// SPDX-License-Identifier: MIT
#include "glint/train/transparency_guidance.h"

#include "glint/core/kernel.h"
#include "glint/render/glass_transport.h"
#include "glint/train/check_fits.h"
#include "glint/train/counted_kernels.h"
#include "glint/train/masked_mean.h"
#include "glint/train/transparency_kernels.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 1024;  // pixels a block

Image eroded_and_weighed(const Image& mask, const Image& cosine) {
  Image result(mask.width(), mask.height(), 1);
  run_kernel(
      mask.num_pixels(),
      kGrain,
      ErodeAndWeigh{mask.on_device(), cosine.on_device(), result.on_device()}
  );
  return result;
}

void keep_counted(const Image& counted, Image& mask) {
  run_kernel(mask.num_pixels(), kGrain, KeepCounted{counted.on_device(), mask.on_device()});
}

template <class T>
double mean_l1(
    const BasicImage<T>& t,
    const TransparencyMasks& masks,
    T weight,
    T transparent_weight,
    BasicImage<T>& dL_dt
) {
  const auto num_pixels = static_cast<double>(t.num_pixels());
  const GuideL1<T> loss_at{
      t.on_device(),
      masks.transparent.on_device(),
      masks.opaque.on_device(),
      weight / static_cast<T>(num_pixels),
      transparent_weight,
      dL_dt.on_device()};
  return sum_kernel(t.size(), loss_at) / num_pixels;
}

}  // namespace

void TransparencyGuidance::mark_needed_depths(const Image& albedo, Image& needed) const {
  if (kind != GuidanceKind::kL1 || albedo.empty()) {
    needed = {};
    return;
  }
  fit(needed, albedo.size(), 1);
  run_kernel(
      needed.num_pixels(), kGrain, MarkLowAlbedo{albedo.on_device(), low_albedo, needed.on_device()}
  );
}

void TransparencyGuidance::label(const TransparencyCues& cues, TransparencyMasks& masks) const {
  const ImageSize size = cues.interface_depth.size();
  const bool is_bce = kind == GuidanceKind::kBce;
  if (size.num_pixels() == 0 || cues.transmission_depth.num_pixels() == 0 ||
      cues.albedo.num_pixels() == 0 || (is_bce && cues.basecolor.num_pixels() == 0)) {
    masks = {};
    return;
  }
  check_fits("depth of the transmission", cues.transmission_depth, size, 1);
  check_fits("albedo prior", cues.albedo, size, 3);
  fit(masks.transparent, size, 1);
  fit(masks.opaque, size, 1);
  label_pixels(cues, masks);
  if (cues.counted.num_pixels() > 0) {
    check_fits("mask of pixels that count", cues.counted, size, 1);
    for (Image* mask : {&masks.transparent, &masks.opaque}) keep_counted(cues.counted.get(), *mask);
  }
  if (!is_bce) return;
  masks.labelled_opaque = masks.opaque;
  masks.transparent = eroded_and_weighed(masks.transparent, cues.cosine.get());
  masks.opaque = eroded_and_weighed(masks.opaque, cues.cosine.get());
}

void TransparencyGuidance::label_pixels(const TransparencyCues& cues, TransparencyMasks& masks)
    const {
  const ImageSize size = cues.interface_depth.size();
  const LabelMaps maps{
      cues.interface_depth.on_device(),
      cues.transmission_depth.on_device(),
      cues.albedo.on_device(),
      cues.basecolor.on_device(),
      masks.transparent.on_device(),
      masks.opaque.on_device()};
  if (kind == GuidanceKind::kL1)
    return run_kernel(size.num_pixels(), kGrain, LabelL1{maps, depth_threshold, low_albedo});
  check_fits("basecolor prior", cues.basecolor, size, 3);
  if (cues.cosine.num_pixels() > 0) check_fits("viewing cosines", cues.cosine, size, 1);
  run_kernel(
      size.num_pixels(),
      kGrain,
      LabelBce{maps, depth_threshold, low_albedo, high_albedo, bright_basecolor}
  );
}

template <class T>
double TransparencyGuidance::evaluate(
    const BasicImage<T>& transparency,
    const TransparencyMasks& masks,
    T weight,
    BasicImage<T>& dL_dtransparency
) const {
  if (masks.transparent.empty()) return 0;
  check_fits("transparency mask", masks.transparent, transparency.size(), 1);
  if (kind == GuidanceKind::kL1)
    return mean_l1(
        transparency, masks, weight, static_cast<T>(transparent_weight), dL_dtransparency
    );
  check_fits("opacity mask", masks.opaque, transparency.size(), 1);
  const CrossEntropyOfT<T> high{static_cast<T>(transparent_target)},
      low{static_cast<T>(opaque_target)};
  return masked_mean(transparency, masks.transparent, high, weight, dL_dtransparency) +
         masked_mean(transparency, masks.opaque, low, weight, dL_dtransparency);
}

Image viewing_cosines(const Camera& camera, const Image& normal) {
  Image cosines(normal.width(), normal.height(), 1);
  run_kernel(
      normal.num_pixels(),
      kGrain,
      ViewingCosine{pixel_rays(camera), normal.on_device(), cosines.on_device()}
  );
  return cosines;
}

template double
TransparencyGuidance::evaluate(const Image&, const TransparencyMasks&, float, Image&) const;
template double TransparencyGuidance::
    evaluate(const BasicImage<double>&, const TransparencyMasks&, double, BasicImage<double>&)
        const;

}  // namespace glint
