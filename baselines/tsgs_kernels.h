// SPDX-License-Identifier: MIT
// Loops over pixels of baselines/tsgs.cpp.
#pragma once

#include "glint/core/kernel.h"
#include "glint/train/pixel_access.h"

namespace glint {

// `inside` where the mask says so (more than a half), else `outside`.
struct ChooseByMask {
  ImageView mask, inside, outside;  // [H][W][1], [H][W][3] twice
  float* chosen;
  GLINT_HD void operator()(std::size_t i) const {
    put3(chosen, i, get3(mask.data[i] > 0.5f ? inside.data : outside.data, i));
  }
};

// The prior of composited normals N [H][W][3] where M = [there is one and <N, prior> > min_cosine]:
// the number of such pixels, and the sum of |prior - N|_1 over them.
struct GatedNormals {
  ImageView normal, prior;
  float min_cosine;
  GLINT_HD bool counts(int x, int y) const {
    const Vec3f target = load3<float>(prior, x, y);
    return length2(target) > 0 && dot(load3<float>(normal, x, y), target) > min_cosine;
  }
};
struct CountGatedNormals {
  GatedNormals gate;
  GLINT_HD double operator()(int x, int y) const { return gate.counts(x, y) ? 1.0 : 0.0; }
};
struct GatedNormalAt {
  GatedNormals gate;
  const float* scale;
  ImageRef dL_dnormal;
  GLINT_HD double operator()(int x, int y) const {
    if (!gate.counts(x, y)) return 0.0;
    const Vec3f off = load3<float>(gate.normal, x, y) - load3<float>(gate.prior, x, y);
    add3(dL_dnormal, x, y, *scale * Vec3f{sign_of(off.x), sign_of(off.y), sign_of(off.z)});
    return static_cast<double>(l1_norm(off));
  }
};

using TsgsKernels = KernelList<ChooseByMask, CountGatedNormals, GatedNormalAt>;

}  // namespace glint
