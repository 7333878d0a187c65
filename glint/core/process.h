// SPDX-License-Identifier: MIT
// What every program says and does alike when it starts and when it cannot go on.
#pragma once

#include <exception>
#include <new>
#include <optional>
#include <string>
#include <string_view>

namespace glint {

inline constexpr std::string_view kNoOutput =
    "standard output cannot be written (a full disk, or whoever read it has gone)";

// Of arrays of images, maps and surfels: says how much was asked for.
class HostMemoryFull : public std::bad_alloc {
 public:
  explicit HostMemoryFull(std::size_t bytes);
  const char* what() const noexcept override { return what_.c_str(); }

 private:
  std::string what_;
};

// What a program says of an error that means that memory has ended, or that more was asked for than
// there can be; nothing: it means something else.
std::optional<std::string> out_of_memory_message(const std::exception& error);

// A limit on the size of files (ulimit -f) ends in an error that names the file, as a full disk
// does, not in a signal without a word.
void ignore_file_size_signal();

// Standard input, output and error that a program was started without get a place where nothing can
// be written: else the next file that is opened would take their number, and what is printed.
void fill_standard_streams();

}  // namespace glint
