// SPDX-License-Identifier: MIT
#include "datasets/glassroom/ray_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "datasets/glassroom/path_tracer.h"
#include "datasets/glassroom/texture.h"
#include "datasets/glassroom/validate_scene.h"
#include "glint/core/error.h"

namespace glint::path_tracing {

namespace {

// Distance by which a ray's origin is moved off its surface, relative to the coordinates: some
// ulps.
constexpr float kRelativeOffset = 4e-6f;
// Share of a segment left out at each end where its ends may lie on surfaces.
constexpr float kSegmentMargin = 1e-4f;

// Embree hands the context to the filter; the standard part comes first.
struct ShadowContext {
  RTCIntersectContext base;
  const RayScene* scene;
  const Triangle* glass_triangles;
  Vec3f direction;
  Vec3f transmittance{1, 1, 1};
};

RTCRay make_ray(Vec3f origin, Vec3f direction, float t_far, RayMask mask) {
  RTCRay ray{};
  ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
  ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
  ray.tfar = t_far;
  ray.mask = static_cast<unsigned>(mask);
  return ray;
}

Triangle make_triangle(const TraceMesh& mesh, int mesh_id, int face_id) {
  const auto& face = mesh.faces[static_cast<std::size_t>(face_id)];
  const auto vertex = [&](int i) { return mesh.vertices[static_cast<std::size_t>(face[i])]; };
  const Vec3f p0 = vertex(0), edge1 = vertex(1) - p0, edge2 = vertex(2) - p0;
  const Vec3f normal = cross(edge1, edge2);
  const float norm = length(normal);
  Triangle triangle{p0, edge1, edge2, (1 / norm) * normal, 0.5f * norm, mesh_id, mesh.material};
  triangle.smooth = !mesh.normals.empty();
  for (std::size_t i = 0; i < 3; ++i) {
    const auto vertex_id = static_cast<std::size_t>(face[i]);
    if (triangle.smooth) triangle.normals[i] = mesh.normals[vertex_id];
    if (!mesh.uvs.empty()) triangle.uvs[i] = mesh.uvs[vertex_id];
  }
  return triangle;
}

bool degenerate(const Triangle& triangle) {
  return !(triangle.area > std::numeric_limits<float>::min());
}

template <class T>
T interpolate(const std::array<T, 3>& values, float u, float v) {
  return (1 - u - v) * values[0] + u * values[1] + v * values[2];
}

// `normal`: the geometric one, on the side of the ray.
Vec3f shading_normal(const Triangle& triangle, float u, float v, Vec3f normal) {
  if (!triangle.smooth) return normal;
  const Vec3f smooth = interpolate(triangle.normals, u, v);
  const float norm = length(smooth);
  if (norm < 1e-6f) return normal;  // opposite normals cancel
  return (dot(smooth, normal) < 0 ? -1 / norm : 1 / norm) * smooth;
}

}  // namespace

RayScene::RayScene(const TraceScene& scene) : scene_(scene) {
  validate_scene(scene);
  for (const Material& material : scene.materials) {
    models_.push_back(prepare_material(material));
    const auto texture = static_cast<std::size_t>(material.texture);
    textures_.push_back(material.texture < 0 ? ImageView{} : scene.textures[texture]);
  }
  add_triangles(false);
  num_opaque_ = triangles_.size();
  add_triangles(true);

  // One instruction set everywhere: its kernels decide the last bits of hits, so of the pictures.
  device_ = rtcNewDevice("isa=avx2");
  GLINT_CHECK(
      device_, kEnvironment, "Embree: no device (error {})", int(rtcGetDeviceError(nullptr))
  );
  GLINT_CHECK(
      rtcGetDeviceProperty(device_, RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED) == 1,
      kEnvironment,
      "Embree was built without EMBREE_RAY_MASK, which the path tracer needs; install libembree-dev"
  );
  bvh_ = rtcNewScene(device_);
  attach(0, num_opaque_, RayMask::kOpaque);
  attach(num_opaque_, triangles_.size() - num_opaque_, RayMask::kGlass);
  rtcCommitScene(bvh_);
  const RTCError error = rtcGetDeviceError(device_);
  GLINT_CHECK(
      error == RTC_ERROR_NONE, kEnvironment, "Embree: error {} building the BVH", int(error)
  );
}

RayScene::~RayScene() {
  rtcReleaseScene(bvh_);
  rtcReleaseDevice(device_);
}

void RayScene::add_triangles(bool glass) {
  for (std::size_t m = 0; m < scene_.meshes.size(); ++m) {
    const TraceMesh& mesh = scene_.meshes[m];
    const Material& material = scene_.materials[static_cast<std::size_t>(mesh.material)];
    if ((material.kind == MaterialKind::kThinDielectric) != glass) continue;
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
      const Triangle triangle = make_triangle(mesh, static_cast<int>(m), static_cast<int>(f));
      if (!degenerate(triangle)) triangles_.push_back(triangle);
    }
  }
}

