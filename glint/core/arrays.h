// SPDX-License-Identifier: MIT
// Vectors that ops read and write, on whichever device they run. An array has a host side and, with
// a GPU in use, a device side. Whichever side is asked for is brought up to date first, so code
// without a kernel works, slower; `device_counters` tells.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <initializer_list>
#include <mutex>
#include <span>
#include <type_traits>
#include <vector>

#include "glint/core/device.h"

namespace glint {

template <class T>
class Array;

// An array where ops run, for the fields of kernels: a `const T*` reads it, a `T*` may write it.
template <class T>
class ConstOnDevice {
 public:
  explicit ConstOnDevice(const Array<T>& array) : array_(array) {}
  operator const T*() const { return array_.device_for_reading(); }

 private:
  const Array<T>& array_;
};
template <class T>
class OnDevice {
 public:
  explicit OnDevice(Array<T>& array) : array_(array) {}
  operator const T*() const { return array_.device_for_reading(); }
  operator T*() const { return array_.device_for_writing(); }

 private:
  Array<T>& array_;
};

namespace detail {
inline std::mutex array_mutex;  // several threads of the host may look at an array first
inline std::atomic<std::uint64_t> last_revision{0};
}  // namespace detail

// T: copied byte by byte, zero when its bytes are.
template <class T>
class Array {
  static_assert(std::is_trivially_copyable_v<T>);
  using Host = std::vector<T, HostAllocator<T>>;

 public:
  using value_type = T;
  using size_type = std::size_t;
  using iterator = T*;
  using const_iterator = const T*;

  Array() = default;
  explicit Array(std::size_t count) { resize(count); }
  Array(std::size_t count, const T& value) {
    if (is_zero(value))
      resize(count);
    else
      assign(count, value);
  }
  Array(std::initializer_list<T> values) : Array(values.begin(), values.end()) {}
  template <class Iterator, class = std::enable_if_t<!std::is_integral_v<Iterator>>>
  Array(Iterator first, Iterator last) : host_(first, last), size_(host_.size()) {}
  Array(const Array& other) { copy(other); }
  Array(Array&& other) noexcept { swap(other); }
  Array& operator=(const Array& other) {
    if (this != &other) copy(other);
    return *this;
  }
  Array& operator=(Array&& other) noexcept {
    swap(other);
    return *this;
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }

  // The host's side.
  const T* data() const {
    to_host();
    return host_.data();
  }
  T* data() {
    to_host_alone();
    return host_.data();
  }
  const T& operator[](std::size_t i) const { return data()[i]; }
  T& operator[](std::size_t i) { return data()[i]; }
  const_iterator begin() const { return data(); }
  const_iterator end() const { return data() + size_; }
  iterator begin() { return data(); }
  iterator end() { return data() + size_; }
  const T& front() const { return data()[0]; }
  const T& back() const { return data()[size_ - 1]; }
  T& back() { return data()[size_ - 1]; }

  void reserve(std::size_t count) { host_for_change().reserve(count); }
  void push_back(const T& value) {
    host_for_change().push_back(value);
    ++size_;
  }
  template <class Iterator, class = std::enable_if_t<!std::is_integral_v<Iterator>>>
  void insert(const_iterator at, Iterator first, Iterator last) {
    Host& host = host_for_change();
    host.insert(host.begin() + (at - host.data()), first, last);
    size_ = host.size();
  }
  void insert(const_iterator at, std::size_t count, const T& value) {
    Host& host = host_for_change();
    host.insert(host.begin() + (at - host.data()), count, value);
    size_ = host.size();
  }
  void pop_back() { resize(size_ - 1); }
  void clear() { resize(0); }
  // New values are zero. On a GPU, where the values are there, they stay there.
  void resize(std::size_t count) {
    if (count == size_) return;
    if (on_gpu() && size_ == 0) {
      host_ = Host();
      sides_ = 0;
    } else if (on_gpu() && has(kDevice) && device_.is_current()) {
      grow_on_device(count);
      written_on_device();
    } else if (sides_ != 0) {
      host_for_change().resize(count);
    }
    size_ = count;
  }
  void resize(std::size_t count, const T& value) {
    if (count == size_) return;
    host_for_change().resize(count, value);
    size_ = count;
  }
  void assign(std::size_t count, const T& value) {
    host_.assign(count, value);
    size_ = count;
    sides_ = kHost;
  }
  template <class Iterator, class = std::enable_if_t<!std::is_integral_v<Iterator>>>
  void assign(Iterator first, Iterator last) {
    *this = Array(first, last);
  }
  // Sets all values, on the device in use.
  void fill(const T& value) {
    if constexpr (std::is_same_v<T, float>) {
      if (on_gpu() && size_ > 0) {
        device_.fit(bytes(), 0);
        device_.fill(size_, value);
        written_on_device();
        return;
      }
    }
    std::fill(begin(), end(), value);
  }
  friend bool operator==(const Array& a, const Array& b) {
    return a.size_ == b.size_ && std::equal(a.begin(), a.end(), b.begin());
  }

