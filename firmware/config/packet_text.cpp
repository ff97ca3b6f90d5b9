#include "firmware/config/packet_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "core/radio/field_type.h"
#include "core/radio/packet.h"
#include "core/radio/packet_parser.h"
#include "firmware/config/radio_presets.h"
#include "firmware/config/wording.h"

namespace touchline::config {
namespace {

constexpr std::size_t kBytesColumn = 24;  // characters
constexpr float kSampleSpeed_mps = 0.5f, kSampleTurn_radps = 1.0f;

std::string hexadecimal(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte byte : bytes) {
    std::array<char, 4> digits{};
    std::snprintf(digits.data(), digits.size(), "%02X", std::to_integer<unsigned>(byte));
    text.append(text.empty() ? "" : " ").append(digits.data());
  }
  return text;
}

std::string with_unit(double value, const char* unit) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), " = %.3f %s", value, unit);
  return text.data();
}

std::string unit_text(const PacketLayout& layout, const FieldReading& reading) {
  const double value = value_of(layout, reading);
  switch (layout.fields[reading.field].value) {
    case FieldValue::kLeft:
    case FieldValue::kRight:
    case FieldValue::kForward:
      return with_unit(value, "m/s");
    case FieldValue::kTurn:
      return with_unit(value, "rad/s");
    case FieldValue::kBattery:
      return with_unit(value, "V");
    default:
      return "";
  }
}

// Id of the robot to which a reading belongs; nothing if the packet does not tell.
std::optional<int> robot_of(const PacketLayout& layout, const FieldReadings& readings, const FieldReading& reading) {
  if (layout.is_by_place()) return layout.first_id + static_cast<int>(reading.robot);
  for (const FieldReading& other : readings) {
    if (other.robot != reading.robot || layout.fields[other.field].value != FieldValue::kId) continue;
    return static_cast<int>(std::lround(value_of(layout, other)));
  }
  return std::nullopt;
}

// Whether the fields of a stop are found again in its bytes.
bool can_be_read_back(const PacketLayout& layout) {
  PacketLayout without_framing = layout;
  without_framing.framing = Framing::kNone;
  OutgoingPackets packets;
  if (!encode(without_framing, {}, {.stop = true}, packets).ok()) return false;
  return std::all_of(packets.begin(), packets.end(), [&](const OutgoingPacket& outgoing) {
    const RobotId receiver = outgoing.receiver == kAllRobots ? kUnknownId : layout.receivers[outgoing.receiver].id;
    ParsedPacket read;
    return decode_packet(without_framing, {outgoing.packet.data(), outgoing.packet.size()}, receiver, read).ok();
  });
}

// Whether several robots hear packets that are meant for one of them.
bool is_shared_without_names(const PacketLayout& layout, const hal::RadioSettings& radio) {
  if (!layout.one_each || layout.has(FieldValue::kId) || layout.has(FieldValue::kAddress)) return false;
  const auto is_shared = [&](const hal::RadioPortSettings& port) {
    const std::size_t robots = port.robots.empty() ? layout.receivers.size() : port.robots.size();
    return port.backend == hal::RadioBackend::kSerial && robots > 1;
  };
  return is_shared(radio) || std::any_of(radio.more.begin(), radio.more.end(), is_shared);
}

bool has_gains(const PacketLayout& layout) {
  return std::any_of(layout.receivers.begin(), layout.receivers.end(),
                     [](const Receiver& receiver) { return receiver.wheel_gain != Receiver{}.wheel_gain; });
}

// The keys of a preset as they can stand in a team file.
std::string section_of(std::string_view preset) {
  constexpr std::string_view kVersion = "version = 1\n\n", kSection = "[radio]\n";
  std::string text(preset);
  if (const std::size_t at = text.find(kVersion); at != std::string::npos) text.erase(at, kVersion.size());
  if (const std::size_t at = text.find(kSection); at != std::string::npos) {
    text.insert(at + kSection.size(), "format = \"own\"\n");
  }
  return text;
}

