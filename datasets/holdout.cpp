// SPDX-License-Identifier: MIT
#include "datasets/holdout.h"

#include <algorithm>
#include <map>
#include <set>

#include "datasets/dataset.h"
#include "glint/core/config.h"
#include "glint/core/error.h"
#include "glint/core/left_behind.h"
#include "glint/core/presence.h"
#include "glint/core/rng.h"
#include "glint/scene/image_files.h"

namespace glint {
namespace {

constexpr const char* kLoader = "easyvolcap";
constexpr const char* kDescription = "scene.json";
constexpr const char* kHeldOut = "held_out";  // there: true
constexpr float kGrey = 0.5f;
// Seeds below can be tried one after the other, until a room looks like the photos.
constexpr std::uint64_t kGuessable = std::uint64_t{1} << 40;

// Of the whole scene: names of its views, by the split.
struct Views {
  std::set<std::string> train, test;
};

Views views_of(const fs::path& folder) {
  const LoaderSpec& loader = find_loader(folder);
  GLINT_CHECK(
      loader.name == kLoader,
      kUsage,
      "{}: a folder of the format {}; `glint-bench dataset export --format {}` makes one that can "
      "be split",
      folder.string(),
      loader.name,
      kLoader
  );
  const Scene scene = loader.outline(folder, {});
  Views views;
  for (const View& view : scene.train) views.train.insert(view.name);
  for (const View& view : scene.test) views.test.insert(view.name);
  GLINT_CHECK(
      !views.test.empty(), kUsage, "{}: no test views, so that nothing is scored", folder.string()
  );
  return views;
}

Json description_of(const fs::path& folder) {
  const fs::path file = folder / kDescription;
  return is_file(file) ? read_json_object(file) : Json::object();
}

// The view that a file is of, where that is photo or prior; empty: neither.
std::string view_of(const fs::path& name) {
  const std::vector<fs::path> parts(name.begin(), name.end());
  if (parts.size() == 3 && parts[0] == "images") return parts[1].string();
  if (parts.size() == 4 && parts[0] == "diffrens") return parts[2].string();
  if (parts.size() == 2 && parts[0] == "counted") return parts[1].stem().string();
  return {};
}

// What everybody may have, by its name below the scene.
bool is_for_all(const fs::path& name, const Views& views) {
  static const std::set<std::string> whole{"intri.yml", "extri.yml", "sparse/0/points3D.ply"};
  return whole.contains(name.generic_string()) || views.train.contains(view_of(name));
}

void copy_into(const fs::path& from, const fs::path& to) {
  fs::create_directories(to.parent_path());
  std::error_code code;
  fs::copy_file(from, to, code);
  GLINT_CHECK(!code, kEnvironment, "{}: cannot be written ({})", to.string(), code.message());
}

bool is_test_photo(const fs::path& name, const Views& views) {
  return *name.begin() == "images" && views.test.contains(view_of(name));
}

// In place of a photo, of its size and under its name, so that the photo goes over it again.
void write_grey(const fs::path& photo, const fs::path& to) {
  GLINT_CHECK(
      to.extension() == ".png",
      kUsage,
      "{}: expected photos as PNG, as `glint-bench dataset export --format {}` writes them",
      photo.string(),
      kLoader
  );
  const ImageSize size = read_image(photo, 3).size();
  write_png(to, Image(size.width, size.height, 3, kGrey));
}

// Training views without priors, and all test views, whose priors are kept back.
std::vector<std::string> without_priors(const Json& whole, const Views& views) {
  std::set<std::string> names = views.test;
  for (const Json& name : whole.value("without_priors", Json::array()))
    if (name.is_string()) names.insert(name.get<std::string>());
  return {names.begin(), names.end()};
}

Json hashes_below(const fs::path& folder) {
  Json hashes = Json::object();
  for (const fs::path& file : list_files_below(folder))
    hashes[file.lexically_relative(folder).generic_string()] =
        fmt::format("{:016x}", hash_name(read_file(file)));
  return hashes;
}

// scene.json for everybody: no options, seeds, hashes or places of things, from which the room
// could be made again.
Json told_description(const fs::path& folder, const Json& whole, const Views& views) {
  Json told = {{kHeldOut, true}, {"test_views", views.test}};
  for (const char* field :
       {"name",
        "dataset",
        "simulated_priors",
        "priors_label",
        "prior_level",
        "prior_axes",
        "prior_depth",
        "prior_overlap",
        "albedo_from_basecolor",
        "alpha",
        "up",
        "unit"})
    if (whole.contains(field)) told[field] = whole[field];
  told["without_priors"] = without_priors(whole, views);
  told["files"] = hashes_below(folder);
  told["hash"] = fmt::format("{:016x}", hash_name(told["files"].dump()));
  return told;
}

std::string warning_of(const Json& whole) {
  const Json options = whole.value("options", Json());
  const Json seed = options.is_object() ? options.value("seed", Json()) : Json();
  if (!seed.is_number_unsigned() || seed.get<std::uint64_t>() >= kGuessable) return {};
  return fmt::format(
      "the room was made with --seed {}, and whoever makes the rooms of the first seeds finds it: "
      "make it anew with a random seed of 64 bits",
      seed.get<std::uint64_t>()
  );
}

bool is_inside(const fs::path& inner, const fs::path& outer) {
  const fs::path relative = inner.lexically_relative(outer);
  return !relative.empty() && *relative.begin() != "..";
}

void check_target(const fs::path& folder) {
  GLINT_CHECK(
      !is_there(folder) || (is_folder(folder) && list_entries(folder).empty()),
      kUsage,
      "{}: is there already and not an empty folder; give another name, or empty it yourself",
      folder.string()
  );
}

void check_places(const std::vector<fs::path>& places) {
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t j = 0; j < places.size(); ++j)
      GLINT_CHECK(
          i == j || !is_inside(places[i], places[j]),
          kUsage,
          "{} lies in {}: the scene, the folder for everybody and the truth want places of their "
          "own",
          places[i].string(),
          places[j].string()
      );
}

void check_whole(const fs::path& scene) {
  GLINT_CHECK(!is_held_out(scene), kUsage, "{}: its truth is kept back already", scene.string());
}

// Each file of the scene into the folder that it belongs to.
void divide(
    const fs::path& scene, const Views& views, const fs::path& for_all, const fs::path& to_score
) {
  for (const fs::path& file : list_files_below(scene)) {
    const fs::path name = file.lexically_relative(scene);
    copy_into(file, (is_for_all(name, views) ? for_all : to_score) / name);
    if (is_test_photo(name, views)) write_grey(file, for_all / name);
  }
}

void put_in_place(const fs::path& unfinished, const fs::path& folder) {
  std::error_code code;
  fs::remove(folder, code);  // an empty one
  fs::rename(unfinished, folder, code);
  GLINT_CHECK(!code, kEnvironment, "{}: cannot be written ({})", folder.string(), code.message());
}

}  // namespace

