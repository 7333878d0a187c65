// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "datasets/front3d/house.h"
#include "glint/core/config.h"
#include "glint/core/error.h"
#include "glint/core/sha256.h"
#include "glint/scene/camera.h"

namespace glint {

namespace {

constexpr double kFarthest = 1e4;                           // metres
constexpr double kSmallestScale = 1e-5, kLargestScale = 5;  // of what counts, as ATISS has it
constexpr const char* kUnreadable = "7e101ef3-7722-4af8-90d5-7c562834fabd";  // a model

const Mat3f kZUp{{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}};  // with_z_up()

std::string trimmed(const std::string& text) {
  constexpr const char* kBlanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

// An entry of the file, and how messages call it.
struct Entry {
  const Json& json;
  std::string where;  // "house.json: mesh 3"

  const Json* find(const char* key) const {
    const auto found = json.find(key);
    return found == json.end() || found->is_null() ? nullptr : &*found;
  }
  // Empty where it is missing.
  std::string text(const char* key) const {
    const Json* value = find(key);
    if (value == nullptr) return {};
    GLINT_CHECK(
        value->is_string(),
        kBadReference,
        "{}: {} is {}, expected a text",
        where,
        key,
        value->type_name()
    );
    return trimmed(value->get<std::string>());
  }
  // Elements that are objects; empty where it is missing.
  std::vector<Entry> entries(const char* key) const {
    const Json* list = find(key);
    if (list == nullptr) return {};
    GLINT_CHECK(
        list->is_array(),
        kBadReference,
        "{}: {} is {}, expected a list",
        where,
        key,
        list->type_name()
    );
    std::vector<Entry> result;
    for (std::size_t i = 0; i < list->size(); ++i) {
      const Json& item = (*list)[i];
      result.push_back({item, fmt::format("{}: {} {}", where, key, i)});
      GLINT_CHECK(
          item.is_object(),
          kBadReference,
          "{} is {}, expected an object",
          result.back().where,
          item.type_name()
      );
    }
    return result;
  }
};

// A list of numbers, flat or in rows. A null becomes `of_null`, where there is one.
std::vector<double> numbers(
    const Entry& entry, const char* key, std::optional<double> of_null = std::nullopt
) {
  std::vector<double> values;
  const Json* list = entry.find(key);
  if (list == nullptr) return values;
  const auto add = [&](const Json& item) {
    const bool is_null = item.is_null() && of_null.has_value();
    GLINT_CHECK(
        item.is_number() || is_null,
        kBadReference,
        "{}: value {} of {} is {}, expected a number",
        entry.where,
        values.size(),
        key,
        item.type_name()
    );
    const double value = is_null ? *of_null : item.get<double>();
    GLINT_CHECK(
        is_null || std::isfinite(value),
        kBadReference,
        "{}: value {} of {} is not finite",
        entry.where,
        values.size(),
        key
    );
    values.push_back(value);
  };
  GLINT_CHECK(
      list->is_array(),
      kBadReference,
      "{}: {} is {}, expected a list of numbers",
      entry.where,
      key,
      list->type_name()
  );
  for (const Json& item : *list)
    if (item.is_array())
      for (const Json& inner : item) add(inner);
    else
      add(item);
  return values;
}

void check_count(const Entry& entry, const char* key, std::size_t found, std::size_t divisor) {
  GLINT_CHECK(
      found % divisor == 0,
      kBadReference,
      "{}: {} has {} numbers, expected a multiple of {}",
      entry.where,
      key,
      found,
      divisor
  );
}

Vec3f point(const Entry& entry, const char* key, const double* values) {
  for (int i = 0; i < 3; ++i)
    GLINT_CHECK(
        std::abs(values[i]) <= kFarthest,
        kBadReference,
        "{}: {} has {} m, expected at most {} m from the origin",
        entry.where,
        key,
        values[i],
        kFarthest
    );
  return cast<float>(Vec3d{values[0], values[1], values[2]});
}

// Three numbers; `otherwise` where they are missing.
Vec3f triple(const Entry& entry, const char* key, Vec3f otherwise) {
  const std::vector<double> values = numbers(entry, key);
  if (values.empty()) return otherwise;
  GLINT_CHECK(
      values.size() == 3,
      kBadReference,
      "{}: {} has {} numbers, expected 3",
      entry.where,
      key,
      values.size()
  );
  return point(entry, key, values.data());
}

std::vector<Vec3f> read_vertices(const Entry& mesh) {
  const std::vector<double> xyz = numbers(mesh, "xyz");
  check_count(mesh, "xyz", xyz.size(), 3);
  std::vector<Vec3f> vertices;
  for (std::size_t i = 0; i < xyz.size(); i += 3)
    vertices.push_back(with_z_up(point(mesh, "xyz", &xyz[i])));
  return vertices;
}

// Empty where any is null, too large to mean anything, or missing.
std::vector<Vec2f> read_uvs(const Entry& mesh, std::size_t num_vertices) {
  constexpr double kLargest = 1e6;
  const std::vector<double> uv = numbers(mesh, "uv", std::nan(""));
  check_count(mesh, "uv", uv.size(), 2);
  std::vector<Vec2f> uvs;
  const bool all =
      std::all_of(uv.begin(), uv.end(), [](double value) { return std::abs(value) <= kLargest; });
  if (!all || uv.size() != 2 * num_vertices) return uvs;
  for (std::size_t i = 0; i < uv.size(); i += 2)
    uvs.push_back({static_cast<float>(uv[i]), static_cast<float>(uv[i + 1])});
  return uvs;
}

std::vector<std::array<std::int32_t, 3>> read_faces(const Entry& mesh, std::size_t num_vertices) {
  const std::vector<double> indices = numbers(mesh, "faces");
  check_count(mesh, "faces", indices.size(), 3);
  std::vector<std::array<std::int32_t, 3>> faces;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    GLINT_CHECK(
        indices[i] >= 0 && indices[i] < static_cast<double>(num_vertices) &&
            indices[i] == std::floor(indices[i]),
        kBadReference,
        "{}: faces names vertex {}, but xyz has {}",
        mesh.where,
        indices[i],
        num_vertices
    );
    if (i % 3 == 0) faces.emplace_back();
    faces.back()[i % 3] = static_cast<std::int32_t>(indices[i]);
  }
  return faces;
}

// 3x3 for column vectors; files have it by rows or by columns, which its last row tells.
std::array<float, 6> read_uv_transform(const Entry& material) {
  constexpr double kLargest = 1e4;
  std::vector<double> m = numbers(material, "UVTransform");
  const bool usable = m.size() == 9 && std::all_of(m.begin(), m.end(), [](double value) {
                        return std::abs(value) <= kLargest;
                      });
  if (!usable) return HouseMaterial().uv_transform;
  const bool by_columns = (m[6] != 0 || m[7] != 0) && m[2] == 0 && m[5] == 0;
  if (by_columns) m = {m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]};
  std::array<float, 6> result{};
  for (std::size_t i = 0; i < 6; ++i) result[i] = static_cast<float>(m[i]);
  return result;
}

HouseMaterial read_material(const Entry& entry) {
  HouseMaterial material{.uid = entry.text("uid"), .jid = entry.text("jid")};
  material.uv_transform = read_uv_transform(entry);
  const std::vector<double> color = numbers(entry, "color");
  material.has_color = color.size() >= 3;
  for (int i = 0; i < 3 && material.has_color; ++i)
    material.color[i] =
        static_cast<float>(std::clamp(color[static_cast<std::size_t>(i)] / 255, 0.0, 1.0));
  return material;
}

// The corners of `bbox`: {"min": [...], "max": [...]}, or six numbers, or three, which are a size.
std::optional<std::array<Vec3f, 2>> read_box(const Entry& entry) {
  const Json* bbox = entry.find("bbox");
  std::vector<double> values = numbers(entry, "size");
  if (bbox != nullptr && bbox->is_object()) {
    const Entry corners{*bbox, entry.where + ": bbox"};
    values = numbers(corners, "min");
    const std::vector<double> high = numbers(corners, "max");
    values.insert(values.end(), high.begin(), high.end());
  } else if (values.empty()) {
    values = numbers(entry, "bbox");
  }
  if (values.size() == 3) {
    const double x = 0.5 * std::abs(values[0]), z = 0.5 * std::abs(values[2]);
    values = {-x, 0, -z, x, std::abs(values[1]), z};
  }
  if (values.size() != 6) return std::nullopt;
  std::array<Vec3f, 2> box{
      with_z_up(point(entry, "bbox", &values[0])), with_z_up(point(entry, "bbox", &values[3]))};
  for (int i = 0; i < 3; ++i)
    if (box[0][i] > box[1][i]) std::swap(box[0][i], box[1][i]);
  return box;
}

// What 3D-FRONT calls "Sofa" or "sofa/three-seat sofa" stands in one of these.
std::string category_of(const Entry& furniture) {
  for (const char* key : {"category", "title", "sourceCategoryId"})
    if (furniture.find(key) != nullptr && furniture.find(key)->is_string())
      if (const std::string text = furniture.text(key); !text.empty()) return text;
  return "furniture";
}

// Of the file's quaternion (x, y, z, w), between frames with z up.
Mat3f read_rotation(const Entry& child) {
  std::vector<double> q = numbers(child, "rot");
  if (q.empty()) q = {0, 0, 0, 1};
  const double norm =
      q.size() == 4 ? std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3])) : 0;
  GLINT_CHECK(
      norm > 1e-6 && norm < 1e6,
      kBadReference,
      "{}: rot has {} numbers and length {}, expected a quaternion x, y, z, w",
      child.where,
      q.size(),
      norm
  );
  const Mat3d turn = rotation_from_quaternion({q[3] / norm, q[0] / norm, q[1] / norm, q[2] / norm});
  return kZUp * cast<float>(turn) * transpose(kZUp);
}

