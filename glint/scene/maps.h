// SPDX-License-Identifier: MIT
// The one table of maps: what methods render, what is true and what priors say, pixel by pixel. The
// files of runs and datasets, packed scenes, scores, pictures, figures, the page, the import and
// `dataset check` walk it, so a new map is a line here and the code that computes it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "glint/core/image.h"

namespace glint {

// How a map is stored, resized, drawn and compared follows from its kind.
enum class MapKind {
  kColor,   // [H][W][3] as displayed, [0, 1]
  kPart,    // [H][W][3] a part of the image; rendered: as displayed, true: linear radiance
  kDepth,   // [H][W][1] planar z in metres, of priors relative (larger = farther); 0: nothing
  kNormal,  // [H][W][3] unit, camera space, OpenCV axes, facing the camera; zero: nothing
  kShare,   // [H][W][1] in [0, 1]
  kMask     // [H][W][1] 0 or 1
};

constexpr int channels_of(MapKind kind) {
  return kind == MapKind::kDepth || kind == MapKind::kShare || kind == MapKind::kMask ? 1 : 3;
}

struct MapRow {
  std::string_view id;
  std::string_view title;  // as people read it
  MapKind kind = MapKind::kColor;
  // Empty: there is none.
  std::string_view file;     // values, in a run's renders/<view>/
  std::string_view picture;  // 8 bits, for people, there
  std::string_view truth;    // folder of a dataset's gt/
  std::string_view prior;    // folder of its diffrens/
  bool shown = true;         // false: stored and scored, but in no picture, figure or page
  bool kept = true;          // false: rendered for the viewer alone, in no file

  constexpr int channels() const { return channels_of(kind); }
  constexpr std::string_view stored_file() const { return file.empty() ? picture : file; }
  constexpr std::string_view shown_file() const { return shown ? stored_file() : ""; }
};

// In the order in which they are shown. "x_normal" is the normal of the surface at "x_depth".
namespace map_rows {
using enum MapKind;

inline constexpr MapRow kSurfaces[] = {
    // The true image is no file of gt/ but the view itself.
    {"rgb", "Image", kColor, "rgb.exr", "rgb.png", "", ""},
    {"depth", "Depth", kDepth, "depth.exr", "", "depth", "depth"},
    {"normal", "Normal", kNormal, "normal.exr", "", "normal", "normal"},
    {"glass", "Glass", kMask, "", "", "glass", "glass"},
    {"transparency", "Transparency t", kShare, "transparency.exr", "", "", ""},
    {"specularity", "Specularity k_s", kShare, "specularity.exr", "", "", ""},
    // How much of the pixel the surfels cover whose depth is reported.
    {"alpha", "Coverage alpha", kShare, "", "", "", "", true, false},
    // The first surface that is not glass along the straight ray.
    {"behind_depth", "Depth behind glass", kDepth, "behind_depth.exr", "", "behind_depth", ""},
    // The same of every method by one rule each, for fair scores: of the set that stands for what
    // is behind glass, or of the only one. Holes stay holes. See add_depth_estimates().
    {"behind_expected",
     "Depth behind glass, expected",
     kDepth,
     "behind_expected.exr",
     "",
     "",
     "",
     false},
    {"behind_median", "Depth behind glass, median", kDepth, "behind_median.exr", "", "", "", false},
    // First and last mode of the weights along a ray, by one rule for every method, of the set
    // whose depth it reports. Holes stay holes. See add_depth_modes().
    {"first_mode", "Depth, first mode", kDepth, "first_mode.exr", "", "", "", false},
    {"last_mode", "Depth, last mode", kDepth, "last_mode.exr", "", "", "", false},
    {"behind_normal", "Normal behind glass", kNormal, "", "", "behind_normal", ""},
};
// The surfaces along the straight ray in their order; the first one's are the rows above. Behind a
// mirror the ray is the mirrored one: depth and normal are those of the mirror image, where it
// appears to stand.
inline constexpr MapRow kLayers[] = {
    {"layer_1_mirror", "Mirror", kMask, "", "", "layer_1_mirror", ""},
    {"layer_2_depth", "Depth of layer 2", kDepth, "layer_2_depth.exr", "", "layer_2_depth", ""},
    {"layer_2_normal",
     "Normal of layer 2",
     kNormal,
     "layer_2_normal.exr",
     "",
     "layer_2_normal",
     ""},
    {"layer_2_glass", "Layer 2 is glass", kMask, "", "", "layer_2_glass", ""},
    {"layer_2_mirror", "Layer 2 is a mirror", kMask, "", "", "layer_2_mirror", ""},
    {"layer_2_transparency",
     "Transparency t of layer 2",
     kShare,
     "layer_2_transparency.exr",
     "",
     "",
     ""},
    {"layer_3_depth", "Depth of layer 3", kDepth, "layer_3_depth.exr", "", "layer_3_depth", ""},
    {"layer_3_normal",
     "Normal of layer 3",
     kNormal,
     "layer_3_normal.exr",
     "",
     "layer_3_normal",
     ""},
    {"layer_3_glass", "Layer 3 is glass", kMask, "", "", "layer_3_glass", ""},
    {"layer_3_mirror", "Layer 3 is a mirror", kMask, "", "", "layer_3_mirror", ""},
    {"layer_3_transparency",
     "Transparency t of layer 3",
     kShare,
     "layer_3_transparency.exr",
     "",
     "",
     ""},
    {"layer_4_depth", "Depth of layer 4", kDepth, "layer_4_depth.exr", "", "layer_4_depth", ""},
    {"layer_4_normal",
     "Normal of layer 4",
     kNormal,
     "layer_4_normal.exr",
     "",
     "layer_4_normal",
     ""},
    {"layer_4_glass", "Layer 4 is glass", kMask, "", "", "layer_4_glass", ""},
    {"layer_4_mirror", "Layer 4 is a mirror", kMask, "", "", "layer_4_mirror", ""},
    {"layer_4_transparency",
     "Transparency t of layer 4",
     kShare,
     "layer_4_transparency.exr",
     "",
     "",
     ""},
};
inline constexpr MapRow kLight[] = {
    // Radiance of each surfel set on its own.
    {"interface", "Interface", kColor, "", "interface.png", "", ""},
    {"transmission", "Transmission", kColor, "", "transmission.png", "", ""},
    {"reflection", "Reflection", kColor, "", "reflection.png", "", ""},
    // What came through the glass and what it mirrored.
    {"transmitted", "Transmitted part", kPart, "transmitted.exr", "", "transmitted", ""},
    {"reflected", "Reflected part", kPart, "reflected.exr", "", "reflected", ""},
    // The same by the first two panes or mirrors on the way, seen from the camera: through one
    // and no other (T), through two (TT), mirrored once (R), through one and mirrored by the next
    // (TR), mirrored and then through one (RT), mirrored twice (rest).
    {"path_t", "Part T", kPart, "path_t.exr", "", "path_t", ""},
    {"path_tt", "Part TT", kPart, "path_tt.exr", "", "path_tt", ""},
    {"path_r", "Part R", kPart, "path_r.exr", "", "path_r", ""},
    {"path_tr", "Part TR", kPart, "path_tr.exr", "", "path_tr", ""},
    {"path_rt", "Part RT", kPart, "path_rt.exr", "", "path_rt", ""},
    {"path_rest", "Other paths", kPart, "", "", "path_rest", ""},
    // Of the material at the first surface; true albedo is linear, priors are as displayed.
    {"albedo", "Albedo", kColor, "", "", "albedo", "diffuse_albedo"},
    {"basecolor", "Base colour", kColor, "", "", "", "basecolor"},
    // The photo without highlights and mirror images.
    {"delighted", "De-lighted image", kColor, "", "", "", "delight"},
};

template <std::size_t A, std::size_t B, std::size_t C>
constexpr auto joined(const MapRow (&a)[A], const MapRow (&b)[B], const MapRow (&c)[C]) {
  std::array<MapRow, A + B + C> rows;
  std::copy(a, a + A, rows.begin());
  std::copy(b, b + B, rows.begin() + A);
  std::copy(c, c + C, rows.begin() + A + B);
  return rows;
}
}  // namespace map_rows

inline constexpr auto kMaps =
    map_rows::joined(map_rows::kSurfaces, map_rows::kLayers, map_rows::kLight);

// The rows of kMaps, then those of tests.
std::span<const MapRow> maps();

// A row of the table. A name in the code that the table lacks does not compile.
class MapId {
 public:
  consteval MapId(const char* id) : index_(index_in_table(id)) {}
  MapId(const MapRow& row);  // of maps(), or a copy

