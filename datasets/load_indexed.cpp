// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <optional>

#include "datasets/colmap_model.h"
#include "datasets/counted_pixels.h"
#include "datasets/map_files.h"
#include "datasets/picture_notes.h"
#include "datasets/prior_evidence.h"
#include "datasets/prior_files.h"
#include "datasets/prior_maps.h"
#include "datasets/released_truth.h"
#include "datasets/scene_index.h"
#include "datasets/scene_json.h"
#include "datasets/undistort.h"
#include "datasets/view_maps.h"
#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "glint/core/rng.h"
#include "glint/core/utf8.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_stored.h"
#include "glint/scene/ply.h"

namespace glint {
namespace {

void check_size(
    const fs::path& path, ImageSize found, const ViewSource& source, ImageSize expected
) {
  GLINT_CHECK(
      found == expected,
      kBadReference,
      "{}: {} x {} pixels, its view's image has {} x {}; store both at one size{}",
      path.string(),
      found.width,
      found.height,
      expected.width,
      expected.height,
      orientation_hint(source.image)
  );
}

MapSet read_truth(const ViewSource& source, ImageSize size) {
  MapSet maps;
  source.truth.for_each([&](const MapRow& row, const fs::path& path) {
    maps[row] = read_true_map(path, row.kind, source.depth_scale);
    check_size(path, maps[row].size(), source, size);
  });
  return maps;
}

// As they are used inside.
MapSet read_priors(const ViewSource& source, const Camera& camera) {
  MapSet maps;
  source.priors.for_each([&](const MapRow& row, const fs::path& path) {
    Image map = read_stored_prior(source, row);
    if (source.prior_programs.has(row)) map = resize_prior(std::move(map), row.kind, camera.size());
    check_size(path, map.size(), source, camera.size());
    convert_prior(row.kind, source.prior_reading, camera, map);
    maps[row] = std::move(map);
  });
  return maps;
}

constexpr float kWhole = 1 - 1e-4f;  // of a sum of weights

void undistort_view(View& view, const std::vector<double>& distortion) {
  using Lookup = Undistortion::Lookup;
  const Undistortion undistortion(view.camera, distortion);
  for_each_map(view, [&](const std::string&, Image& map, const MapRow& row) {
    if (map.empty()) return;
    const bool blend =
        row.kind != MapKind::kDepth && row.kind != MapKind::kNormal && row.kind != MapKind::kMask;
    const bool is_counted = &map == &view.counted;
    map = undistortion.apply(map, blend || is_counted ? Lookup::kBilinear : Lookup::kNearest);
    // A pixel counts where all do that its colour is blended from.
    if (is_counted)
      for (float& share : map.values()) share = share >= kWhole ? 1.0f : 0.0f;
  });
  view.camera = undistortion.camera();
}

// What fails is told with the place that led there: the file may be any.
template <class F>
auto at_place(const std::string& place, F&& body) {
  try {
    return body();
  } catch (const OutOfMemory&) {
    throw;
  } catch (const Error& error) {
    const std::string what = error.what();
    if (what.find(place) != std::string::npos) throw;
    throw Error(error.code(), fmt::format("{}: {}", place, what));
  }
}

View load_view(const ViewSource& source, const LoadOptions& options, ImageSize& stored) {
  View view = read_view(source, options);
  stored = view.rgb.size();
  if (!source.distortion.empty())
    at_place(source.where, [&] { undistort_view(view, source.distortion); });
  fit_view(view, options);
  at_place(source.where, [&] { blank_uncounted(view); });
  return view;
}

// A view of both lists trains.
bool is_scored(const ViewSource& view) { return view.is_test && !view.is_train; }

struct LoadedViews {
  std::vector<View> views;        // in order of their sources
  std::vector<ImageSize> stored;  // of their pictures; {0, 0}: not loaded
};

// Of several failures the first view's is reported, whatever thread met it.
LoadedViews load_views(const std::vector<ViewSource>& sources, const LoadOptions& options) {
  LoadedViews loaded{
      std::vector<View>(sources.size()), std::vector<ImageSize>(sources.size(), ImageSize{})};
  std::vector<std::exception_ptr> failures(sources.size());
  parallel_for(sources.size(), 1, [&](std::size_t i) {
    if (options.test_only && !is_scored(sources[i])) return;
    try {
      loaded.views[i] = load_view(sources[i], options, loaded.stored[i]);
    } catch (...) {
      failures[i] = std::current_exception();
    }
  });
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
  return loaded;
}

void add_points_and_extent(const SceneIndex& index, Scene& scene) {
  if (!index.points.empty())
    scene.points = at_place(index.folder.string(), [&] { return read_points(index.points); });
  set_extent(scene);
}

void check_index(const SceneIndex& index) {
  GLINT_CHECK(
      index.problems.empty(),
      kBadReference,
      "{}: {}",
      index.problems.front().where,
      index.problems.front().message
  );
  std::map<std::string, std::string> names;
  for (const ViewSource& view : index.views) {
    const std::string problem = view_name_problem(view.name, names);
    GLINT_CHECK(problem.empty(), kBadReference, "{}: {}", as_utf8(view.where), problem);
  }
  const bool has_train = std::any_of(
      index.views.begin(), index.views.end(), [](const ViewSource& view) { return view.is_train; }
  );
  const std::string why = scene_name_problem(index);
  GLINT_CHECK(why.empty(), kBadReference, "{}: {}", as_utf8(index.folder.string()), why);
  GLINT_CHECK(has_train, kBadReference, "{}: {}", index.folder.string(), no_train_views(index));
}

// Masks that may be in the channel that is not looked at: they leave nothing out; empty: none.
std::string mask_alpha_note(const SceneIndex& index, const Scene& scene) {
  const auto has_uncounted = [](const View& view) { return !view.counted.empty(); };
  if (std::ranges::any_of(scene.train, has_uncounted) ||
      std::ranges::any_of(scene.test, has_uncounted))
    return {};
  const auto count = std::ranges::count_if(index.views, [](const ViewSource& view) {
    return !view.counted.empty() && has_alpha(view.counted);
  });
  if (count == 0) return {};
  return fmt::format(
      "{} masks are white throughout, so that every pixel counts, and have an alpha channel, which "
      "is not looked at: if it holds the mask, write that as the picture itself",
      count
  );
}

// Views whose intrinsics look like those of another size; empty: none. A crop's may be so rightly.
std::string off_center_note(const Scene& scene) {
  std::size_t count = 0, all = 0;
  for (const std::vector<View>* views : {&scene.train, &scene.test})
    for (const View& view : *views) {
      if (!view.rgb.empty()) ++all;
      if (is_off_center(view.camera)) ++count;
    }
  if (count == 0) return {};
  return fmt::format(
      "the principal points of {} of {} views lie more than a quarter of a side from the middle: "
      "if they are no crops, their intrinsics belong to another size",
      count,
      all
  );
}

// What was passed over, and how priors are read.
void note_data(
    const SceneIndex& index,
    std::span<const ImageSize> stored,
    const LoadOptions& options,
    Scene& scene
) {
  std::vector<std::string>& notes = scene.data_notes;
  const auto both = std::count_if(index.views.begin(), index.views.end(), [](const auto& view) {
    return view.is_train && view.is_test;
  });
  if (both > 0)
    notes.push_back(fmt::format(
        "{} views are listed as train and as test: they train, and are not scored", both
    ));
  for (const Finding& remark : index.remarks)
    notes.push_back(fmt::format("{}: {}", remark.where, remark.message));
  for (std::string& note : picture_notes(index, stored)) notes.push_back(std::move(note));
  for (std::string note :
       {mask_alpha_note(index, scene), counted_note(scene), off_center_note(scene)})
    if (!note.empty()) notes.push_back(std::move(note));
  if (!options.with_priors || index.simulated_priors || index.prior_notes.empty()) return;
  notes.insert(notes.end(), index.prior_notes.begin(), index.prior_notes.end());
  const std::vector<std::string> coverage = prior_coverage(scene);
  notes.insert(notes.end(), coverage.begin(), coverage.end());
}

}  // namespace

namespace {

Image read_picture(const ViewSource& source) {
  const bool is_composed = source.alpha == AlphaUse::kBlack || source.alpha == AlphaUse::kWhite;
  if (!is_composed) return read_image(source.image, 3);
  return read_composed(source.image, 3, source.alpha == AlphaUse::kWhite ? 1.0f : 0.0f);
}

}  // namespace

Camera camera_at(const ViewSource& source, ImageSize image) {
  const std::optional<Finding> problem = camera_problem(source.camera, source.where);
  GLINT_CHECK(!problem, kBadReference, "{}: {}", problem->where, problem->message);
  Camera camera = source.camera;
  const bool stated = camera.width > 0 && camera.height > 0;
  if (stated && camera.size() != image) {
    // One pixel of rounding in either side is what resizing tools leave.
    const double slack = std::abs(
        static_cast<double>(image.width) * camera.height -
        static_cast<double>(image.height) * camera.width
    );
    GLINT_CHECK(
        source.scales_with_image && slack <= std::max(camera.width, camera.height),
        kBadReference,
        "{}: intrinsics for {} x {} pixels, {} has {} x {}; scale the intrinsics or use images of "
        "the stated size{}",
        source.where,
        camera.width,
        camera.height,
        source.image.string(),
        image.width,
        image.height,
        orientation_hint(source.image)
    );
    return resized(camera, image);
  }
  camera.width = image.width;
  camera.height = image.height;
  return camera;
}

View read_view(const ViewSource& source, const LoadOptions& options) {
  View view;
  view.name = source.name;
  view.rgb = at_place(source.where, [&] { return read_picture(source); });
  view.camera = camera_at(source, view.rgb.size());
  if (!source.counted.empty())
    view.counted =
        at_place(source.where, [&] { return read_counted(source.counted, view.rgb.size()); });
  else if (source.alpha == AlphaUse::kMask && has_alpha(source.image))
    view.counted = map_of_mask(mask_of_map(read_alpha(source.image)));
  if (options.with_priors) view.priors = read_priors(source, view.camera);
  if (options.with_truth) view.truth = read_truth(source, view.rgb.size());
  return view;
}

Scene load_indexed(const SceneIndex& index, const LoadOptions& options) {
  check_index(index);
  Scene scene;
  scene.name = index.name;
  scene.dataset = index.dataset;
  scene.spec_hash = index.spec_hash;
  scene.simulated_priors = index.simulated_priors;
  auto [views, stored] = load_views(index.views, options);
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (index.views[i].is_train && !options.test_only) scene.train.push_back(std::move(views[i]));
    if (is_scored(index.views[i])) scene.test.push_back(std::move(views[i]));
  }
  note_data(index, stored, options, scene);
  if (options.test_only) return scene;  // nobody starts a training from it
  add_points_and_extent(index, scene);
  return scene;
}

