#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace touchline::report {

/// Returns standard base64 with padding (RFC 4648, section 4).
std::string base64_of(std::span<const std::byte> bytes);
/// Returns the bytes of a text in standard base64. Empty if its length is no multiple of four, or if it has other
/// characters (line breaks too), missing padding or characters after it.
std::optional<std::string> bytes_of_base64(std::string_view text);

}  // namespace touchline::report
