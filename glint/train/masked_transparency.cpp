// SPDX-License-Identifier: MIT
#include "glint/train/masked_transparency.h"

#include "glint/train/check_fits.h"
#include "glint/train/masked_mean.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 4096;  // pixels a block

// A mean over a mask as a share of the loss; none where that is 0.
template <class Of, class T>
double part(
    const BasicImage<T>& t, const Image& mask, Of of, float share, T weight, BasicImage<T>& dL_dt
) {
  if (share == 0) return 0;
  return static_cast<double>(share) *
         masked_mean(t, mask, of, static_cast<T>(share) * weight, dL_dt);
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
         part(transparency, labelled_, EntropyOfT<T>{}, ramp.entropy(), weight, dL_dt) +
         part(transparency, masks.opaque, ValueOfT<T>{}, ramp.opaque(), weight, dL_dt) +
         part(transparency, masks.transparent, hinge, ramp.hinge(), weight, dL_dt);
}

template double MaskedTransparencyLoss::
    evaluate(const Image&, const TransparencyMasks&, const Image&, MaskedTransparencyRamp, float, Image&);
template double MaskedTransparencyLoss::
    evaluate(const BasicImage<double>&, const TransparencyMasks&, const Image&, MaskedTransparencyRamp, double, BasicImage<double>&);

}  // namespace glint
