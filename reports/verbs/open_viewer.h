// SPDX-License-Identifier: MIT
// The viewer of the verbs `view` and `train --view`.
#pragma once

#include <memory>

#include "reports/run/bench/stages.h"
#include "reports/show/viewer/viewer.h"
#include "reports/verbs/single_cell.h"

namespace glint {

struct ViewerPlace {
  std::string host = "127.0.0.1";
  int port = 0;
  bool browser = true;  // opened where there is one
};
// --host, --port, --no-browser; where it is given, they are of this option alone.
void add_viewer_options(CLI::App& verb, ViewerPlace& place, CLI::Option* needed = nullptr);

// Prints the address (JSON: {"address", "port"}) and opens a browser there, where this is a desk
// with a display.
std::unique_ptr<Viewer> open_viewer(
    const CommonOptions& common,
    const ViewerPlace& place,
    const Scene& scene,
    std::vector<ViewedRun> runs,
    int iterations
);

// Looks at the training of this cell after its steps. Borrowed while the training goes on.
AfterStep watch_training(
    const CommonOptions& common, const ViewerPlace& place, const SingleCell& single
);

}  // namespace glint
