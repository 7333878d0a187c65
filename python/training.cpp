// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <chrono>

#include "glint/train/trainer.h"
#include "python/calls.h"
#include "python/json.h"
#include "python/run.h"
#include "reports/run/bench/stages.h"
#include "reports/verbs/single_cell.h"

namespace glint::python {

namespace py = pybind11;

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kBetweenSignals{50};  // the lock of Python has a price

struct TrainArguments {
  std::string method, run, settings;  // settings: JSON
  int iterations = 0;
  std::uint64_t seed = 0;
  double max_pixels = 0, image_ratio = 1, checkpoint_seconds = 300;
  int test_psnr_every = 0, every = 1;
  bool force = false;
};

py::dict dict_of(const StepStats& stats) {
  py::dict dict, terms, sets;
  dict["iteration"] = stats.iteration;
  dict["loss"] = stats.loss;
  dict["psnr"] = stats.psnr;
  dict["num_surfels"] = stats.num_surfels;
  for (const auto& [name, value] : stats.terms) terms[text_to_python(name)] = value;
  for (const auto& [name, size] : stats.sets) sets[text_to_python(name)] = size;
  dict["terms"] = terms;
  dict["sets"] = sets;
  dict["events"] = texts_to_python(stats.events);
  return dict;
}

// What the trainer calls after each step: signals of Python, and the callback where it is due. The
// run is the training's but for that time.
class StepHook {
 public:
  StepHook(RunPointer run, const py::object& callback, int every)
      : run_(std::move(run)), callback_(callback), every_(every), lock_(run_->mutex) {}
  ~StepHook() { run_->method = nullptr; }  // of what goes with the training
  StepHook(const StepHook&) = delete;
  StepHook& operator=(const StepHook&) = delete;

  void operator()(Method& method, const StepStats& stats) {
    run_->method = &method;
    const bool due = !callback_.is_none() && ((stats.iteration + 1) % every_ == 0 ||
                                              stats.iteration + 1 == run_->options.iterations);
    if (!due && Clock::now() - last_signals_ < kBetweenSignals) return;
    lock_.unlock();
    try {
      call(stats, due);
    } catch (...) {
      lock_.lock();
      throw;
    }
    lock_.lock();
  }

 private:
  void call(const StepStats& stats, bool due) {
    const py::gil_scoped_acquire locked;
    last_signals_ = Clock::now();
    check_signals();
    if (due) callback_(dict_of(stats), run_);
  }

  RunPointer run_;
  const py::object& callback_;  // None: no callback
  int every_;
  std::unique_lock<std::mutex> lock_;
  Clock::time_point last_signals_ = Clock::now();
};

// Trains without the lock of Python and keeps the method in `run`.
RunPointer train_into(
    RunPointer run,
    const py::object& callback,
    int every,
    const std::function<std::unique_ptr<Method>(const AfterStep&)>& body
) {
  without_gil([&] {
    std::unique_ptr<Method> method;
    {
      StepHook hook(run, callback, every);
      method = body([&](Method& m, const StepStats& stats) { hook(m, stats); });
    }
    run->keep(std::move(method));
    return true;
  });
  return run;
}

RunPointer train_in_memory(
    const ScenePointer& scene, const TrainArguments& arguments, const py::object& callback
) {
  TrainOptions options;
  options.run = {arguments.iterations, arguments.seed};
  options.title = fmt::format("{} {}", scene->name, arguments.method);
  auto run = std::make_shared<Run>(arguments.method, "", options.run, scene);
  return train_into(run, callback, arguments.every, [&](const auto& after_step) {
    auto method = create_method(arguments.method, Json::parse(arguments.settings));
    options.after_step = after_step;
    train(*method, *scene, options);
    return method;
  });
}

// "name=value" as --set has it.
std::vector<std::string> assignments(const Json& settings) {
  std::vector<std::string> all;
  for (const auto& [name, value] : settings.items()) all.push_back(name + "=" + value.dump());
  return all;
}

SingleCell cell_to_train(const std::string& dataset, const TrainArguments& arguments) {
  CommonOptions common;
  common.iterations = arguments.iterations;
  common.seed = arguments.seed;
  common.set = assignments(Json::parse(arguments.settings));
  common.checkpoint_seconds = arguments.checkpoint_seconds;
  common.test_psnr_every = arguments.test_psnr_every;
  NewCellOptions options;
  options.dataset = dataset;
  options.run = arguments.run;
  options.method = arguments.method;
  options.max_pixels = arguments.max_pixels;
  options.image_ratio = arguments.image_ratio;
  options.force = arguments.force;
  return new_single_cell(common, options);
}

RunPointer train_into_folder(
    const std::string& dataset, const TrainArguments& arguments, const py::object& callback
) {
  SingleCell single = without_gil([&] { return cell_to_train(dataset, arguments); });
  const RunSpec& spec = single.spec;
  auto scene = std::make_shared<const Scene>(std::move(single.scene));
  auto run = std::make_shared<Run>(spec.method, spec.folder.string(), spec.options, scene);
  return train_into(run, callback, arguments.every, [&](const auto& after_step) {
    return train_stage(spec, *scene, after_step);
  });
}

ScenePointer load(const std::string& dataset, const TrainArguments& arguments) {
  return without_gil([&] {
    SceneSource source;
    source.max_pixels = arguments.max_pixels;
    source.image_ratio = arguments.image_ratio;
    return std::make_shared<const Scene>(load_user_data(source, dataset).scene);
  });
}

// `dataset`: a folder, or a scene that was loaded.
RunPointer train_method(
    const py::object& dataset, const TrainArguments& arguments, const py::object& callback
) {
  choose_device_once();
  const bool loaded = py::isinstance<SceneHandle>(dataset);
  if (!arguments.run.empty()) {
    if (loaded)
      throw py::type_error(
          "dataset: a Scene; expected its folder, since a run's folder says what it was trained on"
      );
    return train_into_folder(py::cast<std::string>(dataset), arguments, callback);
  }
  const ScenePointer scene = loaded ? dataset.cast<const SceneHandle&>().scene
                                    : load(py::cast<std::string>(dataset), arguments);
  return train_in_memory(scene, arguments, callback);
}

}  // namespace

void add_training(py::module_& module) {
  module.def(
      "train",
      [](const py::object& dataset, const py::object& callback, const py::kwargs& given) {
        TrainArguments arguments;
        arguments.method = py::cast<std::string>(given["method"]);
        arguments.run = py::cast<std::string>(given["run"]);
        arguments.settings = py::cast<std::string>(given["settings"]);
        arguments.iterations = py::cast<int>(given["iterations"]);
        arguments.seed = py::cast<std::uint64_t>(given["seed"]);
        arguments.max_pixels = py::cast<double>(given["max_pixels"]);
        arguments.image_ratio = py::cast<double>(given["image_ratio"]);
        arguments.checkpoint_seconds = py::cast<double>(given["checkpoint_seconds"]);
        arguments.test_psnr_every = py::cast<int>(given["test_psnr_every"]);
        arguments.every = py::cast<int>(given["every"]);
        arguments.force = py::cast<bool>(given["force"]);
        return train_method(dataset, arguments, callback);
      }
  );
}

}  // namespace glint::python