HoldoutReport hold_out_truth(const HoldoutOptions& options) {
  const fs::path scene = absolute_folder(options.scene), for_all = absolute_folder(options.for_all),
                 to_score = absolute_folder(options.to_score);
  check_exists(scene, "folder");
  check_places({scene, for_all, to_score});
  check_target(for_all);
  check_target(to_score);
  check_whole(scene);
  const Views views = views_of(scene);
  const Json whole = description_of(scene);
  const UnfinishedFolder all(for_all), truth(to_score);
  divide(scene, views, all.path(), truth.path());
  write_file(all.path() / kDescription, told_description(all.path(), whole, views).dump(1) + "\n");
  const HoldoutReport report{
      list_files_below(all.path()).size(),
      list_files_below(truth.path()).size(),
      views.test.size(),
      warning_of(whole)};
  put_in_place(truth.path(), to_score);
  put_in_place(all.path(), for_all);
  return report;
}

bool is_held_out(const fs::path& folder) {
  if (!is_folder(folder)) return false;
  const fs::path file = folder / kDescription;
  if (!is_file(file)) return false;
  const Json json = parse_json(read_file(file));
  return json.is_object() && json.value(kHeldOut, Json()) == true;
}

bool is_held_out(const Scene& scene) {
  const auto& notes = scene.data_notes;
  return std::find(notes.begin(), notes.end(), kHeldOutNote) != notes.end();
}

void note_held_out(const fs::path& folder, Scene& scene) {
  if (is_held_out(folder) && !is_held_out(scene)) scene.data_notes.emplace_back(kHeldOutNote);
}

void check_not_held_out(const fs::path& folder, const Scene& scene) {
  GLINT_CHECK(
      !is_held_out(folder) && !is_held_out(scene),
      kBadReference,
      "{}: {}. To score renders, give the folder in which both parts are put together",
      folder.string(),
      kHeldOutNote
  );
}

}  // namespace glint
