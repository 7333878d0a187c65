// SPDX-License-Identifier: MIT
#include "datasets/camera_yaml.h"

#include <algorithm>
#include <charconv>
#include <limits>

#include "glint/core/error.h"

namespace glint {
namespace {

using nlohmann::json;

constexpr int kDeepest = 50;  // files of cameras have three

// Numbers where a number stands, text else.
json scalar_of(std::string_view text) {
  const std::string_view digits = text.substr(text.starts_with('+') ? 1 : 0);
  const std::string_view unsigned_text = digits.substr(digits.starts_with('-') ? 1 : 0);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (unsigned_text == ".Inf" || unsigned_text == ".inf")
    return digits.starts_with('-') ? -kInfinity : kInfinity;
  if (text == ".Nan" || text == ".NaN" || text == ".nan")
    return std::numeric_limits<double>::quiet_NaN();
  const bool may_be_number =
      !unsigned_text.empty() &&
      (unsigned_text[0] == '.' || (unsigned_text[0] >= '0' && unsigned_text[0] <= '9'));
  double value = 0;
  const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (may_be_number && end.ec == std::errc{} && end.ptr == digits.data() + digits.size())
    return value;
  return std::string(text);
}

class Parser {
 public:
  Parser(std::string_view text, const std::string& path) : text_(text), path_(path) {}

  json document() {
    refuse_zero_bytes();
    skip_head();
    skip_blanks();
    if (ended()) return nullptr;
    json value = block(0);
    skip_blanks();
    if (!ended()) fail("a line that stands further left or right than its neighbours");
    return value;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    const std::string_view before = text_.substr(0, at_);
    throw Error(
        ExitCode::kBadReference,
        fmt::format(
            "{}: line {}: {}; it is cut off, damaged or no YAML as OpenCV writes it, write it "
            "again",
            path_,
            1 + std::count(before.begin(), before.end(), '\n'),
            why
        )
    );
  }

  // Errors end at them: what() is a C string, and the file's name may stand behind.
  void refuse_zero_bytes() {
    const std::size_t zero = text_.find('\0');
    if (zero == std::string_view::npos) return;
    at_ = zero;
    fail("a zero byte");
  }

  std::string_view rest() const { return text_.substr(at_); }
  bool ended() const { return at_ >= text_.size() || (column() == 0 && rest().starts_with("...")); }
  char peek() const { return at_ < text_.size() ? text_[at_] : '\n'; }
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }
  bool is_space_at(std::size_t at) const {
    return at >= text_.size() || is_space(text_[at]) || text_[at] == '\n';
  }
  std::size_t column() const { return at_ - line_begin_; }
  bool at_dash() const { return peek() == '-' && is_space_at(at_ + 1); }

  void next_line() {
    at_ = std::min(text_.find('\n', at_), text_.size() - 1) + 1;
    line_begin_ = at_;
  }
  void skip_spaces() {
    while (at_ < text_.size() && is_space(text_[at_])) ++at_;
  }
  // Spaces, comments and ends of lines.
  void skip_blanks() {
    for (skip_spaces(); at_ < text_.size() && (peek() == '\n' || peek() == '#'); skip_spaces())
      next_line();
  }
  // "%YAML:1.0", "---".
  void skip_head() {
    while (rest().starts_with('%') || rest().starts_with('#')) next_line();
    if (rest().starts_with("---")) next_line();
  }

  void check_depth(int depth) const {
    if (depth > kDeepest) fail(fmt::format("nested more than {} deep", kDeepest));
  }

  // What begins here and goes on in this column.
  json block(int depth) {
    check_depth(depth);
    if (peek() == '[' || peek() == '{') return flow(depth, "\n");
    return at_dash() ? list(depth) : fields(depth);
  }

  json list(int depth) {
    const std::size_t left = column();
    json items = json::array();
    while (!ended() && column() == left && at_dash()) {
      ++at_;
      items.push_back(value(left, false, depth));
      skip_blanks();
    }
    return items;
  }

