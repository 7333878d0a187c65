// SPDX-License-Identifier: MIT
#include "glint/core/device.h"

#include <algorithm>
#include <memory>
#include <new>

#include "glint/core/error.h"
#include "glint/core/kernel.h"
#include "glint/core/process.h"

namespace glint {

namespace {

constexpr std::size_t kAlignment = 64;  // bytes: a cache line, two vectors

// Before each block: who made it.
struct alignas(kAlignment) BlockHeader {
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

double device_peak_mb() {
  return current == nullptr ? 0 : static_cast<double>(current->peak()) / 1e6;
}
void reset_device_peak() {
  if (current != nullptr) current->reset_peak();
}

std::size_t device_room() { return current == nullptr ? 0 : current->room(); }

void synchronize() {
  if (current == nullptr) return;
  ++device_counters.waits;
  current->synchronize();
}

// Aligned by hand on the host: a block that glibc aligned is too small for its next request of that
// size, so that nothing would be used again.
void* allocate_on_host(std::size_t bytes) {
  const bool own = current == nullptr || current->allocate_host == nullptr;
  const std::size_t total = bytes + sizeof(BlockHeader);
  std::size_t room = total + kAlignment;
  void* block = own ? ::operator new(room, std::nothrow) : current->allocate_host(total);
  if (block == nullptr) throw HostMemoryFull(bytes);
  void* start = block;
  if (own) std::align(kAlignment, total, start, room);
  return new (start) BlockHeader{own ? nullptr : current, block} + 1;
}

void free_on_host(void* memory) noexcept {
  if (memory == nullptr) return;
  BlockHeader* header = static_cast<BlockHeader*>(memory) - 1;
  if (header->backend != nullptr)
    header->backend->release_host(header->block);
  else
    ::operator delete(header->block);
}

void DeviceBlock::swap(DeviceBlock& other) noexcept {
  std::swap(backend_, other.backend_);
  std::swap(data_, other.data_);
  std::swap(capacity_, other.capacity_);
}

bool DeviceBlock::is_current() const { return backend_ == current; }

void DeviceBlock::fit(std::size_t bytes, std::size_t kept) {
  if (is_current() && bytes <= capacity_) return;
  DeviceBlock larger;
  larger.backend_ = current;
  larger.capacity_ = kept > 0 ? bytes + bytes / 2 : bytes;  // what grew will grow again
  larger.data_ = current->allocate(larger.capacity_);
  if (kept > 0) larger.copy(*this, kept);
  swap(larger);
}
void DeviceBlock::upload(const void* from, std::size_t bytes) {
  ++device_counters.uploads;
  backend_->upload(data_, from, bytes);
}
void DeviceBlock::download(void* to, std::size_t bytes) const {
  ++device_counters.downloads;
  ++device_counters.waits;
  backend_->download(to, data_, bytes);
}
void DeviceBlock::copy(const DeviceBlock& from, std::size_t bytes) {
  if (bytes > 0) backend_->copy(data_, from.data_, bytes);
}
void DeviceBlock::clear(std::size_t first, std::size_t bytes) {
  if (bytes > 0) backend_->clear(static_cast<char*>(data_) + first, bytes);
}
void DeviceBlock::fill(std::size_t count, float value) {
  backend_->fill(static_cast<float*>(data_), count, value);
}
void DeviceBlock::release() noexcept {
  if (data_ != nullptr) backend_->release(data_);
  data_ = nullptr;
  capacity_ = 0;
}

namespace detail {
void throw_not_on_device() {
  throw Error(ExitCode::kUsage, "an op on a GPU was given values that are in no array of its own");
}
void throw_no_gpu_kernel(const char* name) {
  throw Error(
      ExitCode::kEnvironment,
      fmt::format("{} has no GPU kernel (glint/cuda/kernels.h); use --device cpu", name)
  );
}
}  // namespace detail

}  // namespace glint