class HouseReader {
 public:
  explicit HouseReader(const fs::path& file) : file_(file) {}

  House read() {
    const std::string text = read_file(file_);
    const Json json = parse_json(text);
    GLINT_CHECK(
        json.is_object(),
        kBadReference,
        "{}: no JSON object, or nested more than {} deep; expected a house of 3D-FRONT",
        file_.string(),
        kDeepestJson
    );
    house_.sha256 = sha256(text);
    const Entry root{json, file_.string()};
    house_.uid = root.text("uid");
    read_materials(root);
    read_meshes(root);
    read_furniture(root);
    read_rooms(root);
    add_notes();
    return std::move(house_);
  }

 private:
  // Of entries with one uid the first counts. Without a uid nothing can refer to it.
  bool is_new(
      std::map<std::string, std::size_t>& known, const std::string& uid, std::size_t index
  ) {
    if (!uid.empty() && known.emplace(uid, index).second) return true;
    ++counts_[uid.empty() ? "entries without a uid" : "entries whose uid another one has"];
    return false;
  }

  void read_materials(const Entry& root) {
    for (const Entry& entry : root.entries("material")) {
      HouseMaterial material = read_material(entry);
      if (is_new(materials_, material.uid, house_.materials.size()))
        house_.materials.push_back(std::move(material));
    }
  }