Scene outline_indexed(const SceneIndex& index) {
  check_index(index);
  Scene scene;
  scene.name = index.name;
  scene.dataset = index.dataset;
  scene.spec_hash = index.spec_hash;
  for (const ViewSource& source : index.views) {
    View view;
    view.name = source.name;
    view.camera = source.camera;
    if (source.is_train) scene.train.push_back(view);
    if (is_scored(source)) scene.test.push_back(view);
  }
  add_points_and_extent(index, scene);
  return scene;
}

PointCloud read_points(const fs::path& path) {
  PointCloud points = path.extension() == ".ply" ? read_point_ply(path) : read_colmap_points(path);
  const bool none = std::all_of(points.normals.begin(), points.normals.end(), [](Vec3f n) {
    return n.x == 0 && n.y == 0 && n.z == 0;
  });
  if (none) points.normals.clear();  // 3DGS writes zeros
  return points;
}

Image read_true_values(const fs::path& path, MapKind kind, double depth_scale) {
  Image map = read_image(path, channels_of(kind));
  if (kind == MapKind::kDepth && path.extension() == ".png")
    for (float& value : map.values()) value *= static_cast<float>(65535 * depth_scale);
  return map;
}

Image read_true_map(const fs::path& path, MapKind kind, double depth_scale) {
  if (kind == MapKind::kMask) return map_of_mask(read_mask(path));
  Image map = read_true_values(path, kind, depth_scale);
  check_finite(path, map);
  return map;
}

