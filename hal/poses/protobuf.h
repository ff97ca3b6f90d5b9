#pragma once

#include <pb.h>

#include <cstddef>
#include <span>

#include "hal/result.h"

// Protocol buffers in fixed memory: structures and tables that nanopb generates from proto/.
namespace touchline::hal {

/// Encodes the structure `message`, which `fields` describes. Returns the number of bytes; 0: `out` is too small.
std::size_t encode_message(const pb_msgdesc_t* fields, const void* message, std::span<std::byte> out);

/// Decodes into the structure `message`, which gets default values for absent fields. Unknown fields are skipped.
/// kCorruptFrame: the bytes cannot be decoded as this type of message, a required field is absent, or a list or text is
/// too long.
Result<void> decode_message(const pb_msgdesc_t* fields, std::span<const std::byte> bytes, void* message);

}  // namespace touchline::hal
