#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/parameter.h"
#include "core/radio/packet_layout.h"

namespace touchline::config {

/// Unit of a number in a packet.
enum class WireUnit : std::uint8_t {
  kNone,
  kMps,
  kCmps,
  kMmps,
  kRadps,
  kDegps,
  kRpm,
  kTurnsps,
  kStepsps,
  kShare,
  kVolt,
  kMillivolt,
  kPercent
};
inline constexpr std::array<Choice<WireUnit>, 13> kWireUnits{{{"none", WireUnit::kNone},
                                                              {"m/s", WireUnit::kMps},
                                                              {"cm/s", WireUnit::kCmps},
                                                              {"mm/s", WireUnit::kMmps},
                                                              {"rad/s", WireUnit::kRadps},
                                                              {"deg/s", WireUnit::kDegps},
                                                              {"rpm", WireUnit::kRpm},
                                                              {"turns/s", WireUnit::kTurnsps},
                                                              {"steps/s", WireUnit::kStepsps},
                                                              {"share", WireUnit::kShare},
                                                              {"V", WireUnit::kVolt},
                                                              {"mV", WireUnit::kMillivolt},
                                                              {"%", WireUnit::kPercent}}};

enum class ByteOrder : std::uint8_t { kLittle, kBig };
inline constexpr std::array<Choice<ByteOrder>, 2> kByteOrders{
    {{"little", ByteOrder::kLittle}, {"big", ByteOrder::kBig}}};

enum class PacketFor : std::uint8_t { kAll, kEach };
inline constexpr std::array<Choice<PacketFor>, 2> kPacketFor{{{"all", PacketFor::kAll}, {"each", PacketFor::kEach}}};

/// [[radio.field]], [[radio.telemetry]]
struct FieldEntry {
  FieldValue value = FieldValue::kConstant;
  FieldType type = FieldType::kBytes;
  std::string name, text, hex;
  int bits = 8;
  WireUnit unit = WireUnit::kNone;
  double scale = 1.0, offset = 0.0;
  // Values beyond mean: no limit but that of the type.
  double low = -kUnlimited, high = kUnlimited;
  int decimals = 0, width = 0;
  bool magnitude = false, between = false;
  int block = 0;
  std::vector<int> codes;
  CheckKind check = CheckKind::kSum8;
  std::string from, to;

  static constexpr double kUnlimited = 1e9;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice(self.value, kFieldValues, {.name = "value", .help = "What the field carries"});
    visit.choice(self.type, kFieldTypes, {.name = "type", .help = "How it is written; bytes: as text or hex say"});
    visit.text(self.name, {.name = "name", .help = "Name for from, to and messages"});
    visit.text(self.text, {.name = "text", .help = "Constant in ASCII"});
    visit.text(self.hex, {.name = "hex", .help = "Constant in hexadecimal: \"7E 00\""});
    visit.number(self.bits, {.name = "bits", .range = {1, 32}, .help = "Bits of the types bits and signed-bits"});
    visit.choice(self.unit, kWireUnits, {.name = "unit", .help = "Unit that the robot understands"});
    visit.number(self.scale, {.name = "scale", .help = "Counts per unit"});
    visit.number(self.offset, {.name = "offset", .help = "Is added to the counts; the number of a constant"});
    visit.number(self.low, {.name = "low", .help = "Smallest number that is sent"});
    visit.number(self.high, {.name = "high", .help = "Largest number that is sent"});
    visit.number(self.decimals, {.name = "decimals", .range = {0, 6}, .help = "Decimals of digits"});
    visit.number(self.width,
                 {.name = "width", .range = {0, 16}, .help = "Characters of digits, filled with zeros; 0: as needed"});
    visit.flag(self.magnitude, {.name = "magnitude", .help = "Without sign, which a direction carries"});
    visit.flag(self.between, {.name = "between", .help = "Separates robots: is left out after the last one"});
    visit.number(self.block, {.name = "block",
                              .range = {0, 9},
                              .help = "Consecutive fields of one block repeat for each robot; 0: once in a packet"});
    visit.numbers(
        self.codes,
        {.name = "codes",
         .help = "stop: numbers of drive and stop; color: of blue and yellow; directions: of both forward, left "
                 "backward, right backward, both "
                 "backward; left-direction and the like: of forward and backward; turn-direction: of left and right"});
    visit.choice(self.check, kCheckKinds, {.name = "check", .help = "Kind of the checksum"});
    visit.text(self.from, {.name = "from",
                           .help = "First field that a length or check covers; empty: the packet's first one for a "
                                   "check, the next one for a length"});
    visit.text(self.to, {.name = "to",
                         .help = "Last field that a length or check covers; empty: the one before the check, which is "
                                 "the next one for a length"});
  }
};

