// SPDX-License-Identifier: MIT
#include "datasets/front3d/house_room.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "datasets/front3d/finishes.h"
#include "datasets/front3d/model_files.h"
#include "datasets/front3d/surface_mesh.h"
#include "datasets/glassroom/fixtures.h"
#include "datasets/glassroom/import_model.h"
#include "glint/core/error.h"

namespace glint {

namespace {

// Metres.
constexpr float kLowestRoom = 2, kHighestRoom = 20;
constexpr float kOpeningReach = 0.3f;  // doors and windows of other rooms that belong here, too
constexpr float kSurfaceReach = 20;    // what lies farther away than that is left out
constexpr float kFurnitureReach = 0.5f;
constexpr float kSlab = 0.02f, kSlabAway = 0.25f, kSlabAbove = 0.05f;
constexpr float kSkyBehind = 0.03f, kSkyAround = 0.3f;
constexpr float kLightHalf = 0.5f, kLightApart = 1.2f, kLightMargin = 0.15f;
constexpr float kFlat = 0.05f;          // a rug: the container may stand on it
constexpr float kOverhead = 1.6f;       // what hangs higher is in nobody's way
constexpr float kAround = 0.05f;        // free space round furniture
constexpr float kThinnest = 0.01f;      // of a box in place of a model
constexpr double kMostSurface = 50000;  // m^2
constexpr std::size_t kMostPieces = 2000, kMostFloorTriangles = 2000;

class HouseRoomBuilder {
 public:
  HouseRoomBuilder(
      const House& house, const HouseRoom& room, const HouseRoomOptions& options, std::string where
  )
      : house_(house), its_(room), options_(options), where_(std::move(where)) {
    find_frame();
    choose_surfaces();
  }

  FurnishedRoom build() {
    FurnishedRoom result{.room = {}, .plan = make_plan(), .origin = origin_};
    room_ = &result.room;
    plan_ = &result.plan;
    Finishes finishes(result.room.scene, options_.textures, options_.seed);
    finishes_ = &finishes;
    const Bounds floor = result.plan.bounds();
    result.room.size = {floor.size().x, floor.size().y, height_};
    for (const std::size_t mesh : surfaces_) add_surface(house_.meshes[mesh]);
    add_lights();
    add_slabs();
    add_furniture(result.pieces);
    check_surface();
    for (const auto& [what, count] : counts_)
      result.notes.push_back(fmt::format("{} {}", count, what));
    return result;
  }

 private:
  // The floor's middle and height, before anything else is known.
  void find_frame() {
    Bounds floor;
    std::size_t triangles = 0;
    for (const std::size_t index : its_.meshes) {
      const HouseMesh& mesh = house_.meshes[index];
      if (mesh.kind() != "floor") continue;
      triangles += mesh.faces.size();
      for (const auto& face : mesh.faces)
        for (const std::int32_t v : face) floor.include(mesh.vertices[static_cast<std::size_t>(v)]);
    }
    GLINT_CHECK(
        triangles > 0 && triangles <= kMostFloorTriangles,
        kBadReference,
        "{}: its floor has {} triangles, expected 1 to {}; choose another room",
        where_,
        triangles,
        kMostFloorTriangles
    );
    origin_ = {floor.center().x, floor.center().y, floor.low.z};
    floor_ = {.low = floor.low - origin_, .high = floor.high - origin_};
  }

  Bounds bounds_in_room(const HouseMesh& mesh) const {
    Bounds bounds;
    for (const Vec3f vertex : mesh.vertices) bounds.include(vertex - origin_);
    return bounds;
  }

  bool touches(const HouseMesh& mesh) const {
    const Bounds bounds = bounds_in_room(mesh);
    Bounds reach = floor_.grown(kOpeningReach);
    reach.high.z = kHighestRoom;
    return !mesh.vertices.empty() && reach.overlaps(bounds);
  }

