// SPDX-License-Identifier: MIT
// Two memories on the host, for kernels that run there: the device's is closed while the host runs,
// the host's (of arrays) while a kernel does, so that a pointer to the wrong side ends the test
// where it is used. Blocks are full of NaN when they are given away.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "glint/cuda/device_buffer.h"

namespace glint::test {

// Addresses that are opened and closed as one.
class Arena {
 public:
  void* allocate(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    const std::size_t size = (bytes + kAlignment - 1) / kAlignment * kAlignment;
    std::vector<char*>& free = free_[size];
    char* block = nullptr;
    if (free.empty()) {
      block = base() + used_;
      grow(used_ + size);
    } else {
      block = free.back();
      free.pop_back();
    }
    sizes_[block] = size;
    poison(block, size);
    return block;
  }
  void release(void* memory) {
    const std::lock_guard lock(mutex_);
    char* block = static_cast<char*>(memory);
    const std::size_t size = sizes_.at(block);
    poison(block, size);
    free_[size].push_back(block);
  }
  void set_open(bool open) {
    if (open == open_) return;
    open_ = open;
    protect(0, mapped_);
  }
  bool is_open() const { return open_; }
  bool has(const void* p) const { return base_ != nullptr && p >= base_ && p < base_ + used_; }

 private:
  static constexpr std::size_t kAlignment = 256;  // as cudaMalloc's
  // What is opened and closed at once: that of many small pages takes longer than kernels do.
  static constexpr std::size_t kHugePage = std::size_t{1} << 21;
  static constexpr std::size_t kReserved = std::size_t{1} << 35;  // bytes of address space

  char* base() {
    if (base_ != nullptr) return base_;
    void* place = mmap(
        nullptr,
        kReserved + kHugePage,
        PROT_NONE,
        MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE,
        -1,
        0
    );
    if (place == MAP_FAILED) throw std::runtime_error("no address space for the memory of tests");
    std::size_t room = kReserved + kHugePage;
    base_ = static_cast<char*>(std::align(kHugePage, kReserved, place, room));
    madvise(base_, kReserved, MADV_HUGEPAGE);
    return base_;
  }
  void grow(std::size_t used) {
    used_ = used;
    const std::size_t wanted = (used + kHugePage - 1) / kHugePage * kHugePage, before = mapped_;
    if (wanted <= before) return;
    mapped_ = wanted;
    protect(before, wanted);
  }
  void protect(std::size_t from, std::size_t to) {
    if (to > from) mprotect(base_ + from, to - from, open_ ? PROT_READ | PROT_WRITE : PROT_NONE);
  }
  void poison(char* block, std::size_t size) {
    const bool before = open_;
    set_open(true);
    std::memset(block, 0xff, size);
    set_open(before);
  }

  std::mutex mutex_;  // arrays of several threads
  char* base_ = nullptr;
  std::size_t used_ = 0, mapped_ = 0;
  bool open_ = false;
  std::map<std::size_t, std::vector<char*>> free_;
  std::map<char*, std::size_t> sizes_;
};

struct HostMemory {
  Arena host, device;
  bool watching = true;
  std::size_t room = std::size_t{1} << 34;  // bytes that the device says are free
  HostMemory() { host.set_open(true); }
};
// Never destroyed: static arrays of tests end later.
inline HostMemory& host_memory() {
  static HostMemory& memory = *new HostMemory;
  return memory;
}
// Opening and closing takes longer than small kernels: long trainings may go without.
inline void watch_memory(bool watching) {
  host_memory().watching = watching;
  host_memory().device.set_open(!watching);
}

// Which memories are open while this lives.
class OpenMemory {
 public:
  enum Side { kDevice, kBoth };
  explicit OpenMemory(Side side)
      : host_(host_memory().host.is_open()), device_(host_memory().device.is_open()) {
    if (!host_memory().watching) return;
    host_memory().device.set_open(true);
    host_memory().host.set_open(side == kBoth);
  }
  ~OpenMemory() {
    host_memory().device.set_open(device_);
    host_memory().host.set_open(host_);
  }
  OpenMemory(const OpenMemory&) = delete;

 private:
  bool host_, device_;
};

// The device's memory by way of the pool that the real one uses.
struct HostDeviceMemory {
  static gpu::MemoryPool& pool() {
    static gpu::MemoryPool& pool = *new gpu::MemoryPool(
        {[](std::size_t bytes) { return host_memory().device.allocate(bytes); },
         [](void* block) { host_memory().device.release(block); },
         [] {}}
    );
    return pool;
  }
  static void* allocate(std::size_t bytes) {
    void* block = pool().allocate(bytes);
    const OpenMemory open(OpenMemory::kBoth);
    std::memset(block, 0xff, bytes);  // what was there before is not to be relied on
    return block;
  }
  static void release(void* block) noexcept { pool().release(block); }
};

}  // namespace glint::test
