// SPDX-License-Identifier: MIT
#include "reports/perf/perf.h"

#include <catch2/catch.hpp>

#include <algorithm>

#include "glint/core/progress.h"
#include "glint/method.h"

using namespace glint;

TEST_CASE("every op and a training step of every method can be timed") {
  set_quiet(true);
  PerfOptions options;
  options.width = 32;
  options.height = 18;
  options.surfels = 200;
  options.runs = 1;
  const std::vector<PerfRow> rows = run_perf(options);
  for (const PerfRow& row : rows) {
    INFO(row.name);
    CHECK(row.ms > 0);
  }
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
    if (!spec.overrides.empty()) continue;
    INFO(id);
    CHECK(std::any_of(rows.begin(), rows.end(), [&, &name = id](const PerfRow& row) {
      return row.name == name + " training step";
    }));
  }
}
