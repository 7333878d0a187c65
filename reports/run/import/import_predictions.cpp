// SPDX-License-Identifier: MIT
#include "reports/run/import/import_predictions.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "datasets/map_files.h"
#include "datasets/released_truth.h"
#include "datasets/scene_index.h"
#include "glint/core/presence.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_depth.h"
#include "glint/scene/image_files_stored.h"
#include "glint/scene/mesh_files.h"
#include "metrics/depth.h"
#include "metrics/mesh_frames.h"
#include "metrics/normal.h"
#include "reports/run/import/map_values.h"
#include "reports/run/records/earlier_run.h"
#include "reports/run/records/lossy_renders.h"
#include "reports/show/pictures/strip.h"

namespace glint {
namespace {

constexpr double kSuspicious = 0.5;  // another convention makes less than half of the error

// gsplat's trainers store truth and render side by side. The right half of such a picture; any
// other picture as it is.
Image without_truth(Image image, const View& view) {
  const int width = view.camera.width;
  constexpr double kSame = 2.0 / 255;  // mean difference; truncated to 8 bits
  if (image.channels() != 3 || image.size() != ImageSize{2 * width, view.camera.height})
    return image;
  Image right(width, image.height(), 3);
  double difference = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) {
        right.at(x, y, c) = image.at(width + x, y, c);
        difference += static_cast<double>(std::abs(image.at(x, y, c) - view.rgb.at(x, y, c)));
      }
  return difference / static_cast<double>(3 * right.num_pixels()) < kSame ? right : image;
}

// EasyVolcap's geo_metric/ has all pixels in one row. Any other map as it is.
Image in_rows(Image image, ImageSize size) {
  if (image.height() != 1 || image.num_pixels() != size.num_pixels()) return image;
  Image rows(size.width, size.height, image.channels());
  std::copy(image.values().begin(), image.values().end(), rows.values().begin());
  return rows;
}

Image read_for(const fs::path& path, int channels, const View& view, const DepthSteps& scale = {}) {
  const auto read = [&] {
    return scale.known() ? read_depth(path, scale) : read_image(path, channels);
  };
  Image image = without_truth(with_exit_code(ExitCode::kBadPrediction, read), view);
  image = in_rows(std::move(image), view.camera.size());
  GLINT_CHECK(
      image.size() == view.camera.size(),
      kBadPrediction,
      "{}: {}x{} pixels, but view {} has {}x{}{}; render at that size, or load the dataset smaller "
      "with --image-ratio or --max-pixels",
      path.string(),
      image.width(),
      image.height(),
      view.name,
      view.camera.width,
      view.camera.height,
      (image.width() == 2 * view.camera.width ? " (truth and render side by side? crop them)" : ""
      ) + orientation_hint(path)
  );
  return image;
}

// Of depth as integers; nothing of floats. Errors (kBadPrediction): nobody says the step.
DepthSteps depth_scale_for(
    const std::map<std::string, fs::path>& files, const View& view, const ImportOptions& options
) {
  const auto depth = files.find("depth");
  if (depth == files.end()) return {};
  return with_exit_code(ExitCode::kBadPrediction, [&]() -> DepthSteps {
    if (!stores_integers(depth->second)) return {};
    if (options.depth_scale > 0) return {options.depth_scale, "--depth-scale"};
    DepthSteps scale = exported_depth_scale(depth->second);
    if (const Image& truth = view.truth["depth"]; !scale.known() && !truth.empty())
      scale = depth_scale_by(depth->second, truth);
    if (!scale.known()) read_depth(depth->second, scale);  // which says what is missing
    return scale;
  });
}

std::vector<std::string> names_of(const std::vector<View>& views) {
  std::vector<std::string> names;
  for (const View& view : views) names.push_back(view.name);
  return names;
}

MapSet read_view(
    const std::map<std::string, fs::path>& files,
    const View& view,
    const ImportOptions& options,
    const DepthSteps& scale,
    OddValues& odd
) {
  MapSet rendered;
  for (const MapRow& row : maps()) {
    const auto file = files.find(std::string(row.id));
    if (file == files.end()) continue;
    Image& map = rendered[row] =
        read_for(file->second, row.channels(), view, row.id == "depth" ? scale : DepthSteps());
    if (row.kind == MapKind::kColor)
      with_exit_code(ExitCode::kBadPrediction, [&] { check_finite(file->second, map); });
    if (row.kind == MapKind::kNormal) to_our_normals(map, view.camera, options.normals);
    if (row.kind == MapKind::kDepth) to_our_depth(map, view.camera, options.depth);
    odd.look(row, file->second.string(), map, view.truth[row]);
  }
  return rendered;
}

// Mean error of the first views under each convention, when the data tells.
template <class Convention, class Error>
std::string better_convention(
    Convention stated, std::span<const Convention> all, Error&& error_of
) {
  const double given = error_of(stated);
  for (const Convention other : all)
    if (other != stated && error_of(other) < kSuspicious * given)
      return Json(other).get<std::string>();
  return {};
}

double absrel(Image depth, const View& view, DepthConvention kind) {
  to_our_depth(depth, view.camera, kind);
  const auto errors = depth_errors(depth, view.truth["depth"]);
  return errors ? errors->absrel : 0;
}

double mean_angle(Image normals, const View& view, NormalAxes axes) {
  to_our_normals(normals, view.camera, axes);
  const auto errors = normal_errors(normals, view.truth["normal"]);
  return errors ? errors->mean_deg : 0;
}

void note_halves(const fs::path& picture, const View& view, std::vector<std::string>& notes) {
  const auto read = [&] { return read_image(picture); };
  if (with_exit_code(ExitCode::kBadPrediction, read).width() == 2 * view.camera.width)
    notes.push_back("pictures hold truth and render side by side: their right halves count");
}

// Files are as stored, not yet in our conventions.
void note_conventions(
    const std::map<std::string, fs::path>& files,
    const View& view,
    const ImportOptions& options,
    const DepthSteps& scale,
    std::vector<std::string>& notes
) {
  constexpr std::array kDepths = {DepthConvention::kPlanar, DepthConvention::kRay};
  constexpr std::array kAxes = {NormalAxes::kOpencv, NormalAxes::kOpengl, NormalAxes::kWorld};
  const auto note = [&](const char* map, const std::string& better, const char* option) {
    if (!better.empty())
      notes.push_back(fmt::format(
          "{} of {} fits the ground truth far better as '{}': give {} {}",
          map,
          view.name,
          better,
          option,
          better
      ));
  };
  if (files.contains("depth") && !view.truth["depth"].empty()) {
    const Image depth = read_for(files.at("depth"), 1, view, scale);
    const auto error = [&](DepthConvention kind) { return absrel(depth, view, kind); };
    note(
        "depth", better_convention<DepthConvention>(options.depth, kDepths, error), "--depth-kind"
    );
  }
  if (files.contains("normal") && !view.truth["normal"].empty()) {
    const Image normals = read_for(files.at("normal"), 3, view);
    const auto error = [&](NormalAxes axes) { return mean_angle(normals, view, axes); };
    note("normals", better_convention<NormalAxes>(options.normals, kAxes, error), "--normal-axes");
  }
}

// Maps that the data have a truth for and the renders do not, so that a table's hole has a reason.
void note_absent(
    const fs::path& folder,
    const PredictionFiles& found,
    const View& view,
    std::vector<std::string>& notes
) {
  for (const char* map : {"depth", "normal"}) {
    if (found.matching.contains(map) || view.truth[*find_map(map)].empty()) continue;
    const auto unread = unread_files(folder, map, found);
    notes.push_back(fmt::format(
        "no {0} maps read, so {0} is not scored{1}",
        map,
        unread.empty() ? std::string()
                       : fmt::format(
                             "; {} lies there, but is none of the files that are read: EXR, NPY or "
                             "TIFF in {}/, one a test view (depth also as grey PNG of 16 bits)",
                             unread.front().string(),
                             map
                         )
    ));
  }
}

// Do they come as integers?
bool has_eight_bit_images(const PredictionFiles& found) {
  return std::any_of(found.views.begin(), found.views.end(), [](const auto& files) {
    return stores_integers(files.at("rgb"));
  });
}

void note_lossy(const PredictionFiles& found, std::vector<std::string>& notes) {
  const auto count = std::ranges::count_if(found.views, [](const auto& files) {
    return is_jpeg(files.at("rgb"));
  });
  if (count > 0)
    notes.push_back(fmt::format(
        "{} of {} pictures are {}: scores are of what the compression left",
        count,
        found.views.size(),
        kLossyRenders
    ));
}

void note_orientation(const PredictionFiles& found, std::vector<std::string>& notes) {
  for (const auto& files : found.views) {
    const fs::path& picture = files.at("rgb");
    const int orientation = stated_orientation(picture);
    if (orientation == 1) continue;
    notes.push_back(fmt::format(
        "{} states {}, perhaps others too; pixels are taken as stored",
        picture.string(),
        orientation_words(orientation)
    ));
    return;
  }
}

// Returns its corners.
std::vector<Vec3f> copy_mesh(const fs::path& from, const fs::path& to, GltfUp up) {
  GLINT_CHECK(is_file(from), kBadPrediction, "{}: no such mesh", from.string());
  return with_exit_code(ExitCode::kBadPrediction, [&] {
    TriangleMesh mesh = read_mesh(from, NonFinite::kKeep);
    if (is_gltf(from) && up == GltfUp::kZ) turn_back(mesh);
    if (mesh_extension(from) == ".ply")
      write_file(to, read_file(from));
    else
      write_mesh_ply(to, mesh);
    return std::move(mesh.vertices);
  });
}

void import_mesh(
    const fs::path& from,
    const RunSpec& spec,
    const ImportOptions& options,
    std::vector<std::string>& notes
) {
  const GltfUp up = options.gltf_up == "z" ? GltfUp::kZ : GltfUp::kY;
  const std::vector<Vec3f> corners = copy_mesh(from, spec.folder / "mesh.ply", up);
  const fs::path truth = true_mesh(spec.dataset_folder);
  if (!is_file(truth)) return;
  const TriangleMesh expected = read_mesh(truth, NonFinite::kKeep);
  const NamedCorners found{from, corners}, wanted{truth, expected.vertices};
  for (std::string doubt : {mesh_unit_doubt(found, wanted), gltf_up_doubt(found, wanted, up)})
    if (!doubt.empty()) notes.push_back(std::move(doubt));
}

}  // namespace

