// SPDX-License-Identifier: MIT
#include <algorithm>
#include <bit>

#include "glint/core/device.h"
#include "glint/cuda/device_buffer.h"

namespace glint::gpu {

std::size_t MemoryPool::rounded(std::size_t bytes) {
  constexpr std::size_t kLeast = 512;
  if (bytes <= kLeast) return kLeast;
  const std::size_t step = std::bit_floor(bytes) / 8;
  return (bytes + step - 1) / step * step;
}

void* MemoryPool::fresh(std::size_t size) {
  void* block = source_.get(size);
  if (block == nullptr && held_ > in_use_) {
    trim_now();
    block = source_.get(size);
  }
  if (block == nullptr) return nullptr;
  ++device_counters.allocations;
  sizes_[block] = size;
  held_ += size;
  return block;
}

void* MemoryPool::allocate(std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  const std::size_t size = rounded(bytes);
  std::vector<void*>& free = free_[size];
  void* block = nullptr;
  if (!free.empty()) {
    block = free.back();
    free.pop_back();
  } else {
    block = fresh(size);
  }
  if (block != nullptr) in_use_ += size;
  peak_ = std::max(peak_, in_use_);
  return block;
}

void MemoryPool::release(void* block) {
  const std::lock_guard lock(mutex_);
  const std::size_t size = sizes_.at(block);
  in_use_ -= size;
  free_[size].push_back(block);
}

void MemoryPool::reset_peak() {
  const std::lock_guard lock(mutex_);
  peak_ = in_use_;
}

void MemoryPool::trim() {
  const std::lock_guard lock(mutex_);
  trim_now();
}

void MemoryPool::trim_now() {
  source_.wait();
  for (auto& [size, blocks] : free_) {
    for (void* block : blocks) {
      source_.give(block);
      sizes_.erase(block);
      held_ -= size;
    }
    blocks.clear();
  }
}

}  // namespace glint::gpu
