// SPDX-License-Identifier: MIT
#include "glint/render/trace.h"

#include <optional>

#include "glint/core/error.h"
#include "glint/render/op_backends.h"

namespace glint {

struct Tracer::State {
  std::optional<TraceCall> call;
  TraceOutput output;
  TraceGradient gradient;
  DeviceChoice<TraceBackend> devices;

  TraceBackend& device() { return devices.on(on_gpu(), trace_on_cpu, gpu_ops.tracer); }
  const TraceCall& last_call() const {
    GLINT_CHECK(call.has_value(), kUsage, "trace: nothing was traced before");
    return *call;
  }
};

namespace {

void check_call(const TraceCall& call) {
  const TraceInput& input = call.input;
  const Rays& rays = call.rays;
  const std::size_t n = input.count;
  const bool sizes_agree = input.means.size() == 3 * n && input.scales.size() == 2 * n &&
                           input.rotations.size() == 4 * n && input.opacities.size() == n &&
                           input.sh_dc.size() == 3 * n && input.sh_rest.size() == 45 * n;
  GLINT_CHECK(sizes_agree, kUsage, "trace: array sizes do not match {} surfels", n);
  GLINT_CHECK(
      rays.origins.size() == rays.directions.size() && rays.origins.channels() == 3 &&
          rays.directions.channels() == 3,
      kUsage,
      "trace: origins are {}x{}x{}, directions {}x{}x{}, expected two images of 3 channels",
      rays.origins.width(),
      rays.origins.height(),
      rays.origins.channels(),
      rays.directions.width(),
      rays.directions.height(),
      rays.directions.channels()
  );
}

void fit_output(ImageSize size, TraceOutput& out) {
  fit(out.color, size, 3);
  fit(out.normal, size, 3);
  fit(out.alpha, size, 1);
  fit(out.depth_sum, size, 1);
}

void fit_gradient(const TraceInput& input, ImageSize size, TraceGradient& out) {
  const std::size_t n = input.count;
  out.means.resize(3 * n);
  out.scales.resize(2 * n);
  out.rotations.resize(4 * n);
  out.opacities.resize(n);
  out.sh_dc.resize(3 * n);
  out.sh_rest.resize(45 * n);
  out.visibility.resize(n);
  out.half_depths.resize(3 * n);
  fit(out.rays.origins, size, 3);
  fit(out.rays.directions, size, 3);
}

}  // namespace

Tracer::Tracer() : state_(std::make_unique<State>()) {}
Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;
Tracer& Tracer::operator=(Tracer&&) noexcept = default;

const TraceCall& Tracer::call() const { return state_->last_call(); }
const TraceOutput& Tracer::output() const { return state_->output; }
std::size_t Tracer::num_hits() const { return state_->device().num_hits(); }

const TraceOutput& Tracer::forward(const TraceCall& call) {
  check_call(call);
  state_->call.emplace(call);
  fit_output(call.rays.origins.size(), state_->output);
  state_->device().forward(call, state_->output);
  return state_->output;
}

const TraceGradient& Tracer::backward(const TraceOutputGradient& dL_doutput) {
  const TraceCall& call = state_->last_call();
  fit_gradient(call.input, call.rays.origins.size(), state_->gradient);
  state_->device().backward(call, state_->output, dL_doutput, state_->gradient);
  return state_->gradient;
}

}  // namespace glint