  // The room's own, and openings that other rooms share with it.
  void choose_surfaces() {
    std::set<std::size_t> chosen(its_.meshes.begin(), its_.meshes.end());
    for (std::size_t i = 0; i < house_.meshes.size(); ++i) {
      const std::string kind = house_.meshes[i].kind();
      if ((kind == "door" || kind == "window") && touches(house_.meshes[i])) chosen.insert(i);
    }
    Bounds reach = floor_.grown(kSurfaceReach);
    reach.high.z = 10 * kHighestRoom;  // so that walls in another unit are found
    float walls = 0;
    for (const std::size_t i : chosen) {
      const HouseMesh& mesh = house_.meshes[i];
      if (mesh.kind() == "slab" || mesh.faces.empty()) continue;
      const Bounds bounds = bounds_in_room(mesh);
      if (!reach.contains(bounds)) {
        ++counts_["meshes that reach farther than 20 m beyond the floor"];
        continue;
      }
      surfaces_.push_back(i);
      closed_.include(bounds.low);
      closed_.include(bounds.high);
      if (mesh.kind() == "wall" || mesh.kind() == "ceiling") walls = std::max(walls, bounds.high.z);
    }
    height_ = walls > 0 ? walls : 2.8f;
    GLINT_CHECK(
        height_ >= kLowestRoom && height_ <= kHighestRoom,
        kBadReference,
        "{}: its walls are {:.1f} m high, expected {} to {} m (the unit is the metre); choose "
        "another "
        "room",
        where_,
        height_,
        kLowestRoom,
        kHighestRoom
    );
  }

  FloorPlan make_plan() const {
    std::vector<TraceMesh> floors;
    for (const std::size_t i : its_.meshes)
      if (house_.meshes[i].kind() == "floor")
        floors.push_back(surface_mesh(house_.meshes[i], origin_));
    return FloorPlan(floors, where_);
  }

  void add(TraceMesh mesh, const std::string& name, const Finish& finish) {
    scale_uvs(mesh, finish.periods_per_metre);
    add_mesh(room_->scene, std::move(mesh), name, finish.material);
  }

  void add_surface(const HouseMesh& mesh) {
    const std::string kind = mesh.kind(), name = mesh.type.empty() ? kind : mesh.type.substr(0, 80);
    const HouseMaterial* material =
        mesh.material < 0 ? nullptr : &house_.materials[static_cast<std::size_t>(mesh.material)];
    if (kind == "window") add_sky(mesh);
    if (material != nullptr && !mesh.uvs.empty())
      if (const auto own = finishes_->own_picture(*material))
        return add(own_surface_mesh(mesh, *material, origin_), name, {*own, 1});
    TraceMesh surface = surface_mesh(mesh, origin_);
    const bool colored = material != nullptr && material->has_color && kind == "other";
    if (colored)
      add(std::move(surface), name, {finishes_->own_color(*material), 1});
    else
      add(std::move(surface), name, finishes_->of(kind));
  }

  static float distance_to(const FloorPlan::Side& side, Vec2f p) {
    const Vec2f d = p - side.start;
    const float along = std::clamp(d.x * side.along.x + d.y * side.along.y, 0.0f, side.length);
    return std::hypot(d.x - along * side.along.x, d.y - along * side.along.y);
  }

  // The side of the floor that an opening belongs to.
  const FloorPlan::Side* side_at(Vec2f p) const {
    const auto& sides = plan_->sides();
    const auto nearest = std::min_element(sides.begin(), sides.end(), [&](auto& a, auto& b) {
      return distance_to(a, p) < distance_to(b, p);
    });
    return nearest == sides.end() || distance_to(*nearest, p) > 1 ? nullptr : &*nearest;
  }

  // A glowing panel behind a window, as wide as a look through it from the side needs.
  void add_sky(const HouseMesh& window) {
    const Bounds box = bounds_in_room(window);
    const FloorPlan::Side* side = side_at({box.center().x, box.center().y});
    if (side == nullptr) return;
    Bounds local;  // along, outward, up
    for (const Vec3f vertex : window.vertices) {
      const Vec3f p = vertex - origin_;
      const Vec2f d{p.x - side->start.x, p.y - side->start.y};
      local.include(
          {d.x * side->along.x + d.y * side->along.y,
           d.x * side->outward.x + d.y * side->outward.y,
           p.z}
      );
    }
    const float away = std::max(local.high.y, 0.0f) + kSkyBehind;
    const auto at = [&](float along, float z) {
      const Vec2f p = side->start + along * side->along + away * side->outward;
      return Vec3f{p.x, p.y, z};
    };
    // In rows of other brightness, as GlassRoom's windows have them.
    const float left = local.low.x - kSkyAround, right = local.high.x + kSkyAround;
    const float row = (local.size().z + 2 * kSkyAround) / kWindowRows;
    for (std::size_t i = 0; i < kWindowRows; ++i) {
      const float low = local.low.z - kSkyAround + static_cast<float>(i) * row;
      const Vec3f corner = at(left, low);
      TraceMesh sky = quad_mesh(corner, at(right, low) - corner, {0, 0, row});
      closed_.include(bounds_of(sky).low);
      closed_.include(bounds_of(sky).high);
      const int light = finishes_->emitter(fmt::format("sky {}", i), kWindowLight[i]);
      add_mesh(room_->scene, std::move(sky), "sky", light);
    }
  }

