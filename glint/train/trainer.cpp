// SPDX-License-Identifier: MIT
#include "glint/train/trainer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <utility>

#include "glint/core/device_lost.h"
#include "glint/core/interrupt.h"
#include "glint/core/progress.h"
#include "glint/core/recorded_step.h"
#include "glint/core/rng.h"
#include "glint/render/void_steps.h"

namespace glint {

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Json log_line(const StepStats& stats, const TrainReport& report) {
  Json line = {
      {"iteration", stats.iteration},
      {"loss", stats.loss},
      {"psnr", stats.psnr},
      {"num_surfels", stats.num_surfels},
      {"seconds", report.seconds},
      {"saving_seconds", report.saving_seconds}};
  for (const auto& [name, value] : stats.terms) line["terms"][name] = value;
  return line;
}

// On a GPU the host looks at losses this often; in between it waits for nothing.
constexpr int kToldInterval = 20;

void note_void_steps(int iteration, Json& events) {
  const std::size_t count = take_void_steps();
  if (count > 0)
    events.push_back(
        {{"iteration", iteration},
         {"text", fmt::format("{} steps were left out: no room for their pairs yet", count)}}
    );
}

template <class F>
void for_each_image(const View& view, F&& f) {
  f(view.rgb);
  view.priors.for_each([&](const MapRow&, const Image& map) { f(map); });
  view.truth.for_each([&](const MapRow&, const Image& map) { f(map); });
}

// Images of views come to the device when a step first needs them. They stay there if all of them
// fill at most half of it; else each step's leave, and come again.
class ImagesOnDevice {
 public:
  explicit ImagesOnDevice(const Scene& scene) : views_(scene.train) {
    std::size_t bytes = 0;
    for (const View& view : views_)
      for_each_image(view, [&](const Image& image) {
        bytes += image.num_pixels() * static_cast<std::size_t>(image.channels()) * sizeof(float);
      });
    stay_ = !on_gpu() || bytes <= device_room() / 2;
  }
  void end_step() const {
    if (stay_) return;
    for (const View& view : views_)
      for_each_image(view, [](const Image& image) { image.array().leave_device(); });
  }

 private:
  const std::vector<View>& views_;
  bool stay_;
};

void check_step(const Method& method, const StepStats& stats, const fs::path& checkpoint) {
  if (std::isfinite(stats.loss)) return;
  const std::string where = fmt::format(
      "training stopped at iteration {}; the last good state is in {}",
      stats.iteration,
      checkpoint.string()
  );
  try {
    method.check_finite();
  } catch (const Error& culprit) {
    throw Error(ExitCode::kBadPrediction, fmt::format("{}: {}", where, culprit.what()));
  }
  for (const auto& [name, value] : stats.terms)
    GLINT_CHECK(std::isfinite(value), kBadPrediction, "{}: loss term {} is {}", where, name, value);
  throw Error(ExitCode::kBadPrediction, fmt::format("{}: the loss is {}", where, stats.loss));
}

// Written beside the last one and put in its place: whatever fails half-way, one is whole.
void save_checkpoint(const Method& method, const fs::path& checkpoint) {
  fs::path fresh = checkpoint;
  fresh += ".tmp";
  method.check_finite();
  fs::remove_all(fresh);
  method.save(fresh.string());
  fs::remove_all(checkpoint);
  fs::rename(fresh, checkpoint);
}

// `step()`; where the device is lost, the error also says what is left of the run.
template <class F>
auto on_device(int iteration, const fs::path& checkpoint, F&& step) {
  try {
    return step();
  } catch (const DeviceLost& lost) {
    throw DeviceLost(fmt::format(
        "training stopped at iteration {}, {}: {}",
        iteration,
        fs::exists(checkpoint) ? "the last checkpoint is in " + checkpoint.string()
                               : "before the first checkpoint",
        lost.what()
    ));
  }
}

}  // namespace

int scaled_step(int published, int iterations, int at_least, int of) {
  const double scaled = static_cast<double>(published) * iterations / of;
  return std::max(at_least, static_cast<int>(std::lround(scaled)));
}

ViewSampler::ViewSampler(std::size_t num_views, std::uint64_t seed)
    : num_views_(num_views), seed_(seed) {}

std::size_t ViewSampler::next() {
  if (remaining_.empty()) {
    remaining_.resize(num_views_);
    std::iota(remaining_.begin(), remaining_.end(), std::size_t{0});
    Rng rng(seed_, hash_name("views") + epoch_++);
    for (std::size_t i = num_views_; i > 1; --i)
      std::swap(remaining_[i - 1], remaining_[rng.below(static_cast<std::uint32_t>(i))]);
  }
  const std::size_t view = remaining_.back();
  remaining_.pop_back();
  return view;
}

TrainReport train(Method& method, const Scene& scene, const TrainOptions& options) {
  GLINT_CHECK(!scene.train.empty(), kBadReference, "{}: no training views", scene.name);
  const fs::path checkpoint = options.folder / "checkpoint";
  const bool on_disk = !options.folder.empty();
  method.initialize(scene, options.run);
  for (const std::string& warning : method.warnings()) log::warn(warning);
  Progress progress(options.title, static_cast<std::size_t>(options.run.iterations));
  const ImagesOnDevice images(scene);
  TrainReport report;
  Json events = Json::array();  // since the last line of the log
  for (int i = 0; i < options.run.iterations; ++i) {
    throw_if_interrupted();
    const bool due = (i + 1) % options.log_interval == 0 || i + 1 == options.run.iterations;
    const bool told = !on_gpu() || due || i % kToldInterval == 0;
    const auto start = Clock::now();
    const StepStats stats = on_device(i, checkpoint, [&] {
      const SilentStep silent(!told);
      RecordedStep recorded;
      StepStats result = method.step(i);
      end_silent_step();
      recorded.end();
      images.end_step();
      return result;
    });
    report.seconds += seconds_since(start);
    report.iterations = i + 1;
    if (told) {
      check_step(method, stats, checkpoint);
      report.last = stats;
      note_void_steps(i, events);
    }
    progress.advance(
        1,
        fmt::format(
            "loss {:.4f}  psnr {:.2f}  {} surfels",
            report.last.loss,
            report.last.psnr,
            report.last.num_surfels
        )
    );
    for (const std::string& event : stats.events)
      events.push_back({{"iteration", i}, {"text", event}});
    if (on_disk && due) {
      Json line = log_line(stats, report);
      if (!events.empty()) line["events"] = std::exchange(events, Json::array());
      append_line(options.folder / "log.jsonl", line.dump());
    }
    if (on_disk && (i + 1) % options.save_interval == 0) {
      const auto save = Clock::now();
      on_device(i, checkpoint, [&] { save_checkpoint(method, checkpoint); });
      report.saving_seconds += seconds_since(save);
    }
  }
  method.check_finite();
  report.num_surfels = method.num_surfels();
  return report;
}

}  // namespace glint
