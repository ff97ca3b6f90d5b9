#include "tools/programs/radio/packet_text.h"

#include <cstdint>
#include <utility>
#include <vector>

#include "core/radio/packet.h"
#include "core/radio/telemetry.h"
#include "core/radio/wire_format.h"
#include "tools/programs/command_line/formatted.h"

namespace touchline::radio {
namespace {

class FieldList {
 public:
  explicit FieldList(std::span<const std::byte> bytes) : bytes_(bytes) {}
  /// Adds a line for the next `count` bytes.
  void add(std::size_t count, const std::string& meaning) {
    std::string hex;
    for (std::size_t i = 0; i < count && at_ < bytes_.size(); ++i) {
      hex += formatted("%02X ", std::to_integer<unsigned>(bytes_[at_++]));
    }
    text_ += formatted("  %-16s%s\n", hex.c_str(), meaning.c_str());
  }
  [[nodiscard]] std::size_t at() const { return at_; }
  [[nodiscard]] unsigned byte() const { return std::to_integer<unsigned>(bytes_[at_]); }
  [[nodiscard]] unsigned number() const { return uint16_at(bytes_, at_); }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::string text_;
};

std::string raw_text(std::span<const std::byte> bytes, const char* meaning) {
  FieldList fields(bytes);
  while (fields.at() < bytes.size()) fields.add(std::min<std::size_t>(bytes.size() - fields.at(), 5), meaning);
  return fields.text();
}

std::string speed_text(const char* wheel, unsigned number) {
  return formatted("%s wheel %+.3f m/s", wheel,
                   static_cast<double>(static_cast<std::int16_t>(number)) * static_cast<double>(kWheelResolutionMps));
}

std::string check_text(std::span<const std::byte> packet) {
  const std::size_t end = packet.size() - kPacketCrcBytes;
  const bool is_right = crc16_ccitt_false(packet.first(end)) == uint16_at(packet, end);
  return is_right ? "checksum, right" : "checksum, WRONG";
}

}  // namespace

std::string packet_text(std::span<const std::byte> bytes) {
  if (bytes.empty() || packet_length(bytes) != bytes.size()) return raw_text(bytes, "no packet");
  FieldList fields(bytes);
  fields.add(2, "start \"TL\"");
  fields.add(1, formatted("version %u", fields.byte()));
  fields.add(1, fields.byte() == std::to_integer<unsigned>(kPacketFlagStop) ? "flags: all robots stop" : "flags: none");
  fields.add(1, formatted("sequence number %u", fields.byte()));
  if (packet_team(bytes) != kNoTeamNumber) fields.add(1, formatted("team number %u", fields.byte()));
  const unsigned robots = fields.byte();
  fields.add(1, formatted("%u robot%s", robots, robots == 1 ? "" : "s"));
  for (unsigned i = 0; i < robots; ++i) {
    fields.add(1, formatted("robot %u", fields.byte()));
    fields.add(2, speed_text("left", fields.number()));
    fields.add(2, speed_text("right", fields.number()));
  }
  fields.add(kPacketCrcBytes, check_text(bytes));
  return fields.text();
}

std::string telemetry_text(std::span<const std::byte> bytes) {
  std::string text;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::span<const std::byte> rest = bytes.subspan(at);
    RobotTelemetry telemetry;
    if (rest.size() >= kTelemetryBytes && decode_telemetry(rest.first(kTelemetryBytes), telemetry).ok()) {
      FieldList fields(rest.first(kTelemetryBytes));
      fields.add(2, "start \"TR\"");
      fields.add(1, formatted("version %u", fields.byte()));
      fields.add(1, formatted("robot %u", fields.byte()));
      fields.add(1, formatted("sequence number %u", fields.byte()));
      fields.add(2, formatted("battery %.3f V", static_cast<double>(telemetry.battery_v)));
      fields.add(1, telemetry.link_percent == kLinkUnknown ? "link: not measured"
                                                           : formatted("link %d %%", int{telemetry.link_percent}));
      fields.add(kPacketCrcBytes, "checksum, right");
      text += fields.text();
      at += kTelemetryBytes;
      continue;
    }
    std::size_t end = at + 1;
    while (end < bytes.size() && bytes[end] != kTelemetryMagic0) ++end;
    text += raw_text(bytes.subspan(at, end - at), "no packet of a robot");
    at = end;
  }
  return text;
}

}  // namespace touchline::radio
