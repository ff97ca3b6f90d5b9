#pragma once

#include <cstdint>
#include <string>

namespace touchline::console {

/// Where other computers log in, for the person at the terminal: a link for each of this computer's addresses (or for
/// `address` alone if it is not 0.0.0.0), a QR code of the first one for a phone, and who else can read what is sent.
/// The text contains the token, so do not write it to files that others can read.
std::string login_text(const std::string& address, std::uint16_t port, const std::string& token);

/// A QR code (ISO/IEC 18004) drawn with half blocks, dark on light, for a terminal with UTF-8; "" if the text is too
/// long.
std::string qr_code(const std::string& text);

}  // namespace touchline::console
