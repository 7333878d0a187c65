// SPDX-License-Identifier: MIT
#include "reports/verbs/dataset_compare.h"

#include <memory>

#include "metrics/tools/numeric_options.h"
#include "reports/pictures/radiance_difference.h"

namespace glint {

namespace {

struct CompareArguments {
  std::string first, second, picture;
  float range = 0.1f;
};

Json number_json(std::optional<double> value) { return value ? Json(*value) : Json(); }

Json difference_json(const RadianceDifference& d) {
  return {
      {"ratio", number_json(d.all().ratio())},
      {"ratio_opaque", number_json(d.opaque.ratio())},
      {"ratio_glass", number_json(d.glass.ratio())},
      {"block_rms", number_json(d.block_rms())},
      {"pixels", d.all().pixels},
      {"pixels_glass", d.glass.pixels}};
}

std::string number_text(std::optional<double> value) {
  return value ? fmt::format("{:.4f}", *value) : "-";
}

std::string line_of(const std::string& name, const RadianceDifference& d) {
  return fmt::format(
      "{:<8} {:>8} {:>8} {:>8} {:>10}\n",
      name,
      number_text(d.all().ratio()),
      number_text(d.opaque.ratio()),
      number_text(d.glass.ratio()),
      number_text(d.block_rms())
  );
}

void print_table(const std::vector<ComparedView>& views, const RadianceDifference& together) {
  std::string text = fmt::format(
      "mean radiance of the second over that of the first\n{:<8} {:>8} {:>8} {:>8} {:>10}\n",
      "view",
      "all",
      "opaque",
      "glass",
      "8x8 rms"
  );
  for (const ComparedView& view : views) text += line_of(view.name, view.difference);
  print_text(text + line_of("together", together));
}

void print_comparison_json(
    const CompareArguments& arguments,
    const std::vector<ComparedView>& views,
    const RadianceDifference& together
) {
  Json list = Json::array();
  for (const ComparedView& view : views) {
    list.push_back({{"view", view.name}});
    list.back().update(difference_json(view.difference));
  }
  print_json(
      {{"first", arguments.first},
       {"second", arguments.second},
       {"together", difference_json(together)},
       {"views", list},
       {"picture", arguments.picture.empty() ? Json() : Json(arguments.picture)}}
  );
}

int run_compare(const CommonOptions& common, const CompareArguments& arguments) {
  const std::vector<ComparedView> views =
      compare_renderings(arguments.first, arguments.second, arguments.picture, arguments.range);
  RadianceDifference together;
  for (const ComparedView& view : views) together += view.difference;
  if (common.json)
    print_comparison_json(arguments, views, together);
  else
    print_table(views, together);
  return 0;
}

}  // namespace

void add_dataset_compare(CommandLine& line, CLI::App& dataset) {
  auto arguments = std::make_shared<CompareArguments>();
  CLI::App* verb = line.add_verb(
      dataset,
      "compare",
      "two renderings of one scene, by the radiance in their gt/rgb",
      [&line, arguments] { return run_compare(line.common, *arguments); },
      kJsonOption | kQuietOption
  );
  verb->add_option("first", arguments->first, "scene folder, with the glass masks")->required();
  verb->add_option("second", arguments->second, "the same views by another renderer")->required();
  verb->add_option("--picture", arguments->picture, "PNG: first, second, relative difference");
  verb->add_option("--range", arguments->range, "difference of the strongest colour")
      ->check(above_zero())
      ->capture_default_str();
}

}  // namespace glint
