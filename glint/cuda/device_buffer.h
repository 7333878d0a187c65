// SPDX-License-Identifier: MIT
// Memory of the device beside arrays: what the ops themselves need.
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

namespace glint::gpu {

// Blocks of device memory that are used again. All work is in one order (one stream), so a block
// that was released may be given away at once: what still reads it comes first. Threads of the host
// may call it at the same time. Sizes are rounded
// up so that what grows a little finds its old block again.
class MemoryPool {
 public:
  // `get` returns null where there is no room; `give` is only called when no work is left, after
  // `wait`.
  struct Source {
    void* (*get)(std::size_t bytes);
    void (*give)(void* block);
    void (*wait)();
  };
  explicit MemoryPool(Source source) : source_(source) {}
  MemoryPool(const MemoryPool&) = delete;

  // Null: there is no room, even with what was released given back.
  void* allocate(std::size_t bytes);
  void release(void* block);
  // Gives back what is not in use.
  void trim();
  std::size_t bytes_in_use() const { return in_use_; }
  std::size_t bytes_held() const { return held_; }  // those in use, too
  // The most that were in use since the last reset.
  std::size_t peak_bytes() const { return peak_; }
  void reset_peak();

  // At most an eighth larger.
  static std::size_t rounded(std::size_t bytes);

 private:
  void* fresh(std::size_t size);
  void trim_now();

  Source source_;
  std::mutex mutex_;
  std::map<std::size_t, std::vector<void*>> free_;  // by size
  std::map<void*, std::size_t> sizes_;
  std::size_t in_use_ = 0, held_ = 0, peak_ = 0;
};

// An array without a host's side. Grows and never shrinks, so that a steady state allocates
// nothing. Memory::allocate(bytes) and Memory::release(block).
template <class T, class Memory>
class DeviceBuffer {
 public:
  DeviceBuffer() = default;
  DeviceBuffer(DeviceBuffer&& other) noexcept { swap(other); }
  DeviceBuffer& operator=(DeviceBuffer&& other) noexcept {
    swap(other);
    return *this;
  }
  ~DeviceBuffer() { release(); }

  // What was there before is not kept once it has to grow, which it does by half more than that.
  void resize(std::size_t count) { resize(count, count + count / 2); }
  // For counts that have a margin already.
  void resize_exactly(std::size_t count) { resize(count, count); }
  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }
  T* data() { return data_; }
  const T* data() const { return data_; }

 private:
  void resize(std::size_t count, std::size_t room) {
    size_ = count;
    if (count <= capacity_) return;
    release();
    data_ = static_cast<T*>(Memory::allocate(room * sizeof(T)));
    capacity_ = room;
  }
  void release() {
    if (data_ != nullptr) Memory::release(data_);
    data_ = nullptr;
    capacity_ = 0;
  }
  void swap(DeviceBuffer& other) {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }
  T* data_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace glint::gpu
