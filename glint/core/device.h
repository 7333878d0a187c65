// SPDX-License-Identifier: MIT
// Where ops run and where arrays live: one device at a time, chosen before the first array is made.
// On a GPU, arrays are in memory that host and device share (pages move on demand), so every op has
// the same signature on both and whatever has no kernel still works, slower. What ops begin runs
// on in the background: the host calls synchronize() before it looks at arrays that ops wrote.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

namespace glint {

enum class Device { kCpu, kCuda };

// What a backend other than the CPU offers (glint/cuda; tests that run kernels on the host).
struct DeviceBackend {
  const char* name;                      // of the device, for people
  void* (*allocate)(std::size_t bytes);  // seen by host and device; throws Error (kEnvironment)
  void (*free)(void* block);             // waits for the device
  void (*fill)(float* to, std::size_t count, float value);
  void (*synchronize)();
};

Device current_device();
inline bool on_gpu() { return current_device() != Device::kCpu; }
void use_cpu();
// `backend` must live as long as arrays made with it.
void use_gpu(const DeviceBackend& backend);
// Of the GPU in use, or "cpu".
const char* device_name();

// What the host asked of a device since the program began: differences over a step are of interest.
struct DeviceCounters {
  std::uint64_t launches = 0;
  std::uint64_t uploads = 0, downloads = 0;  // copies from and to the host
  std::uint64_t waits = 0;                   // of the host for the device, those of downloads, too
  std::uint64_t allocations = 0;             // blocks that were not there before
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
// Sets floats in the order of the ops.
void fill(float* to, std::size_t count, float value);

// Memory of arrays, 64-byte aligned. Blocks may be freed while another device is in use.
void* allocate_array(std::size_t bytes);
void free_array(void* array) noexcept;

// Of vectors whose elements ops read or write.
template <class T>
struct ArrayAllocator {
  using value_type = T;
  ArrayAllocator() = default;
  template <class U>
  ArrayAllocator(const ArrayAllocator<U>&) {}
  T* allocate(std::size_t count) { return static_cast<T*>(allocate_array(count * sizeof(T))); }
  void deallocate(T* array, std::size_t) noexcept { free_array(array); }
  friend bool operator==(ArrayAllocator, ArrayAllocator) { return true; }
};

}  // namespace glint
