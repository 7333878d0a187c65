// SPDX-License-Identifier: MIT
#include "datasets/front3d/finishes.h"

#include <algorithm>
#include <utility>

#include "datasets/front3d/model_files.h"
#include "datasets/glassroom/import_model.h"
#include "datasets/glassroom/room_programs.h"
#include "glint/scene/image_files.h"

namespace glint {

namespace {

constexpr float kPicturePeriod = 1.5f;  // metres that a picture of the folder covers
constexpr Vec3f kGrey{0.5f, 0.5f, 0.5f};

Vec3f linear(Vec3f srgb) {
  Vec3f result{};
  for (int i = 0; i < 3; ++i) result[i] = std::min(srgb_decode(srgb[i]), 0.95f);
  return result;
}

}  // namespace

Finishes::Finishes(TraceScene& scene, const fs::path& textures, std::uint64_t seed)
    : scene_(scene), textures_(textures), rng_(seed, hash_name("front3d/finishes")) {
  if (!textures_.empty()) pictures_ = surface_pictures(textures_);
}

Finish Finishes::of(const std::string& kind) {
  const auto known = known_.find(kind);
  if (known != known_.end()) return known->second;
  return known_[kind] = make(kind);
}

// One of those whose name begins with the kind.
std::optional<fs::path> Finishes::picture_for(const std::string& kind) {
  std::vector<fs::path> fitting;
  for (const fs::path& picture : pictures_)
    if (picture.filename().string().starts_with(kind)) fitting.push_back(picture);
  if (fitting.empty()) return std::nullopt;
  return fitting[rng_.below(static_cast<std::uint32_t>(fitting.size()))];
}

Finish Finishes::patterned(const std::string& name, PatternSpec spec) {
  spec.seed = rng_.next_u32();
  const int texture = add_texture(scene_, make_pattern(spec));
  return {
      add_material(scene_, {.name = name, .albedo = {1, 1, 1}, .texture = texture}),
      1 / spec.period};
}

Finish Finishes::plain(Material material) { return {add_material(scene_, std::move(material)), 1}; }

int Finishes::emitter(const std::string& name, Vec3f radiance) {
  const auto known = own_.find("emitter " + name);
  if (known != own_.end()) return known->second;
  return own_["emitter " + name] =
             add_material(scene_, {.name = name, .albedo = kGrey, .emission = radiance});
}

// Patterns are those of GlassRoom's rooms, of any of them for each kind.
Finish Finishes::make(const std::string& kind) {
  const std::vector<RoomProgram>& programs = room_programs();
  const RoomProgram& program = programs[rng_.below(static_cast<std::uint32_t>(programs.size()))];
  const WallProgram& wall = program.walls[rng_.below(4)];
  if (const auto picture = picture_for(kind)) {
    const int texture = add_texture(scene_, read_reflectance(*picture));
    return {
        add_material(scene_, {.name = kind, .albedo = {1, 1, 1}, .texture = texture}),
        1 / kPicturePeriod};
  }
  if (kind == "floor") return patterned(kind, program.floor);
  if (kind == "wall") return patterned(kind, wall.finish);
  if (kind == "fabric") return patterned(kind, program.fabric);
  if (kind == "wood" || kind == "door" || kind == "baseboard") return patterned(kind, program.wood);
  if (kind == "slab") return plain({.name = kind, .albedo = kGrey});
  if (kind == "metal")
    return plain(
        {.name = kind,
         .kind = MaterialKind::kRoughConductor,
         .albedo = {0.6f, 0.6f, 0.62f},
         .roughness = 0.45f}
    );
  return plain({.name = kind, .albedo = srgb_hex(kind == "ceiling" ? 0xEEECE6 : 0xE8E2D4)});
}

std::optional<int> Finishes::own_picture(const HouseMaterial& material) {
  const auto known = own_.find("picture " + material.jid);
  if (known != own_.end()) return known->second;
  const auto picture = find_picture(textures_, material.jid);
  if (!picture) return std::nullopt;
  const int texture = add_texture(scene_, read_reflectance(*picture));
  const int made =
      add_material(scene_, {.name = material.jid, .albedo = {1, 1, 1}, .texture = texture});
  return own_["picture " + material.jid] = made;
}

int Finishes::own_color(const HouseMaterial& material) {
  const auto known = own_.find("color " + material.uid);
  if (known != own_.end()) return known->second;
  return own_["color " + material.uid] =
             add_material(scene_, {.name = "color", .albedo = linear(material.color)});
}

}  // namespace glint
