// SPDX-License-Identifier: MIT
// LPIPS as a training loss [Zhang18], with weights that the user has (metrics/lpips_weights.h).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "glint/method.h"
#include "glint/train/counted_pixels.h"

namespace glint {

class PerceptualLoss {
 public:
  virtual ~PerceptualLoss() = default;
  // False: images too small for the network.
  virtual bool accepts(ImageSize size) const = 0;
  // rendered: [H][W][3], as the photo. Adds weight * gradient to dL_drendered and returns the
  // unweighted loss, which is only told (NaN in a silent step). Where a pixel does not count it is
  // right.
  double evaluate(const Image& rendered, const Photo& photo, float weight, Image& dL_drendered) {
    return counted_.evaluate(rendered, photo, dL_drendered, [&](const Image& picture, Image& dL) {
      return evaluate_all(picture, photo.rgb, weight, dL);
    });
  }

 private:
  virtual double evaluate_all(
      const Image& rendered, const Image& target, float weight, Image& dL_drendered
  ) = 0;

  CountedPixels counted_;
};

// When and how much of it a method wants.
struct PerceptualConfig {
  float lambda_lpips = 0.01f;
  int lpips_from = 45000;
  bool lpips_unit_range = false;  // its network is fed [0, 1] instead of [-1, 1]

  template <class V>
  void visit(V&& v) {
    v("lambda_lpips", lambda_lpips, "weight of LPIPS");
    v("lpips_from", lpips_from, "first published iteration of LPIPS");
  }
  // Of Method::inputs().
  void add_inputs(std::vector<std::string>& inputs) const {
    if (lambda_lpips > 0) inputs.emplace_back("LPIPS weights");
  }
};

// With VGG16 where its weights are found, otherwise with AlexNet; `note` says which. Null without
// weights; `note` says so. Photos of the scene's training views, which stay where and what they are
// while there is a loss, are known when they come again. Errors (kEnvironment): weights that cannot
// be used.
std::unique_ptr<PerceptualLoss> make_perceptual_loss(
    const Scene& scene, bool unit_range, std::string& note
);

// The network that it finds on this machine, "vgg, sha256 ..."; empty: none. Looked for once in a
// process.
std::string perceptual_network();

// The loss that the config asks for, null without; where there is none, or some training view is
// too small for it, its weight becomes 0. A warning says which network it is, or why there is none,
// so that the record of the run has it.
std::unique_ptr<PerceptualLoss> wanted_perceptual_loss(
    PerceptualConfig& config,
    const Scene& scene,
    const std::string& method,
    std::vector<std::string>& warnings
);

// Adds the weighted loss to stats.terms and its gradient to dL_drendered, once its iteration has
// come. config: windows of this run; loss: may be null.
void add_perceptual(
    PerceptualLoss* loss,
    const PerceptualConfig& config,
    int iteration,
    const Image& rendered,
    const Photo& photo,
    Image& dL_drendered,
    StepStats& stats
);

}  // namespace glint
