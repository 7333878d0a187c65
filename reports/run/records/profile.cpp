// SPDX-License-Identifier: MIT
#include "reports/run/records/profile.h"

#include <charconv>
#include <cmath>
#include <set>

#include "glint/core/files.h"
#include "glint/core/nearest.h"
#include "glint/core/presence.h"
#include "glint/method.h"
#include "glint/scene/scene.h"
#include "reports/run/records/embedded.h"
#include "reports/run/records/manifest.h"

namespace glint {

namespace {

std::string profile_text(const std::string& name) {
  const auto it = embedded_files().find(fmt::format("profiles/{}.toml", name));
  if (it != embedded_files().end()) return std::string(it->second);
  const std::vector<std::string> known = embedded_names("profiles");
  GLINT_CHECK(
      with_exit_code(ExitCode::kUsage, [&] { return is_file(name); }),
      kUsage,
      "--profile {}: no such profile or TOML file; {}profiles: {}",
      name,
      did_you_mean(name, known),
      comma_list(known)
  );
  return with_exit_code(ExitCode::kUsage, [&] { return read_file(name); });
}

// "method.name=value" -> {"method", "name=value"}; without a method the first part is empty.
std::pair<std::string, std::string> split_assignment(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  GLINT_CHECK(
      equals != std::string::npos && equals > 0,
      kUsage,
      "--set {}: expected name=value or method.name=value",
      assignment
  );
  const std::size_t dot = assignment.substr(0, equals).find('.');
  if (dot == std::string::npos) return {"", assignment};
  return {assignment.substr(0, dot), assignment.substr(dot + 1)};
}

std::vector<SceneSource> manifest_sources(const std::string& id, const std::string& where) {
  const Manifest* manifest = find_manifest(id);
  GLINT_CHECK(
      manifest != nullptr,
      kUsage,
      "{}: manifests: no published dataset '{}'; there are: {}",
      where,
      id,
      comma_list(embedded_names("manifests"))
  );
  std::vector<SceneSource> sources;
  for (const ManifestScene& scene : manifest->scenes) {
    SceneSource source{id, scene.name, scene.folder};
    source.image_ratio = manifest->image_ratio;
    source.manifest = id;
    sources.push_back(source);
  }
  return sources;
}

template <class T>
void check_once(const std::vector<T>& values, const char* field, const std::string& where) {
  std::set<T> seen;
  for (const T& value : values)
    GLINT_CHECK(
        seen.insert(value).second,
        kUsage,
        "{}: {} has {} twice; expected each once",
        where,
        field,
        value
    );
}

void check_lists(const Profile& profile, const std::string& where) {
  check_once(profile.methods, "methods", where);
  check_once(profile.seeds, "seeds", where);
}

void check_least(const std::string& where, const char* field, double value, double least) {
  GLINT_CHECK(
      value >= least, kUsage, "{}: {} is {}; expected {} or more", where, field, value, least
  );
}

void check_numbers(const Profile& profile, const std::string& where) {
  check_least(where, "iterations", profile.iterations, 1);
  check_least(where, "test_psnr_every", profile.test_psnr_every, 0);
  check_least(where, "timing_frames", profile.timing_frames, 1);
  check_least(where, "timing_warmup", profile.timing_warmup, 0);
  check_least(where, "gpus", profile.gpus, 0);
}

// What no room can be made with, and pictures cannot be shrunk to.
void check_sizes(const SceneSource& source, const std::string& where) {
  constexpr int kLeastSide = 8, kMostSide = 8192;  // pixels, as of rooms that are made
  constexpr double kLeastRatio = 0.001;
  for (const auto& [field, pixels] : {std::pair{"width", source.width}, {"height", source.height}})
    GLINT_CHECK(
        pixels >= kLeastSide && pixels <= kMostSide,
        kUsage,
        "{}: {} is {}; expected {} to {} pixels",
        where,
        field,
        pixels,
        kLeastSide,
        kMostSide
    );
  check_least(where, "views", source.views, 1);
  check_least(where, "spp", source.spp, 1);
  check_least(where, "max_pixels", source.max_pixels, 0);
  GLINT_CHECK(
      source.image_ratio >= kLeastRatio && source.image_ratio <= 1,
      kUsage,
      "{}: image_ratio is {}; expected {} to 1",
      where,
      source.image_ratio,
      kLeastRatio
  );
}

// Opens the message of an error with where it was found.
template <class F>
void with_place(const std::string& where, F&& check) {
  try {
    check();
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("{}: {}", where, error.what()));
  }
}

// A value as it is typed: JSON, numbers that JSON does not know (.5, 5., -.5), or text.
Json assigned_value(const std::string& text) {
  if (Json value = parse_json(text); !value.is_discarded()) return value;
  double number = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error == std::errc() && stop == end && std::isfinite(number)) return number;
  return text;
}

}  // namespace

