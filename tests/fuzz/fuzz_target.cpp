// libFuzzer's entry: decodes the bytes with the decoder number TOUCHLINE_DECODER of decoder_checks().
#include <cstdint>

#include "tests/fuzz/decoder_checks.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  touchline::fuzz::decoder_checks()[TOUCHLINE_DECODER].check(std::as_bytes(std::span(data, size)));
  return 0;
}
