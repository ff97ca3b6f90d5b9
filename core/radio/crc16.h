#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace touchline {

/// CRC-16/CCITT-FALSE (also called CRC-16/IBM-3740): polynomial 0x1021, start value 0xFFFF, no reflection, no final
/// inversion. Check value of the nine characters "123456789": 0x29B1 (catalogue of parametrised CRC algorithms,
/// reveng.sourceforge.io). Finds every error burst of at most 16 bits and every error of up to three bits in a packet
/// of any length that we send.
std::uint16_t crc16_ccitt_false(std::span<const std::byte> bytes);

}  // namespace touchline
