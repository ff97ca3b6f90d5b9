#include "tools/programs/arena/served_game.h"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>

#include "firmware/arena_loop.h"

namespace touchline::arena {
namespace {

// The fastest line of a board file.
constexpr int kFastestBaud = 4000000;

}  // namespace

Result<void> ServedGame::make(const config::Configuration& configuration, std::uint64_t seed) {
  const config::BoardFile& board = configuration.board;
  layout_ = configuration.pipeline.radio;
  if (layout_.one_each && !layout_.names_robots()) {
    return failure(ErrorCode::kUnsupported,
                   "%s: radio: the packets do not tell for which robot they are, and all of them arrive at one port",
                   configuration.team_where.file().c_str());
  }
  stream_ = PacketStream(layout_);
  hal::RadioSettings radio = board.radio;
  radio.baud = kFastestBaud;
  radio.pause_s = 0.0;
  arena_ = std::make_unique<hal::mock::Arena>(board.arena, board.camera, radio, seed);
  arena_->channel().set_layouts(layout_, configuration.pipeline.telemetry);
  TOUCHLINE_TRY_ASSIGN(opponents_, make_opponents(configuration, seed));
  arena_->game().set_side(hal::mock::Side::kOpponent, opponents_.side.get());
  objects_.attach(*arena_, team_colors(configuration), ArenaTimeControl::kNone);
  arena_->start_camera();
  return {};
}

Result<void> ServedGame::take_packets(RobotPort& port) {
  std::array<std::byte, kMaxPacketBytes> bytes;
  for (;;) {
    TOUCHLINE_TRY_ASSIGN(const std::size_t count, port.receive(bytes));
    if (count == 0) return {};
    take(std::span(bytes).first(count), port.keeps_packets());
  }
}

void ServedGame::take(std::span<const std::byte> bytes, bool keeps_packets) {
  if (keeps_packets) {
    stream_.reset();
    pending_.clear();
  }
  for (const std::byte byte : bytes) {
    // The robots' receivers skip bytes before a packet, as this one does.
    if (pending_.size() == kMaxPacketBytes) pending_.clear();
    pending_.push_back(byte);
    stream_.push(byte);
    ParsedPacket packet;
    if (!stream_.next(packet)) continue;
    count(packet);
    pass_on({pending_.data(), pending_.size()});
    pending_.clear();
  }
  const bool is_damaged = keeps_packets && !pending_.empty();
  if (is_damaged) counters_.damaged_bytes += pending_.size();
  if (!keeps_packets) counters_.damaged_bytes = stream_.skipped_bytes();
}

void ServedGame::count(const ParsedPacket& packet) {
  ++counters_.packets;
  if (!packet.has_sequence) return;
  if (last_sequence_) {
    // A jump back is a packet that another one overtook, or a program that has started again.
    const auto step = static_cast<std::int8_t>(packet.sequence - *last_sequence_);
    if (step > 1) counters_.missing += static_cast<std::uint64_t>(step - 1);
  }
  last_sequence_ = packet.sequence;
}

void ServedGame::pass_on(std::span<const std::byte> packet) {
  hash_.add(frames_);
  hash_.add(packet);
  // A packet is lost if the queue is full, as with a real radio module.
  static_cast<void>(arena_->channel().send(packet, arena_->now()));
}

void ServedGame::send_telemetry(RobotPort& port) {
  std::array<std::byte, kMaxPacketBytes> bytes;
  while (port.can_send()) {
    std::size_t sender = kAllRobots;
    const std::size_t count = arena_->channel().receive(bytes, sender);
    if (count == 0) return;
    port.send(std::span(bytes).first(count));
  }
}

std::string ServedGame::summary() const {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(),
                "packets received: %" PRIu64 ", %" PRIu64 " missing on the way, %" PRIu64
                " bytes of no packet; hash %016" PRIx64 "\n",
                counters_.packets, counters_.missing, counters_.damaged_bytes, hash_.value());
  return "pictures taken: " + std::to_string(frames_) + "\n" + text.data() + summary_of(*arena_);
}

}  // namespace touchline::arena
