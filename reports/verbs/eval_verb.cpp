// SPDX-License-Identifier: MIT
#include <memory>

#include "datasets/dataset.h"
#include "glint/core/progress.h"
#include "metrics/fusion/tsdf.h"
#include "metrics/tools/numeric_options.h"
#include "reports/bench/run_record.h"
#include "reports/bench/run_stage.h"
#include "reports/bench/stage_documents.h"
#include "reports/import/import_model.h"
#include "reports/import/import_predictions.h"
#include "reports/records/earlier_run.h"
#include "reports/records/environment.h"
#include "reports/records/parcel_run.h"
#include "reports/verbs/headline_scores.h"
#include "reports/verbs/single_run.h"

namespace glint {

namespace {

// Of the trained model; nothing: another program's renders, or its files are gone.
std::optional<std::size_t> count_surfels(const RunSpec& spec) {
  if (!read_stage(spec.folder, Stage::kTrain)) return std::nullopt;
  try {
    return load_trained(spec)->num_surfels();
  } catch (const Error& error) {
    log::warn(fmt::format("{}: surfels are not counted: {}", spec.folder.string(), error.what()));
    return std::nullopt;
  }
}

// What the run says about its cost, and an earlier scoring; scoring again does not change it.
Scores known_cost(const RunSpec& spec) {
  Scores cost = training_cost(spec);
  if (const auto surfels = count_surfels(spec)) cost["num-surfels"] = static_cast<double>(*surfels);
  const fs::path path = spec.folder / "metrics.json";
  if (!fs::exists(path)) return cost;
  const Json json = parse_json(read_file(path));
  if (!json.is_object())
    log::warn(fmt::format("{}: damaged; fps and surfels are not known any more", path.string()));
  if (json.is_object() && json.value("metrics", Json()).is_object())
    for (const char* id : {"fps", "num-surfels"})
      if (const auto it = json["metrics"].find(id); it != json["metrics"].end() && it->is_number())
        cost.emplace(id, it->get<double>());
  return cost;
}

// That of the voxels the run's meshes were made with.
MeshProtocol mesh_protocol_of(const RunSpec& spec) {
  const fs::path path = spec.folder / "mesh.json";
  if (!fs::exists(path)) return {};
  const Json json = read_json_object(path, ExitCode::kBadPrediction);
  GLINT_CHECK(
      json.contains("options"),
      kBadPrediction,
      "{}: not a report of the mesh stage; run `glint-bench mesh` again",
      path.string()
  );
  TsdfOptions options;
  config_from_json(options, json["options"], path.string());
  return mesh_protocol_for(options);
}

int print_scores(
    const CommonOptions& common,
    const fs::path& folder,
    const Scores& means,
    bool all,
    const std::vector<std::string>& warnings = {}
) {
  if (common.json) {
    Json json = {{"run", folder.string()}, {"metrics", means}};
    if (!warnings.empty()) json["warnings"] = warnings;
    print_json(json);
    return 0;
  }
  print_text(all ? all_scores(means) : headline_scores(means));
  if (!all)
    log::info(fmt::format(
        "{} values in all: --all; those of each view: {}",
        means.size(),
        (folder / "metrics.json").string()
    ));
  return 0;
}

// The frames behind the cost that an earlier scoring found; nothing: none were timed.
std::optional<TimingOptions> earlier_timing(const fs::path& run) {
  const auto scored = read_stage(run, Stage::kScore);
  if (!scored) return std::nullopt;
  const double frames = number_or(scored->document, "timing_frames", -1),
               warmup = number_or(scored->document, "timing_warmup", -1);
  if (!(frames >= 0 && warmup >= 0 && frames + warmup < 1e9)) return std::nullopt;
  return TimingOptions{static_cast<int>(frames), static_cast<int>(warmup)};
}

// Of renders and meshes without a key (an earlier version's, another program's): none.
std::string key_of(const fs::path& run, Stage stage) {
  const auto done = read_stage(run, stage);
  return done ? stage_key(done->document) : "";
}

// Of a run apart from any profile: what its folder and its scores say.
Record single_record(const SingleRun& single, const Json& score_document, const Scores& means) {
  const RunSpec& spec = single.spec;
  Record record;
  record.profile = kSingleProfile;
  record.dataset = spec.dataset;
  record.cell = spec.cell();
  record.metrics = means;
  record.train_key = key_of(spec.folder, Stage::kTrain);
  record.score_key = stage_key(score_document);
  record.dataset_hash = single.scene.spec_hash;
  record.environment = environment_json();
  describe_run(record, spec, single.scene);
  if (!single.data_warning.empty()) record.warnings.push_back(single.data_warning);
  return record;
}

// Appends it, or says why not.
void record_single(const CommonOptions& common, const RunSpec& spec, const Record& record) {
  const fs::path file = single_records_file(common, spec);
  if (file.empty()) {
    log::info(fmt::format(
        "not recorded: {} is a run of a profile, whose records `glint-bench all` writes",
        spec.folder.string()
    ));
    return;
  }
  const auto stored = read_records(file);
  const Record* earlier = find_record(stored, record.cell);
  if (earlier && earlier->train_key != record.train_key)
    log::warn(fmt::format(
        "{}: replaces the record of another run of {}; train with another --seed to keep both",
        file.string(),
        record.cell.text()
    ));
  append_record(file, record);
  log::info(fmt::format(
      "recorded in {}; tables: glint-bench table --out {}",
      file.string(),
      file.parent_path().string()
  ));
}

// Errors (kBadReference): nothing to score.
void check_test_views(const Scene& scene, const fs::path& dataset) {
  GLINT_CHECK(
      !scene.test.empty(),
      kBadReference,
      "{}: no test views, which are what is scored; name some in scene.json (test_views)",
      dataset.string()
  );
}

struct EvalArguments {
  std::string run, predictions, dataset, method, depth = "planar", axes = "opencv", mesh;
  std::optional<double> max_pixels, image_ratio;
  bool all = false, force = false;
};

// Other data than a run was trained on may be the scene, made or moved anew; not a scene of another
// name, against which its renders say nothing.
void check_same_scene(const SingleRun& single, const std::string& run) {
  GLINT_CHECK(
      single.data_warning.empty() || single.scene.name == single.spec.scene,
      kUsage,
      "--dataset is scene '{}', but {} was trained on '{}' and rendered its views; give that "
      "scene's "
      "data",
      single.scene.name,
      run,
      single.spec.scene
  );
}

int eval_run(const CommonOptions& common, const EvalArguments& arguments) {
  const std::string& folder = arguments.run;
  refuse_parcel_run(folder, "eval");
  const SingleRun single = open_single_run(folder, arguments.dataset);
  check_same_scene(single, folder);
  check_test_views(single.scene, single.spec.dataset_folder);
  const MeshProtocol protocol = mesh_protocol_of(single.spec);
  const std::optional<TimingOptions> timing = earlier_timing(folder);
  const Json document = score_document(
      single.spec.method,
      {key_of(folder, Stage::kRender),
       key_of(folder, Stage::kMesh),
       truth_content(single.spec.dataset_folder, common.data)},
      protocol,
      timing
  );
  Scores means;
  run_stage(folder, Stage::kScore, document, [&] {
    const Scores cost = known_cost(single.spec);
    means = eval_stage(single.spec, single.scene, cost, protocol, timing);
    return std::string();
  });
  record_single(common, single.spec, single_record(single, document, means));
  return print_scores(common, folder, means, arguments.all);
}

// Errors (kUsage): the store has the cell, and nobody said that it may be replaced.
void check_new_import(
    const fs::path& records, const CellKey& cell, const EvalArguments& arguments
) {
  const auto stored = read_records(records);
  const Record* earlier = find_record(stored, cell);
  GLINT_CHECK(
      earlier == nullptr || arguments.force,
      kUsage,
      "{}: holds {} already ({}); give another --method or --seed, or --force to replace it",
      records.string(),
      cell.text(),
      earlier && !earlier->imported.empty() ? "imported from " + earlier->imported : "trained here"
  );
}

Record record_of(const RunSpec& spec, const Profile& profile, const std::string& predictions) {
  Record record;
  record.profile = profile.name;
  record.dataset = spec.dataset;
  record.cell = spec.cell();
  record.dataset_hash = spec.dataset_hash;
  record.imported = predictions;
  record.environment = environment_json();
  record.not_measured = missing_metrics();
  return record;
}

// Imports stand beside single runs where --out is the folder of such.
Profile import_profile(const CommonOptions& common) {
  if (!holds_single_runs(common.out)) return common.resolved_profile();
  Profile profile;
  profile.name = kSingleProfile;
  return profile;
}

RunSpec spec_of(
    const CommonOptions& common,
    const Profile& profile,
    const EvalArguments& arguments,
    const Scene& scene
) {
  RunSpec spec;
  spec.method = arguments.method;
  spec.dataset_folder = fs::absolute(arguments.dataset);
  spec.dataset = scene.dataset;
  spec.scene = scene.name;
  spec.options.seed = common.seed.value_or(0);
  spec.max_pixels = arguments.max_pixels.value_or(0);
  spec.image_ratio = arguments.image_ratio.value_or(1);
  spec.dataset_hash = scene.spec_hash;
  spec.folder =
      run_folder(common.own_folder(profile), {spec.scene, spec.method, spec.options.seed});
  return spec;
}

// A scene of the profile is named as there, and as large if the command does not say otherwise.
Scene load_imported(const CommonOptions& common, const Profile& profile, EvalArguments& arguments) {
  const auto source = find_source(profile, arguments.dataset, common.data);
  if (source && !arguments.max_pixels && !arguments.image_ratio) {
    arguments.max_pixels = source->max_pixels;
    arguments.image_ratio = source->image_ratio;
  }
  LoadOptions load;
  load.max_pixels = arguments.max_pixels.value_or(0);
  load.image_ratio = arguments.image_ratio.value_or(1);
  if (source) load.loader = source->loader;
  Scene scene = load_scene(arguments.dataset, load);
  check_test_views(scene, arguments.dataset);
  if (!source) return scene;
  log::info(fmt::format(
      "{}: {} of profile {}, at {}x{}",
      arguments.dataset,
      source->scene,
      profile.name,
      scene.test.front().camera.width,
      scene.test.front().camera.height
  ));
  scene.name = source->scene;
  scene.dataset = source->dataset;
  return scene;
}

int eval_predictions(const CommonOptions& common, EvalArguments arguments) {
  GLINT_CHECK(
      !arguments.predictions.empty() && !arguments.dataset.empty(),
      kUsage,
      "give --run FOLDER, or --predictions FOLDER --dataset FOLDER --method NAME"
  );
  check_row_name(arguments.method);
  const Profile profile = import_profile(common);
  const Scene scene = load_imported(common, profile, arguments);
  const RunSpec spec = spec_of(common, profile, arguments, scene);
  const ImportOptions options{
      Json(arguments.depth).get<DepthConvention>(),
      Json(arguments.axes).get<NormalAxes>(),
      arguments.mesh};
  check_new_import(
      common.records_file(profile), {spec.scene, spec.method, spec.options.seed}, arguments
  );
  Record record = record_of(spec, profile, arguments.predictions);
  EarlierRun earlier(spec.folder);
  record.warnings = import_predictions(arguments.predictions, scene, spec, options);
  log::info(record.warnings.front());  // whose renders they are
  for (std::size_t i = 1; i < record.warnings.size(); ++i) log::warn(record.warnings[i]);
  const Json document = score_document(
      spec.method,
      {content_hash(arguments.predictions, fs::path(common.data) / ".hashes"),
       "",
       truth_content(spec.dataset_folder, common.data)},
      profile.mesh_protocol(),
      std::nullopt
  );
  record.score_key = stage_key(document);
  run_stage(spec.folder, Stage::kScore, document, [&] {
    record.metrics = eval_stage(spec, scene, {}, profile.mesh_protocol());
    return std::string();
  });
  if (!record.metrics.contains("psnr") && record.metrics.contains("psnr-8bit"))
    record.not_measured["psnr"] = "8-bit images";
  record.not_applicable = not_applicable(record.metrics, record.not_measured);
  const Camera& camera = scene.test.front().camera;
  record.resolution = fmt::format("{}x{}", camera.width, camera.height);
  append_record(common.records_file(profile), record);
  earlier.drop();
  log::info("recorded in " + common.records_file(profile).string());
  return print_scores(common, spec.folder, record.metrics, arguments.all, record.warnings);
}

void add_prediction_options(CLI::App& verb, CLI::Option& predictions, EvalArguments& arguments) {
  const auto add = [&](const char* name, auto& value, const char* help) {
    return verb.add_option(name, value, help)->needs(&predictions);
  };
  add("--method", arguments.method, "row in tables, e.g. mine");
  add("--depth-kind", arguments.depth, "of their depth: along z, or along rays")
      ->check(CLI::IsMember({"planar", "ray"}))
      ->capture_default_str();
  add("--normal-axes", arguments.axes, "of their normals")
      ->check(CLI::IsMember({"opencv", "opengl", "world"}))
      ->capture_default_str();
  add("--mesh", arguments.mesh, "PLY of theirs; otherwise looked for");
  add("--max-pixels", arguments.max_pixels, "shrink images below this area")
      ->check(at_least_zero());
  add("--image-ratio", arguments.image_ratio, "shrink both sides of images to this share")
      ->check(CLI::Range(1e-3, 1.0))
      ->excludes("--max-pixels");
}

void add_eval_verb(CommandLine& line) {
  auto arguments = std::make_shared<EvalArguments>();
  CLI::App* verb = line.add_verb(
      line.app,
      "eval",
      "score the renders of a run, or those that another program left in a folder",
      [&line, arguments] {
        return arguments->run.empty() ? eval_predictions(line.common, *arguments)
                                      : eval_run(line.common, *arguments);
      },
      kOutOption | kDataOption | kProfileOption | kSeedOption | kDeviceOption | kThreadsOption |
          kJsonOption | kQuietOption
  );
  auto* run = verb->add_option("--run", arguments->run, "run folder: writes its metrics.json");
  auto* predictions = verb->add_option(
      "--predictions", arguments->predictions, "folder with renders of the test views by anyone"
  );
  run->excludes(predictions);
  verb->add_option(
      "--dataset",
      arguments->dataset,
      "of --predictions: folder or packed scene; of --run: where its data are now, if they have "
      "moved"
  );
  verb->add_flag("--force", arguments->force, "replace an import of the same name");
  verb->add_flag("--all", arguments->all, "print every value, not the ten headlines");
  add_prediction_options(*verb, *predictions, *arguments);
}

}  // namespace

GLINT_REGISTER(Verb, {"eval", add_eval_verb})

}  // namespace glint
