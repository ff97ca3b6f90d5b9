// Writes the seeds of all decoders: FOLDER/DECODER/0, 1, ...
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/fuzz/decoder_checks.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 64;
  }
  for (const touchline::fuzz::DecoderCheck& decoder : touchline::fuzz::decoder_checks()) {
    const std::filesystem::path folder = std::filesystem::path(argv[1]) / decoder.name;
    std::filesystem::create_directories(folder);
    int number = 0;
    for (const std::string& seed : decoder.seeds()) {
      std::ofstream(folder / std::to_string(number++), std::ios::binary) << seed;
    }
  }
  return 0;
}
