// SPDX-License-Identifier: MIT
#include "glint/render/trace_bvh.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "glint/core/error.h"
#include "glint/core/parallel.h"

namespace glint {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// What a callback needs beside Embree's own arguments.
struct Context {
  RTCIntersectContext embree;
  const SurfelCluster* clusters;
  Vec3<Float8> origin, direction;
  NearestHits* hits;
  std::size_t looked_at = 0;
};

// Tells Embree where to stop looking, if anywhere; ties with the last place still have to be seen.
bool shorten(RTCRay& ray, const NearestHits& hits) {
  if (hits.last_t() == NearestHits::kFarthest) return false;
  ray.tfar = std::bit_cast<float>(std::bit_cast<std::uint32_t>(hits.last_t()) + 1);
  return true;
}

void intersect_cluster(const RTCIntersectFunctionNArguments* args) {
  if (args->valid[0] == 0) return;
  auto& context = *reinterpret_cast<Context*>(args->context);
  ++context.looked_at;
  const SurfelCluster& cluster = context.clusters[args->primID];
  offer(cluster.load(args->primID), context.origin, context.direction, *context.hits);
  shorten(reinterpret_cast<RTCRayHit*>(args->rayhit)->ray, *context.hits);
}

void cluster_bounds(const RTCBoundsFunctionArguments* args) {
  const auto& surfels = *static_cast<const std::vector<TracedSurfel>*>(args->geometryUserPtr);
  const auto [low, high] = box_of_cluster(surfels, args->primID);
  *args->bounds_o = {low.x, low.y, low.z, 0, high.x, high.y, high.z, 0};
}

}  // namespace

struct SurfelBvh::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  RTCGeometry geometry = nullptr;
  const std::vector<TracedSurfel>* surfels = nullptr;
  std::vector<SurfelCluster> clusters;
  std::size_t count = 0;

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
  void add_discs() {
    geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(clusters.size()));
    rtcSetGeometryUserData(geometry, const_cast<std::vector<TracedSurfel>*>(surfels));
    rtcSetGeometryBoundsFunction(geometry, cluster_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect_cluster);
  }
  void rebuild() {
    release_scene();
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC);
    add_discs();
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);  // the scene keeps it
    rtcCommitScene(scene);
    check("building the tree");
  }
  void refit() {
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
    rtcSetGeometryUserData(geometry, const_cast<std::vector<TracedSurfel>*>(surfels));
    rtcCommitGeometry(geometry);
    rtcCommitScene(scene);
    check("refitting the tree");
  }
};

SurfelBvh::SurfelBvh() : impl_(std::make_unique<Impl>()) {
  // One instruction set everywhere: which boxes a ray visits must not depend on the machine.
#if defined(GLINT_STD_THREADS)  // Embree's threads are TBB's, too
  impl_->device = rtcNewDevice("isa=avx2,threads=1");
#else
  impl_->device = rtcNewDevice("isa=avx2");
#endif
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

void SurfelBvh::update(const std::vector<TracedSurfel>& surfels, bool refit) {
  const bool same = impl_->scene != nullptr && impl_->count == surfels.size();
  impl_->surfels = &surfels;
  impl_->count = surfels.size();
  make_clusters(surfels, impl_->clusters);
  if (same && refit)
    impl_->refit();
  else
    impl_->rebuild();
}

std::span<const SurfelCluster> SurfelBvh::clusters() const { return impl_->clusters; }

std::size_t SurfelBvh::nearest(Vec3f origin, Vec3f direction, NearestHits& hits) const {
  Context context;
  rtcInitIntersectContext(&context.embree);
  context.clusters = impl_->clusters.data();
  context.origin = all_lanes(origin);
  context.direction = all_lanes(direction);
  context.hits = &hits;
  RTCRayHit ray{};
  ray.ray.org_x = origin.x;
  ray.ray.org_y = origin.y;
  ray.ray.org_z = origin.z;
  ray.ray.dir_x = direction.x;
  ray.ray.dir_y = direction.y;
  ray.ray.dir_z = direction.z;
  // Boxes are tested a little before the last hit: theirs and ours round differently.
  ray.ray.tnear = (1 - kBoxMargin) * hits.after_t();
  ray.ray.tfar = kInfinity;
  ray.ray.mask = ~0u;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->scene, &context.embree, &ray);
  return context.looked_at;
}

}  // namespace glint
