#pragma once

#include <cstdint>
#include <string>

namespace touchline::console {

/// Returns a text for the person at the terminal that says how other computers log in: a link for each of this
/// computer's addresses (only for `address` if it is not 0.0.0.0), a QR code of the first link for a phone, and who
/// else can read the traffic. The text contains the token, so do not write it to files that others can read.
std::string login_text(const std::string& address, std::uint16_t port, const std::string& token);

/// Returns a QR code (ISO/IEC 18004) drawn with half blocks, dark on light, for a terminal with UTF-8; "" if the text
/// is too long.
std::string qr_code(const std::string& text);

}  // namespace touchline::console
