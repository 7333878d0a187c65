// SPDX-License-Identifier: MIT
#include "metrics/tools/orders.h"

#include <CLI/CLI.hpp>

#include <map>
#include <ostream>

#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "glint/scene/layer_maps.h"
#include "metrics/tools/order_tuples.h"
#include "metrics/tools/tool.h"

namespace glint {
namespace {

struct OrderArguments {
  std::string predictions, tuples, subset = "layer_all";
  bool fronts = false, inverse = false, json = false, quiet = false;
};

struct Counts {
  std::size_t right = 0, all = 0;
  double percent() const { return 100.0 * static_cast<double>(right) / static_cast<double>(all); }
};
// "pairs", "triplets", "quadruplets" (and "single points", of what is not there), by "all",
// "1", "2", ..., "mixed".
using OrderScores = std::map<std::string, std::map<std::string, Counts>>;

void add_options(CLI::App& app, OrderArguments& a) {
  app.add_option(
         "PREDICTIONS",
         a.predictions,
         "folder with a depth map for each layer: NAME_1.png, NAME_2.png (or .npy, .exr, .tiff), "
         "or "
         "a run folder"
  )
      ->required();
  app.add_option("TUPLES", a.tuples, "NAME.jsonl or NAME.json of LayeredDepth, or folder of such")
      ->required();
  app.add_option("--subset", a.subset, "of NAME.json")
      ->check(CLI::IsMember({"layer_all", "layer_first"}))
      ->capture_default_str();
  app.add_flag(
      "--fronts",
      a.fronts,
      "annotated layers count where rays leave objects, too; the prediction has where they enter: "
      "its layer 2 is the annotated 3"
  );
  app.add_flag("--inverse", a.inverse, "the maps hold inverse depth: larger is nearer");
  app.add_flag("--json", a.json, "one JSON document, numbers not rounded");
  app.add_flag("--quiet", a.quiet, "no warnings on standard error");
  app.footer("Example:\n  glint-orders estimations/mine data/pairs_layerall_test\n");
}

// Of an image, layer 1 first; empty: it has none.
std::vector<Image> read_layers(const OrderArguments& a, const std::string& name) {
  std::vector<Image> layers;
  const fs::path folder = a.predictions;
  for (int k = 1;; ++k) {
    fs::path found;
    for (const char* extension : {".png", ".npy", ".exr", ".tiff"})
      if (const fs::path file = folder / fmt::format("{}_{}{}", name, k, extension);
          found.empty() && is_file(file))
        found = file;
    if (k <= kMaxLayers)
      if (const fs::path file =
              folder / "renders" / name / kLayerDepth[static_cast<std::size_t>(k - 1)].row().file;
          found.empty() && is_file(file))
        found = file;
    if (found.empty()) return layers;
    layers.push_back(with_exit_code(ExitCode::kBadPrediction, [&] { return read_image(found, 1); })
    );
    GLINT_CHECK(
        layers.back().size() == layers.front().size(),
        kBadPrediction,
        "{}: {} x {} pixels, layer 1 has {} x {}",
        found.string(),
        layers.back().width(),
        layers.back().height(),
        layers.front().width(),
        layers.front().height()
    );
  }
}

class Judge {
 public:
  Judge(const OrderArguments& a, std::vector<Image> layers) : a_(a), layers_(std::move(layers)) {}

  // Empty: a point lies outside of the picture, or at a layer that is not asked for.
  std::optional<bool> is_right(const AnnotatedTuple& tuple) const {
    for (const LayerPoint& p : tuple.points)
      if (p.x >= layers_.front().width() || p.y >= layers_.front().height() ||
          (a_.fronts && p.layer % 2 == 0))
        return std::nullopt;
    const auto depth = [&](LayerPoint p) { return depth_at(p); };
    if (tuple.is_real) return in_order(tuple.points, depth);
    return std::ranges::none_of(tuple.points, [&](LayerPoint p) { return depth(p).has_value(); });
  }

 private:
  std::optional<float> depth_at(LayerPoint p) const {
    const auto layer = static_cast<std::size_t>(a_.fronts ? (p.layer + 1) / 2 : p.layer);
    if (layer > layers_.size()) return std::nullopt;
    const float value = layers_[layer - 1].at(p.x, p.y);
    if (!(value > 0)) return std::nullopt;
    return a_.inverse ? 1 / value : value;
  }

  const OrderArguments& a_;
  std::vector<Image> layers_;
};

std::string size_name(const AnnotatedTuple& tuple) {
  constexpr const char* kNames[] = {"single points", "pairs", "triplets", "quadruplets"};
  return kNames[tuple.points.size() - 1];
}

std::string layer_name(const AnnotatedTuple& tuple) {
  const int first = tuple.points.front().layer;
  const bool one =
      std::ranges::all_of(tuple.points, [&](LayerPoint p) { return p.layer == first; });
  return one ? std::to_string(first) : "mixed";
}

OrderScores score(const OrderArguments& a) {
  OrderScores scores;
  std::size_t missing = 0, left_out = 0;
  const auto images = read_order_tuples(a.tuples, a.subset);
  for (const AnnotatedImage& image : images) {
    std::vector<Image> layers = read_layers(a, image.name);
    if (layers.empty()) {
      ++missing;
      continue;
    }
    const Judge judge(a, std::move(layers));
    for (const AnnotatedTuple& tuple : image.tuples) {
      const auto right = judge.is_right(tuple);
      if (!right) ++left_out;
      for (const std::string& layer : {std::string("all"), layer_name(tuple)})
        if (right) {
          Counts& counts = scores[size_name(tuple)][layer];
          ++counts.all;
          counts.right += *right ? 1 : 0;
        }
    }
  }
  GLINT_CHECK(
      !scores.empty(),
      kBadPrediction,
      "{}: nothing to score: no map of {} images ({}_1.png, ...) holds an annotated point",
      a.predictions,
      images.size(),
      images.front().name
  );
  if (missing > 0)
    log::warn(fmt::format("{} of {} images have no prediction", missing, images.size()));
  if (left_out > 0)
    log::warn(fmt::format("{} tuples left out: outside of the picture, or other layers", left_out));
  return scores;
}

void print_scores(const OrderArguments& a, const OrderScores& scores, std::ostream& out) {
  if (!a.json) {
    for (const auto& [size, layers] : scores)
      for (const auto& [layer, counts] : layers)
        out << fmt::format(
            "{} {}: {:.2f} % ({} of {})\n", size, layer, counts.percent(), counts.right, counts.all
        );
    return;
  }
  Json json = {{"tool", "glint-orders"}, {"prediction", a.predictions}, {"tuples", a.tuples}};
  json["protocol"] = {
      {"without_a_depth", "wrong"},
      {"fronts", a.fronts},
      {"inverse", a.inverse},
      {"subset", a.subset}};
  for (const auto& [size, layers] : scores)
    for (const auto& [layer, counts] : layers)
      json["scores"][size][layer] = {
          {"percent", counts.percent()}, {"right", counts.right}, {"all", counts.all}};
  out << json.dump(2) << "\n";
}

}  // namespace

int run_orders_program(const std::vector<std::string>& args, std::ostream& out, std::ostream& err) {
  CLI::App app(
      "The share of annotated pairs, triplets and quadruplets of points across layers whose "
      "predicted depths are in order (LayeredDepth, ICCV 2025). No scale is needed.",
      "glint-orders"
  );
  OrderArguments arguments;
  add_options(app, arguments);
  return run_program(app, args, out, err, [&] {
    set_quiet(arguments.quiet);
    print_scores(arguments, score(arguments), out);
  });
}

}  // namespace glint
