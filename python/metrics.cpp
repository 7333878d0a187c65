// SPDX-License-Identifier: MIT
// The programs glint-psnr, glint-ssim, glint-lpips, glint-depth and glint-normal on arrays: their
// options, families, protocols and warnings; and every metric of a view, as `glint-bench eval` has
// them.
#include "python/metrics.h"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <CLI/CLI.hpp>

#include "glint/core/error.h"
#include "metrics/tools/tool_output.h"
#include "python/arrays.h"
#include "python/calls.h"
#include "python/json.h"
#include "python/scene.h"
#include "reports/run/bench/evaluate.h"

namespace glint::python {

namespace py = pybind11;

namespace {

std::unique_ptr<MetricTool> make_tool(const std::string& name) {
  if (name == "psnr") return make_psnr_tool();
  if (name == "ssim") return make_ssim_tool();
  if (name == "lpips") return make_lpips_tool();
  if (name == "depth") return make_depth_tool();
  return make_normal_tool();
}

// As the program's command line. Errors (kUsage): options that it does not take.
void set_options(MetricTool& tool, const std::vector<std::string>& args) {
  CLI::App app(tool.description(), tool.name());
  tool.add_options(app);
  try {
    app.parse(std::vector<std::string>(args.rbegin(), args.rend()));
  } catch (const CLI::ParseError& error) {
    throw Error(ExitCode::kUsage, fmt::format("{}: {}", tool.name(), error.what()));
  }
  tool.check_options();
}

// The item of a list, or what stands for all.
py::object item_of(const py::list& items, std::size_t i) {
  if (items.empty()) return py::none();
  return items[items.size() == 1 ? 0 : i];
}

// Of both sides, with what Python calls them; one image, or as many of each.
struct Arrays {
  std::pair<std::string, std::string> names;
  py::list predictions, references, masks, glass;
  int channels;

  MapPair pair(std::size_t i) const {
    const std::string at = predictions.size() == 1 ? "" : fmt::format("[{}]", i);
    const std::string prediction = names.first + at, reference = names.second + at;
    MapPair pair;
    pair.files = {std::to_string(i), prediction, reference, {}, {}};
    pair.prediction = image_of(predictions[i], prediction, channels);
    pair.reference = image_of(references[i], reference, channels);
    pair.mask = mask_of(item_of(masks, i), "mask");
    pair.glass = mask_of(item_of(glass, i), "glass");
    return pair;
  }
};

// The document that the program prints, without names of files.
Json document_of(const MetricTool& tool, std::vector<ImageScores> images) {
  for (ImageScores& image : images) image.files = {image.files.name, {}, {}, {}, {}};
  return report_json(tool, {{}, {}, {}, {}, std::move(images), {}});
}

// `name` of the tool; `family` of its metrics.
py::object score_arrays(
    const std::string& name,
    const std::pair<std::string, std::string>& names,
    const py::list& predictions,
    const py::list& references,
    const py::list& masks,
    const py::list& glass,
    const std::vector<std::string>& args,
    std::size_t family
) {
  const auto tool = make_tool(name);
  const Arrays arrays{names, predictions, references, masks, glass, name == "depth" ? 1 : 3};
  without_gil([&] {
    set_options(*tool, args);
    return true;
  });
  std::vector<ImageScores> images;
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    MapPair pair = arrays.pair(i);
    pair.family = family;
    images.push_back(without_gil([&] { return score_maps(*tool, std::move(pair), i == 0); }));
  }
  for (const ImageScores& image : images)
    for (const std::string& warning : image.warnings) warn(warning);
  return to_python(document_of(*tool, std::move(images)));
}

// A view that has the truth of a dict alone.
View view_of(const py::dict& truth, const py::object& counted) {
  View view;
  view.truth = maps_of(truth, "truth");
  view.rgb = view.truth["rgb"];
  view.truth["rgb"] = {};
  const MaskImage mask = mask_of(counted, "counted");
  if (!mask.empty()) view.counted = map_of_mask(mask);
  return view;
}

py::object score_maps_of_view(
    const py::dict& rendered, const py::object& truth, const py::object& counted
) {
  MapSet maps = maps_of(rendered, "rendered");
  const bool of_scene = py::isinstance<ViewOfScene>(truth);
  const View own = of_scene ? View{} : view_of(truth.cast<py::dict>(), counted);
  const View& view = of_scene ? *truth.cast<const ViewOfScene&>().view : own;
  const Json json = without_gil([&] {
    const Scores scores = score_rendered(std::move(maps), view);
    const Json protocols = score_protocols();
    Json metrics = Json::object(), used = Json::object();
    for (const auto& [id, value] : scores) {
      metrics[id] = value;
      const std::string plain = id.substr(0, id.find('@'));
      used[plain] = protocols.at(plain);
    }
    return Json{{"metrics", metrics}, {"protocol", used}};
  });
  return to_python(json);
}

}  // namespace

void add_metrics(py::module_& module) {
  module.def("score_arrays", &score_arrays);
  module.def("score_view", &score_maps_of_view);
}

}  // namespace glint::python