void RayScene::attach(std::size_t first, std::size_t count, RayMask mask) {
  const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  if (count > 0) {
    auto* vertices = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), 3 * count
    ));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), count
    ));
    for (std::size_t i = 0; i < count; ++i) {
      const Triangle& triangle = triangles_[first + i];
      vertices[3 * i] = triangle.p0;
      vertices[3 * i + 1] = triangle.p0 + triangle.edge1;
      vertices[3 * i + 2] = triangle.p0 + triangle.edge2;
    }
    for (std::size_t i = 0; i < 3 * count; ++i) indices[i] = static_cast<unsigned>(i);
  }
  rtcSetGeometryMask(geometry, static_cast<unsigned>(mask));
  if (mask == RayMask::kGlass)
    rtcSetGeometryOccludedFilterFunction(geometry, &RayScene::pass_glass);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(bvh_, geometry);  // geometry 0: opaque, 1: glass
  rtcReleaseGeometry(geometry);
}

RTCRayHit RayScene::closest(Vec3f origin, Vec3f direction, RayMask mask) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{make_ray(origin, direction, std::numeric_limits<float>::infinity(), mask), {}};
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(bvh_, &context, &query);
  return query;
}

std::optional<Surface> RayScene::intersect(Vec3f origin, Vec3f direction, RayMask mask) const {
  const RTCRayHit query = closest(origin, direction, mask);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

  const std::size_t id = (query.hit.geomID == 0 ? 0 : num_opaque_) + query.hit.primID;
  const Triangle& triangle = triangles_[id];
  const float u = query.hit.u, v = query.hit.v;
  Surface surface;
  // From the barycentric coordinates: closer to the plane than origin + t direction.
  surface.position = triangle.p0 + u * triangle.edge1 + v * triangle.edge2;
  surface.normal = dot(triangle.normal, direction) > 0 ? -triangle.normal : triangle.normal;
  surface.t = query.ray.tfar;
  surface.triangle = static_cast<int>(id);
  surface.material = triangle.material;
  surface.mesh = triangle.mesh;
  surface.uv = interpolate(triangle.uvs, u, v);
  const ImageView texture = textures_[static_cast<std::size_t>(triangle.material)];
  if (texture.data != nullptr) prefetch_texture(texture, surface.uv);
  surface.shading_normal = shading_normal(triangle, u, v, surface.normal);
  if (dot(surface.shading_normal, direction) >= 0) surface.shading_normal = surface.normal;
  return surface;
}

void RayScene::pass_glass(const RTCFilterFunctionNArguments* arguments) {
  auto& context = *reinterpret_cast<ShadowContext*>(arguments->context);
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] == 0) continue;
    arguments->valid[i] = 0;  // go on behind the pane
    const Triangle& pane = context.glass_triangles[RTCHitN_primID(arguments->hit, arguments->N, i)];
    const Material& glass =
        context.scene->scene_.materials[static_cast<std::size_t>(pane.material)];
    const float cosine = std::abs(dot(pane.normal, context.direction));
    const float passed = 1 - thin_slab_reflectance(cosine, glass.ior);
    context.transmittance = hadamard(context.transmittance, passed * glass.tint);
  }
}

Vec3f RayScene::transmittance(Vec3f from, Vec3f to) const {
  const Vec3f segment = to - from;
  ShadowContext context{{}, this, triangles_.data() + num_opaque_, normalize(segment), {1, 1, 1}};
  rtcInitIntersectContext(&context.base);
  RTCRay ray = make_ray(from, segment, 1, RayMask::kAll);
  rtcOccluded1(bvh_, &context.base, &ray);
  return ray.tfar < 0 ? Vec3f{} : context.transmittance;
}

bool RayScene::occluded(Vec3f from, Vec3f to) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = make_ray(from, to - from, 1 - kSegmentMargin, RayMask::kOpaque);
  ray.tnear = kSegmentMargin;
  rtcOccluded1(bvh_, &context, &ray);
  return ray.tfar < 0;
}

Vec3f RayScene::leave(Vec3f position, Vec3f normal, Vec3f direction) {
  const Vec3f p = position;
  const float scale = std::max({1.0f, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return p + std::copysign(kRelativeOffset * scale, dot(direction, normal)) * normal;
}

Vec3f RayScene::albedo(const Surface& surface) const {
  const Material& m = material(surface);
  const ImageView texture = textures_[static_cast<std::size_t>(surface.material)];
  return texture.data == nullptr ? m.albedo
                                 : hadamard(m.albedo, sample_texture(texture, surface.uv));
}

}  // namespace glint::path_tracing
