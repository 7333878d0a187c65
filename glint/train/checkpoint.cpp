// SPDX-License-Identifier: MIT
#include "glint/train/checkpoint.h"

#include <cmath>
#include <cstring>
#include <map>
#include <vector>

#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/method.h"

namespace glint {

namespace {

// Kept in the metadata; grows when a checkpoint of before cannot be read any more.
constexpr const char* kFormat = "glint-bench checkpoint 2";
constexpr const char* kFormatKey = "format";
constexpr const char* kIdentityKey = "identity";

class StateWriter final : public TrainingState {
 public:
  bool reading() const override { return false; }
  std::map<std::string, std::string> texts;
  std::vector<TensorToWrite> tensors;  // borrow what was visited

 private:
  void exchange(const std::string& name, std::string& text) override { texts[name] = text; }
  void exchange(
      const std::string& name,
      TensorType type,
      std::size_t count,
      const std::function<void*(std::size_t)>& place
  ) override {
    const TensorInfo info{type, {count}};
    tensors.push_back({name, info, [place, info, count](std::byte* to) {
                         if (count > 0) std::memcpy(to, place(count), info.num_bytes());
                       }});
  }
};

class StateReader final : public TrainingState {
 public:
  explicit StateReader(const fs::path& file) : file_(file) {}
  bool reading() const override { return true; }

 private:
  [[noreturn]] void fail(const std::string& name, const std::string& found) const {
    throw Error(
        ExitCode::kBadReference,
        fmt::format(
            "{}: {} {}; remove it or give --force, and the training starts anew",
            file_.path().string(),
            name,
            found
        )
    );
  }
  void exchange(const std::string& name, std::string& text) override {
    const auto found = file_.metadata().find(name);
    if (found == file_.metadata().end()) fail(name, "is not in its metadata");
    text = found->second;
  }
  void exchange(
      const std::string& name,
      TensorType type,
      std::size_t,
      const std::function<void*(std::size_t)>& place
  ) override {
    const TensorInfo* info = file_.find(name);
    if (info == nullptr) fail(name, "is not among its tensors");
    if (info->type != type || info->shape.size() != 1)
      fail(
          name,
          fmt::format(
              "is {} {}, expected {} of one dimension",
              name_of(info->type),
              shape_text(info->shape),
              name_of(type)
          )
      );
    void* to = place(info->num_values());
    file_.read_bytes(name, {static_cast<std::byte*>(to), info->num_bytes()});
  }

  SafetensorsFile file_;
};

}  // namespace

void TrainingProgress::visit_state(TrainingState& state) {
  state("iterations", iterations);
  state("seconds", seconds);
  state("saving_seconds", saving_seconds);
  state("peak_memory_mb", peak_memory_mb);
  state("device_memory_mb", device_memory_mb);
  state("void_steps", void_steps);
  state("events", events);
  if (!state.reading()) return;
  const bool possible = iterations >= 0 && std::isfinite(seconds) &&
                        std::isfinite(saving_seconds) && std::isfinite(peak_memory_mb) &&
                        std::isfinite(device_memory_mb);
  GLINT_CHECK(
      possible, kBadReference, "iteration {} after {} s, of no training", iterations, seconds
  );
}

bool write_checkpoint(
    const fs::path& file, const std::string& identity, Method& method, TrainingProgress progress
) {
  StateWriter state;
  if (!method.visit_state(state)) return false;
  state("trainer", progress);
  state.texts[kFormatKey] = kFormat;
  state.texts[kIdentityKey] = identity;
  write_safetensors(file, state.texts, state.tensors);
  return true;
}

bool is_checkpoint_of(const fs::path& file, const std::string& identity) {
  if (!is_there(file)) return false;
  try {
    const SafetensorsFile found(file);
    const auto& texts = found.metadata();
    const auto format = texts.find(kFormatKey), of = texts.find(kIdentityKey);
    return format != texts.end() && format->second == kFormat && of != texts.end() &&
           of->second == identity;
  } catch (const Error&) {
    return false;
  }
}

void read_checkpoint(const fs::path& file, Method& method, TrainingProgress& progress) {
  StateReader state(file);
  try {
    GLINT_CHECK(method.visit_state(state), kBadReference, "of a method without a state");
    state("trainer", progress);
  } catch (const Error& error) {
    const std::string what = error.what();
    const bool named = what.find(file.string()) != std::string::npos;
    throw Error(error.code(), named ? what : fmt::format("{}: {}", file.string(), what));
  }
}

}  // namespace glint
