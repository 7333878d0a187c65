// SPDX-License-Identifier: MIT
#include "glint/train/masked_transparency.h"

#include "glint/render/map_kernels.h"
#include "glint/train/check_fits.h"
#include "glint/train/masked_transparency_kernels.h"
#include "glint/train/share_kernels.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 4096;  // pixels a block

// weight times the mean of f(t) over a mask, 0 for an empty one.
template <class Of, class T>
double masked_mean(
    const BasicImage<T>& t, const Image& mask, Of of, float share, T weight, BasicImage<T>& dL_dt
) {
  if (share == 0) return 0;
  Array<double> mask_sum;
  Array<T> scale;
  sum_kernel_to(t.size(), SumPixels{mask.on_device()}, mask_sum);
  share_of(mask_sum.on_device(), static_cast<T>(share) * weight, scale);
  const MaskedSumAt<T, Of> loss_at{
      t.on_device(), mask.on_device(), of, scale.on_device(), dL_dt.on_device()};
  const double sum = sum_kernel(t.size(), loss_at), count = told(mask_sum);
  return count == 0 ? 0 : static_cast<double>(share) * sum / count;
}

}  // namespace

template <class T>
double MaskedTransparencyLoss::evaluate(
    const BasicImage<T>& transparency,
    const TransparencyMasks& masks,
    const Image& image,
    MaskedTransparencyRamp ramp,
    T weight,
    BasicImage<T>& dL_dt
) {
  TransparencyPriorLoss smooth;
  smooth.entropy = smooth.sparsity = 0;
  const double smoothness = smooth.evaluate(transparency, image, weight, dL_dt);
  if (masks.transparent.empty() || masks.opaque.empty()) return smoothness;
  const ImageSize size = transparency.size();
  check_fits("transparency mask", masks.transparent, size, 1);
  check_fits("opacity mask", masks.opaque, size, 1);
  fit(labelled_, size, 1);
  run_kernel(
      size.num_pixels(),
      kGrain,
      AddMasks{masks.transparent.on_device(), masks.opaque.on_device(), labelled_.on_device()}
  );
  const HingeOfT<T> hinge{static_cast<T>(kLeastOnGlass)};
  return smoothness +
         masked_mean(transparency, labelled_, EntropyOfT<T>{}, ramp.entropy(), weight, dL_dt) +
         masked_mean(transparency, masks.opaque, ValueOfT<T>{}, ramp.opaque(), weight, dL_dt) +
         masked_mean(transparency, masks.transparent, hinge, ramp.hinge(), weight, dL_dt);
}

template double MaskedTransparencyLoss::
    evaluate(const Image&, const TransparencyMasks&, const Image&, MaskedTransparencyRamp, float, Image&);
template double MaskedTransparencyLoss::
    evaluate(const BasicImage<double>&, const TransparencyMasks&, const Image&, MaskedTransparencyRamp, double, BasicImage<double>&);

}  // namespace glint
