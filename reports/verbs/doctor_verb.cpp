// SPDX-License-Identifier: MIT
#include <fmt/ranges.h>

#include <algorithm>
#include <ctime>
#include <memory>

#include "glint/core/error.h"
#include "glint/core/machine.h"
#include "glint/core/parallel.h"
#include "glint/core/rows.h"
#include "glint/drawing/canvas.h"
#include "metrics/feature_net.h"
#include "metrics/fusion/tsdf_volume.h"
#include "metrics/lpips_weights.h"
#include "reports/run/provenance/examine_machine.h"
#include "reports/run/provenance/examine_profile.h"
#include "reports/run/records/environment.h"
#include "reports/run/records/revision.h"
#include "reports/show/figures/figures.h"
#include "reports/verbs/doctor_card.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {

constexpr std::uint64_t kGiB = std::uint64_t{1} << 30;
constexpr std::uint64_t kNeededDisk = 2 * kGiB;  // a profile on rooms stays well below
constexpr std::uint64_t kNeededMemory = 2 * kGiB;

std::string gib(std::uint64_t bytes) {
  return fmt::format("{:.1f} GiB", static_cast<double>(bytes) / static_cast<double>(kGiB));
}

Checked good(std::string name, std::string value) {
  return {std::move(name), CheckState::kOk, std::move(value)};
}

Checked needed(std::string name, std::string value, bool there, const char* advice) {
  const CheckState state = there ? CheckState::kOk : CheckState::kBad;
  return {std::move(name), state, std::move(value), there ? "" : advice};
}

// Which networks LPIPS has weights of, and whether they are those that were published.
Checked lpips_weights() {
  const fs::path place = lpips_weights_place();
  if (place.empty()) return good("lpips", "off: its columns will say 'no weights'");
  std::vector<std::string> found;
  bool published = true;
  try {
    for (const LpipsNetwork& network : lpips_networks())
      if (const auto weights = lpips_weights_at(place, network.name)) {
        published = published && !weights->version.empty();
        found.push_back(
            network.name + (weights->version.empty() ? " (unknown)" : " " + weights->version)
        );
      }
  } catch (const Error& error) {
    return {"lpips", CheckState::kBad, error.what(), "mend or remove the file"};
  }
  if (found.empty())
    return {
        "lpips",
        CheckState::kNote,
        fmt::format("no weights at {}: its columns will say so", place.string()),
        "scripts/fetch_lpips_weights.sh fetches them"};
  const std::string text = fmt::format("{}", fmt::join(found, ", "));
  if (published) return good("lpips", text);
  return {"lpips", CheckState::kNote, text, "not the published weights: values stand alone"};
}

// The module that fuses depth into meshes lies in lib/ beside the program's folder; a program that
// was copied alone has none.
Checked meshes() {
  if (has_tsdf_volume()) return good("meshes", "Open3D");
  return {
      "meshes",
      CheckState::kNote,
      "no lib/libglint_tsdf.so beside the program's folder: mesh columns will say 'no Open3D'",
      "install libopen3d-dev and build again, or copy lib/ with bin/"};
}

// Of figures. Another font is no failure: only their look differs.
Checked font() {
  const std::string found = figures_font.here() ? figures_font() : "";
  if (found.empty()) return good("font", "off: this build draws no figures");
  if (found == kFontFamily) return good("font", found);
  return {
      "font",
      CheckState::kNote,
      fmt::format("{} in place of {}", found, kFontFamily),
      "install fonts-inter"};
}

std::vector<Checked> examine_machine(const CommonOptions& common) {
  const Machine machine = this_machine();
  const std::uint64_t disk = free_disk_bytes(common.out);
  return {
      good("cpu", machine.cpu),
      needed(
          "avx2",
          machine.has_avx2 ? "yes" : "no",
          machine.has_avx2,
          "the CPU kernels need AVX2 and FMA; use another machine"
      ),
      good("threads", fmt::format("{} of {}", num_threads(), machine.cores)),
      needed(
          "memory",
          gib(machine.memory_bytes),
          machine.memory_bytes >= kNeededMemory,
          "2 GiB are needed; use smaller images"
      ),
      needed(
          "disk",
          fmt::format("{} free for {}", gib(disk), common.out),
          disk >= kNeededDisk,
          "2 GiB are needed; free some or choose another --out"
      ),
      examine_folder("out", common.out, "--out"),
      examine_clock(std::time(nullptr), git_time()),
      examine_open_files()};
}

std::vector<Checked> examine_program() {
  return {
      good("networks", feature_net_libraries()),
      lpips_weights(),
      meshes(),
      font(),
      good("revision", git_revision())};
}

std::vector<Checked> examine_plan(const CommonOptions& common) {
  const Profile profile = common.resolved_profile();
  std::vector<Checked> rows = examine_profile(
      {profile,
       make_plan(profile, common.filter(), common.set),
       profile_folder(common.out, profile.name),
       common.data,
       common.scene_identifier()}
  );
  rows.insert(rows.begin(), examine_folder("data", common.data, "--data"));
  return rows;
}

Json doctor_json(const std::vector<Checked>& rows) {
  Json json = Json::object();
  for (const Checked& row : rows)
    json[row.name] = {
        {"value", row.detail},
        {"ok", row.state != CheckState::kBad},
        {"state", state_word(row.state)},
        {"advice", row.advice}};
  return json;
}

std::string doctor_text(const std::vector<Checked>& rows) {
  std::vector<std::vector<std::string>> lines;
  for (const Checked& row : rows) {
    lines.push_back({row.name, std::string(state_word(row.state)), row.detail});
    if (!row.advice.empty()) lines.push_back({"", "", "-> " + row.advice});
  }
  return aligned_rows(lines);
}

struct DoctorOptions {
  std::function<bool()> with_profile;
  bool card = false;
};

std::vector<Checked> rows_of(const CommonOptions& common, const DoctorOptions& options) {
  if (options.card) return examine_card(common.device);
  std::vector<Checked> rows = examine_machine(common);
  const auto add = [&](const std::vector<Checked>& more) {
    rows.insert(rows.end(), more.begin(), more.end());
  };
  add(examine_card(common.device));
  add(examine_program());
  if (options.with_profile()) add(examine_plan(common));
  return rows;
}

int run_doctor(const CommonOptions& common, const DoctorOptions& options) {
  const std::vector<Checked> rows = rows_of(common, options);
  Json json = doctor_json(rows);
  if (options.card) json["cuda"].update(card_json());
  print_result(common, json, doctor_text(rows));
  const bool fit = std::none_of(rows.begin(), rows.end(), [](const Checked& row) {
    return row.state == CheckState::kBad;
  });
  return static_cast<int>(fit ? ExitCode::kSuccess : ExitCode::kEnvironment);
}

void add_doctor_verb(CommandLine& line) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* verb = line.add_verb(
      line.app,
      "doctor",
      "is this machine fit for it; with --profile: is all there that the profile needs",
      [&line, options] { return run_doctor(line.common, *options); },
      kPlanOptions | kThreadsOption | kDeviceLater
  );
  verb->add_flag("--card", options->card, "the GPU alone");
  options->with_profile = [verb] { return verb->get_option("--profile")->count() > 0; };
}

}  // namespace

GLINT_REGISTER(Verb, {"doctor", add_doctor_verb})

}  // namespace glint
