// SPDX-License-Identifier: MIT
#include <memory>

#include "datasets/dataset.h"
#include "datasets/exchange/exchange_scene.h"
#include "datasets/glassroom/glassroom.h"
#include "datasets/holdout.h"
#include "datasets/packed_scene.h"
#include "glint/core/interrupt.h"
#include "glint/core/nearest.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/core/rows.h"
#include "metrics/tools/numeric_options.h"
#include "reports/verbs/dataset_parts.h"
#include "reports/verbs/load_options.h"
#include "reports/verbs/print_findings.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {

constexpr CommonOption kDatasetOptions = kThreadsOption | kJsonOption | kQuietOption;

struct MakeOptions {
  std::string dataset;
  std::vector<std::string> scenes{"room_1"};
  GlassRoomOptions room;
  Front3dOptions front3d;
  std::string write_scene;  // folder; empty: the scene is rendered
};

fs::path folder_for(
    const CommonOptions& common, const GlassRoomOptions& room, bool out_given, bool single
) {
  if (out_given) return single ? fs::path(common.out) : fs::path(common.out) / room.scene;
  return fs::path(common.data) / "glassroom" /
         fmt::format("{}-{}", room.scene, glassroom_hash(room).substr(0, 8));
}

// `scene`: a room of GlassRoom; 3D-FRONT has its own.
MadeScene make_scene_of(
    const CommonOptions& common, MakeOptions& options, const std::string& scene, bool out_given
) {
  if (options.dataset == "front3d")
    return make_front3d_scene(common, options.front3d, options.room, out_given);
  options.room.scene = scene;
  const fs::path folder = folder_for(common, options.room, out_given, options.scenes.size() == 1);
  return {scene, folder, make_glassroom(options.room, folder, false)};
}

ExchangeScene exchange_scene_of(MakeOptions& options, const std::string& scene) {
  if (options.dataset == "front3d")
    return front3d_for_exchange(front3d_shots(options.front3d, options.room));
  options.room.scene = scene;
  return glassroom_for_exchange(options.room);
}

// The scenes for other renderers, in place of our pictures of them.
int write_scenes(const CommonOptions& common, MakeOptions& options) {
  Json written = Json::array();
  for (const std::string& scene : options.scenes) {
    const fs::path root = options.write_scene;
    const fs::path folder = options.scenes.size() == 1 ? root : root / scene;
    const ExchangeScene exchange = exchange_scene_of(options, scene);
    write_exchange_scene(exchange, folder);
    written.push_back({{"scene", exchange.name}, {"folder", folder.string()}});
    if (!common.json) print_text(fmt::format("{} written\n", folder.string()));
  }
  if (common.json) print_json({{"scenes", written}});
  return 0;
}

int run_make(const CommonOptions& common, MakeOptions options, bool out_given) {
  GLINT_CHECK(
      options.dataset == "glassroom" || options.dataset == "front3d",
      kUsage,
      "dataset make {}: no such generator; expected glassroom or front3d",
      options.dataset
  );
  if (options.dataset == "glassroom") check_no_front3d_options(options.front3d);
  GLINT_CHECK(
      options.dataset == "glassroom" || !options.room.layers,
      kUsage,
      "dataset make front3d: --layers is of glassroom alone"
  );
  install_interrupt_handler();
  options.room.seed = common.seed.value_or(0);
  if (options.dataset == "front3d") options.scenes.resize(1);
  if (!options.write_scene.empty()) return write_scenes(common, options);
  Json made = Json::array();
  for (const std::string& name : options.scenes) {
    const MadeScene scene = make_scene_of(common, options, name, out_given);
    const std::string folder = scene.folder.string();
    made.push_back({{"scene", scene.name}, {"folder", folder}, {"made", scene.is_new}});
    if (!common.json)
      print_text(fmt::format("{} {}\n", folder, scene.is_new ? "made" : "was there already"));
  }
  if (common.json) print_json({{"scenes", made}});
  return 0;
}

std::vector<std::string> names_of_views(const std::vector<View>& views) {
  std::vector<std::string> names;
  for (const View& view : views) names.push_back(view.name);
  return names;
}