  json fields(int depth) {
    const std::size_t left = column();
    json object = json::object();
    while (!ended() && column() == left && !at_dash()) {
      std::string name = key();
      object.emplace(std::move(name), value(left, true, depth));
      skip_blanks();
    }
    return object;
  }

  std::string key() {
    std::string name;
    if (peek() == '"' || peek() == '\'') {
      name = quoted();
    } else {
      const std::size_t end = std::min(text_.find_first_of(":\n,[]{}", at_), text_.size());
      name = trimmed(text_.substr(at_, end - at_));
      at_ = end;
    }
    if (name.empty() || peek() != ':') fail("expected a name and a colon");
    ++at_;
    return name;
  }

  static std::string trimmed(std::string_view text) {
    while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
    return std::string(text);
  }

  // Behind a colon or dash of a block that begins in column `left`.
  json value(std::size_t left, bool of_field, int depth) {
    skip_tag();
    if (peek() != '\n' && peek() != '#') {
      json inline_value = flow(depth + 1, "\n");
      skip_spaces();
      if (peek() != '\n' && peek() != '#') fail("something behind a value");
      return inline_value;
    }
    skip_blanks();
    const bool inside = column() > left || (of_field && column() == left && at_dash());
    return !ended() && inside ? block(depth + 1) : json();
  }

  void skip_tag() {
    skip_spaces();
    if (peek() == '!')
      while (!is_space_at(at_)) ++at_;
    skip_spaces();
  }

  // A value in a line or in brackets; one without brackets and quotes ends at one of `stops`.
  json flow(int depth, std::string_view stops) {
    check_depth(depth);
    skip_tag();
    if (peek() == '[') return flow_list(depth);
    if (peek() == '{') return flow_fields(depth);
    if (peek() == '"' || peek() == '\'') return quoted();
    std::size_t end = std::min(text_.find_first_of(stops, at_), text_.size());
    std::string_view plain = text_.substr(at_, end - at_);
    plain = plain.substr(0, plain.find(" #"));
    const std::string word = trimmed(plain);
    if (word.empty() || word.find(": ") != std::string::npos || word.ends_with(':'))
      fail("expected a value");
    at_ += plain.size();
    return scalar_of(word);
  }

  json flow_list(int depth) {
    json items = json::array();
    for (++at_, skip_blanks(); peek() != ']'; skip_blanks()) {
      items.push_back(flow(depth + 1, ",]}\n"));
      skip_separator(']');
    }
    ++at_;
    return items;
  }

  json flow_fields(int depth) {
    json object = json::object();
    for (++at_, skip_blanks(); peek() != '}'; skip_blanks()) {
      std::string name = key();
      skip_blanks();
      object.emplace(std::move(name), flow(depth + 1, ",]}\n"));
      skip_separator('}');
    }
    ++at_;
    return object;
  }

  void skip_separator(char closing) {
    skip_blanks();
    if (at_ < text_.size() && peek() == ',')
      ++at_;
    else if (at_ >= text_.size() || peek() != closing)
      fail(fmt::format("expected a comma or {}", closing));
  }

  std::string quoted() {
    const char quote = text_[at_++];
    std::string value;
    for (; peek() != quote; ++at_) {
      if (peek() == '\n') fail("a quote that does not end in its line");
      value += quote == '"' && peek() == '\\' ? escaped() : peek();
    }
    ++at_;
    return value;
  }

  // The last character of it stays ahead.
  char escaped() {
    ++at_;
    if (peek() == 'n') return '\n';
    if (peek() == 't') return '\t';
    if (peek() == '\n') fail("a quote that does not end in its line");
    return peek();
  }

  std::string_view text_;
  const std::string& path_;
  std::size_t at_ = 0, line_begin_ = 0;
};

}  // namespace

nlohmann::json parse_camera_yaml(std::string_view text, const std::string& path) {
  return Parser(text, path).document();
}

}  // namespace glint
