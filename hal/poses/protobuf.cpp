#include "hal/poses/protobuf.h"

#include <pb_decode.h>
#include <pb_encode.h>

namespace touchline::hal {

std::size_t encode_message(const pb_msgdesc_t* fields, const void* message, std::span<std::byte> out) {
  pb_ostream_t stream = pb_ostream_from_buffer(reinterpret_cast<pb_byte_t*>(out.data()), out.size());
  return pb_encode(&stream, fields, message) ? stream.bytes_written : 0;
}

Result<void> decode_message(const pb_msgdesc_t* fields, std::span<const std::byte> bytes, void* message) {
  pb_istream_t stream = pb_istream_from_buffer(reinterpret_cast<const pb_byte_t*>(bytes.data()), bytes.size());
  if (pb_decode(&stream, fields, message)) return {};
  return failure(ErrorCode::kCorruptFrame, "not a valid message: %s", PB_GET_ERROR(&stream));
}

}  // namespace touchline::hal
