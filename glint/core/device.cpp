// SPDX-License-Identifier: MIT
#include "glint/core/device.h"

#include <algorithm>
#include <memory>
#include <new>

#include "glint/core/error.h"
#include "glint/core/kernel.h"

namespace glint {

namespace {

constexpr std::size_t kAlignment = 64;  // bytes: a cache line, two vectors

// Before each array: who made it.
struct alignas(kAlignment) ArrayHeader {
  const DeviceBackend* backend;  // null: the host
  void* block;                   // as allocated
};

const DeviceBackend* current = nullptr;

}  // namespace

Device current_device() { return current == nullptr ? Device::kCpu : Device::kCuda; }
void use_cpu() {
  synchronize();
  current = nullptr;
}
void use_gpu(const DeviceBackend& backend) { current = &backend; }
const char* device_name() { return current == nullptr ? "cpu" : current->name; }

void synchronize() {
  if (current != nullptr) current->synchronize();
}

void fill(float* to, std::size_t count, float value) {
  if (count == 0) return;
  if (current != nullptr)
    current->fill(to, count, value);
  else
    std::fill_n(to, count, value);
}

// Aligned by hand on the host: a block that glibc aligned is too small for its next request of that
// size, so that nothing would be used again.
void* allocate_array(std::size_t bytes) {
  const std::size_t total = bytes + sizeof(ArrayHeader);
  std::size_t room = total + kAlignment;
  void* block = current != nullptr ? current->allocate(total) : ::operator new(room);
  void* start = block;
  if (current == nullptr) std::align(kAlignment, total, start, room);
  return new (start) ArrayHeader{current, block} + 1;
}

void free_array(void* array) noexcept {
  if (array == nullptr) return;
  ArrayHeader* header = static_cast<ArrayHeader*>(array) - 1;
  if (header->backend != nullptr)
    header->backend->free(header->block);
  else
    ::operator delete(header->block);
}

namespace detail {
void throw_no_gpu_kernel(const char* name) {
  throw Error(
      ExitCode::kEnvironment,
      fmt::format("{} has no GPU kernel (glint/cuda/kernels.h); use --device cpu", name)
  );
}
}  // namespace detail

}  // namespace glint