namespace {

// Names in files that lead out of the folder become problems: a dataset of strangers reads nothing
// else of the machine. Links in the folder are its owner's.
void refuse_outside(const fs::path& folder, SceneIndex& index) {
  const fs::path inside = fs::absolute(folder / "").lexically_normal();
  const auto refuse = [&](const fs::path& file, const std::string& where) {
    const fs::path relative = fs::absolute(file).lexically_normal().lexically_relative(inside);
    if (!relative.empty() && *relative.begin() != "..") return;
    index.problems.push_back(
        {"path-outside",
         where,
         fmt::format(
             "{} lies outside of {}; move the files into the folder, or link them there",
             file.string(),
             folder.string()
         )}
    );
  };
  for (const ViewSource& view : index.views) {
    refuse(view.image, view.where);
    if (!view.counted.empty()) refuse(view.counted, view.where);
  }
  if (!index.points.empty()) refuse(index.points, folder.string());
}

// Evidence of a second kind for what a check has told already is no second finding: the message
// goes to the first.
void add_unless_told(Finding finding, std::vector<Finding>& findings) {
  const auto told = std::find_if(findings.begin(), findings.end(), [&](const Finding& other) {
    return other.check == finding.check && other.where.find("gt/") == std::string::npos;
  });
  if (told == findings.end())
    findings.push_back(std::move(finding));
  else
    told->message += "; " + finding.message;
}

}  // namespace

