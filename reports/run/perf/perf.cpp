// SPDX-License-Identifier: MIT
#include "reports/run/perf/perf.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "glint/core/device.h"
#include "glint/core/files.h"
#include "glint/core/machine.h"
#include "glint/core/median.h"
#include "glint/core/parallel.h"
#include "glint/core/progress.h"
#include "glint/core/rows.h"
#include "glint/cuda/backend.h"
#include "glint/render/void_steps.h"
#include "reports/run/records/environment.h"

namespace glint {

namespace {

constexpr std::size_t kCopyBytes = std::size_t{256} << 20;  // beyond any cache

double milliseconds(const std::function<void()>& body) {
  const auto start = std::chrono::steady_clock::now();
  body();
  synchronize();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

// What one run of several asked for since `before`.
DeviceCounters asked_since(const DeviceCounters& before, int runs) {
  DeviceCounters asked;
  DeviceCounters::for_each(
      [runs](const char*, std::uint64_t& count, std::uint64_t now, std::uint64_t then) {
        count = (now - then) / static_cast<std::uint64_t>(runs);
      },
      asked,
      device_counters,
      before
  );
  if (asked.waits > 0) --asked.waits;  // for the clock
  return asked;
}

void warn_of_void_runs(const PerfCase& c) {
  end_silent_step();
  if (take_void_steps().count > 0)
    log::warn(fmt::format("{}: some of its runs had no room and did less than they had to", c.name)
    );
}

// On a GPU runs are silent, as nearly all steps of a training are.
PerfRow measure(const PerfCase& c, int threads, int runs) {
  set_num_threads(threads);
  std::vector<double> times, ratios;
  const bool with_scalar = c.run_scalar && !on_gpu();
  c.run();
  const SilentStep silent(true);
  c.run();
  const DeviceCounters before = device_counters;
  if (with_scalar) c.run_scalar();
  for (int i = 0; i < runs; ++i) {
    times.push_back(milliseconds(c.run));
    if (with_scalar) ratios.push_back(milliseconds(c.run_scalar) / times.back());
  }
  PerfRow row{c.name, c.unit, threads, upper_median(times)};
  row.asked = asked_since(before, runs);
  warn_of_void_runs(c);
  row.per_second = c.work() / (row.ms / 1000);
  if (c.bytes) row.bytes_per_second = c.bytes() / (row.ms / 1000);
  if (!ratios.empty()) row.scalar_ratio = upper_median(ratios);
  return row;
}

std::string rate(double per_second, const std::string& unit) {
  for (const auto& [scale, prefix] : {std::pair{1e9, "G"}, {1e6, "M"}, {1e3, "k"}})
    if (per_second >= scale) return fmt::format("{:.2f} {}{}/s", per_second / scale, prefix, unit);
  return fmt::format("{:.1f} {}/s", per_second, unit);
}

std::string asked_text(const std::vector<PerfRow>& rows) {
  std::vector<Column> columns{{"", "op"}};
  DeviceCounters names;
  DeviceCounters::for_each(
      [&](const char* name, std::uint64_t) {
        columns.push_back({"", name, "{}"});
      },
      names
  );
  Rows asked(columns);
  for (const PerfRow& row : rows) {
    std::vector<Cell> cells{row.name};
    DeviceCounters::for_each(
        [&](const char*, std::uint64_t count) { cells.emplace_back(count); }, row.asked
    );
    asked.add(cells);
  }
  return "\nasked of the device in a run\n" + asked.text();
}

std::string ratio(double value) { return value > 0 ? fmt::format("{:.2f}x", value) : "-"; }

Cell asked_cell(const PerfRow& row) {
  if (!on_gpu()) return Cell::absent();
  Json asked;
  DeviceCounters::for_each(
      [&](const char* name, std::uint64_t count) { asked[name] = count; }, row.asked
  );
  return asked;
}

Rows listed(const std::vector<PerfRow>& rows) {
  Rows list(
      {{"op", "op"},
       {"threads", "threads", "{}"},
       {"ms", "ms", "{:.3f}"},
       {"per_second", "rate", "{}"},
       {"scalar_ratio", "vs scalar", "{}"},
       {"thread_ratio", "vs 1 thr.", "{}"},
       {"bytes_per_second", "moves", "{}"}},
      "unit asked"
  );
  for (const PerfRow& row : rows)
    list.add(
        {row.name,
         row.threads,
         row.ms,
         {row.per_second, rate(row.per_second, row.unit)},
         {row.scalar_ratio, ratio(row.scalar_ratio)},
         {row.thread_ratio, ratio(row.thread_ratio)},
         {row.bytes_per_second, row.bytes_per_second > 0 ? rate(row.bytes_per_second, "B") : "-"},
         row.unit,
         asked_cell(row)}
    );
  return list;
}

}  // namespace

bool PerfOptions::wants(std::string_view name) const {
  for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
    end = only.find('|', begin);
    if (glob_match(std::string_view(only).substr(begin, end - begin), name)) return true;
  }
  return false;
}

std::vector<PerfCase> make_perf_cases(const PerfOptions& options) {
  std::vector<PerfCase> cases;
  for (const auto& [id, registered] : Registry<PerfCases>::all())
    for (PerfCase& c : registered.make(options))
      if (options.wants(c.name)) cases.push_back(std::move(c));
  GLINT_CHECK(
      !cases.empty(),
      kUsage,
      "--op {}: fits no op that this device is timed with; globs fit whole names, as "
      "'*rasterize*' (`perf` without --op has all)",
      options.only
  );
  return cases;
}

std::vector<PerfRow> run_perf(const PerfOptions& options) {
  const std::vector<PerfCase> cases = make_perf_cases(options);
  std::vector<PerfRow> rows;
  const int max_threads = std::thread::hardware_concurrency() > 1 && !on_gpu() ? 2 : 1;
  Progress progress("perf", cases.size() * static_cast<std::size_t>(max_threads));
  for (const PerfCase& c : cases)
    for (int threads = 1; threads <= max_threads; ++threads) {
      rows.push_back(measure(c, threads, options.runs));
      if (threads > 1) rows.back().thread_ratio = rows[rows.size() - 2].ms / rows.back().ms;
      progress.advance(1, c.name);
    }
  set_num_threads(0);
  return rows;
}

Json perf_setting(const PerfOptions& options) {
  return {
      {"cpu", this_machine().cpu},
      {"device", device_name()},
      {"width", options.width},
      {"height", options.height},
      {"surfels", options.surfels},
      {"overlap", options.overlap},
      {"runs", options.runs},
      {"rows", Json::array()}};
}

Json perf_to_json(const PerfOptions& options, const std::vector<PerfRow>& rows) {
  Json json = perf_setting(options);
  if (on_gpu()) json["copy_bytes_per_second"] = gpu::measure_copy_bandwidth(kCopyBytes);
  json["rows"] = listed(rows).json();
  return json;
}

std::string perf_to_text(const PerfOptions& options, const std::vector<PerfRow>& rows) {
  std::string text = fmt::format(
      "{}x{}, {} surfels (overlap {}), medians of {} runs, {}\n",
      options.width,
      options.height,
      options.surfels,
      options.overlap,
      options.runs,
      on_gpu() ? device_name() : this_machine().cpu
  );
  text += listed(rows).text();
  if (on_gpu())
    text += fmt::format(
        "copies inside the device: {}\n", rate(gpu::measure_copy_bandwidth(kCopyBytes), "B")
    );
  if (on_gpu()) text += asked_text(rows);
  return text;
}

}  // namespace glint