// Names of test views in lines of a terminal's width, behind the column of titles.
std::string names_text(const std::vector<View>& views) {
  constexpr std::string_view kTitles = "               ";
  if (views.empty()) return "none";
  std::string text;
  for (const std::string& line : wrapped(comma_list(names_of_views(views)), 100 - kTitles.size()))
    text.append("\n").append(kTitles).append(line);
  return text.substr(1 + kTitles.size());
}

std::string split_rule_of(const LoaderSpec& loader, const std::string& folder) {
  return loader.split_rule ? loader.split_rule(folder) : "as it was packed";
}

Json scene_json(const Scene& scene, const std::string& loader, const std::string& split_rule) {
  const bool any = !scene.train.empty();
  return {
      {"name", scene.name},
      {"dataset", scene.dataset},
      {"loader", loader},
      {"train_views", scene.train.size()},
      {"test_views", scene.test.size()},
      {"test_view_names", names_of_views(scene.test)},
      {"split_rule", split_rule},
      {"width", any ? scene.train[0].camera.width : 0},
      {"height", any ? scene.train[0].camera.height : 0},
      {"points", scene.points.positions.size()},
      {"simulated_priors", scene.simulated_priors},
      {"data_notes", scene.data_notes},
      {"spatial_scale", scene.spatial_scale},
      {"hash", scene.spec_hash}};
}

struct FolderOptions {
  std::string folder;
  LoadOptions load;  // loader, priors, size
};

int run_info(const CommonOptions& common, const FolderOptions& options) {
  if (const auto code = show_manifest(common, options.folder)) return *code;
  const LoaderSpec& loader = find_loader(options.folder, options.load.loader);
  Scene scene = loader.load(options.folder, options.load);
  note_held_out(options.folder, scene);
  const std::string split_rule = split_rule_of(loader, options.folder);
  const std::string text = fmt::format(
      "{}format         {}\nsplit          {}\ntest views     {}\n",
      describe_scene(scene),
      loader.name,
      split_rule,
      names_text(scene.test)
  );
  print_result(common, scene_json(scene, loader.name, split_rule), text);
  return 0;
}

int run_check(const CommonOptions& common, const FolderOptions& options) {
  if (const auto code = check_manifest(common, options.folder)) return *code;
  const std::vector<Finding> findings = check_dataset(options.folder, options.load);
  return print_findings(common, options.folder, findings, "nothing wrong");
}

struct PackOptions : FolderOptions {
  std::string file;
  bool test_truth_only = false, compact = false;
  std::vector<std::string> without;
};

// An earlier packed scene is replaced; whatever else lies there is somebody's.
void check_pack_target(const fs::path& file) {
  GLINT_CHECK(
      file.has_filename() && !is_folder(file),
      kUsage,
      "{}: is a folder; give the name of a file, such as {}",
      file.string(),
      (file / "scene.safetensors").string()
  );
  GLINT_CHECK(
      !is_there(file) || is_packed_scene(file),
      kUsage,
      "{}: is there and is no packed scene; it is left as it is, give another name or move it away",
      file.string()
  );
}

int run_pack(const CommonOptions& common, const PackOptions& options) {
  check_pack_target(options.file);
  Scene scene = load_scene(options.folder, options.load);
  note_held_out(options.folder, scene);
  for (const std::string& prior : options.without) leave_out_prior(prior, scene);
  if (options.test_truth_only) leave_out_train_truth(scene);
  if (options.compact) make_compact(scene);
  write_packed_scene(options.file, scene);
  const std::uintmax_t bytes = fs::file_size(options.file);
  const std::size_t views = scene.train.size() + scene.test.size();
  const double mebibytes = static_cast<double>(bytes) / (1 << 20);
  print_result(
      common,
      {{"file", options.file}, {"bytes", bytes}, {"views", views}},
      fmt::format("{}: {} views, {:.1f} MiB\n", options.file, views, mebibytes)
  );
  return 0;
}

