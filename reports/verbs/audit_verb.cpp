// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>

#include "datasets/dataset.h"
#include "glint/core/device.h"
#include "glint/core/interrupt.h"
#include "glint/core/parallel.h"
#include "glint/core/progress.h"
#include "glint/core/rows.h"
#include "reports/provenance/audit.h"
#include "reports/provenance/checked.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {

constexpr const char* kRoomProfile = "smoke";  // whose room every audit trains in
constexpr int kRepeatsOnGpu = 3;

struct AuditArguments {
  int repeats = 0;  // 0: 2, on a GPU 3
  std::string dataset, keep;
};

// The room, or data of the user's: a lean build can make no room.
Scene audited_scene(
    const CommonOptions& common, const AuditArguments& arguments, const Profile& room
) {
  if (arguments.dataset.empty()) return common.scene_loader()(room.sources().front()).scene;
  return with_exit_code(ExitCode::kBadReference, [&] { return load_scene(arguments.dataset, {}); });
}

// Variants share their method's code: unless they are named, the methods alone.
std::vector<std::string> audited_methods(const CommonOptions& common, const Profile& profile) {
  std::vector<std::string> methods = planned_methods(profile.methods, common.methods);
  if (common.methods.empty())
    std::erase_if(methods, [](const std::string& id) { return id.find('/') != std::string::npos; });
  std::erase_if(methods, [&](const std::string& id) {
    return !filter_accepts(common.filter(), {"room_1", id, common.seed.value_or(0)});
  });
  GLINT_CHECK(!methods.empty(), kUsage, "no method is left; see --methods, --only and --skip");
  return methods;
}

AuditOptions audit_options(
    const CommonOptions& common, const AuditArguments& arguments, const Profile& room
) {
  AuditOptions options;
  options.run = {
      common.iterations > 0 ? common.iterations : room.iterations, common.seed.value_or(0)};
  options.repeats = arguments.repeats > 0 ? arguments.repeats : on_gpu() ? kRepeatsOnGpu : 2;
  options.other_threads = !on_gpu();
  options.tsdf = room.tsdf_options();
  options.mesh = room.mesh_protocol();
  return options;
}

// A GPU sums in no fixed order: how far runs are apart is worth knowing, and no failure.
CheckState state_of(const AuditedMethod& method) {
  if (!method.failure.empty()) return CheckState::kBad;
  if (method.same_bytes()) return CheckState::kOk;
  return on_gpu() ? CheckState::kNote : CheckState::kBad;
}

std::string maps_text(const AuditedRun& run) {
  std::string text;
  for (const auto& [id, difference] : run.maps)
    text += fmt::format(
        "{}{} {:.1e} ({:.1e})", text.empty() ? "" : ", ", id, difference.max, difference.rms
    );
  return text.empty() ? "equal" : text;
}

std::string run_text(const AuditedRun& run) {
  if (run.differing.empty()) return fmt::format("{} files of the same bytes", run.files);
  return fmt::format(
      "{} of {} files differ, {} first; maps, largest (RMS) difference: {}",
      run.differing.size(),
      run.files,
      run.differing.front(),
      maps_text(run)
  );
}

std::string spread_text(const AuditedMethod& method) {
  std::string text;
  for (const char* id : {"psnr", "ssim", "absrel", "normal-mae", "mesh-cd"})
    if (const auto found = method.spread.find(id); found != method.spread.end())
      text += fmt::format("{}{} {:.2g}", text.empty() ? "" : ", ", id, found->second);
  return text.empty() ? fmt::format("{} metrics", method.spread.size()) : text;
}

