#include <charconv>
#include <optional>

#include "hal/replay/picture_decoder.h"

// Portable pixmaps and graymaps, binary or as text (https://netpbm.sourceforge.net/doc/pnm.html).
namespace touchline::hal {
namespace {

constexpr std::string_view kWhitespace = " \t\n\v\f\r";

/// Reads the text of a file: numbers, between them spaces and comments up to the line's end.
class PnmText {
 public:
  explicit PnmText(std::string_view rest) : rest_(rest) {}
  /// Nothing: no number, or one beyond 32 bits.
  std::optional<std::uint32_t> number() {
    skip_space();
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (error != std::errc{}) return std::nullopt;
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return value;
  }
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  void skip_space() {
    for (;;) {
      rest_.remove_prefix(std::min(rest_.find_first_not_of(kWhitespace), rest_.size()));
      if (!rest_.starts_with('#')) return;
      rest_.remove_prefix(std::min(rest_.find('\n'), rest_.size()));
    }
  }

  std::string_view rest_;
};

/// The next sample of the binary formats, with 16 bits in big-endian order.
std::uint32_t take_binary(std::string_view& rest, bool is_wide) {
  std::uint32_t value = static_cast<unsigned char>(rest[0]);
  if (is_wide) value = value << 8u | static_cast<unsigned char>(rest[1]);
  rest.remove_prefix(is_wide ? 2 : 1);
  return value;
}

}  // namespace

Result<Picture> decode_pnm(std::string_view bytes, std::int64_t max_pixels) {
  const bool is_gray = bytes[1] == '2' || bytes[1] == '5', is_text = bytes[1] == '2' || bytes[1] == '3';
  PnmText text(bytes.substr(2));
  const std::optional<std::uint32_t> width = text.number(), height = text.number(), max_value = text.number();
  if (!width || !height || !max_value) return damaged("no size");
  if (*width == 0 || *height == 0 || *max_value == 0 || *max_value > 65535) return damaged("wrong size or depth");
  // Neither factor is larger than 32 bits, so their product fits.
  if (std::uint64_t{*width} * *height > static_cast<std::uint64_t>(max_pixels)) return too_many_pixels(max_pixels);
  const bool is_wide = *max_value > 255;
  const std::size_t pixels = std::size_t{*width} * *height, samples = pixels * (is_gray ? 1 : 3);
  std::string_view binary = text.rest();
  binary.remove_prefix(std::min<std::size_t>(binary.size(), 1));  // one space after the header
  // Samples as text take at least two characters, but the last one.
  const std::size_t least_bytes = is_text ? 2 * samples - 1 : samples * (is_wide ? 2 : 1);
  if (binary.size() < least_bytes) return damaged("pixels are missing");
  Picture out{*width, *height, {}, {}};
  if (is_wide) {
    out.rgb16.reserve(3 * pixels);
  } else {
    out.rgb8.reserve(3 * pixels);
  }
  const std::uint32_t white = is_wide ? 65535 : 255;
  for (std::size_t i = 0; i < samples; ++i) {
    const std::optional<std::uint32_t> stored = is_text ? text.number() : take_binary(binary, is_wide);
    if (!stored || *stored > *max_value) return damaged(stored ? "a value is too large" : "pixels are missing");
    const std::uint32_t value = (*stored * white + *max_value / 2) / *max_value;
    for (int copy = 0; copy < (is_gray ? 3 : 1); ++copy) {
      if (is_wide) {
        out.rgb16.push_back(static_cast<std::uint16_t>(value));
      } else {
        out.rgb8.push_back(static_cast<std::uint8_t>(value));
      }
    }
  }
  return out;
}

}  // namespace touchline::hal
