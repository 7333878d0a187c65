// SPDX-License-Identifier: MIT
#include "metrics/tools/mesh_output.h"

#include <algorithm>
#include <ostream>

#include "glint/core/printable.h"
#include "glint/drawing/color_maps.h"
#include "glint/scene/ply.h"
#include "metrics/tools/tool_output.h"

namespace glint {
namespace {

Json direction_json(const DirectionScores& scores) {
  Json json = {
      {"mean_m", scores.mean_m},
      {"rms_m", scores.rms_m},
      {"max_m", scores.max_m},
      {"clipped", scores.clipped},
      {"num_samples", scores.num_samples}};
  if (scores.normal_consistency) json["normal_consistency"] = *scores.normal_consistency;
  return json;
}

// What stands for the surface: drawn over a mesh's area, or points of a cloud.
Json surface_json(const SurfaceInput& input, std::size_t num_samples) {
  Json json = {{"kind", input.cleaning ? "mesh" : "points"}, {"num_samples", num_samples}};
  if (const auto* points = std::get_if<SurfacePoints>(&input.surface))
    json["num_points"] = points->positions.size();
  if (input.cleaning) json["cleaning"] = config_to_json(*input.cleaning);
  if (input.culling) json["culling"] = config_to_json(*input.culling);
  return json;
}

void print_direction(const char* name, const DirectionScores& scores, std::ostream& out) {
  out << fmt::format("{}: rms {:.6f} m, largest {:.6f} m", name, scores.rms_m, scores.max_m);
  if (scores.clipped > 0) out << fmt::format(", {:.2f} % clipped", 100 * scores.clipped);
  out << fmt::format(", {} samples\n", scores.num_samples);
}

// Of a point cloud: which of its points were measured, and what is measured to.
void print_sampling(
    const char* name,
    const SurfaceInput& input,
    std::size_t num_samples,
    std::uint64_t seed,
    std::ostream& out
) {
  const auto* points = std::get_if<SurfacePoints>(&input.surface);
  if (points == nullptr) return;
  const std::size_t count = points->positions.size();
  const std::string taken = num_samples < count
                                ? fmt::format("{} of them drawn (seed {})", num_samples, seed)
                                : "all of them measured";
  out << fmt::format(
      "{}: {} points, {}; distances to it: to its nearest point\n", name, count, taken
  );
}

void print_cleaning(const char* name, const SurfaceInput& input, std::ostream& out) {
  if (!input.cleaning) return;
  const CleanReport& report = *input.cleaning;
  if (report.faces_after < report.faces_before)
    out << fmt::format(
        "{}: of {} faces dropped {} not finite, {} without area, {} repeated\n",
        name,
        report.faces_before,
        report.not_finite,
        report.zero_area,
        report.duplicate
    );
  if (report.non_manifold_edges > 0)
    out << fmt::format("{}: {} non-manifold edges, kept\n", name, report.non_manifold_edges);
}

void print_culling(const char* name, const SurfaceInput& input, std::ostream& out) {
  if (!input.culling) return;
  const CullRecipe& recipe = *input.culling;
  out << fmt::format(
      "{}: {} of {} faces ({:.2f} of {:.2f} m2) seen by {} cameras, tolerance {:g} m\n",
      name,
      recipe.faces_after,
      recipe.faces_split,
      recipe.area_after_m2,
      recipe.area_before_m2,
      recipe.num_cameras,
      recipe.tolerance_m
  );
}

std::vector<Vec3f> distance_colors(
    const std::vector<Vec3f>& positions, const Surface& target, double range_m
) {
  const std::vector<double> distances = distances_to({positions, {}}, target).distances;
  Image row(static_cast<int>(distances.size()), 1, 1);
  for (std::size_t i = 0; i < distances.size(); ++i)  // 0 would mean no value
    row.data()[i] = std::max(1e-12f, static_cast<float>(distances[i]));
  const Image colors = colorize_depth(row, 0, static_cast<float>(range_m));
  std::vector<Vec3f> result(distances.size());
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = {colors.data()[3 * i], colors.data()[3 * i + 1], colors.data()[3 * i + 2]};
  return result;
}

}  // namespace

void print_mesh_text(const MeshReport& report, std::ostream& out) {
  print_scores(mesh_values(report.scores, report.protocol), out);
  print_direction("accuracy", report.scores.accuracy, out);
  print_direction("completeness", report.scores.completeness, out);
  const std::uint64_t seed = report.protocol.seed;
  print_sampling("prediction", report.prediction, report.scores.accuracy.num_samples, seed, out);
  print_sampling("reference", report.reference, report.scores.completeness.num_samples, seed, out);
  print_cleaning("prediction", report.prediction, out);
  print_cleaning("reference", report.reference, out);
  print_culling("prediction", report.prediction, out);
  print_culling("reference", report.reference, out);
  out << fmt::format("protocol {}\n", config_to_json(report.protocol).dump());
  if (report.color_range_m)
    out << fmt::format("colours: 0 m yellow to {:g} m violet\n", *report.color_range_m);
}

void print_mesh_csv(const MeshReport& report, std::ostream& out) {
  const ToolScores values = mesh_values(report.scores, report.protocol);
  out << "name";
  for (const auto& value : values) out << "," << value.first;
  out << "\n" << csv_field(report.prediction.path.string());
  for (const auto& value : values) out << fmt::format(",{}", value.second);
  out << "\n";
}

Json mesh_report_json(const MeshReport& report) {
  Json json = {
      {"tool", "glint-mesh"},
      {"prediction", report.prediction.path.string()},
      {"reference", report.reference.path.string()}};
  if (!report.dataset.empty()) json["dataset"] = report.dataset.string();
  if (!report.gltf_up.empty()) json["gltf_up"] = report.gltf_up;
  if (!report.warnings.empty()) json["warnings"] = report.warnings;
  json["metrics"] = scores_json(mesh_values(report.scores, report.protocol));
  json["summary"] = {
      {"accuracy", direction_json(report.scores.accuracy)},
      {"completeness", direction_json(report.scores.completeness)}};
  json["protocol"] = config_to_json(report.protocol);
  json["surfaces"] = {
      {"prediction", surface_json(report.prediction, report.scores.accuracy.num_samples)},
      {"reference", surface_json(report.reference, report.scores.completeness.num_samples)}};
  if (report.color_range_m) json["colors_m"] = {0.0, *report.color_range_m};
  json["curve"] = Json::array();
  for (const ThresholdScores& at : report.curve) json["curve"].push_back(config_to_json(at));
  return json;
}

void print_mesh_json(const MeshReport& report, std::ostream& out) {
  const Json json = mesh_report_json(report);
  out << json.dump(2, ' ', false, Json::error_handler_t::replace) << "\n";
}

void write_colored(
    const fs::path& path, const Surface& surface, const Surface& target, double range_m
) {
  if (const auto* points = std::get_if<SurfacePoints>(&surface)) {
    const std::vector<Vec3f> colors = distance_colors(points->positions, target, range_m);
    write_point_ply(path, {points->positions, colors, points->normals});
    return;
  }
  TriangleMesh mesh = std::get<TriangleMesh>(surface);
  mesh.colors = distance_colors(mesh.vertices, target, range_m);
  write_mesh_ply(path, mesh);
}

}  // namespace glint