Profile load_profile(const std::string& name) {
  const std::string where = fmt::format("profile {}", name);
  Profile profile;
  config_from_json(profile, json_from_toml(profile_text(name), where), where);
  profile.name = fs::path(name).stem().string();
  check_numbers(profile, where);
  check_lists(profile, where);
  profile.sources();
  profile.mesh_protocol();
  return profile;
}

TsdfOptions Profile::tsdf_options() const {
  TsdfOptions options;
  const std::string where = fmt::format("profile {} [mesh]", name);
  config_from_json(options, mesh, where);
  with_place(where, [&] { check_tsdf_options(options); });
  return options;
}

MeshProtocol Profile::mesh_protocol() const {
  MeshProtocol protocol = mesh_protocol_for(tsdf_options());
  const std::string where = fmt::format("profile {} [mesh_metrics]", name);
  config_from_json(protocol, mesh_metrics, where);
  with_place(where, [&] { check_mesh_protocol(protocol); });
  return protocol;
}

std::vector<SceneSource> Profile::sources() const {
  const std::string where = fmt::format("profile {}", name);
  std::vector<SceneSource> sources;
  std::set<std::string> names;
  for (const Json& entry : scenes) {
    SceneSource source{"glassroom"};
    config_from_json(source, defaults, where + " defaults");
    config_from_json(source, entry.is_string() ? Json{{"scene", entry}} : entry, where + " scenes");
    GLINT_CHECK(
        !source.scene.empty() && names.insert(source.scene).second,
        kUsage,
        "{}: scene '{}' has no name or stands there twice",
        where,
        source.scene
    );
    const std::string why = why_no_folder_name(source.scene);
    GLINT_CHECK(why.empty(), kUsage, "{}: scene '{}' {}", where, source.scene, why);
    check_prior_options(source.foreign_priors, fmt::format("{}: scene '{}'", where, source.scene));
    check_prior_level(source.priors, fmt::format("{}: scene '{}'", where, source.scene));
    check_sizes(source, fmt::format("{}: scene '{}'", where, source.scene));
    sources.push_back(source);
  }
  for (const std::string& id : manifests)
    for (SceneSource& source : manifest_sources(id, where)) {
      GLINT_CHECK(
          names.insert(source.scene).second,
          kUsage,
          "{}: scene '{}' of {} stands there twice",
          where,
          source.scene,
          id
      );
      sources.push_back(std::move(source));
    }
  return sources;
}

Json method_overrides(
    const Profile& profile, const std::string& method, const std::vector<std::string>& assignments
) {
  Json config = profile.overrides.value(method, Json::object());
  for (const std::string& text : assignments) {
    const auto [target, assignment] = split_assignment(text);
    const std::size_t equals = assignment.find('=');
    const Json field{{assignment.substr(0, equals), assigned_value(assignment.substr(equals + 1))}};
    if (target.empty() || target == method)
      config.update(field);
    else
      create_method(target, field);  // a misspelt one is no method's, or no field of it
  }
  return config;
}

}  // namespace glint