std::string audit_text(const std::vector<AuditedMethod>& methods) {
  std::vector<std::vector<std::string>> lines{{"method", "training", "verdict", "detail"}};
  int same = 0;
  for (const AuditedMethod& method : methods) {
    const std::string word(state_word(state_of(method)));
    if (!method.failure.empty()) lines.push_back({method.method, "", word, method.failure});
    for (const AuditedRun& run : method.runs)
      lines.push_back({method.method, run.name, run.differing.empty() ? "ok" : word, run_text(run)}
      );
    if (!method.spread.empty())
      lines.push_back({method.method, "spread", word, spread_text(method)});
    same += method.same_bytes();
  }
  return aligned_rows(lines) + fmt::format(
                                   "{} of {} methods trained to the same bytes each time, on {}\n",
                                   same,
                                   methods.size(),
                                   device_name()
                               );
}

Json run_json(const AuditedRun& run) {
  Json json = {
      {"run", run.name},
      {"threads", run.threads},
      {"files", run.files},
      {"differing", run.differing},
      {"maps", Json::object()}};
  for (const auto& [id, difference] : run.maps)
    json["maps"][id] = {{"max", difference.max}, {"rms", difference.rms}};
  return json;
}

Json audit_json(const std::vector<AuditedMethod>& methods, const AuditOptions& options) {
  Json json = {
      {"device", device_name()},
      {"iterations", options.run.iterations},
      {"threads", num_threads()},
      {"methods", Json::array()}};
  for (const AuditedMethod& method : methods) {
    Json runs = Json::array();
    for (const AuditedRun& run : method.runs) runs.push_back(run_json(run));
    json["methods"].push_back(
        {{"method", method.method},
         {"verdict", state_word(state_of(method))},
         {"failure", method.failure.empty() ? Json() : Json(method.failure)},
         {"runs", std::move(runs)},
         {"spread", method.spread}}
    );
  }
  return json;
}

// Without the progress of each training: there are many short ones.
AuditedMethod audit_quietly(
    const std::string& id, const Json& config, const Scene& scene, const AuditOptions& options
) {
  const bool quiet = is_quiet();
  set_quiet(true);
  AuditedMethod audited = audit_method(id, config, scene, options);
  set_quiet(quiet);
  return audited;
}

int run_audit(const CommonOptions& common, const AuditArguments& arguments) {
  install_interrupt_handler();
  const Profile profile = load_profile(common.profile), room = load_profile(kRoomProfile);
  const std::vector<std::string> ids = audited_methods(common, profile);
  AuditOptions options = audit_options(common, arguments, room);
  const Scene scene = audited_scene(common, arguments, room);
  const TemporaryFolder temporary("glint_audit");
  options.folder = arguments.keep.empty() ? temporary.path() : fs::path(arguments.keep);
  std::vector<AuditedMethod> methods;
  Progress progress("audit", ids.size());
  for (const std::string& id : ids) {
    const Json config = method_overrides(profile, id, common.set);
    methods.push_back(audit_quietly(id, config, scene, options));
    progress.advance(1, id);
  }
  if (common.json)
    print_json(audit_json(methods, options));
  else
    print_text(audit_text(methods));
  const bool bad = std::any_of(methods.begin(), methods.end(), [](const AuditedMethod& method) {
    return state_of(method) == CheckState::kBad;
  });
  return static_cast<int>(bad ? ExitCode::kCheckFailed : ExitCode::kSuccess);
}

void add_audit_verb(CommandLine& line) {
  auto arguments = std::make_shared<AuditArguments>();
  CLI::App* verb = line.add_verb(
      line.app,
      "audit",
      "train one small cell again and again: on the CPU the same bytes have to come out",
      [&line, arguments] { return run_audit(line.common, *arguments); },
      kDataOption | kProfileOption | kCellOptions | kSeedOption | kIterationsOption | kSetOption |
          kWorkOptions
  );
  verb->add_option(
          "--repeats", arguments->repeats, "trainings with the same threads; else 2, on a GPU 3"
  )
      ->check(CLI::Range(2, 100));
  verb->add_option(
      "--dataset", arguments->dataset, "train on this folder or packed scene, not on a room"
  );
  verb->add_option("--keep", arguments->keep, "leave the runs in this folder");
}

}  // namespace

GLINT_REGISTER(Verb, {"audit", add_audit_verb})

}  // namespace glint
