// SPDX-License-Identifier: MIT
#include "reports/run/import/import_model.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "glint/core/nearest.h"
#include "glint/core/presence.h"
#include "glint/scene/gaussian_ply.h"
#include "glint/scene/ply.h"
#include "reports/run/records/earlier_run.h"
#include "reports/run/records/stage_files.h"

namespace glint {
namespace {

// File names of a set, ours first, then those of the official code and of scripts around it.
struct SetNames {
  std::string ours;
  std::array<std::string_view, 4> names;
};
const std::array<SetNames, 3> kSets{{
    {"interface.ply", {"interface.ply", "pcd.ply", "intr.ply", "base.ply"}},
    {"transmission.ply", {"transmission.ply", "trans_env.ply", "trans.ply", "transmissive.ply"}},
    {"reflection.ply", {"reflection.ply", "env.ply", "refl.ply", "environment.ply"}},
}};

// point_cloud/iteration_N/point_cloud.ply of the largest N; empty: none.
fs::path last_iteration(const fs::path& folder) {
  fs::path last;
  long most = -1;
  for (const fs::path& entry : list_folders(folder / "point_cloud")) {
    const std::string name = entry.filename().string(), prefix = "iteration_";
    long iteration = -1;
    if (!name.starts_with(prefix)) continue;
    std::from_chars(name.data() + prefix.size(), name.data() + name.size(), iteration);
    const fs::path file = entry / "point_cloud.ply";
    if (iteration > most && is_file(file)) most = iteration, last = file;
  }
  return last;
}

std::vector<ModelFiles::Set> sets_in(const fs::path& folder) {
  std::vector<ModelFiles::Set> sets;
  for (const SetNames& set : kSets) {
    const auto found = std::find_if(set.names.begin(), set.names.end(), [&](auto name) {
      return is_file(folder / name);
    });
    if (found != set.names.end()) sets.push_back({set.ours, folder / *found, {}});
  }
  return sets;
}

bool has_set(const ModelFiles& files, std::string_view name) {
  return std::any_of(files.sets.begin(), files.sets.end(), [&](const ModelFiles::Set& set) {
    return set.name == name;
  });
}

// Secondary rays of GLINT's official code, with which its sets were trained, meet nothing nearer.
Json official_tracing(const std::string& method) {
  constexpr double kNearest = 0.06;
  if (method != "glint") return Json::object();
  return {{"mirror_near", kNearest}, {"secondary_near", kNearest}};
}

// The method that has these sets, and what its interface needs.
void choose_method(const fs::path& model, ModelFiles& files) {
  const bool transmission = has_set(files, "transmission.ply"),
             reflection = has_set(files, "reflection.ply");
  GLINT_CHECK(
      files.sets.front().name == "interface.ply" && (!transmission || reflection),
      kBadPrediction,
      "{}: found {}, expected interface.ply alone, with reflection.ply (EnvGS), or with "
      "transmission.ply and reflection.ply (GLINT)",
      model.string(),
      files.sets.front().path.filename().string()
  );
  files.method = transmission ? "glint" : reflection ? "envgs" : "2dgs";
  std::vector<std::string>& channels = files.sets.front().channels;
  if (transmission) channels.push_back("transparency");
  if (reflection) channels.push_back("specular");
  files.config = official_tracing(files.method);
}

// What became of a set, for people.
void note_set(
    const ModelFiles::Set& set,
    const GaussianPly& read,
    const std::vector<std::string>& ignored,
    std::vector<std::string>& notes
) {
  const std::string file = set.path.filename().string();
  notes.push_back(fmt::format("{}: {} surfels", file, read.cloud.size()));
  if (read.has_ellipsoids)
    notes.back() += fmt::format(
        " from ellipsoids, whose flattest axis was dropped (it is {:.2g} of the middle one, 90 % "
        "below {:.2g}): pictures differ from those of the program that trained them",
        read.flatness.median,
        read.flatness.percentile_90
    );
  if (!ignored.empty()) notes.back() += fmt::format("; fields ignored: {}", comma_list(ignored));
}

}  // namespace

ModelFiles find_model(const fs::path& model) {
  ModelFiles files;
  if (is_file(model)) {
    files.sets = {{"interface.ply", model, {}}};
  } else {
    files.sets = sets_in(model);
    if (const fs::path last = last_iteration(model); files.sets.empty() && !last.empty())
      files.sets = {{"interface.ply", last, {}}};
  }
  GLINT_CHECK(
      !files.sets.empty(),
      kBadPrediction,
      "{}: no model; expected a PLY with Gaussians, a folder with interface.ply (and "
      "transmission.ply, reflection.ply), or one with point_cloud/iteration_*/point_cloud.ply",
      model.string()
  );
  choose_method(model, files);
  return files;
}

std::vector<std::string> import_model(
    const fs::path& model, const ModelFiles& files, const RunSpec& spec
) {
  std::vector<std::string> notes{
      fmt::format("trained by another program: {}", fs::absolute(model).filename().string())};
  if (!spec.config.empty()) notes.push_back(fmt::format("rendered with {}", spec.config.dump()));
  std::vector<SurfelCloud> clouds;
  for (const ModelFiles::Set& set : files.sets) {
    std::vector<std::string> ignored;
    GaussianPly read = with_exit_code(ExitCode::kBadPrediction, [&] {
      return read_gaussian_ply(set.path, set.channels, ignored);
    });
    note_set(set, read, ignored, notes);
    clouds.push_back(std::move(read.cloud));
  }
  EarlierRun earlier(spec.folder);
  write_run_spec(spec, spec.train_document.at("config"));
  std::vector<std::string> names = save_in_place(spec.folder, [&](const fs::path& folder) {
    for (std::size_t i = 0; i < clouds.size(); ++i)
      write_surfel_ply(folder / files.sets[i].name, clouds[i]);
  });
  TrainCost cost;
  cost.notes = notes;
  write_trained(spec, cost);
  names.emplace_back("env.json");
  write_stage(spec.folder, Stage::kTrain, spec.train_document, names);
  earlier.drop();
  return notes;
}

void check_row_name(const std::string& name) {
  GLINT_CHECK(
      !name.empty() && !Registry<MethodSpec>::all().contains(name),
      kUsage,
      "--method '{}': name the method that made it, not one of ours; such as --method "
      "pgsr-official",
      name
  );
  for (const fs::path& part : fs::path(name + "/").parent_path())
    GLINT_CHECK(
        why_no_folder_name(part.string()).empty(),
        kUsage,
        "--method '{}': '{}' {}; results lie in a folder of that name",
        name,
        part.string(),
        why_no_folder_name(part.string())
    );
}

}  // namespace glint
