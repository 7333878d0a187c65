// SPDX-License-Identifier: MIT
#include "datasets/front3d/front3d_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "glint/core/error.h"
#include "glint/core/rng.h"

namespace glint {

namespace {

// Metres.
constexpr float kSmallestClearance = 0.45f;  // of a place for the smallest container
constexpr float kGap = 0.05f;                // between the container and what stands about
constexpr float kHeadroom = 0.5f;            // above it
constexpr float kSmallestScale = 0.5f;       // of GlassRoom's containers
constexpr float kGoodShare = 0.75f;          // of the largest clearance that a place needs
constexpr float kFlat = 0.05f;
constexpr double kFromContainer = 0.5, kPathWidth = 1.2;
// In a house the container stands wherever there is room, and cameras where they can.
constexpr double kMinGlass = 0.08, kMaxGlass = 0.5;

// Half of the footprint's diagonal: no turn of the container needs more.
float half_diagonal(const ContainerShape& shape) {
  return 0.5f * std::hypot(shape.size.x, shape.size.y);
}

std::vector<FloorPlan::Spot> good_spots(const FloorPlan& plan, const std::string& where) {
  std::vector<FloorPlan::Spot> spots = plan.free_spots();
  float largest = 0;
  for (const FloorPlan::Spot& spot : spots) largest = std::max(largest, spot.clearance);
  GLINT_CHECK(
      largest >= kSmallestClearance,
      kBadReference,
      "{}: the largest free spot of its floor has a radius of {:.2f} m, the smallest glass "
      "container "
      "needs {} m; choose another room",
      where,
      largest,
      kSmallestClearance
  );
  std::erase_if(spots, [&](const FloorPlan::Spot& spot) {
    return spot.clearance < std::max(kSmallestClearance, kGoodShare * largest);
  });
  return spots;
}

// The top of the rugs under a circle.
float support_at(const std::vector<HousePiece>& pieces, const FloorPlan::Spot& spot) {
  float top = 0;
  for (const HousePiece& piece : pieces) {
    const Bounds reach = piece.bounds.grown(spot.clearance);
    const bool under = spot.place.x > reach.low.x && spot.place.x < reach.high.x &&
                       spot.place.y > reach.low.y && spot.place.y < reach.high.y;
    if (under && piece.bounds.high.z <= kFlat) top = std::max(top, piece.bounds.high.z);
  }
  return top;
}

// GlassRoom's, smaller where the place asks for it.
ContainerShape fitting_container(float clearance, float height, Rng& rng) {
  ContainerShape shape = random_container(rng);
  const float fit =
      std::min((clearance - kGap) / half_diagonal(shape), (height - kHeadroom) / shape.size.z);
  const float scale = std::max(kSmallestScale, std::min(1.0f, fit) * rng.uniform(0.85f, 1.0f));
  GLINT_CHECK(scale <= fit, kEnvironment, "the container does not fit at its place");
  shape.size = scale * shape.size;
  return shape;
}

}  // namespace

ChosenRoom choose_front3d_room(const Front3dOptions& options) {
  GLINT_CHECK(
      !options.house.empty(), kUsage, "front3d: no house; give --house FILE.json of 3D-FRONT"
  );
  ChosenRoom chosen{.house = read_house(options.house), .room = {}, .where = {}};
  chosen.room = choose_room(chosen.house, options.room, options.house);
  chosen.where = fmt::format("{}: room '{}'", options.house, chosen.room.instanceid.substr(0, 80));
  return chosen;
}

std::uint64_t front3d_render_seed(const ChosenRoom& chosen, const Front3dOptions& options) {
  return options.seed + hash_name(chosen.house.sha256 + chosen.room.instanceid);
}

FurnishedRoom furnish_front3d_room(const ChosenRoom& chosen, const Front3dOptions& options) {
  const HouseRoomOptions looks{options.models, options.textures, options.seed};
  return furnish_house_room(chosen.house, chosen.room, looks, chosen.where);
}

std::unique_ptr<GlassRoomScene> build_front3d_scene(
    const FurnishedRoom& furnished, const ChosenRoom& chosen, const Front3dOptions& options
) {
  const ShotOptions shots = shots_of(options);
  check_shots(shots, "front3d");
  const std::vector<FloorPlan::Spot> spots = good_spots(furnished.plan, chosen.where);
  FloorPlan::Spot spot;
  const auto room = [&](std::uint64_t seed) {
    Rng rng(seed, hash_name("front3d/place"));
    spot = spots[rng.below(static_cast<std::uint32_t>(spots.size()))];
    RoomModel model = furnished.room;
    model.container_place = spot.place;
    model.support_height = support_at(furnished.pieces, spot);
    model.yaw_range = std::numbers::pi_v<float>;
    return model;
  };
  const auto path = [&](const RoomModel& model, const ContainerShape& shape) {
    CameraPathOptions cameras;
    cameras.min_radius = static_cast<double>(half_diagonal(shape)) + kFromContainer;
    cameras.max_radius = cameras.min_radius + kPathWidth;
    cameras.high_height = std::min(cameras.high_height, static_cast<double>(model.size.z) - 0.5);
    cameras.above_floor = [&](Vec2d p) {
      return furnished.plan.is_floor({static_cast<float>(p.x), static_cast<float>(p.y)});
    };
    return cameras;
  };
  const LayoutRecipe recipe{
      .generator = "front3d",
      .name = chosen.room.instanceid,
      .room = room,
      .container =
          [&](const RoomModel& model, Rng& rng) {
            return fitting_container(spot.clearance, model.size.z - model.support_height, rng);
          },
      .path = path,
      .min_glass = kMinGlass,
      .max_glass = kMaxGlass,
      .seed = options.seed};
  return build_layout(recipe, shots);
}

}  // namespace glint
