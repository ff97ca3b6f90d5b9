// Writes a datagram of each output to FOLDER, for readers in other languages.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "firmware/network/firasim.h"
#include "firmware/network/json_line.h"
#include "firmware/network/ssl_tracked.h"
#include "firmware/network/ssl_vision.h"
#include "tests/network/example_frame.h"

int main(int argc, char** argv) {
  using namespace touchline::network;
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 64;
  }
  const touchline::Snapshot snapshot = example_snapshot();
  const OutputFrame frame = example_output(snapshot);
  SslVisionEncoder ssl_vision;
  if (!ssl_vision.configure(example_geometry()).ok()) return 1;
  const auto write = [&](const char* name, const std::string& bytes) {
    std::ofstream(std::filesystem::path(argv[1]) / name, std::ios::binary) << bytes;
  };
  write("ssl_detection", datagram([&](auto out) { return ssl_vision.encode_detection(frame, out); }));
  write("ssl_geometry", datagram([&](auto out) { return ssl_vision.encode_geometry(frame.camera_id, out); }));
  write("ssl_tracked",
        datagram([&](auto out) { return encode_ssl_tracked(frame, "01234567-89ab-4cde-8f01-23456789abcd", out); }));
  write("firasim",
        datagram([&](auto out) { return encode_firasim_environment(frame, example_geometry().field, out); }));
  write("json", datagram([&](auto out) {
          return write_json_line(frame, kExampleNames, example_geometry().field, "/dev/video0", out);
        }));
  return 0;
}
