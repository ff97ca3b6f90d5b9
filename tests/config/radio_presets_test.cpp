// The presets of boards/radios: bytes, decoding, damage, and their page.
#include "firmware/config/radio_presets.h"

#include <optional>

#include "core/radio/field_type.h"
#include "core/radio/packet.h"
#include "core/radio/packet_parser.h"
#include "core/radio/telemetry.h"
#include "firmware/config/resolve_radio.h"
#include "firmware/config/team_file.h"
#include "firmware/config/wording.h"
#include "tests/config/radio_golden.h"
#include "tests/results.h"

namespace touchline::config {
namespace {

constexpr double kWheelBase_m = 0.0625, kMaxWheelSpeed_mps = 2.0, kWheelRadius_m = 0.025, kStepsPerTurn = 350.0;
constexpr std::uint8_t kSequence = 7;

std::string address_of(std::string_view preset, int number) {
  if (preset == "ararabots") return "24:6F:28:AA:0B:0" + std::to_string(number);
  if (preset == "pequi") return "0x35D" + std::to_string(number);
  if (preset == "robot-soccer-kit-udp") return "192.168.100.1" + std::to_string(number);
  return "";
}

struct PresetTeam {
  RadioEntry radio;  // as the preset says
  std::unique_ptr<PipelineParameters> pipeline = std::make_unique<PipelineParameters>();
  RobotId first_id = 1;
};

// `name`: of a preset, or "touchline 9".
PresetTeam team_of(std::string_view name) {
  PresetTeam out;
  TeamFile team;
  const std::size_t space = name.find(' ');
  if (space != std::string_view::npos) team.team_number = name[space + 1] - '0';
  const std::string format(name.substr(0, space));
  if (format != "touchline") {
    EXPECT_TRUE(read_radio_preset(format, out.radio)) << format;
  }
  team.radio = out.radio;
  team.radio.format = format;
  if (team.radio.wheel_radius_m == 0.0) team.radio.wheel_radius_m = kWheelRadius_m;
  if (team.radio.steps_per_turn == 0.0) team.radio.steps_per_turn = kStepsPerTurn;
  team.own.color = "blue";
  team.control.drive.wheel_base_m = kWheelBase_m;
  team.control.drive.max_wheel_speed_mps = kMaxWheelSpeed_mps;
  if (out.radio.places == 3 && out.radio.first_id == 0) out.first_id = 0;
  for (int i = 0; i < 3; ++i) {
    RobotEntry robot;
    robot.id = out.first_id + i;
    robot.address = address_of(name, i + 1);
    team.own.robot.push_back(robot);
  }
  EXPECT_OK(resolve_radio(team, Locations(format), *out.pipeline));
  return out;
}

std::string hex(std::span<const std::byte> bytes) {
  std::string out;
  for (const std::byte byte : bytes) {
    constexpr std::string_view kDigits = "0123456789ABCDEF";
    if (!out.empty()) out += ' ';
    out += kDigits[std::to_integer<std::size_t>(byte >> 4)];
    out += kDigits[std::to_integer<std::size_t>(byte & std::byte{15})];
  }
  return out;
}

Commands commands_of(const PresetTeam& team, const std::vector<WheelSpeeds>& wheels, bool stop = false) {
  Commands commands;
  commands.stop = stop;
  for (std::size_t i = 0; i < wheels.size(); ++i) {
    commands.robots.push_back({static_cast<RobotId>(team.first_id + static_cast<int>(i)), {}, wheels[i]});
  }
  return commands;
}

std::vector<std::vector<std::byte>> packets_of(const PresetTeam& team, const Commands& commands, bool start = false) {
  OutgoingPackets packets;
  EXPECT_TRUE(encode(team.pipeline->radio, commands, {commands.stop, start, kSequence, {}}, packets).ok());
  std::vector<std::vector<std::byte>> out;
  for (const auto& packet : packets) out.emplace_back(packet.packet.begin(), packet.packet.end());
  return out;
}

const std::vector<WheelSpeeds> kDrive{{0.5f, 0.5f}, {-0.25f, 0.25f}, {-0.75f, -0.25f}};

void expect_packets(const PresetTeam& team, const Commands& commands, const HexPackets& expected, const char* what) {
  const auto packets = packets_of(team, commands);
  ASSERT_EQ(packets.size(), expected.size()) << what;
  for (std::size_t i = 0; i < packets.size(); ++i) EXPECT_EQ(hex(packets[i]), expected[i]) << what << ' ' << i;
}

TEST(RadioPresets, SendTheBytesThatTheSourcesPublish) {
  for (const RadioGolden& golden : kRadioGolden) {
    SCOPED_TRACE(golden.preset);
    const PresetTeam team = team_of(golden.preset);
    expect_packets(team, commands_of(team, kDrive), golden.drive, "drive");
    expect_packets(team, commands_of(team, {{-30.0f, 30.0f}, {30.0f, 30.0f}}), golden.limits, "limits");
    expect_packets(team, commands_of(team, kDrive, true), golden.stop, "stop");
  }
}

TEST(RadioPresets, EachHasGoldenBytes) {
  for (const RadioPreset& preset : radio_presets()) {
    EXPECT_TRUE(std::any_of(kRadioGolden.begin(), kRadioGolden.end(), [&](const RadioGolden& golden) {
      return golden.preset == preset.name;
    })) << preset.name;
  }
}

TEST(RadioPresets, StartBytesComeBeforeTheFirstPacket) {
  const auto first = [](std::string_view preset) {
    const PresetTeam team = team_of(preset);
    return hex(packets_of(team, commands_of(team, kDrive), true)[0]);
  };
  EXPECT_EQ(first("create2"), "80 83 91 01 F4 01 F4");
  const std::string rhock = "72 68 6F 63 6B 0D 0A ";
  EXPECT_EQ(first("robot-soccer-kit"), rhock + rhock + rhock + "FF AA 50 07 02 01 F4 00 00 00 00 F7");
}

TEST(RadioPresets, TouchlinesTelemetryHasItsBytes) {
  Packet packet;
  RobotTelemetry telemetry;
  telemetry.id = 3;
  telemetry.sequence = 200;
  telemetry.battery_v = 7.412f;
  telemetry.link_percent = 87;
  ASSERT_TRUE(encode_telemetry(touchline_telemetry_layout(), telemetry, packet).ok());
  EXPECT_EQ(hex({packet.data(), packet.size()}), kTelemetryGolden);
}

// Speed of a wheel by one count of each field.
double count_mps(const PacketLayout& layout) {
  double count = 1e-6;
  for (const PacketField& field : layout.fields) {
    double unit = 1.0;
    for (unsigned i = 0; i < field.decimals; ++i) unit *= 10.0;
    const double step = is_float(field.type) ? 0.0 : 1.0 / std::abs(field.scale * unit);
    if (field.value == FieldValue::kLeft) count += step * (layout.pwm.empty() ? 1.0 : kMaxWheelSpeed_mps);
    if (field.value == FieldValue::kForward) count += step;
    if (field.value == FieldValue::kTurn) count += step * kWheelBase_m / 2;
  }
  return count;
}

std::optional<Commands> decoded(const PresetTeam& team, std::span<const std::byte> bytes, std::size_t packet) {
  const auto receiver = static_cast<RobotId>(team.first_id + static_cast<int>(packet));
  ParsedPacket out;
  if (!decode_packet(team.pipeline->radio, bytes, receiver, out).ok()) return std::nullopt;
  return out.commands;
}

TEST(RadioPresets, AreReadBackWithinACount) {
  for (const RadioGolden& golden : kRadioGolden) {
    SCOPED_TRACE(golden.preset);
    const PresetTeam team = team_of(golden.preset);
    const double count = count_mps(team.pipeline->radio);
    std::mt19937 random(1);
    // Within the limits of all robots: an e-puck2 drives at 0.129 m/s.
    std::uniform_real_distribution<float> speed(-0.12f, 0.12f);
    for (int trial = 0; trial < 200; ++trial) {
      std::vector<WheelSpeeds> wheels;
      for (int i = 0; i < 3; ++i) wheels.push_back({speed(random), speed(random)});
      const auto packets = packets_of(team, commands_of(team, wheels));
      std::size_t found = 0;
      for (std::size_t i = 0; i < packets.size(); ++i) {
        const auto read = decoded(team, packets[i], i);
        ASSERT_TRUE(read) << hex(packets[i]);
        EXPECT_FALSE(read->stop);
        for (const RobotCommand& robot : read->robots) {
          const int index = robot.id - team.first_id;
          if (index < 0 || index >= 3) continue;  // an empty place
          ++found;
          const WheelSpeeds& sent = wheels[static_cast<std::size_t>(index)];
          EXPECT_NEAR(robot.wheels.left_mps, sent.left_mps, count) << hex(packets[i]);
          EXPECT_NEAR(robot.wheels.right_mps, sent.right_mps, count) << hex(packets[i]);
        }
      }
      EXPECT_EQ(found, 3U);
    }
  }
}

TEST(RadioPresets, AStopMovesNoRobot) {
  for (const RadioGolden& golden : kRadioGolden) {
    SCOPED_TRACE(golden.preset);
    const PresetTeam team = team_of(golden.preset);
    const auto packets = packets_of(team, commands_of(team, kDrive, true));
    for (std::size_t i = 0; i < packets.size(); ++i) {
      const auto read = decoded(team, packets[i], i);
      ASSERT_TRUE(read);
      for (const RobotCommand& robot : read->robots) {
        EXPECT_EQ(robot.wheels.left_mps, 0.0f);
        EXPECT_EQ(robot.wheels.right_mps, 0.0f);
      }
    }
  }
}

TEST(RadioPresets, TruncatedPacketsAreRefused) {
  for (const RadioGolden& golden : kRadioGolden) {
    SCOPED_TRACE(golden.preset);
    const PresetTeam team = team_of(golden.preset);
    const auto packets = packets_of(team, commands_of(team, kDrive));
    for (std::size_t i = 0; i < packets.size(); ++i) {
      for (std::size_t size = 0; size < packets[i].size(); ++size) {
        EXPECT_FALSE(decoded(team, std::span(packets[i]).first(size), i)) << size;
      }
    }
  }
}

bool moves(const std::optional<Commands>& commands) {
  return commands && !commands->stop &&
         std::any_of(commands->robots.begin(), commands->robots.end(), [](const RobotCommand& robot) {
           return robot.wheels.left_mps != 0.0f || robot.wheels.right_mps != 0.0f;
         });
}

// Of `trials` random strings of a packet's length.
int moving_random_strings(const PresetTeam& team, int trials) {
  std::vector<std::byte> bytes = packets_of(team, commands_of(team, kDrive))[0];
  std::mt19937 random(1);
  int count = 0;
  for (int trial = 0; trial < trials; ++trial) {
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      if (i % 4 == 0) word = static_cast<std::uint32_t>(random());
      bytes[i] = static_cast<std::byte>((word >> (8 * (i % 4))) & 0xFFu);
    }
    if (moves(decoded(team, bytes, 0))) ++count;
  }
  return count;
}

struct Damage {
  int trials = 0, moving = 0;
};

// Packets with one wrong byte.
Damage damaged(const PresetTeam& team) {
  Damage out;
  auto packets = packets_of(team, commands_of(team, kDrive));
  for (std::size_t i = 0; i < packets.size(); ++i) {
    for (std::byte& byte : packets[i]) {
      const std::byte right = byte;
      for (int wrong = 0; wrong < 256; ++wrong) {
        byte = static_cast<std::byte>(wrong);
        if (byte == right) continue;
        ++out.trials;
        if (moves(decoded(team, packets[i], i))) ++out.moving;
      }
      byte = right;
    }
  }
  return out;
}

TEST(RadioPresets, ChecksFindEachDamagedByte) {
  for (const std::string_view preset : {"touchline", "touchline 9", "unball", "rodetas", "pequi", "robot-soccer-kit"}) {
    const PresetTeam team = team_of(preset);
    EXPECT_EQ(damaged(team).moving, 0) << preset;
  }
  // The kit's sum does not cover the destination: two of its wrong values are those of the other two robots.
  EXPECT_EQ(damaged(team_of("robot-soccer-kit-udp")).moving, 3 * 2);
}

const std::string& page() {
  static const std::string text = [] {
    std::ifstream file(std::string(TOUCHLINE_SOURCE_DIR) + "/docs/radio-presets.md");
    std::ostringstream out;
    out << file.rdbuf();
    return out.str();
  }();
  return text;
}

std::string units_of(const RadioEntry& radio) {
  std::string out;
  for (const FieldEntry& field : radio.field) {
    if (field.unit == WireUnit::kNone) continue;
    const std::string word(word_of(field.unit, kWireUnits));
    if (out.find(word) == std::string::npos) out += (out.empty() ? "" : ", ") + word;
  }
  return out;
}

std::string check_of(const RadioEntry& radio) {
  for (const FieldEntry& field : radio.field) {
    if (field.value == FieldValue::kCheck) return std::string(word_of(field.check, kCheckKinds));
  }
  return "none";
}

std::string time_out_of(const RadioEntry& radio) {
  if (radio.time_out_s == 0.0) return "none";
  std::ostringstream out;
  out << radio.time_out_s << " s";
  return out.str();
}

// `hits`: of a million random strings.
std::string row_of(std::string_view name, const PresetTeam& team, int hits) {
  const RadioEntry& radio = team.radio;
  const auto packets = packets_of(team, commands_of(team, kDrive));
  const Damage damage = damaged(team);
  std::ostringstream out;
  out << "| `" << name << "` | " << radio.about << " | " << packets[0].size()
      << (radio.packet_for == PacketFor::kEach ? " each" : "") << " | " << units_of(radio) << " | " << check_of(radio)
      << " | " << time_out_of(radio) << " | " << hits << " | "
      << (damage.moving * 100 + damage.trials / 2) / damage.trials << " % |";
  return out.str();
}

std::string note_of(std::string_view name, const RadioEntry& radio) {
  return "| `" + std::string(name) + "` | " + radio.note + " | " + radio.source + " |";
}

// A million random strings take a second for presets without a check.
constexpr int kStrings = 1000000;

TEST(RadioPresetsPage, HasTheRowsOfAllPresets) {
  for (const RadioPreset& preset : radio_presets()) {
    const PresetTeam team = team_of(preset.name);
    const std::string row = row_of(preset.name, team, moving_random_strings(team, kStrings));
    EXPECT_NE(page().find("\n" + row + "\n"), std::string::npos) << "docs/radio-presets.md should contain\n" << row;
    const std::string note = note_of(preset.name, team.radio);
    EXPECT_NE(page().find("\n" + note + "\n"), std::string::npos) << "docs/radio-presets.md should contain\n" << note;
  }
}

TEST(RadioPresetsPage, NamesNoOtherPreset) {
  std::istringstream lines(page());
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("| `")) continue;
    const std::string name = line.substr(3, line.find('`', 3) - 3);
    const auto presets = radio_presets();
    EXPECT_TRUE(std::any_of(presets.begin(), presets.end(), [&](const RadioPreset& preset) {
      return preset.name == name;
    })) << line;
  }
}

TEST(RadioPresets, SayWhereTheirBytesArePublished) {
  for (const RadioPreset& preset : radio_presets()) {
    RadioEntry radio;
    ASSERT_TRUE(read_radio_preset(preset.name, radio));
    EXPECT_FALSE(radio.about.empty()) << preset.name;
    EXPECT_FALSE(radio.source.empty()) << preset.name;
    EXPECT_FALSE(radio.note.empty()) << preset.name;
  }
}

}  // namespace
}  // namespace touchline::config
