// SPDX-License-Identifier: MIT
#include "reports/verbs/open_viewer.h"

#include <cstdlib>

#include "glint/core/progress.h"
#include "reports/run/bench/child_process.h"
#include "reports/show/tables/method_title.h"

namespace glint {

namespace {

bool has_display() {
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY"}) {
    const char* value = std::getenv(name);
    if (value != nullptr && *value != '\0') return true;
  }
  return false;
}

// Where the server is reached from elsewhere, everybody on the way can read along.
void warn_of_host(const std::string& host) {
  if (host.starts_with("127.") || host == "localhost" || host == "::1") return;
  log::warn(fmt::format(
      "--host {}: others in the network can reach the viewer, unencrypted; the token in its "
      "address "
      "is what keeps them out",
      host
  ));
}

}  // namespace

void add_viewer_options(CLI::App& verb, ViewerPlace& place, CLI::Option* needed) {
  const auto need = [&](CLI::Option* option) {
    if (needed != nullptr) option->needs(needed);
    return option;
  };
  need(verb.add_option("--host", place.host, "address to listen at, as numbers; 0.0.0.0: all"))
      ->capture_default_str();
  need(verb.add_option("--port", place.port, "0: any that is free"))
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  need(verb.add_flag("!--no-browser", place.browser, "only print the address"));
}

std::unique_ptr<Viewer> open_viewer(
    const CommonOptions& common,
    const ViewerPlace& place,
    const Scene& scene,
    std::vector<ViewedRun> runs,
    int iterations
) {
  warn_of_host(place.host);
  auto viewer = std::make_unique<Viewer>(
      ViewerOptions{place.host, place.port, iterations}, scene, std::move(runs)
  );
  const std::string address = viewer->address();
  // A training has its own result for standard output.
  if (iterations > 0)
    log::info("to watch: " + address);
  else
    print_result(common, {{"address", address}}, address + "\n");
  if (place.browser && has_display()) run_command({"setsid", "--fork", "xdg-open", address});
  return viewer;
}

AfterStep watch_training(
    const CommonOptions& common, const ViewerPlace& place, const SingleCell& single
) {
  open_web_server.require();
  auto viewer = std::make_shared<std::unique_ptr<Viewer>>();
  return [&common, place, &single, viewer](Method& method, const StepStats& stats) {
    if (*viewer == nullptr) {  // there is something to see from the first step on
      const RunSpec& spec = single.spec;
      std::vector<ViewedRun> runs;
      runs.emplace_back(
          ViewedRun::Names{
              fmt::format("{} (training)", spec.method),
              spec.method,
              method_title(spec.method),
              spec.folder},
          method,
          single.scene,
          true
      );
      *viewer = open_viewer(common, place, single.scene, std::move(runs), spec.options.iterations);
    }
    (*viewer)->between_steps(stats.iteration + 1);
  };
}

}  // namespace glint
