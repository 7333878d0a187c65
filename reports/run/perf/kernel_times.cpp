// SPDX-License-Identifier: MIT
// How the time of each op is shared out among its kernels.
#include <algorithm>

#include "glint/core/device.h"
#include "glint/core/kernel_trace.h"
#include "glint/core/machine.h"
#include "glint/core/progress.h"
#include "glint/core/rows.h"
#include "glint/cuda/backend.h"
#include "glint/cuda/kernel_events.h"
#include "reports/run/perf/perf.h"

namespace glint {

namespace {

// In use for as long as it lives.
class TraceInUse {
 public:
  explicit TraceInUse(std::unique_ptr<KernelTrace> trace) : trace_(std::move(trace)) {
    kernel_trace = trace_.get();
  }
  ~TraceInUse() { kernel_trace = nullptr; }
  TraceInUse(const TraceInUse&) = delete;
  TraceInUse& operator=(const TraceInUse&) = delete;
  KernelTrace* operator->() { return trace_.get(); }

 private:
  std::unique_ptr<KernelTrace> trace_;
};

std::vector<KernelRow> rows_of(
    const std::string& op, const std::map<std::string, KernelTime>& times, int runs
) {
  std::vector<KernelRow> rows;
  for (const auto& [kernel, time] : times)
    rows.push_back({op, kernel, static_cast<double>(time.launches) / runs, time.ms / runs});
  std::stable_sort(rows.begin(), rows.end(), [](const KernelRow& a, const KernelRow& b) {
    return a.ms > b.ms;
  });
  return rows;
}

bool runs_on_cuda() { return on_gpu() && device_name() == gpu::cuda_device().name; }

double sum_of(std::span<const KernelRow> rows) {
  double sum = 0;
  for (const KernelRow& row : rows) sum += row.ms;
  return sum;
}

// With the kernels' shares of their sum.
Rows listed(std::span<const KernelRow> rows) {
  Rows list(
      {{"ms", "ms", "{:.4f}"},
       {"", "share", "{:.1f} %"},
       {"launches", "launches", "{:.1f}"},
       {"kernel", "kernel"}},
      "op"
  );
  const double sum = sum_of(rows);
  for (const auto& [op, kernel, launches, ms] : rows)
    list.add({ms, 100 * ms / sum, launches, kernel, op});
  return list;
}

}  // namespace

std::vector<KernelRow> run_kernel_times(const PerfOptions& options) {
  const std::vector<PerfCase> cases = make_perf_cases(options);
  Progress progress("kernels", cases.size());
  std::vector<KernelRow> all;
  for (const PerfCase& c : cases) {
    c.run();
    synchronize();
    TraceInUse trace(runs_on_cuda() ? gpu::trace_by_events() : trace_by_clock());
    for (int i = 0; i < options.runs; ++i) c.run();
    const std::vector<KernelRow> rows = rows_of(c.name, trace->take(), options.runs);
    all.insert(all.end(), rows.begin(), rows.end());
    progress.advance(1, c.name);
  }
  return all;
}

Json kernels_to_json(const PerfOptions& options, const std::vector<KernelRow>& rows) {
  Json json = perf_setting(options);
  json["rows"] = listed(rows).json();
  return json;
}

// An op's rows under a line of its own.
std::string kernels_to_text(const PerfOptions& options, const std::vector<KernelRow>& rows) {
  std::string text = fmt::format(
      "{}x{}, {} surfels, means of {} runs, {}\n",
      options.width,
      options.height,
      options.surfels,
      options.runs,
      on_gpu() ? device_name() : this_machine().cpu
  );
  for (std::size_t begin = 0, end = 0; begin < rows.size(); begin = end) {
    while (end < rows.size() && rows[end].op == rows[begin].op) ++end;
    const std::span of_op = std::span(rows).subspan(begin, end - begin);
    text += fmt::format("{}: {:.3f} ms in kernels\n", rows[begin].op, sum_of(of_op));
    text += listed(of_op).text();
  }
  return text;
}

}  // namespace glint
