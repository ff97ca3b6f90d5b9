#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace touchline::report {

/// Writes JSON without spaces and line breaks into the caller's memory. Never allocates. The caller writes keys only in
/// objects, and as many ends as beginnings.
class JsonWriter {
 public:
  explicit JsonWriter(std::span<char> out) : out_(out) {}

  void begin_object() { open('{'); }
  void end_object() { close('}'); }
  void begin_array() { open('['); }
  void end_array() { close(']'); }
  void key(std::string_view name);

  void null();
  void boolean(bool value);
  void integer(std::int64_t value);
  /// Writes a decimal number that reads back as the same double, always with a point or an exponent. Writes null if it
  /// is not finite.
  void number(double value);
  /// Bytes that are not UTF-8 become U+FFFD.
  void string(std::string_view value);
  /// Ends a line.
  void line_end() { append("\n"); }

  /// Returns false if the text did not fit and is cut off.
  [[nodiscard]] bool fits() const { return fits_; }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  void open(char bracket);
  void close(char bracket);
  void separate();
  void append(std::string_view text);
  template <class... Texts>
  void append_all(const Texts&... texts) {
    (append(texts), ...);
  }
  void quote(std::string_view text);

  std::span<char> out_;
  std::size_t size_ = 0;
  bool fits_ = true;
  bool needs_comma_ = false;
};

/// Returns the multiple of `step` nearest to the value. 1 / step must be a whole number, so that the result has few
/// decimals.
double rounded(double value, double step);

}  // namespace touchline::report