LoaderSpec indexed_loader(
    const std::string& name,
    std::function<LoaderMatch(const fs::path&)> match,
    FolderIndexer index_folder,
    const std::string& looks_for
) {
  const FolderIndexer index = [index_folder](const fs::path& folder, const LoadOptions& options) {
    SceneIndex of_folder = index_folder(folder, options);
    of_folder.folder = folder;
    read_scene_json(folder, of_folder);
    refuse_outside(folder, of_folder);
    if (!options.background.empty()) set_alpha_use(options.background, "background", of_folder);
    mark_alpha_use(of_folder);
    add_released_truth(folder, of_folder);
    return of_folder;
  };
  LoaderSpec loader;
  loader.name = name;
  loader.match = std::move(match);
  loader.looks_for = looks_for;
  const auto index_with_priors = [index](const fs::path& folder, const LoadOptions& options) {
    SceneIndex of_folder = index(folder, options);
    attach_priors(folder, options.priors, of_folder);
    return of_folder;
  };
  loader.load = [index_with_priors](const fs::path& folder, const LoadOptions& options) {
    SceneIndex of_folder = index_with_priors(folder, options);
    if (options.with_priors && !options.test_only)  // nobody trains on priors of test views
      settle_readings(
          options.priors,
          of_folder.simulated_priors ? PriorEvidence{} : weigh_priors(of_folder),
          of_folder
      );
    return load_indexed(of_folder, options);
  };
  loader.outline = [index](const fs::path& folder, const LoadOptions& options) {
    return outline_indexed(index(folder, options));
  };
  loader.check = [index_with_priors](const fs::path& folder, const LoadOptions& options) {
    SceneIndex of_folder = index_with_priors(folder, options);
    settle_readings(options.priors, {}, of_folder);  // as documented or stated, to be checked
    std::vector<Finding> findings = check_indexed(of_folder);
    const PriorEvidence evidence = weigh_priors(of_folder);
    for (Finding& finding : check_readings(options.priors, evidence, of_folder))
      add_unless_told(std::move(finding), findings);
    return findings;
  };
  loader.split_rule = [index](const fs::path& folder) { return index(folder, {}).split_rule; };
  return loader;
}

}  // namespace glint
