// SPDX-License-Identifier: MIT
#include "glint/render/trace_bvh.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "glint/core/error.h"

namespace glint {

namespace {

constexpr int kRebuildInterval = 16;  // updates; bounds of a refitted tree loosen as surfels move
constexpr float kMargin = 1e-4f;      // of the extent: rounding of bounds and of Embree's box tests
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// What a callback needs beside Embree's own arguments.
struct Context {
  RTCIntersectContext embree;
  const std::vector<TracedSurfel>* surfels;
  Vec3f origin, direction;
  NearestHits* hits;
};

// Offers a surfel to the list. Returns the ray parameter beyond which nothing is of interest.
float offer(Context& context, std::uint32_t surfel, float t_far) {
  const TracedSurfel& s = (*context.surfels)[surfel];
  const PlaneHit<float> hit = meet(s, context.origin, context.direction);
  const float rho = fma_of(hit.u, hit.u, hit.v * hit.v);
  const HitKey key{hit.t, surfel};
  if (!(rho <= s.max_rho) || !(hit.t < kInfinity) || !(context.hits->after < key)) return t_far;
  if (!context.hits->insert(key)) return t_far;
  // Ties with the last place still have to be seen.
  return std::nextafter(context.hits->hits[NearestHits::kCapacity - 1].t, kInfinity);
}

void intersect_surfel(const RTCIntersectFunctionNArguments* args) {
  if (args->valid[0] == 0) return;
  auto& ray = *reinterpret_cast<RTCRayHit*>(args->rayhit);
  ray.ray.tfar = offer(*reinterpret_cast<Context*>(args->context), args->primID, ray.ray.tfar);
}

// Rejects every triangle hit after having looked at its surfel; a hit is accepted only to shorten
// the ray, which is the one way to do so.
void filter_triangle(const RTCFilterFunctionNArguments* args) {
  auto& ray = *reinterpret_cast<RTCRay*>(args->ray);
  const auto& hit = *reinterpret_cast<RTCHit*>(args->hit);
  const float t_far = offer(*reinterpret_cast<Context*>(args->context), hit.primID / 2, kInfinity);
  if (t_far < kInfinity)
    ray.tfar = t_far;
  else
    args->valid[0] = 0;
}

float reach(const TracedSurfel& s, int axis) {
  return std::sqrt(std::max(s.max_rho, 0.0f) * (s.h0[axis] * s.h0[axis] + s.h1[axis] * s.h1[axis]));
}

bool is_finite(const TracedSurfel& s) {
  const Vec3f sum = s.mean + s.h0 + s.h1;
  return std::isfinite(sum.x + sum.y + sum.z) && s.max_rho > 0;
}

// The box of a surfel's disc; inverted (skipped by Embree) where it counts nowhere.
void surfel_bounds(const RTCBoundsFunctionArguments* args) {
  const auto& surfels = *static_cast<const std::vector<TracedSurfel>*>(args->geometryUserPtr);
  const TracedSurfel& s = surfels[args->primID];
  float low[3], high[3];
  for (int axis = 0; axis < 3; ++axis) {
    const float half = reach(s, axis) * (1 + kMargin) + kMargin * std::abs(s.mean[axis]) * 0.01f;
    low[axis] = is_finite(s) ? s.mean[axis] - half : kInfinity;
    high[axis] = is_finite(s) ? s.mean[axis] + half : -kInfinity;
  }
  *args->bounds_o = {low[0], low[1], low[2], 0, high[0], high[1], high[2], 0};
}

// Corners of a quad at the surfel's reach along both axes, in the order (-,+), (-,-), (+,+), (+,-).
void write_quad(const TracedSurfel& s, float* corners) {
  const float k = is_finite(s) ? std::sqrt(s.max_rho) * (1 + kMargin) : 0.0f;
  const float signs[4][2] = {{-1, 1}, {-1, -1}, {1, 1}, {1, -1}};
  for (int i = 0; i < 4; ++i)
    for (int axis = 0; axis < 3; ++axis)
      corners[3 * i + axis] =
          is_finite(s) ? s.mean[axis] + k * (signs[i][0] * s.h0[axis] + signs[i][1] * s.h1[axis])
                       : std::numeric_limits<float>::quiet_NaN();  // Embree skips such triangles
}

}  // namespace

bool NearestHits::insert(HitKey hit) {
  if (full() && !(hit < hits[kCapacity - 1])) return false;
  int place = full() ? kCapacity - 1 : count;
  while (place > 0 && hit < hits[place - 1]) --place;
  if (place > 0 && hits[place - 1] == hit) return false;  // the second triangle of a quad
  for (int i = std::min(count, kCapacity - 1); i > place; --i) hits[i] = hits[i - 1];
  hits[place] = hit;
  count = std::min(count + 1, kCapacity);
  return full();
}

struct SurfelBvh::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  RTCGeometry geometry = nullptr;
  const std::vector<TracedSurfel>* surfels = nullptr;
  std::size_t count = 0;
  bool triangles = false;
  int updates = 0;