void add_pack(CommandLine& line, CLI::App& dataset) {
  auto options = std::make_shared<PackOptions>();
  CLI::App* pack = line.add_verb(
      dataset,
      "pack",
      "a scene in one file, which every verb takes in place of its folder",
      [&line, options] { return run_pack(line.common, *options); },
      kDatasetOptions
  );
  pack->add_option("folder", options->folder, "dataset folder")->required();
  pack->add_option("file", options->file, "for example room_1.safetensors")->required();
  add_load_options(*pack, options->load);
  pack->add_option("--max-pixels", options->load.max_pixels, "shrink images below this area")
      ->check(at_least_zero());
  pack->add_flag(
      "--test-truth-only",
      options->test_truth_only,
      "leave out the ground truth of train views, which is never scored, but for glass masks"
  );
  pack->add_flag(
      "--compact",
      options->compact,
      "leave out all that no training and no score reads, and round truth as far as no score shows"
  );
  pack->add_option("--without", options->without, "leave out a prior, such as basecolor");
}

void add_make(CommandLine& line, CLI::App& dataset) {
  auto options = std::make_shared<MakeOptions>();
  auto verb = std::make_shared<CLI::App*>(nullptr);
  *verb = line.add_verb(
      dataset,
      "make",
      "render GlassRoom scenes, or a room of 3D-FRONT (--seed varies the layout)",
      [&line, options, verb] {
        return run_make(line.common, *options, (*verb)->count("--out") > 0);
      },
      kDatasetOptions | kOutOption | kDataOption | kSeedOption
  );
  CLI::App& make = **verb;
  describe_out(make, "folder of the scene, or of several; else DATA/glassroom or DATA/front3d");
  GlassRoomOptions& room = options->room;
  make.add_option("dataset", options->dataset, "glassroom or front3d")->required();
  make.add_option(
          "--scene",
          options->scenes,
          "room_1 ... room_5, nested_1, window_1, mirror_1, tinted_1; several make several"
  )
      ->capture_default_str();
  make.add_option("--width", room.width, "pixels")->capture_default_str();
  make.add_option("--height", room.height, "pixels")->capture_default_str();
  make.add_option("--views", room.views, "views along the camera path")->capture_default_str();
  make.add_option("--spp", room.spp, "samples a pixel")->capture_default_str();
  make.add_option(
          "--priors",
          room.priors,
          "how good simulated priors are: " + comma_list(prior_kinds()) +
              "; the last ones may be joined by +"
  )
      ->capture_default_str();
  make.add_flag(
      "--layers",
      room.layers,
      "also true maps of every layer and path, of rooms; the scenes with other names have them"
  );
  add_front3d_options(make, options->front3d);
  make.add_option(
      "--write-scene",
      options->write_scene,
      "folder: no pictures, but meshes, materials and cameras for other renderers "
      "(docs/reference/datasets.md)"
  );
}

using FolderAction = int (*)(const CommonOptions&, const FolderOptions&);

void add_folder_verb(
    CommandLine& line, CLI::App& dataset, const char* name, const char* help, FolderAction action
) {
  auto options = std::make_shared<FolderOptions>();
  CLI::App* verb = line.add_verb(
      dataset,
      name,
      help,
      [&line, options, action] { return action(line.common, *options); },
      kDatasetOptions | kDataOption
  );
  verb->add_option(
          "folder", options->folder, "dataset folder or packed scene; or ref-dl3dv, 3d-front-t"
  )
      ->required();
  add_load_options(*verb, options->load);
}

void add_dataset_verb(CommandLine& line) {
  CLI::App* dataset =
      line.app.add_subcommand("dataset", "make, describe, check, pack, export and split datasets");
  dataset->require_subcommand(1);
  add_make(line, *dataset);
  add_folder_verb(line, *dataset, "info", "what a folder holds, as methods will see it", run_info);
  add_folder_verb(line, *dataset, "check", "everything wrong with a folder; exit 4", run_check);
  add_pack(line, *dataset);
  add_dataset_export(line, *dataset);
  add_dataset_import(line, *dataset);
  add_dataset_holdout(line, *dataset);
}

}  // namespace

GLINT_REGISTER(Verb, {"dataset", add_dataset_verb})

}  // namespace glint