  void read_meshes(const Entry& root) {
    for (const Entry& entry : root.entries("mesh")) {
      HouseMesh mesh{.uid = entry.text("uid"), .type = entry.text("type")};
      mesh.vertices = read_vertices(entry);
      mesh.uvs = read_uvs(entry, mesh.vertices.size());
      mesh.faces = read_faces(entry, mesh.vertices.size());
      const auto material = materials_.find(entry.text("material"));
      if (material != materials_.end()) mesh.material = static_cast<int>(material->second);
      if (is_new(meshes_, mesh.uid, house_.meshes.size())) house_.meshes.push_back(std::move(mesh));
    }
  }

  // Where any piece has a flag `valid`, those without one are not.
  void read_furniture(const Entry& root) {
    const std::vector<Entry> entries = root.entries("furniture");
    const bool flagged = std::any_of(entries.begin(), entries.end(), [](const Entry& entry) {
      return entry.find("valid") != nullptr;
    });
    for (const Entry& entry : entries) {
      HouseFurniture piece{
          .uid = entry.text("uid"),
          .jid = entry.text("jid"),
          .category = category_of(entry),
          .box = read_box(entry)};
      const Json* valid = entry.find("valid");
      const bool counts = !flagged || (valid != nullptr && *valid == true);
      if (!counts) left_out_.insert(piece.uid);
      if (counts && is_new(furniture_, piece.uid, house_.furniture.size()))
        house_.furniture.push_back(std::move(piece));
    }
    if (!left_out_.empty()) counts_["pieces of furniture that are not valid"] = left_out_.size();
  }