  constexpr std::size_t index() const { return index_; }
  const MapRow& row() const { return maps()[index_]; }
  friend bool operator==(MapId, MapId) = default;

 private:
  static consteval std::size_t index_in_table(std::string_view id) {
    for (std::size_t i = 0; i < kMaps.size(); ++i)
      if (kMaps[i].id == id) return i;
    throw "no such map in glint/scene/maps.h";
  }
  std::size_t index_;
};

// Null: the table has none of that id.
const MapRow* find_map(std::string_view id);
// The file of a true map below gt/; `view` is its view's name.
std::string true_map_file(const MapRow& row, const std::string& view);
// The depth of the surface that a normal map describes; null: the table has none.
const MapRow* depth_of(const MapRow& normal);

// One T for each map of the table; those that are empty() are absent.
template <class T>
class BasicMapSet {
 public:
  const T& operator[](MapId id) const {
    static const T none{};
    return id.index() < maps_.size() ? maps_[id.index()] : none;
  }
  // Stays where it is while the set lives.
  T& operator[](MapId id) {
    if (maps_.size() < maps().size()) maps_.resize(maps().size());
    return maps_[id.index()];
  }
  bool has(MapId id) const { return !(*this)[id].empty(); }
  bool empty() const {
    for (const T& map : maps_)
      if (!map.empty()) return false;
    return true;
  }
  // Calls f(row, map) for those that are present, in the order of the table.
  template <class F>
  void for_each(F&& f) const {
    for (std::size_t i = 0; i < maps_.size(); ++i)
      if (!maps_[i].empty()) f(maps()[i], maps_[i]);
  }
  template <class F>
  void for_each(F&& f) {
    for (std::size_t i = 0; i < maps_.size(); ++i)
      if (!maps_[i].empty()) f(maps()[i], maps_[i]);
  }

 private:
  std::vector<T> maps_;
};

using MapSet = BasicMapSet<Image>;
using MapViews = BasicMapSet<ImageView>;

// Valid as long as the maps.
MapViews views_of(const MapSet& maps);

// Masks as maps and back; values above a half count.
Image map_of_mask(MaskView mask);
MaskImage mask_of_map(ImageView map);

// For tests: a row behind those of kMaps for as long as this lives.
class ExtraMap {
 public:
  explicit ExtraMap(const MapRow& row);
  ~ExtraMap();
  ExtraMap(const ExtraMap&) = delete;
  ExtraMap& operator=(const ExtraMap&) = delete;
};

}  // namespace glint
