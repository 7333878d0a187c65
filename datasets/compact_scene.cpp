// SPDX-License-Identifier: MIT
#include "datasets/map_codes.h"
#include "datasets/packed_scene.h"
#include "glint/core/error.h"
#include "glint/core/nearest.h"
#include "glint/scene/layer_maps.h"

namespace glint {
namespace {

// True maps that are compared with a run's files, or that those are a share of, and masks.
bool is_scored(const MapRow& row) {
  return row.kind == MapKind::kMask || row.kind == MapKind::kPart || !row.stored_file().empty();
}

// What they say of what is seen through glass and in it counts on glass alone (metrics/view/).
bool counts_on_glass(const MapRow& row) {
  return row.kind == MapKind::kPart || row.id == "behind_depth";
}

// Where the first surface is glass; for parts by path also where it is a mirror.
bool is_counted(const MapSet& truth, const MapRow& row, std::size_t pixel) {
  const Image& mirror = truth["layer_1_mirror"];
  const bool by_path = is_path_map(row) && !mirror.empty();
  return truth["glass"].data()[pixel] != 0 || (by_path && mirror.data()[pixel] != 0);
}

void clear_what_does_not_count(const MapSet& truth, const MapRow& row, Image& map) {
  const auto channels = static_cast<std::size_t>(map.channels());
  for (std::size_t i = 0; i < map.values().size(); ++i)
    if (!is_counted(truth, row, i / channels)) map.data()[i] = 0;
}

MapSet compact_truth(const MapSet& truth) {
  MapSet kept;
  truth.for_each([&](const MapRow& row, const Image& map) {
    if (!is_scored(row)) return;
    Image& copy = kept[row] = map;
    if (counts_on_glass(row) && truth.has("glass")) clear_what_does_not_count(truth, row, copy);
    round_truth(row.kind, copy);
  });
  return kept;
}

MapSet glass_alone(const MapSet& maps) {
  MapSet kept;
  if (maps.has("glass")) kept["glass"] = maps["glass"];
  return kept;
}

}  // namespace

void leave_out_train_truth(Scene& scene) {
  for (View& view : scene.train) view.truth = glass_alone(view.truth);
}

void make_compact(Scene& scene) {
  leave_out_train_truth(scene);
  for (View& view : scene.test) {
    view.priors = glass_alone(view.priors);
    view.truth = compact_truth(view.truth);
  }
}

void leave_out_prior(const std::string& id, Scene& scene) {
  const MapRow* row = find_map(id);
  bool found = false;
  for (std::vector<View>* views : {&scene.train, &scene.test})
    for (View& view : *views)
      if (row != nullptr && view.priors.has(*row)) {
        view.priors[*row] = Image();
        found = true;
      }
  if (found) return;
  std::vector<std::string> known;
  for (const MapRow& prior : maps())
    if (!prior.prior.empty()) known.emplace_back(prior.id);
  throw Error(
      ExitCode::kUsage,
      fmt::format("--without {}: the scene has no such prior; priors are {}", id, comma_list(known))
  );
}

}  // namespace glint
