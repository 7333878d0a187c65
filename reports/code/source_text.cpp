// SPDX-License-Identifier: MIT
#include "reports/code/source_text.h"

#include <fmt/format.h>
#include <algorithm>
#include <cctype>

namespace glint {
namespace {

bool in_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }
bool is_blank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }
// "a + +b" is not "a ++b".
bool in_operator(char c) {
  return std::string_view("+-*/%&|^<>=!:.").find(c) != std::string_view::npos;
}

class Stripper {
 public:
  explicit Stripper(std::string_view text) : text_(text) {}

  std::string strip() {
    while (at_ < text_.size())
      if (!skip_blank() && !skip_comment()) take_token();
    return std::move(code_);
  }

 private:
  char peek(std::size_t ahead = 0) const {
    return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0';
  }
  bool opens(std::string_view what) const { return text_.substr(at_, what.size()) == what; }
  // One past `closing`, or the end.
  std::size_t after(std::string_view closing, std::size_t from) const {
    const std::size_t found = text_.find(closing, from);
    return found == std::string_view::npos ? text_.size() : found + closing.size();
  }

  bool skip_blank() {
    if (opens("\\\n")) return at_ += 2, blank_ = true;
    if (!is_blank(peek())) return false;
    if (peek() == '\n') {
      line_end_ = line_end_ || directive_;
      directive_ = false;
      line_start_ = true;
    }
    ++at_;
    return blank_ = true;
  }

  bool skip_comment() {
    if (opens("/*"))
      at_ = after("*/", at_ + 2);
    else if (opens("//"))
      at_ = std::min(text_.find('\n', at_), text_.size());
    else
      return false;
    return blank_ = true;
  }

  void take_token() {
    if (line_start_ && peek() == '#') directive_ = line_end_ = true;
    line_start_ = false;
    take_to(end_of_token());
  }

  std::size_t end_of_token() const {
    if (is_digit(peek()) || (peek() == '.' && is_digit(peek(1)))) return end_of_number();
    std::size_t end = at_;
    while (end < text_.size() && in_name(text_[end])) ++end;
    const char next = end < text_.size() ? text_[end] : '\0';
    if (next == '"' && end > at_ && text_[end - 1] == 'R') return end_of_raw_string(end);
    if (next == '"' || next == '\'') return end_of_literal(end);
    return std::max(end, at_ + 1);
  }

  std::size_t end_of_number() const {
    std::size_t end = at_;
    const auto separator = [&] {  // 1'000
      return text_[end] == '\'' && end + 1 < text_.size() && in_name(text_[end + 1]);
    };
    while (end < text_.size() && (in_name(text_[end]) || text_[end] == '.' || separator())) ++end;
    return end;
  }

  std::size_t end_of_raw_string(std::size_t quote) const {
    const std::size_t open = std::min(text_.find('(', quote), text_.size());
    const std::string closing = fmt::format("){}\"", text_.substr(quote + 1, open - quote - 1));
    return after(closing, open);
  }

  std::size_t end_of_literal(std::size_t quote) const {
    std::size_t end = quote + 1;
    while (end < text_.size() && text_[end] != text_[quote]) end += text_[end] == '\\' ? 2 : 1;
    return std::min(end + 1, text_.size());
  }

  void take_to(std::size_t end) {
    if (!code_.empty() && line_end_)
      code_ += '\n';
    else if (!code_.empty() && blank_ && separates(code_.back(), peek()))
      code_ += ' ';
    blank_ = line_end_ = false;
    code_ += text_.substr(at_, end - at_);
    at_ = end;
  }

  bool separates(char before, char behind) const {
    return directive_ || (in_name(before) && in_name(behind)) ||
           (in_operator(before) && in_operator(behind));
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::string code_;
  bool blank_ = false, line_end_ = false;  // in front of the next token
  bool directive_ = false, line_start_ = true;
};

}  // namespace

std::string code_of(std::string_view text) { return Stripper(text).strip(); }

std::vector<std::string> quoted_includes(std::string_view code) {
  std::vector<std::string> includes;
  constexpr std::string_view kOpening = "#include \"";
  for (std::size_t at = 0; (at = code.find(kOpening, at)) != std::string_view::npos;) {
    const bool opens_line = at == 0 || code[at - 1] == '\n';
    at += kOpening.size();
    if (opens_line) includes.emplace_back(code.substr(at, code.find('"', at) - at));
  }
  return includes;
}

}  // namespace glint