/// [radio] of the team file: what the robots understand (docs/radio.md). A preset is a file with the same keys, in
/// boards/radios.
struct RadioEntry {
  std::string format = "touchline";
  std::string about, source, note;
  int default_baud = 0;
  double time_out_s = 0.0;
  double pause_s = 0.0;
  PacketFor packet_for = PacketFor::kAll;
  int places = 0, first_id = 0;
  ByteOrder byte_order = ByteOrder::kLittle;
  Framing framing = Framing::kNone;
  std::string start_text, start_hex;
  double start_period_s = 0.0;
  double wheel_radius_m = 0.0, steps_per_turn = 0.0;
  std::vector<double> pwm_speed_mps, pwm_share;
  std::vector<FieldEntry> field, telemetry;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text(self.format, {.name = "format",
                             .help = "What the robots understand: a preset (`touchline radio` lists them), or \"own\": "
                                     "the fields of this file"});
    visit.text(self.about, {.name = "about", .reload = Reload::kNoEffect, .help = "Robots that understand it"});
    visit.text(self.source, {.name = "source", .reload = Reload::kNoEffect, .help = "Where its bytes are published"});
    visit.text(self.note, {.name = "note", .reload = Reload::kNoEffect, .help = "What `touchline check` says of it"});
    visit.number(self.default_baud, {.name = "default_baud",
                                     .range = {0, 4000000},
                                     .unit = "Bd",
                                     .help = "Baud rate if the board file has none; 0: that of the board file"});
    visit.number(self.time_out_s,
                 {.name = "time_out_s",
                  .range = {0.0, 60.0},
                  .unit = "s",
                  .help = "Time without packets after which the robots stop by themselves; 0: they do not"});
    visit.number(self.pause_s, {.name = "pause_s",
                                .range = {0.0, 1.0},
                                .unit = "s",
                                .help = "Serial line: pause after each packet, for robots that need one to separate "
                                        "packets"});
    visit.choice(self.packet_for, kPacketFor,
                 {.name = "packet_for", .help = "One packet for all robots, or one for each robot"});
    visit.number(self.places,
                 {.name = "places",
                  .range = {0, kMaxRobotsPerTeam},
                  .help = "Places for robots in each packet, which stand for ids if no field carries an id; "
                          "0: as many as the team has"});
    visit.number(self.first_id, {.name = "first_id", .range = {0, 127}, .help = "Id of the first place"});
    visit.choice(self.byte_order, kByteOrders, {.name = "byte_order", .help = "Order of the bytes of a number"});
    visit.choice(self.framing, kFramings, {.name = "framing", .help = "Bytes that separate packets"});
    visit.text(self.start_text, {.name = "start_text", .help = "Sent before the first packets, in ASCII"});
    visit.text(self.start_hex, {.name = "start_hex", .help = "The same in hexadecimal"});
    visit.number(self.start_period_s, {.name = "start_period_s",
                                       .range = {0.0, 3600.0},
                                       .unit = "s",
                                       .help = "The start is sent again every period; 0: only after the radio opened"});
    visit.number(self.wheel_radius_m, {.name = "wheel_radius_m",
                                       .range = {0.0, 0.2},
                                       .unit = "m",
                                       .help = "Radius of the wheels, for speeds in turns or steps"});
    visit.number(self.steps_per_turn, {.name = "steps_per_turn",
                                       .range = {0.0, 1e6},
                                       .help = "Encoder or motor steps of a wheel's turn, for speeds in steps/s"});
    visit.numbers(self.pwm_speed_mps, {.name = "pwm_speed_mps",
                                       .range = {0.0, 10.0},
                                       .unit = "m/s",
                                       .help = "Wheel speeds that the shares pwm_share give, ascending from 0"});
    visit.numbers(self.pwm_share, {.name = "pwm_share",
                                   .range = {0.0, 1.0},
                                   .help = "PWM shares; the first one is where a wheel starts to turn. Empty: a share "
                                           "of 1 gives control.max_wheel_speed_mps"});
    visit.list(self.field, {.name = "field", .help = "Field of the packets, in their order"});
    visit.list(self.telemetry, {.name = "telemetry", .help = "Field of the packets that robots send"});
  }
};

}  // namespace touchline::config
