// SPDX-License-Identifier: MIT
#include "reports/run/parcels/tar_file.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <utility>

#include "glint/core/error.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

constexpr std::size_t kBlock = 512;
constexpr std::uintmax_t kMostNameBytes = 1 << 16;  // of long names and pax records

using Block = std::array<char, kBlock>;

// A field up to its first zero byte.
std::string text_at(const Block& block, std::size_t at, std::size_t size) {
  const std::string field(block.data() + at, size);
  return field.substr(0, field.find('\0'));
}

// Octal digits; nothing: something else.
std::optional<std::uintmax_t> octal(const std::string& field) {
  std::uintmax_t number = 0;
  std::size_t digits = 0;
  for (const char c : field) {
    if (c == ' ' && digits == 0) continue;
    if (c == ' ') break;
    if (c < '0' || c > '7' || ++digits > 20) return std::nullopt;
    number = 8 * number + static_cast<std::uintmax_t>(c - '0');
  }
  return digits > 0 ? std::optional(number) : std::nullopt;
}

// The sum of its bytes, those of the sum itself as spaces.
bool has_its_sum(const Block& block) {
  constexpr std::size_t kAt = 148, kSize = 8;
  std::uintmax_t sum = 0;
  for (std::size_t i = 0; i < kBlock; ++i)
    sum += i >= kAt && i < kAt + kSize ? ' ' : static_cast<unsigned char>(block[i]);
  return octal(text_at(block, kAt, kSize)) == sum;
}

bool is_empty(const Block& block) {
  return std::all_of(block.begin(), block.end(), [](char c) { return c == 0; });
}

struct TarHeader {
  TarMember member;
  char type = '0';
};

std::optional<TarHeader> header_of(const Block& block) {
  if (!has_its_sum(block)) return std::nullopt;
  const auto bytes = octal(text_at(block, 124, 12));
  if (!bytes) return std::nullopt;
  const std::string prefix = text_at(block, 257, 5) == "ustar" ? text_at(block, 345, 155) : "";
  const std::string name = text_at(block, 0, 100);
  return TarHeader{{prefix.empty() ? name : prefix + "/" + name, *bytes}, block[156]};
}

// "path" of pax records, "27 path=some/long/name\n" each; empty: none.
std::string path_of_pax(const std::string& records) {
  const std::size_t at = records.find(" path=");
  if (at == std::string::npos) return {};
  const std::size_t begin = at + 6, end = records.find('\n', begin);
  return records.substr(begin, end == std::string::npos ? end : end - begin);
}

class TarReader {
 public:
  explicit TarReader(const fs::path& path) : in_(open_file(path)), size_(fs::file_size(path)) {}

  std::string read(
      const std::function<bool(const TarMember&)>& wanted,
      const std::function<void(const TarMember&, std::string&&)>& take
  ) {
    std::string long_name;
    for (Block block; next(block);) {
      if (is_empty(block)) return {};  // the end, as it should be
      auto header = header_of(block);
      if (!header) return fmt::format("no tar header at byte {}", at_ - kBlock);
      if (!long_name.empty()) header->member.name = std::exchange(long_name, "");
      const TarMember& member = header->member;
      const bool file = header->type == '0' || header->type == '\0';
      const bool names = header->type == 'L' || header->type == 'x';
      if (member.bytes > size_ - at_)
        return fmt::format("cut off in {}: {} of {} bytes", member.name, size_ - at_, member.bytes);
      if (names && member.bytes <= kMostNameBytes) {
        const std::string text = content(member.bytes);
        long_name = header->type == 'L' ? text.substr(0, text.find('\0')) : path_of_pax(text);
      } else if (file && wanted(member)) {
        take(member, content(member.bytes));
      } else {
        skip(member.bytes);
      }
    }
    return "cut off behind its last file";
  }

 private:
  bool next(Block& block) {
    if (size_ - at_ < kBlock) return false;
    in_.read(block.data(), kBlock);
    at_ += kBlock;
    return in_.good();
  }
  // With what fills up its last block.
  std::string content(std::uintmax_t bytes) {
    std::string text(bytes, '\0');
    in_.read(text.data(), static_cast<std::streamsize>(bytes));
    at_ += bytes;
    fill(bytes);
    return text;
  }
  void skip(std::uintmax_t bytes) {
    at_ += bytes;
    fill(bytes);
  }
  void fill(std::uintmax_t bytes) {
    at_ = std::min(at_ + (kBlock - bytes % kBlock) % kBlock, size_);
    in_.seekg(static_cast<std::streamoff>(at_));
  }

  std::ifstream in_;
  std::uintmax_t size_, at_ = 0;
};

}  // namespace

bool is_tar_file(const fs::path& path) {
  std::ifstream in = open_file(path);
  Block block{};
  in.read(block.data(), kBlock);
  return in.good() && !is_empty(block) && header_of(block).has_value();
}

std::string read_tar(
    const fs::path& path,
    const std::function<bool(const TarMember&)>& wanted,
    const std::function<void(const TarMember&, std::string&& content)>& take
) {
  check_exists(path);
  return read_within_memory(path, [&] { return TarReader(path).read(wanted, take); });
}

}  // namespace glint
