// SPDX-License-Identifier: MIT
#include <memory>

#include "datasets/holdout.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "metrics/fusion/tsdf.h"
#include "metrics/tools/numeric_options.h"
#include "reports/run/bench/stage_documents.h"
#include "reports/run/import/import_model.h"
#include "reports/run/import/import_predictions.h"
#include "reports/run/records/earlier_run.h"
#include "reports/run/records/parcel_run.h"
#include "reports/run/records/stage_files.h"
#include "reports/verbs/headline_scores.h"
#include "reports/verbs/single_cell.h"

namespace glint {

namespace {

// What an earlier scoring measured and counted: scoring again does not change it.
void add_earlier_cost(const fs::path& metrics_file, ScoreOptions& options) {
  const auto text = with_exit_code(ExitCode::kBadPrediction, [&] {
    return is_there(metrics_file) ? std::optional(read_file(metrics_file)) : std::nullopt;
  });
  if (!text) return;
  const Json json = parse_json(*text);
  if (!json.is_object())
    return log::warn(
        fmt::format("{}: damaged; fps and surfels are not known any more", metrics_file.string())
    );
  const Json means = json.value("metrics", Json()),
             timing = json.value(Json::json_pointer("/protocol/fps"), Json());
  for (const char* id : {"fps", "num-surfels"})
    if (means.is_object() && means.value(id, Json()).is_number())
      options.cost[id] = means[id].get<double>();
  if (!timing.is_object()) return;
  const double frames = number_or(timing, "frames", -1), warmup = number_or(timing, "warmup", -1);
  if (frames >= 0 && warmup >= 0 && frames + warmup < 1e9)
    options.timing = TimingOptions{static_cast<int>(frames), static_cast<int>(warmup)};
}

// Of the trained model, where nobody has; not of another program's renders.
void add_surfels(const RunSpec& spec, Scores& cost) {
  if (cost.contains("num-surfels") || !read_stage(spec.folder, Stage::kTrain)) return;
  try {
    cost["num-surfels"] = static_cast<double>(load_trained(spec)->num_surfels());
  } catch (const Error& error) {
    log::warn(fmt::format("{}: surfels are not counted: {}", spec.folder.string(), error.what()));
  }
}

// By what the folder says of the run: its cost, the voxels that its meshes were made with.
ScoreOptions score_options(const CommonOptions& common, const RunSpec& spec) {
  ScoreOptions options;
  options.cost = training_cost(spec);
  options.truth = truth_content(spec.dataset_folder, common.data);
  add_earlier_cost(spec.folder / "metrics.json", options);
  add_surfels(spec, options.cost);
  const auto mesh = read_stage(spec.folder, Stage::kMesh);
  if (mesh && mesh->note.empty() && mesh->document.contains("mesh"))
    options.mesh = mesh_protocol_for(options_in<TsdfOptions>(mesh->document, "mesh"));
  return options;
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

// Appends it; the records of a profile are `all`'s.
void record_single(const CommonOptions& common, const RunSpec& spec, const Record& record) {
  const fs::path folder = records_folder(common, spec), file = folder / "records.jsonl";
  const auto stored = read_records(file);
  if (!stored.empty() && !holds_single_runs(folder))
    return log::info(fmt::format(
        "not recorded: {} is a run of a profile, whose records `glint-bench all` writes",
        spec.folder.string()
    ));
  const Record* earlier = find_record(stored, record.cell);
  if (earlier && earlier->train_key != record.train_key)
    log::warn(fmt::format(
        "{}: replaces the record of another run of {}; train with another --seed to keep both",
        file.string(),
        record.cell.text()
    ));
  append_record(file, record);
  log::info(fmt::format(
      "recorded in {}; tables: glint-bench table --out {}", file.string(), folder.string()
  ));
}

// Errors (kBadReference): nothing to score.
void check_test_views(const Scene& scene, const fs::path& dataset) {
  check_not_held_out(dataset, scene);
  GLINT_CHECK(
      !scene.test.empty(),
      kBadReference,
      "{}: no test views, which are what is scored; name some in scene.json (test_views)",
      dataset.string()
  );
}

struct EvalArguments {
  std::string run, predictions, dataset, method, depth = "planar", axes = "opencv", mesh,
                                                 gltf_up = "y";
  std::optional<double> max_pixels, image_ratio;
  double depth_scale = 0;  // metres; 0: not given
  bool all = false, force = false;
};

// Other data than a run was trained on may be the scene, made or moved anew; not a scene of another
// name, against which its renders say nothing.
void check_same_scene(const SingleCell& single, const std::string& run) {
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
  refuse_parcel_run(arguments.run, "eval");
  const SingleCell single = open_single_cell(arguments.run, arguments.dataset);
  const RunSpec& spec = single.spec;
  check_same_scene(single, arguments.run);
  check_test_views(single.scene, spec.dataset_folder);
  const Scores means = eval_stage(spec, single.scene, score_options(common, spec));
  Record record = make_record(kSingleProfile, spec, single.scene, means);
  if (!single.data_warning.empty()) record.warnings.push_back(single.data_warning);
  record_single(common, spec, record);
  return print_scores(common, arguments.run, means, arguments.all);
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

// Imports stand beside single runs where --out is the folder of such.
Profile import_profile(const CommonOptions& common) {
  Profile profile =
      holds_single_runs(common.out) ? single_profile(common, 0) : common.resolved_profile();
  profile.iterations = 0;  // not known
  return profile;
}

// A scene of the profile is named as there, and as large if the command does not say otherwise.
SceneSource import_source(
    const CommonOptions& common, const Profile& profile, const EvalArguments& arguments
) {
  const SceneSource named =
      find_source(profile, arguments.dataset, common.data).value_or(SceneSource{});
  const bool as_there = !arguments.max_pixels && !arguments.image_ratio;
  SceneSource source;
  source.dataset = named.dataset;
  source.scene = named.scene;
  source.loader = named.loader;
  source.max_pixels = as_there ? named.max_pixels : arguments.max_pixels.value_or(0);
  source.image_ratio = as_there ? named.image_ratio : arguments.image_ratio.value_or(1);
  return source;
}

LoadedScene load_imported(
    const Profile& profile, const EvalArguments& arguments, SceneSource& source
) {
  const std::string named = source.scene;
  LoadedScene loaded = load_user_data(source, arguments.dataset);
  check_test_views(loaded.scene, arguments.dataset);
  if (named.empty()) return loaded;
  const Camera& camera = loaded.scene.test.front().camera;
  log::info(fmt::format(
      "{}: {} of profile {}, at {}x{}",
      arguments.dataset,
      named,
      profile.name,
      camera.width,
      camera.height
  ));
  return loaded;
}

// A run folder of an import, for it alone. Folders around it that were made for the lock go again
// where nothing came of the import.
class ImportPlace {
 public:
  explicit ImportPlace(const fs::path& run) : run_(run), there_(run) {
    do there_ = there_.parent_path();
    while (!there_.empty() && !is_there(there_));
    lock_.emplace(lock_run(run, "give another --method or --seed"));
  }
  ~ImportPlace() {
    lock_.reset();
    std::error_code code;
    fs::path folder = run_.parent_path();
    while (folder != there_ && fs::remove(folder, code)) folder = folder.parent_path();
  }
  ImportPlace(const ImportPlace&) = delete;
  ImportPlace& operator=(const ImportPlace&) = delete;

 private:
  fs::path run_, there_;
  std::optional<FileLock> lock_;
};

// Why results lie there, in words of what was asked.
std::string store_words(const CommonOptions& common, const Profile& profile) {
  if (holds_single_runs(common.out)) return " (beside the runs of --out)";
  return fmt::format(
      " (below --out {}, in the store of profile {}; --out DIR or --profile NAME is another)",
      common.out,
      profile.name
  );
}

int eval_predictions(const CommonOptions& common, const EvalArguments& arguments) {
  GLINT_CHECK(
      !arguments.predictions.empty() && !arguments.dataset.empty(),
      kUsage,
      "give --run FOLDER, or --predictions FOLDER --dataset FOLDER --method NAME"
  );
  check_row_name(arguments.method);
  const Profile profile = import_profile(common);
  PlanCell cell{{"", arguments.method, common.seed.value_or(0)}, {}, Json::object()};
  cell.source = import_source(common, profile, arguments);
  const LoadedScene loaded = load_imported(profile, arguments, cell.source);
  cell.cell.scene = cell.source.scene;
  const RunSpec spec =
      make_spec(cell, profile, loaded, run_folder(common.own_folder(profile), cell.cell));
  const fs::path records = common.records_file(profile);
  const ImportPlace place(spec.folder);
  check_new_import(records, cell.cell, arguments);
  EarlierRun earlier(spec.folder);
  const auto notes = import_predictions(
      arguments.predictions,
      loaded.scene,
      spec,
      {Json(arguments.depth).get<DepthConvention>(),
       Json(arguments.axes).get<NormalAxes>(),
       arguments.mesh,
       arguments.gltf_up,
       arguments.depth_scale}
  );
  log::info(notes.front());  // whose renders they are
  for (std::size_t i = 1; i < notes.size(); ++i) log::warn(notes[i]);
  const Scores means = eval_stage(
      spec,
      loaded.scene,
      {.mesh = profile.mesh_protocol(),
       .truth = truth_content(spec.dataset_folder, common.data),
       .render_key = content_hash(arguments.predictions, fs::path(common.data) / ".hashes")}
  );
  Record record = make_record(profile.name, spec, loaded.scene, means);
  record.imported = arguments.predictions;
  record.warnings = notes;
  append_record(records, record);
  earlier.drop();
  log::info(fmt::format("recorded in {}{}", records.string(), store_words(common, profile)));
  return print_scores(common, spec.folder, means, arguments.all, notes);
}

void add_prediction_options(CLI::App& verb, CLI::Option& predictions, EvalArguments& arguments) {
  const auto add = [&](const char* name, auto& value, const char* help) {
    return verb.add_option(name, value, help)->needs(&predictions);
  };
  add("--method", arguments.method, "row in tables, e.g. mine");
  add("--depth-kind", arguments.depth, "of their depth: along z, or along rays")
      ->check(CLI::IsMember({"planar", "ray"}))
      ->capture_default_str();
  add("--depth-scale", arguments.depth_scale, "metres of a step of depth as integers")
      ->check(above_zero());
  add("--normal-axes", arguments.axes, "of their normals")
      ->check(CLI::IsMember({"opencv", "opengl", "world"}))
      ->capture_default_str();
  add("--mesh", arguments.mesh, "PLY, GLB, OBJ or STL of theirs; otherwise looked for");
  add("--gltf-up", arguments.gltf_up, "of a GLB: axis that was up in the frame it was written from")
      ->check(CLI::IsMember({"y", "z"}))
      ->capture_default_str();
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
