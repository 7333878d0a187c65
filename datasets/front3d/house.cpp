// SPDX-License-Identifier: MIT
#include "datasets/front3d/house.h"

#include <algorithm>
#include <cmath>

#include "glint/core/error.h"
#include "glint/core/nearest.h"

namespace glint {

namespace {

double horizontal_area(const HouseMesh& mesh) {
  double sum = 0;
  for (const auto& face : mesh.faces) {
    const auto at = [&](std::size_t k) {
      return cast<double>(mesh.vertices[static_cast<std::size_t>(face[k])]);
    };
    sum += 0.5 * std::abs(cross(at(1) - at(0), at(2) - at(0)).z);
  }
  return sum;
}

std::string rooms_and_areas(const House& house) {
  constexpr std::size_t kShown = 20;
  std::vector<std::string> names;
  for (const HouseRoom& room : house.rooms)
    if (names.size() < kShown)
      names.push_back(
          fmt::format("{} ({:.1f} m^2)", room.instanceid.substr(0, 80), floor_area(house, room))
      );
  const std::size_t more = house.rooms.size() - names.size();
  return comma_list(names) + (more > 0 ? fmt::format(" and {} more", more) : "");
}

}  // namespace

std::string surface_kind(const std::string& type) {
  const auto has = [&](const char* word) { return type.find(word) != std::string::npos; };
  if (has("Slab")) return "slab";
  if (has("Floor")) return "floor";
  if (has("Ceiling")) return "ceiling";
  if (has("Baseboard")) return "baseboard";
  if (has("Cornice")) return "cornice";
  if (has("Window")) return "window";
  if (has("Door")) return "door";
  return has("Wall") ? "wall" : "other";
}

std::string HouseMesh::kind() const { return surface_kind(type); }

double floor_area(const House& house, const HouseRoom& room) {
  double area = 0;
  for (const std::size_t mesh : room.meshes)
    if (house.meshes[mesh].kind() == "floor") area += horizontal_area(house.meshes[mesh]);
  return area;
}

const HouseRoom& choose_room(
    const House& house, const std::string& instanceid, const fs::path& file
) {
  const HouseRoom* largest = nullptr;
  double area = 0;
  for (const HouseRoom& room : house.rooms) {
    if (!instanceid.empty() && room.instanceid != instanceid) continue;
    const double its = floor_area(house, room);
    if (its <= area) continue;
    largest = &room;
    area = its;
  }
  GLINT_CHECK(
      largest != nullptr || instanceid.empty(),
      kUsage,
      "{}: no room '{}' with a floor; the rooms are {}",
      file.string(),
      instanceid,
      rooms_and_areas(house)
  );
  GLINT_CHECK(
      largest != nullptr,
      kBadReference,
      "{}: none of its {} rooms has a mesh of type Floor; choose another house",
      file.string(),
      house.rooms.size()
  );
  return *largest;
}

}  // namespace glint
