// Writes a recording and copies of it that are cut off at random bytes into a folder, with what each contains in a JSON
// file beside it, for read_recordings.js: write_recordings FOLDER
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <random>
#include <span>

#include "firmware/report/base64.h"
#include "tests/recording/example_recording.h"

namespace {

using touchline::testing::WrittenMessage;

void describe(const std::string& path, const std::vector<WrittenMessage>& messages, bool is_complete, int chunks) {
  nlohmann::json list = nlohmann::json::array();
  for (const WrittenMessage& message : messages) {
    list.push_back({{"topic", message.topic},
                    {"sequence", message.sequence},
                    {"time_ns", std::to_string(message.time_ns)},
                    {"data", touchline::report::base64_of(std::as_bytes(std::span(message.data)))}});
  }
  std::ofstream(path) << nlohmann::json{{"messages", list}, {"is_complete", is_complete}, {"chunks", chunks}};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 64;
  const std::filesystem::path folder = argv[1];
  constexpr int kChunks = 20, kCuts = 200;
  const std::string whole = (folder / "whole.mcap").string();
  std::vector<WrittenMessage> all;
  for (const auto& chunk : touchline::testing::write_example(whole, kChunks)) {
    all.insert(all.end(), chunk.begin(), chunk.end());
  }
  describe((folder / "whole.json").string(), all, true, kChunks);
  std::ifstream file(whole, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  std::mt19937 random(2);
  for (int i = 0; i < kCuts; ++i) {
    // At least the file's first record; the last bytes are the file's end.
    const std::size_t size = 64 + random() % (bytes.size() - 64 - 1);
    const std::string name = "cut-" + std::to_string(i);
    std::ofstream(folder / (name + ".mcap"), std::ios::binary) << bytes.substr(0, size);
    // Our reader finds the same, which McapWriter.ACutFileIsReadUpToItsLastWholeChunk compares with what was written.
    const auto read = touchline::testing::read_all((folder / (name + ".mcap")).string());
    describe((folder / (name + ".json")).string(), read.messages, false, 0);
  }
}