  // Where ops run; null when empty. The host's side on the CPU.
  OnDevice<T> on_device() { return OnDevice<T>(*this); }
  ConstOnDevice<T> on_device() const { return ConstOnDevice<T>(*this); }
  const T* device_for_reading() const {
    if (!on_gpu()) return size_ == 0 ? nullptr : data();
    return to_device();
  }
  T* device_for_writing() {
    if (!on_gpu()) return size_ == 0 ? nullptr : data();
    T* device = to_device();
    written_on_device();
    return device;
  }
  // The same where every value will be written: what was there is not brought there.
  T* device_for_overwriting() {
    if (!on_gpu()) return size_ == 0 ? nullptr : data();
    if (size_ == 0) return nullptr;
    device_.fit(bytes(), 0);
    written_on_device();
    return static_cast<T*>(device_.data());
  }
  // On a GPU: the same number as before only if nobody has asked for the values for writing since,
  // on either side, and no other array has ever had it. So ops know what they need not do again. On
  // the CPU, where it would cost each access, and of nothing: 0. Brings the values to the device.
  std::uint64_t device_revision() const {
    if (!on_gpu() || size_ == 0) return 0;
    to_device();
    return revision_;
  }
  // On a GPU: the host would have to ask for its side.
  bool is_on_device_alone() const { return on_gpu() && size_ > 0 && !has(kHost); }
  // Gives the device's side back where the host has the values, too.
  void leave_device() const {
    if (has(kHost) && has(kDevice)) {
      device_.release();
      sides_ = kHost;
    }
  }

 private:
  static constexpr int kHost = 1, kDevice = 2;  // sides that are up to date; neither: zeros

  static bool is_zero(const T& value) {
    if constexpr (std::is_arithmetic_v<T>)
      return value == T{};
    else
      return false;
  }
  bool has(int side) const { return (sides_.load(std::memory_order_acquire) & side) != 0; }
  std::size_t bytes() const { return size_ * sizeof(T); }

  void to_host() const {
    if (!has(kHost)) [[unlikely]]
      bring_to_host();
  }
  void to_host_alone() {
    if (sides_.load(std::memory_order_acquire) == kHost) [[likely]]
      return;
    to_host();
    sides_ = kHost;
  }
  Host& host_for_change() {
    to_host_alone();
    return host_;
  }
  void bring_to_host() const {
    const std::lock_guard lock(detail::array_mutex);
    if (has(kHost)) return;
    if (has(kDevice)) {
      host_.resize(size_);
      if (size_ > 0) device_.download(host_.data(), bytes());
    } else {
      host_.assign(size_, T{});
    }
    sides_ |= kHost;
  }
  T* to_device() const {
    if (size_ == 0) return nullptr;
    if (!has(kDevice) || !device_.is_current()) bring_to_device();
    return static_cast<T*>(device_.data());
  }
  void bring_to_device() const {
    if (has(kDevice)) to_host();  // of another device
    device_.fit(bytes(), 0);
    if (has(kHost))
      device_.upload(host_.data(), bytes());
    else
      device_.clear(0, bytes());
    sides_ |= kDevice;
    revision_ = ++detail::last_revision;
  }
  // Will be, before the next look. What the host writes makes the device's side invalid, so that
  // the next look brings it there: another revision, too.
  void written_on_device() {
    sides_ = kDevice;
    revision_ = ++detail::last_revision;
  }
  void grow_on_device(std::size_t count) {
    if (count <= size_) return;
    device_.fit(count * sizeof(T), bytes());
    device_.clear(bytes(), (count - size_) * sizeof(T));
  }
  void copy(const Array& other) {
    size_ = other.size_;
    if (other.has(kDevice) && other.device_.is_current()) {
      device_.fit(bytes(), 0);
      device_.copy(other.device_, bytes());
      written_on_device();
    } else {
      if (other.sides_ != 0) other.to_host();
      host_ = other.host_;
      sides_ = other.sides_ & kHost;
    }
  }
  void swap(Array& other) noexcept {
    std::swap(host_, other.host_);
    std::swap(device_, other.device_);
    std::swap(size_, other.size_);
    std::swap(revision_, other.revision_);
    sides_ = other.sides_.exchange(sides_);
  }

  mutable Host host_;
  mutable DeviceBlock device_;
  std::size_t size_ = 0;
  mutable std::uint64_t revision_ = 0;  // of the device's side
  mutable std::atomic<int> sides_{kHost};
};

using FloatArray = Array<float>;

namespace detail {
[[noreturn]] void throw_not_on_device();
}

// The values of an array that lives longer, or, for ops on the CPU, of any vector.
template <class T>
class Borrowed {
 public:
  Borrowed() = default;
  Borrowed(const Array<T>& array)
      : array_(&array), host_(on_gpu() ? nullptr : array.data()), size_(array.size()) {}
  Borrowed(std::span<const T> values) : host_(values.data()), size_(values.size()) {}
  Borrowed(const std::vector<T>& values) : Borrowed(std::span<const T>(values)) {}

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  // Where ops run on the CPU; an array's are not known there while a GPU is in use.
  const T* data() const { return host_; }
  const T& operator[](std::size_t i) const { return host_[i]; }
  operator std::span<const T>() const { return {host_, size_}; }
  // Errors (kUsage): a vector on a GPU.
  const T* on_device() const {
    if (array_ != nullptr) return array_->device_for_reading();
    if (on_gpu() && size_ > 0) detail::throw_not_on_device();
    return host_;
  }
  std::uint64_t device_revision() const {
    return array_ == nullptr ? 0 : array_->device_revision();
  }

 private:
  const Array<T>* array_ = nullptr;
  const T* host_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace glint