  void check(const char* what) const {
    const RTCError error = rtcGetDeviceError(device);
    GLINT_CHECK(
        error == RTC_ERROR_NONE, kEnvironment, "Embree: {} failed (error {})", what, int(error)
    );
  }
  void release_scene() {
    if (scene != nullptr) rtcReleaseScene(scene);
    scene = nullptr;
  }
  void write_corners() const {
    auto* corners =
        static_cast<float*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0));
    for (std::size_t i = 0; i < count; ++i) write_quad((*surfels)[i], corners + 12 * i);
  }
  void add_triangles() {
    geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 4 * count
    );
    auto* faces = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), 2 * count
    ));
    for (unsigned i = 0; i < count; ++i)
      for (unsigned j = 0; j < 6; ++j) faces[6 * i + j] = 4 * i + (j < 3 ? j : j - 2);
    write_corners();
    rtcSetGeometryIntersectFilterFunction(geometry, filter_triangle);
  }
  void add_discs() {
    geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(count));
    rtcSetGeometryUserData(geometry, const_cast<std::vector<TracedSurfel>*>(surfels));
    rtcSetGeometryBoundsFunction(geometry, surfel_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect_surfel);
  }
  void rebuild() {
    release_scene();
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC);
    if (triangles)
      add_triangles();
    else
      add_discs();
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);  // the scene keeps it
    rtcCommitScene(scene);
    check("building the tree");
    updates = 0;
  }
  void refit() {
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
    if (triangles) {
      write_corners();
      rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
    } else {
      rtcSetGeometryUserData(geometry, const_cast<std::vector<TracedSurfel>*>(surfels));
    }
    rtcCommitGeometry(geometry);
    rtcCommitScene(scene);
    check("refitting the tree");
  }
};

SurfelBvh::SurfelBvh() : impl_(std::make_unique<Impl>()) {
  // One instruction set everywhere: which boxes a ray visits must not depend on the machine.
  impl_->device = rtcNewDevice("isa=avx2");
  GLINT_CHECK(
      impl_->device != nullptr,
      kEnvironment,
      "Embree: no device (error {})",
      int(rtcGetDeviceError(nullptr))
  );
}
SurfelBvh::~SurfelBvh() {
  impl_->release_scene();
  rtcReleaseDevice(impl_->device);
}

void SurfelBvh::update(const std::vector<TracedSurfel>& surfels, bool triangles) {
  const bool same =
      impl_->scene != nullptr && impl_->count == surfels.size() && impl_->triangles == triangles;
  impl_->surfels = &surfels;
  impl_->count = surfels.size();
  impl_->triangles = triangles;
  if (same && ++impl_->updates % kRebuildInterval != 0)
    impl_->refit();
  else
    impl_->rebuild();
}

void SurfelBvh::nearest(Vec3f origin, Vec3f direction, NearestHits& hits) const {
  Context context;
  rtcInitIntersectContext(&context.embree);
  context.surfels = impl_->surfels;
  context.origin = origin;
  context.direction = direction;
  context.hits = &hits;
  hits.count = 0;
  RTCRayHit ray{};
  ray.ray.org_x = origin.x;
  ray.ray.org_y = origin.y;
  ray.ray.org_z = origin.z;
  ray.ray.dir_x = direction.x;
  ray.ray.dir_y = direction.y;
  ray.ray.dir_z = direction.z;
  // Boxes are tested a little before the last hit: theirs and ours round differently.
  ray.ray.tnear = std::max(0.0f, hits.after.t - kMargin * std::abs(hits.after.t));
  ray.ray.tfar = kInfinity;
  ray.ray.mask = ~0u;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->scene, &context.embree, &ray);
}

}  // namespace glint