  void read_rooms(const Entry& root) {
    const Json* scene = root.find("scene");
    GLINT_CHECK(
        scene != nullptr && scene->is_object(),
        kBadReference,
        "{}: no object `scene` with the rooms; expected a house of 3D-FRONT",
        root.where
    );
    std::set<std::string> known;
    for (const Entry& entry : Entry{*scene, root.where + ": scene"}.entries("room")) {
      HouseRoom room{.instanceid = entry.text("instanceid"), .type = entry.text("type")};
      if (room.instanceid.empty()) room.instanceid = fmt::format("room-{}", house_.rooms.size());
      if (!known.insert(room.instanceid).second) {
        ++counts_["rooms whose instanceid another one has"];
        continue;
      }
      referred_.clear();
      placed_.clear();
      for (const Entry& child : entry.entries("children")) read_child(child, room);
      house_.rooms.push_back(std::move(room));
    }
    GLINT_CHECK(!house_.rooms.empty(), kBadReference, "{}: scene has no room", root.where);
  }

  // Meshes are in world coordinates already: only furniture is placed.
  void read_child(const Entry& child, HouseRoom& room) {
    const std::string ref = child.text("ref");
    if (const auto mesh = meshes_.find(ref); mesh != meshes_.end()) {
      if (referred_.insert(mesh->second).second) room.meshes.push_back(mesh->second);
      return;
    }
    const auto piece = furniture_.find(ref);
    if (piece == furniture_.end()) {
      if (!left_out_.contains(ref)) ++counts_["references to nothing"];
      return;
    }
    place(child, piece->second, room);
  }

  void place(const Entry& child, std::size_t piece, HouseRoom& room) {
    const Vec3f scale = triple(child, "scale", {1, 1, 1});
    const HousePlacement placement{
        .furniture = piece,
        .rotation = read_rotation(child),
        .scale = {scale.x, scale.z, scale.y},
        .translation = with_z_up(triple(child, "pos", {}))};
    for (int i = 0; i < 3; ++i) {
      const auto factor = static_cast<double>(scale[i]);
      if (factor >= kSmallestScale && factor <= kLargestScale) continue;
      ++counts_["pieces scaled to nothing, mirrored or scaled beyond 5"];
      return;
    }
    if (house_.furniture[piece].jid == kUnreadable) {
      ++counts_["pieces of a model that nobody can read"];
      return;
    }
    const std::string key = fmt::format(
        "{} {}",
        piece,
        Json{placement.translation.x, placement.translation.y, placement.translation.z}.dump()
    );
    if (!placed_.insert(key).second)
      ++counts_["pieces that stand twice in one place"];
    else
      room.furniture.push_back(placement);
  }

  void add_notes() {
    for (const auto& [what, count] : counts_)
      house_.notes.push_back(fmt::format("{} {}", count, what));
  }

  fs::path file_;
  House house_;
  std::map<std::string, std::size_t> materials_, meshes_, furniture_;  // by uid
  std::set<std::string> left_out_;                                     // uids of furniture
  std::set<std::size_t> referred_;             // meshes of the room being read
  std::set<std::string> placed_;               // pieces of it, with their places
  std::map<std::string, std::size_t> counts_;  // of what was passed over
};

}  // namespace

House read_house(const fs::path& file) {
  return read_within_memory(file, [&] { return HouseReader(file).read(); });
}

}  // namespace glint
