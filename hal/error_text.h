#pragma once

#include <array>
#include <cstdarg>
#include <cstddef>
#include <iosfwd>
#include <memory>
#include <string>
#include <string_view>

namespace touchline {

/// A message for the user. Up to kInlineCapacity bytes are stored in the object itself, so the real-time loop can make,
/// copy and pass on an error without allocating. Longer messages (a camera's list of formats, a list of configuration
/// errors) use the heap; if there is no memory left, the message is cut off. Never throws.
class ErrorText {
 public:
  // Number of bytes stored in the object. A message of the loop is one line: a sentence with a device's path below
  // /dev/v4l/by-path (about 90 bytes), which may occur twice.
  static constexpr std::size_t kInlineCapacity = 383;

  ErrorText() noexcept { inline_[0] = '\0'; }
  ErrorText(std::string_view text) noexcept : ErrorText() { append(text); }  // NOLINT(google-explicit-constructor)
  ErrorText(const char* text) noexcept                                       // NOLINT(google-explicit-constructor)
      : ErrorText(std::string_view(text)) {}
  ErrorText(const std::string& text) noexcept  // NOLINT(google-explicit-constructor)
      : ErrorText(std::string_view(text)) {}
  ErrorText(const ErrorText& other) noexcept : ErrorText(other.view()) {}
  ErrorText(ErrorText&& other) noexcept;
  ErrorText& operator=(const ErrorText& other) noexcept;
  ErrorText& operator=(ErrorText&& other) noexcept;
  ~ErrorText() = default;

  void clear() noexcept { truncate(0); }
  /// Replaces the text; the arguments are as for printf.
  void set(const char* format, ...) noexcept __attribute__((format(printf, 2, 3)));
  /// Appends to the text; the arguments are as for printf.
  void append_format(const char* format, ...) noexcept __attribute__((format(printf, 2, 3)));
  void append_format_list(const char* format, std::va_list arguments) noexcept __attribute__((format(printf, 2, 0)));
  void append(std::string_view text) noexcept;
  /// Inserts `text` at the beginning.
  void prepend(std::string_view text) noexcept;
  /// Cuts the text off after `size` bytes.
  void truncate(std::size_t size) noexcept;

  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] const char* c_str() const noexcept { return heap_ != nullptr ? heap_.get() : inline_.data(); }
  [[nodiscard]] std::string_view view() const noexcept { return {c_str(), size_}; }
  /// Returns a copy on the heap.
  [[nodiscard]] std::string str() const { return std::string(view()); }
  /// Returns the separator for the next element of a list: "; " if there is text already, else "".
  [[nodiscard]] const char* separator() const noexcept { return empty() ? "" : "; "; }

  friend bool operator==(const ErrorText& a, const ErrorText& b) noexcept { return a.view() == b.view(); }
  friend bool operator==(const ErrorText& a, std::string_view b) noexcept { return a.view() == b; }
  friend bool operator==(const ErrorText& a, const std::string& b) noexcept { return a.view() == b; }
  friend bool operator==(const ErrorText& a, const char* b) noexcept { return a.view() == b; }
  friend std::ostream& operator<<(std::ostream& stream, const ErrorText& text);

 private:
  [[nodiscard]] char* data() noexcept { return heap_ != nullptr ? heap_.get() : inline_.data(); }
  /// Makes room for `size` bytes; returns false if there is no memory.
  bool reserve(std::size_t size) noexcept;

  std::size_t size_ = 0, capacity_ = kInlineCapacity;  // number of bytes without the terminating zero
  std::unique_ptr<char[]> heap_;                       // used instead of the inline bytes if not null
  std::array<char, kInlineCapacity + 1> inline_;
};

}  // namespace touchline