std::string number_on_wire(const PacketField& field, const FieldReading& reading) {
  std::array<char, 32> text{};
  if (field.type == FieldType::kU48 || field.type == FieldType::kU64) {
    std::snprintf(text.data(), text.size(), "0x%llX", static_cast<unsigned long long>(reading.address));
    return text.data();
  }
  std::snprintf(text.data(), text.size(), "%.10g", reading.number);
  return text.data();
}

}  // namespace

std::string packet_text(const PacketLayout& layout, std::span<const std::byte> bytes) {
  FieldReadings readings;
  const std::size_t length = parse_packet(layout, bytes, readings);
  if (length != bytes.size()) return "  unknown: " + hexadecimal(bytes) + "\n";
  std::string text;
  for (const FieldReading& reading : readings) {
    const PacketField& field = layout.fields[reading.field];
    std::array<char, 16> place{};
    std::snprintf(place.data(), place.size(), "  %3u  ", unsigned{reading.begin});
    std::string shown =
        hexadecimal(bytes.subspan(reading.begin, static_cast<std::size_t>(reading.end - reading.begin)));
    shown.resize(std::max(shown.size(), kBytesColumn), ' ');
    text.append(place.data()).append(shown).append("  ").append(word_of(field.value, kFieldValues));
    const std::optional<int> robot = field.block > 0 ? robot_of(layout, readings, reading) : std::nullopt;
    if (robot && field.value != FieldValue::kId) text += " of robot " + std::to_string(*robot);
    if (field.type != FieldType::kBytes) text += ": " + number_on_wire(field, reading) + unit_text(layout, reading);
    text += "\n";
  }
  return text;
}

std::string received_text(const PacketLayout& layout, std::span<const std::byte> bytes) {
  std::string text;
  std::size_t unknown = 0;  // where bytes begin that are no packet
  for (std::size_t at = 0; at < bytes.size();) {
    FieldReadings readings;
    const std::size_t length = parse_packet(layout, bytes.subspan(at), readings);
    if (length == kNoPacket || length == kMoreBytes || layout.fields.empty()) {
      ++at;
      continue;
    }
    if (unknown < at) text += "  unknown: " + hexadecimal(bytes.subspan(unknown, at - unknown)) + "\n";
    text += packet_text(layout, bytes.subspan(at, length));
    unknown = at += length;
  }
  if (unknown < bytes.size()) text += "  unknown: " + hexadecimal(bytes.subspan(unknown)) + "\n";
  return text;
}

std::string sample_packet_text(const PipelineParameters& parameters) {
  const PacketLayout& layout = parameters.radio;
  Commands commands;
  commands.stop = false;
  const float half = kSampleTurn_radps * static_cast<float>(parameters.control.drive.wheel_base_m) / 2;
  for (const Receiver& receiver : layout.receivers) {
    RobotCommand command;
    command.id = receiver.id;
    command.wheels = {kSampleSpeed_mps - half, kSampleSpeed_mps + half};
    commands.robots.push_back(command);
  }
  PacketLayout without_framing = layout;
  without_framing.framing = Framing::kNone;
  OutgoingPackets framed, plain;
  if (!encode(layout, commands, {}, framed).ok() || !encode(without_framing, commands, {}, plain).ok()) {
    return "radio: no packet can be sent: too many bytes\n";
  }
  if (framed.empty()) return "radio: no packet is sent, because the team has no robots\n";
  const Packet& packet = framed[0].packet;
  std::string text = "radio: " + std::string(layout.one_each ? "a packet for each robot" : "a packet for all robots") +
                     ", " + std::to_string(packet.size()) + " bytes; at " + number_text(kSampleSpeed_mps) +
                     " m/s and " + number_text(kSampleTurn_radps) + " rad/s" +
                     (layout.one_each ? ", for robot " + std::to_string(layout.receivers[0].id) : "") +
                     (has_gains(layout) ? ", divided by own.robot.wheel_gain" : "") + ":\n";
  if (layout.framing != Framing::kNone) {
    text += "  on the line: " + hexadecimal({packet.data(), packet.size()}) + "\n";
  }
  return text + packet_text(layout, {plain[0].packet.data(), plain[0].packet.size()});
}

