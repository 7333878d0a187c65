// SPDX-License-Identifier: MIT
#include "reports/run/selftest/programs.h"

#include <sstream>

#include "datasets/dataset.h"
#include "metrics/tools/tool.h"
#include "reports/run/bench/stages.h"
#include "reports/run/import/import_predictions.h"
#include "reports/run/selftest/mesh_program.h"

namespace glint {
namespace {

using Arguments = std::vector<std::string>;

std::unique_ptr<MetricTool> make_tool(const std::string& name) {
  if (name == "glint-psnr") return make_psnr_tool();
  if (name == "glint-ssim") return make_ssim_tool();
  if (name == "glint-depth") return make_depth_tool();
  if (name == "glint-normal") return make_normal_tool();
  if (name == "glint-lpips") return make_lpips_tool();
  return nullptr;
}

// "mean" of a program that scores images, "metrics" of one that scores surfaces.
std::map<std::string, double> values_of(const Json& json) {
  std::map<std::string, double> values;
  for (const char* key : {"mean", "metrics"})
    if (const auto block = json.find(key); block != json.end() && block->is_object())
      for (const auto& [id, value] : block->items())
        if (value.is_number()) values[id] = value.get<double>();
  return values;
}

template <class Run>
ProgramResult result_of(Arguments arguments, Run&& run) {
  arguments.insert(arguments.end(), {"--json", "--quiet"});
  std::ostringstream out, err;
  ProgramResult result;
  result.exit_code = static_cast<ExitCode>(run(arguments, out, err));
  result.message = err.str();
  if (result.exit_code == ExitCode::kSuccess) result.values = values_of(parse_json(out.str()));
  return result;
}

std::string option(const Arguments& arguments, const std::string& name) {
  for (std::size_t i = 0; i + 1 < arguments.size(); ++i)
    if (arguments[i] == name) return arguments[i + 1];
  throw Error(ExitCode::kUsage, "no " + name);
}

ProgramResult eval_predictions(const Arguments& arguments) {
  try {
    const TemporaryFolder scratch("glint_selftest");
    const fs::path dataset = option(arguments, "--dataset");
    const Scene scene = load_scene(dataset, {});
    RunSpec spec;
    spec.folder = scratch / "run";
    spec.dataset_folder = dataset;
    import_predictions(option(arguments, "--predictions"), scene, spec, {});
    return {ExitCode::kSuccess, eval_stage(spec, scene), ""};
  } catch (const Error& error) {
    return {error.code(), {}, error.what()};
  }
}

}  // namespace

ProgramResult run_scorer(const Arguments& arguments) {
  const std::string& name = arguments.front();
  const Arguments rest(arguments.begin() + 1, arguments.end());
  if (name == "glint-bench") return eval_predictions(rest);
  if (name == "glint-mesh") return result_of(rest, run_mesh_program);
  const auto tool = make_tool(name);
  if (tool == nullptr) return {ExitCode::kUsage, {}, name + ": no such program"};
  return result_of(rest, [&](const Arguments& args, std::ostream& out, std::ostream& err) {
    return run_tool(*tool, args, out, err);
  });
}

}  // namespace glint
