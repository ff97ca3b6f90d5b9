#pragma once

#include <cstddef>
#include <string>

namespace touchline::hal {

/// The text behind reason(): reserved once, so that an error that comes with every frame costs no allocation.
/// What does not fit is cut off.
class Reason {
 public:
  // A device's whole list of formats and sizes fits in most cases; anything else is a line.
  static constexpr std::size_t kCapacity = 2048;

  Reason() { text_.reserve(kCapacity); }
  ~Reason() = default;
  Reason(const Reason&) = delete;
  Reason& operator=(const Reason&) = delete;

  void clear() { text_.clear(); }
  /// As printf.
  void set(const char* format, ...) __attribute__((format(printf, 2, 3)));
  void append(const char* format, ...) __attribute__((format(printf, 2, 3)));
  void assign(const Reason& other) { text_.assign(other.text_); }
  /// Back to a size() of before.
  void truncate(std::size_t size) { text_.resize(size < text_.size() ? size : text_.size()); }

  /// What stands before a further item: "; ", nothing before the first.
  [[nodiscard]] const char* separator() const { return text_.empty() ? "" : "; "; }
  [[nodiscard]] bool empty() const { return text_.empty(); }
  [[nodiscard]] std::size_t size() const { return text_.size(); }
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const char* c_str() const { return text_.c_str(); }

 private:
  std::string text_;
};

}  // namespace touchline::hal
