#include "tests/recording/example_recording.h"

#include <random>
#include <stdexcept>

namespace touchline::testing {
namespace {

void check(const Result<void>& result) {
  if (!result.ok()) throw std::runtime_error(result.text());
}

}  // namespace

std::vector<std::vector<WrittenMessage>> write_example(const std::string& path, int chunks) {
  constexpr int kMessages = 7;
  constexpr std::uint64_t kBegin = 1'800'000'000'000'000'000, kPeriod = 16'666'667;
  hal::mcap::McapWriter writer;
  check(writer.create(path, "touchline test"));
  const std::uint16_t schema = writer.add_schema("example.Text", "jsonschema", R"({"type":"object"})").value();
  const std::uint16_t channels[2] = {writer.add_channel(schema, "/first", "json").value(),
                                     writer.add_channel(schema, "/second", "json").value()};
  std::mt19937 random(1);
  std::vector<std::vector<WrittenMessage>> written;
  std::uint32_t sequence = 0;
  for (int chunk = 0; chunk < chunks; ++chunk) {
    written.emplace_back();
    for (int i = 0; i < kMessages; ++i) {
      const int which = i % 3 == 0 ? 1 : 0;
      WrittenMessage message{which == 0 ? "/first" : "/second", std::string(random() % 400, 'a'), sequence,
                             kBegin + sequence * kPeriod};
      for (char& c : message.data) c = static_cast<char>(random());
      ++sequence;
      // In two parts, as pictures are written behind what precedes them.
      const std::string_view data = message.data;
      writer.add(
          {channels[which], message.sequence, message.time_ns, {}},
          {hal::mcap::bytes_of(data.substr(0, data.size() / 2)), hal::mcap::bytes_of(data.substr(data.size() / 2))});
      written.back().push_back(std::move(message));
    }
    check(writer.flush());
  }
  check(writer.close());
  return written;
}

ReadMessages read_all(const std::string& path) {
  hal::mcap::McapReader reader;
  ReadMessages out;
  check(reader.open(path));
  for (;;) {
    const auto next = reader.next();
    if (!next.ok()) throw std::runtime_error(next.text());
    if (!next.value()) break;
    const hal::mcap::Message& message = *next.value();
    out.messages.push_back({reader.channels().at(message.channel).topic,
                            {reinterpret_cast<const char*>(message.data.data()), message.data.size()},
                            message.sequence,
                            message.time_ns});
  }
  out.is_complete = reader.is_complete();
  out.is_damaged = reader.is_damaged();
  out.rest = reader.rest();
  return out;
}

}  // namespace touchline::testing
