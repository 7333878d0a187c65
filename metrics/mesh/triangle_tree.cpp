// SPDX-License-Identifier: MIT
#include "metrics/mesh/triangle_tree.h"

#include <embree3/rtcore.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "glint/core/error.h"
#include "metrics/mesh/triangle.h"

namespace glint {
namespace {

// Embree compares boxes with the query's radius in float; what is as near as the best face within
// that rounding must still be visited.
constexpr double kRadiusSlack = 1 + 1e-5;

struct Query {
  const TriangleMesh* mesh;
  Vec3d point;
  double best2;  // squared metres
  std::int32_t face;
};

float search_radius(const Query& query) {
  return static_cast<float>(std::sqrt(query.best2) * kRadiusSlack);
}

// True when the face is the new best: nearer, or as near and earlier.
bool offer_face(Query& query, std::int32_t face) {
  const double distance2 =
      squared_distance(query.point, corners_of(*query.mesh, static_cast<std::size_t>(face)));
  if (distance2 > query.best2 || (distance2 == query.best2 && face >= query.face)) return false;
  query.best2 = distance2;
  query.face = face;
  return true;
}

bool visit_face(RTCPointQueryFunctionArguments* arguments) {
  Query& query = *static_cast<Query*>(arguments->userPtr);
  if (!offer_face(query, static_cast<std::int32_t>(arguments->primID))) return false;
  arguments->query->radius = search_radius(query);
  return true;
}

RTCRay ray_of(Vec3f origin, Vec3f direction, float length) {
  RTCRay ray{};
  ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
  ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
  ray.tfar = length;
  ray.mask = 0xffffffff;  // Debian's Embree is built with ray masks: 0 would meet nothing
  return ray;
}

template <class T>
void copy_to_buffer(
    RTCGeometry geometry, RTCBufferType type, RTCFormat format, const std::vector<T>& values
) {
  void* to = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(T), values.size());
  GLINT_CHECK(to != nullptr, kEnvironment, "Embree: no memory for {} elements", values.size());
  std::memcpy(to, values.data(), values.size() * sizeof(T));
}

}  // namespace

struct TriangleTree::Impl {
  const TriangleMesh* mesh = nullptr;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~Impl() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }

  void add_faces() {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);  // the scene holds it
    copy_to_buffer(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh->vertices);
    copy_to_buffer(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh->faces);
    rtcCommitGeometry(geometry);
  }
};

TriangleTree::TriangleTree(const TriangleMesh& mesh) : impl_(std::make_unique<Impl>()) {
  impl_->mesh = &mesh;
  // One instruction set and one building thread: the same tree everywhere.
  impl_->device = rtcNewDevice("isa=avx2,threads=1");
  GLINT_CHECK(
      impl_->device != nullptr,
      kEnvironment,
      "Embree: no device (error {})",
      int(rtcGetDeviceError(nullptr))
  );
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);  // no ray slips between two faces
  impl_->add_faces();
  rtcCommitScene(impl_->scene);
  const RTCError error = rtcGetDeviceError(impl_->device);
  GLINT_CHECK(
      error == RTC_ERROR_NONE,
      kEnvironment,
      "Embree: a mesh of {} faces could not be built (error {})",
      mesh.faces.size(),
      int(error)
  );
}

TriangleTree::~TriangleTree() = default;

Nearest TriangleTree::nearest(Vec3f point, double max_distance, std::int32_t guess) const {
  Query query{impl_->mesh, cast<double>(point), max_distance * max_distance, -1};
  if (guess >= 0) offer_face(query, guess);
  RTCPointQuery sphere{point.x, point.y, point.z, 0, search_radius(query)};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(impl_->scene, &sphere, &context, visit_face, &query);
  return {query.face >= 0 ? std::sqrt(query.best2) : max_distance, query.face};
}

bool TriangleTree::is_blocked(Vec3f origin, Vec3f direction, float length) const {
  RTCRay ray = ray_of(origin, direction, length);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(impl_->scene, &context, &ray);
  return ray.tfar < 0;  // Embree's sign for a hit
}

RayHit TriangleTree::first_hit(Vec3f origin, Vec3f direction) const {
  RTCRayHit query{};
  query.ray = ray_of(origin, direction, std::numeric_limits<float>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(impl_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return {query.ray.tfar, static_cast<std::int32_t>(query.hit.primID)};
}

}  // namespace glint