std::string radio_warnings(const Configuration& configuration) {
  const hal::RadioSettings& port = configuration.board.radio;
  const PacketLayout& layout = configuration.pipeline.radio;
  const RadioEntry& radio = configuration.team.radio;
  if (port.backend == hal::RadioBackend::kNone) return "";
  std::string text;
  const std::string& file = configuration.team_where.file();
  const bool is_touchline = radio.format == "touchline";
  if (!is_touchline && radio.time_out_s <= 0.0) {
    text += "robots of the format \"" + radio.format +
            "\" are not known to stop by themselves when packets are missing: they drive on if the radio or this "
            "computer fails; if yours stop, set radio.time_out_s in " +
            file + "\n";
  }
  if (is_touchline && configuration.team.team_number == 0) {
    text +=
        "packets have no team number: robots obey every Touchline on their channel; to prevent it, set team_number "
        "in " +
        file + " and in the robots (docs/radio.md)\n";
  }
  const std::size_t robots = layout.receivers.size();
  const std::size_t bytes = largest_packet(layout, robots) * (layout.one_each ? robots : 1);
  const hal::LineTime line = hal::line_time(port);
  const double pauses_s = seconds(line.pause) * static_cast<double>(layout.one_each ? robots : 1);
  const double line_s = seconds(line.of(bytes)) + pauses_s;
  const double rate_hz = configuration.board.camera.rate_hz;
  if (rate_hz > 0.0 && line_s > 1.0 / rate_hz) {
    text += "a frame's packets of up to " + std::to_string(bytes) + " bytes take " +
            number_text(std::round(line_s * 1e4) / 10) + " ms at radio.baud = " + std::to_string(port.baud) +
            (pauses_s > 0.0 ? " with their pauses" : "") + ", longer than a frame of " +
            number_text(std::round(1e4 / rate_hz) / 10) + " ms: robots get a command in some frames only\n";
  }
  if (!layout.pwm.empty() && radio.pwm_speed_mps.empty()) {
    text +=
        "the motors' curve is not known: full power is sent for control.drive.max_wheel_speed_mps = " +
        number_text(configuration.team.control.drive.max_wheel_speed_mps) +
        " m/s, so a lower limit does not make the robots slower; measure radio.pwm_speed_mps and radio.pwm_share (" +
        file + ")\n";
  }
  if (is_shared_without_names(layout, port)) {
    text +=
        "the packets for single robots name none of them, but several robots share a serial port, so each obeys the "
        "packets of all: give each robot a port of its own ([[radio.more]] and robots of " +
        configuration.board_where.file() + "), or add the field id or address\n";
  }
  if (!can_be_read_back(layout)) {
    text +=
        "these packets cannot be told apart from their bytes, so robots of the arena will not move: separate "
        "digits by constants or give them a width (" +
        file + ": radio.field)\n";
  }
  if (!radio.note.empty()) text += radio.note + "\n";
  return text;
}

Result<std::string> radio_formats_text(const std::string& name) {
  std::vector<std::string_view> names{"touchline"};
  for (const RadioPreset& preset : radio_presets()) {
    if (preset.name == name) return section_of(preset.toml);
    names.push_back(preset.name);
  }
  if (name == "touchline")
    return std::string("# docs/radio.md describes it; it is the default.\n[radio]\nformat = \"touchline\"\n");
  if (!name.empty()) {
    return failure(ErrorCode::kNotFound, "no robots are known as \"%s\"%s", name.c_str(),
                   suggestion(name, names, "formats").c_str());
  }
  std::string text = "radio.format of the team file can be:\n";
  const auto add = [&text](std::string_view format, const std::string& about) {
    text.append("  ").append(format).append(std::string(format.size() < 16 ? 16 - format.size() : 1, ' '));
    text.append(about).append("\n");
  };
  add("touchline", "Touchline's own packet, with a checksum and a sequence number (docs/radio.md)");
  for (const RadioPreset& preset : radio_presets()) {
    RadioEntry entry;
    read_radio_preset(preset.name, entry);
    add(preset.name, entry.about);
  }
  add("own", "the fields of [[radio.field]] in the team file; begin with `touchline radio FORMAT` of similar robots");
  return text;
}

}  // namespace touchline::config