  // The lowest thing above a square, no lower than a person.
  float ceiling_above(Vec2f p, float half) const {
    float lowest = height_;
    for (const TraceMesh& mesh : room_->scene.meshes)
      for (const float x : {-half, 0.0f, half})
        for (const float y : {-half, 0.0f, half})
          lowest = std::min(lowest, lowest_above(mesh, {p.x + x, p.y + y}, 1.9f));
    return lowest;
  }

  // The spot with room for a light that is nearest to a point.
  static const FloorPlan::Spot* spot_near(
      const std::vector<FloorPlan::Spot>& spots, Vec2f p, float clearance
  ) {
    const FloorPlan::Spot* best = nullptr;
    const auto distance = [&](const FloorPlan::Spot& spot) {
      return std::hypot(spot.place.x - p.x, spot.place.y - p.y);
    };
    for (const FloorPlan::Spot& spot : spots)
      if (spot.clearance >= clearance && (best == nullptr || distance(spot) < distance(*best)))
        best = &spot;
    return best;
  }

  // Two by two over the floor's box, where it has floor; smaller ones in a narrow room.
  void add_lights() {
    const std::vector<FloorPlan::Spot> spots = plan_->free_spots();
    const auto widest = std::max_element(spots.begin(), spots.end(), [](auto& a, auto& b) {
      return a.clearance < b.clearance;
    });
    if (widest == spots.end()) return;
    const float half = std::min(kLightHalf, 0.7f * widest->clearance);
    std::vector<Vec2f> placed;
    for (const float x : {-0.25f, 0.25f})
      for (const float y : {-0.25f, 0.25f}) {
        const Vec2f wish{x * room_->size.x, y * room_->size.y};
        const FloorPlan::Spot* spot = spot_near(spots, wish, half + kLightMargin);
        const Vec2f place = spot != nullptr ? spot->place : widest->place;
        const bool crowded = std::any_of(placed.begin(), placed.end(), [&](Vec2f other) {
          return std::hypot(other.x - place.x, other.y - place.y) < kLightApart;
        });
        if (crowded) continue;
        placed.push_back(place);
        add_light(place, half);
      }
  }

  void add_light(Vec2f place, float half) {
    Palette palette;
    palette.metal = finishes_->of("metal");
    FixturePalette fixtures;
    fixtures.ceiling_light = finishes_->emitter("ceiling light", kCeilingLight);
    const float z = ceiling_above(place, half + kLightMargin);
    for (FurniturePart& part : make_ceiling_light(palette, fixtures, half)) {
      transform(part.mesh, translated({place.x, place.y, z - 0.001f}));
      add_mesh(room_->scene, std::move(part.mesh), "ceiling light", part.material);
    }
  }

  // Six slabs round all that was kept.
  void add_slabs() {
    Bounds inner = closed_.grown(kSlabAway);
    inner.low.z = closed_.low.z - kSlabAbove;
    inner.high.z = std::max(closed_.high.z, height_) + kSlabAbove;
    const Bounds outer = inner.grown(kSlab);
    for (int axis = 0; axis < 3; ++axis)
      for (const bool high : {false, true}) {
        Bounds slab = outer;
        (high ? slab.low : slab.high)[axis] = high ? inner.high[axis] : inner.low[axis];
        add(box_mesh(slab.low, slab.high), "slab", finishes_->of("slab"));
      }
  }

  void add_furniture(std::vector<HousePiece>& pieces) {
    GLINT_CHECK(
        its_.furniture.size() <= kMostPieces,
        kBadReference,
        "{}: has {} pieces of furniture, expected at most {}",
        where_,
        its_.furniture.size(),
        kMostPieces
    );
    for (const HousePlacement& placement : its_.furniture)
      if (auto piece = add_piece(placement)) pieces.push_back(std::move(*piece));
  }

  // A model in its own frame, z up; imported once, however often it stands there.
  const Furniture* model_of(const HouseFurniture& source) {
    const auto known = models_.find(source.jid);
    if (known != models_.end()) return &known->second;
    const auto files = find_model(options_.models, source.jid);
    if (!files) return nullptr;
    Furniture model = import_model(files->model, room_->scene, files->texture);
    for (FurniturePart& part : model) {
      for (Vec3f& vertex : part.mesh.vertices) vertex = with_z_up(vertex);
      for (Vec3f& normal : part.mesh.normals) normal = with_z_up(normal);
    }
    return &(models_[source.jid] = std::move(model));
  }