void to_our_depth(Image& depth, const Camera& camera, DepthConvention kind) {
  if (kind == DepthConvention::kRay) make_planar(depth, camera);
}

void to_our_normals(Image& normals, const Camera& camera, NormalAxes axes) {
  if (axes == NormalAxes::kOpencv) return;
  for (std::size_t i = 0; i < normals.num_pixels(); ++i) {
    float* n = normals.data() + 3 * i;
    if (axes == NormalAxes::kOpengl) {
      n[1] = -n[1], n[2] = -n[2];
      continue;
    }
    const Vec3d world{
        static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])};
    const Vec3d cam = camera.rotation_cam_from_world * world;
    n[0] = static_cast<float>(cam.x), n[1] = static_cast<float>(cam.y);
    n[2] = static_cast<float>(cam.z);
  }
}

std::vector<std::string> import_predictions(
    const fs::path& folder, const Scene& scene, const RunSpec& spec, const ImportOptions& options
) {
  const PredictionFiles found = find_predictions(folder, names_of(scene.test));
  std::vector<std::string> notes = {"renders by another program: " + folder.string()};
  for (const auto& [map, matching] : found.matching)
    if (matching == Matching::kOrder)
      notes.push_back(map + ": files given to test views by their order, not by name");
  note_halves(found.views.front().at("rgb"), scene.test.front(), notes);
  const bool eight_bit = has_eight_bit_images(found);
  if (eight_bit)
    notes.emplace_back(
        "pictures of integers: their PSNR is psnr-8bit, of values rounded to n / 255, which is not "
        "ranked beside psnr"
    );
  note_lossy(found, notes);
  note_orientation(found, notes);
  const DepthSteps scale = depth_scale_for(found.views.front(), scene.test.front(), options);
  if (scale.known())
    notes.push_back(
        fmt::format("depth of integers: steps of {} m (by {})", scale.metres, scale.from)
    );
  note_absent(folder, found, scene.test.front(), notes);
  note_conventions(found.views.front(), scene.test.front(), options, scale, notes);
  remove_renders(spec.folder / "renders");
  write_run_spec(
      spec,
      {{"imported", folder.string()},
       {"import", config_to_json(options)},
       {kEightBitField, eight_bit}}
  );
  OddValues odd;
  for (std::size_t i = 0; i < scene.test.size(); ++i) {
    const MapSet rendered = read_view(found.views[i], scene.test[i], options, scale, odd);
    if (const std::string problem = color_range_problem(rendered["rgb"]); !problem.empty())
      notes.push_back(fmt::format("{}: {}", found.views[i].at("rgb").string(), problem));
    write_render(view_folder(spec.folder, scene.test[i].name), rendered, eight_bit);
  }
  for (std::string& note : odd.notes()) notes.push_back(std::move(note));
  const fs::path mesh = options.mesh.empty() ? found.mesh : fs::path(options.mesh);
  if (!mesh.empty()) import_mesh(mesh, spec, options, notes);
  if (write_strips.here()) write_strips(spec.folder, scene.test);
  return notes;
}

}  // namespace glint
