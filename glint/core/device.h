// SPDX-License-Identifier: MIT
// Where ops run: one device at a time, chosen before the first array is made. A GPU has memory of
// its own; arrays (arrays.h) have a host and a device side and copy between them when the other is
// asked for. What ops begin runs on in the background; looking at an array on the host waits for
// it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

namespace glint {

enum class Device { kCpu, kCuda };

// What a backend other than the CPU offers (glint/cuda; tests that run kernels on the host). All
// but download() and synchronize() are in the order of the ops and wait for nothing, but that
// upload() may wait until `from` has been read. They throw Error (kEnvironment).
struct DeviceBackend {
  const char* name;                      // of the device, for people
  void* (*allocate)(std::size_t bytes);  // device memory, 64-byte aligned, of any content
  void (*release)(void* block) noexcept;
  // The host may change `from` at once, and has what it downloads.
  void (*upload)(void* to, const void* from, std::size_t bytes);
  void (*download)(void* to, const void* from, std::size_t bytes);
  void (*copy)(void* to, const void* from, std::size_t bytes);
  void (*clear)(void* block, std::size_t bytes);  // to zeros
  void (*fill)(float* to, std::size_t count, float value);
  void (*synchronize)();
  std::size_t (*room)();  // bytes of its memory that are free
  // The most bytes of its memory that were in use since the last reset.
  std::size_t (*peak)();
  void (*reset_peak)();
  // Memory of the host's sides, 64-byte aligned; null: the host's own.
  void* (*allocate_host)(std::size_t bytes) = nullptr;
  void (*release_host)(void* block) noexcept = nullptr;
};

Device current_device();
inline bool on_gpu() { return current_device() != Device::kCpu; }
void use_cpu();
// `backend` must live as long as arrays made with it.
void use_gpu(const DeviceBackend& backend);
// Of the GPU in use, or "cpu".
const char* device_name();
// Bytes of the GPU's memory that are free; 0 on the CPU.
std::size_t device_room();
// The most of the GPU's memory that this program had in use since the last reset, in megabytes
// (10^6 bytes); 0 on the CPU.
double device_peak_mb();
void reset_device_peak();

// What the host asked of a device since the program began: differences over a step are of interest.
struct DeviceCounters {
  std::uint64_t launches = 0;
  std::uint64_t uploads = 0, downloads = 0;  // copies from and to the host
  std::uint64_t waits = 0;                   // of the host for the device, those of downloads, too
  std::uint64_t allocations = 0;             // blocks that were not there before

  // f(name, count of each) for all of them.
  template <class F, class... Counters>
  static void for_each(F&& f, Counters&... counters) {
    f("launches", counters.launches...);
    f("uploads", counters.uploads...);
    f("downloads", counters.downloads...);
    f("waits", counters.waits...);
    f("allocations", counters.allocations...);
  }
};
inline DeviceCounters device_counters;

// In a silent step the host looks at nothing that ops compute, so that it never waits: sums that
// are only told are not read, and lists that ops make are as long as their memory. On the CPU there
// is no difference.
class SilentStep {
 public:
  explicit SilentStep(bool silent) : before_(std::exchange(silent_, silent)) {}
  ~SilentStep() { silent_ = before_; }
  SilentStep(const SilentStep&) = delete;
  SilentStep& operator=(const SilentStep&) = delete;
  static bool now() { return silent_ && on_gpu(); }

 private:
  static inline bool silent_ = false;
  bool before_;
};

void synchronize();

// Memory of the host, 64-byte aligned. Blocks may be freed while another device is in use.
void* allocate_on_host(std::size_t bytes);
void free_on_host(void* block) noexcept;

template <class T>
struct HostAllocator {
  using value_type = T;
  HostAllocator() = default;
  template <class U>
  HostAllocator(const HostAllocator<U>&) {}
  T* allocate(std::size_t count) { return static_cast<T*>(allocate_on_host(count * sizeof(T))); }
  void deallocate(T* block, std::size_t) noexcept { free_on_host(block); }
  friend bool operator==(HostAllocator, HostAllocator) { return true; }
};

// Memory of the device in use when it was first asked for. Grows, never shrinks.
class DeviceBlock {
 public:
  DeviceBlock() = default;
  DeviceBlock(DeviceBlock&& other) noexcept { swap(other); }
  DeviceBlock& operator=(DeviceBlock&& other) noexcept {
    swap(other);
    return *this;
  }
  ~DeviceBlock() { release(); }

  void* data() const { return data_; }
  // Room for so many bytes on the device in use, of which the first `kept` stay what they are.
  void fit(std::size_t bytes, std::size_t kept);
  void upload(const void* from, std::size_t bytes);
  void download(void* to, std::size_t bytes) const;
  void copy(const DeviceBlock& from, std::size_t bytes);  // of the same device
  void clear(std::size_t first, std::size_t bytes);
  void fill(std::size_t count, float value);
  void release() noexcept;
  bool is_current() const;  // of the device in use

 private:
  void swap(DeviceBlock& other) noexcept;
  const DeviceBackend* backend_ = nullptr;
  void* data_ = nullptr;
  std::size_t capacity_ = 0;  // bytes
};

}  // namespace glint