  static bool is_soft(std::string category) {
    for (char& c : category) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    for (const char* word : {"sofa", "bed", "chair", "stool", "cushion", "rug", "carpet"})
      if (category.find(word) != std::string::npos) return true;
    return false;
  }

  std::optional<Furniture> box_of(const HouseFurniture& source) {
    if (!source.box) return std::nullopt;
    auto [low, high] = *source.box;
    for (int i = 0; i < 3; ++i) high[i] = std::max(high[i], low[i] + kThinnest);
    const Finish finish = finishes_->of(is_soft(source.category) ? "fabric" : "wood");
    TraceMesh box = box_mesh(low, high);
    scale_uvs(box, finish.periods_per_metre);
    return Furniture{{std::move(box), finish.material}};
  }

  static void place(Furniture& furniture, const HousePiece& piece) {
    const Vec3f inverse{1 / piece.scale.x, 1 / piece.scale.y, 1 / piece.scale.z};
    for (FurniturePart& part : furniture) {
      for (Vec3f& vertex : part.mesh.vertices) vertex = hadamard(piece.scale, vertex);
      for (Vec3f& normal : part.mesh.normals) normal = normalize(hadamard(inverse, normal));
      transform(part.mesh, piece.pose);
    }
  }

  // None: nothing is known of its shape, or it does not stand in the room.
  std::optional<HousePiece> add_piece(const HousePlacement& placement) {
    const HouseFurniture& source = house_.furniture[placement.furniture];
    const Furniture* model = model_of(source);
    const std::optional<Furniture> shape = model != nullptr ? *model : box_of(source);
    if (!shape) {
      ++counts_["pieces of furniture with neither a model nor a size"];
      return std::nullopt;
    }
    HousePiece piece{
        .category = source.category.substr(0, 80),
        .jid = source.jid.substr(0, 200),
        .has_model = model != nullptr,
        .pose = {placement.rotation, placement.translation - origin_},
        .scale = placement.scale};
    Furniture placed = *shape;
    place(placed, piece);
    piece.bounds = bounds_of(placed);
    Bounds reach = floor_.grown(kFurnitureReach);
    reach.high.z = height_ + kFurnitureReach;
    if (!reach.contains(piece.bounds)) {
      ++counts_["pieces of furniture that do not stand in the room"];
      return std::nullopt;
    }
    for (FurniturePart& part : placed)
      add_mesh(room_->scene, std::move(part.mesh), piece.category, part.material);
    room_->items.push_back({piece.category, -1, piece.bounds});
    take_floor(piece, bounds_of(*shape));
    return piece;
  }

  // `local`: of the model before it is scaled.
  void take_floor(const HousePiece& piece, const Bounds& local) {
    if (piece.bounds.high.z <= kFlat || piece.bounds.low.z >= kOverhead) return;
    const bool upright = piece.pose.rotation.rows[2].z > 0.99f;
    const Bounds scaled{
        .low = hadamard(piece.scale, local.low), .high = hadamard(piece.scale, local.high)};
    if (upright)
      plan_->block(scaled, piece.pose, kAround);
    else
      plan_->block(piece.bounds, {}, kAround);
  }

  // True meshes are cut into pieces of a decimetre.
  void check_surface() const {
    double area = 0;
    for (const TraceMesh& mesh : room_->scene.meshes) area += area_of(mesh);
    GLINT_CHECK(
        area <= kMostSurface,
        kBadReference,
        "{}: its surfaces are {:.0f} m^2, expected at most {} m^2; choose another room",
        where_,
        area,
        kMostSurface
    );
  }

  const House& house_;
  const HouseRoom& its_;
  const HouseRoomOptions& options_;
  std::string where_;
  Vec3f origin_{};
  Bounds floor_, closed_;  // of the floor; of all that is kept
  float height_ = 0;
  std::vector<std::size_t> surfaces_;
  RoomModel* room_ = nullptr;
  FloorPlan* plan_ = nullptr;
  Finishes* finishes_ = nullptr;
  std::map<std::string, Furniture> models_;  // by jid
  std::map<std::string, std::size_t> counts_;
};

}  // namespace

FurnishedRoom furnish_house_room(
    const House& house,
    const HouseRoom& room,
    const HouseRoomOptions& options,
    const std::string& where
) {
  return HouseRoomBuilder(house, room, options, where).build();
}

}  // namespace glint
