#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "core/fixed_vector.h"
#include "core/parameter.h"
#include "core/radio/checksum.h"
#include "core/types.h"

// A packet layout describes the packets that robots understand, or the telemetry that they send, as a list of fields.
// Encoder, decoder, the arena's robots and the text of `touchline check` all follow it (docs/radio.md).
namespace touchline {

/// The sender's team, 1 to 255. kNoTeamNumber: packets have no number.
using TeamNumber = std::uint8_t;
constexpr TeamNumber kNoTeamNumber = 0;

/// What a field carries.
enum class FieldValue : std::uint8_t {
  kConstant,  // bytes that never change; a receiver checks them
  kUnused,    // 0; a receiver ignores it
  kId,        // of the robot
  kAddress,   // of the robot: Receiver::address
  kLeft,      // speed of the left wheel's rim in m/s, or its PWM share if the layout has a curve
  kRight,     // the same for the right wheel
  kForward,   // speed of the robot in m/s
  kTurn,      // turn rate in rad/s
  // Codes are numbers on the wire, without scale and offset.
  kDirections,        // codes[0..3]: both wheels forward, left one backward, right one backward, both backward
  kLeftDirection,     // codes[0]: forward, codes[1]: backward
  kRightDirection,    // the same of the right wheel
  kForwardDirection,  // the same of the robot
  kTurnDirection,     // codes[0]: to the left, codes[1]: to the right
  kStop,              // codes[0]: drive, codes[1]: stop
  kCount,             // robots in the packet
  kLength,            // bytes from field `first` up to field `end`
  kSequence,          // number of the packet
  kTeam,              // TeamNumber
  kColor,             // codes[0]: our team is the blue one, codes[1]: the yellow one
  kTime,              // milliseconds
  kCheck,             // checksum of the bytes from field `first` up to field `end`
  kBattery,           // V, of telemetry
  kLink               // percent of packets received, of telemetry
};
inline constexpr std::array<Choice<FieldValue>, 23> kFieldValues{{{"constant", FieldValue::kConstant},
                                                                  {"unused", FieldValue::kUnused},
                                                                  {"id", FieldValue::kId},
                                                                  {"address", FieldValue::kAddress},
                                                                  {"left", FieldValue::kLeft},
                                                                  {"right", FieldValue::kRight},
                                                                  {"forward", FieldValue::kForward},
                                                                  {"turn", FieldValue::kTurn},
                                                                  {"directions", FieldValue::kDirections},
                                                                  {"left-direction", FieldValue::kLeftDirection},
                                                                  {"right-direction", FieldValue::kRightDirection},
                                                                  {"forward-direction", FieldValue::kForwardDirection},
                                                                  {"turn-direction", FieldValue::kTurnDirection},
                                                                  {"stop", FieldValue::kStop},
                                                                  {"count", FieldValue::kCount},
                                                                  {"length", FieldValue::kLength},
                                                                  {"sequence", FieldValue::kSequence},
                                                                  {"team", FieldValue::kTeam},
                                                                  {"color", FieldValue::kColor},
                                                                  {"time", FieldValue::kTime},
                                                                  {"check", FieldValue::kCheck},
                                                                  {"battery", FieldValue::kBattery},
                                                                  {"link", FieldValue::kLink}}};

/// How a number is written.
enum class FieldType : std::uint8_t {
  kBytes,
  kU8,
  kI8,
  kU16,
  kI16,
  kU32,
  kI32,
  kU48,  // of addresses alone, as kU64: other numbers are doubles
  kU64,
  kF32,
  kF64,
  kBits,
  kSignedBits,
  kDigits
};
inline constexpr std::array<Choice<FieldType>, 14> kFieldTypes{{{"bytes", FieldType::kBytes},
                                                                {"u8", FieldType::kU8},
                                                                {"i8", FieldType::kI8},
                                                                {"u16", FieldType::kU16},
                                                                {"i16", FieldType::kI16},
                                                                {"u32", FieldType::kU32},
                                                                {"i32", FieldType::kI32},
                                                                {"u48", FieldType::kU48},
                                                                {"u64", FieldType::kU64},
                                                                {"f32", FieldType::kF32},
                                                                {"f64", FieldType::kF64},
                                                                {"bits", FieldType::kBits},
                                                                {"signed-bits", FieldType::kSignedBits},
                                                                {"digits", FieldType::kDigits}}};

/// Number on the wire = value x scale + offset, rounded and limited to low .. high and to the range of the type.
struct PacketField {
  FieldValue value = FieldValue::kUnused;
  FieldType type = FieldType::kU8;
  std::uint8_t bits = 8;      // of kBits and kSignedBits, 1 to 32; consecutive ones share bytes, lowest bit first
  std::uint8_t decimals = 0;  // of kDigits
  std::uint8_t width = 0;     // of kDigits: filled with zeros to this number of characters; 0: as short as possible
  bool big_endian = false;
  bool magnitude = false;  // without its sign, which a direction carries
  bool between = false;    // is left out after the last robot
  std::uint8_t block = 0;  // consecutive fields of one block are repeated for each robot; 0: once in a packet
  CheckKind check = CheckKind::kSum8;
  std::uint8_t first = 0, end = 0;  // fields that kLength and kCheck cover: without `end`, which may be the list's end
  std::uint8_t text_size = 0;       // constant: its bytes in PacketLayout::text
  std::uint16_t text_at = 0;
  double scale = 1.0, offset = 0.0;
  double low = std::numeric_limits<double>::lowest(), high = std::numeric_limits<double>::max();
  std::array<std::int32_t, 4> codes{0, 1, 2, 3};
};

/// How packets are separated on the line.
enum class Framing : std::uint8_t {
  kNone,  // by constants, lengths and checks of the packet itself
  kCobs,  // consistent overhead byte stuffing with a zero after each packet (Cheshire and Baker, 1999)
  kSlip,  // RFC 1055, with an END byte before and after each packet
  kXbee   // escapes of XBee's API mode 2: the first byte 7E starts a packet, 7D escapes 7E, 7D, 11 and 13 after it
};
inline constexpr std::array<Choice<Framing>, 4> kFramings{
    {{"none", Framing::kNone}, {"cobs", Framing::kCobs}, {"slip", Framing::kSlip}, {"xbee-escapes", Framing::kXbee}}};

/// Speed of a wheel that a PWM share of 0 to 1 gives.
struct PwmPoint {
  float speed_mps = 0.0f, share = 0.0f;
};
constexpr std::size_t kMaxPwmPoints = 8;

// Touchline's packet needs 17 fields; the longest published one, a list of nine numbers in ASCII, 20.
constexpr std::size_t kMaxPacketFields = 40, kMaxPacketTextBytes = 160;

/// A robot that packets are sent to, in the order of own.robot of the team file.
struct Receiver {
  RobotId id = kUnknownId;
  std::uint64_t address = 0;  // number of its radio module; 0: none
  // Speed of the left and right wheel's rim per commanded speed, above 0. Packets carry the wanted speed divided by it,
  // so that the robot drives as it is commanded; everything that uses Commands reads wanted speeds.
  std::array<float, 2> wheel_gain{1.0f, 1.0f};
};

/// Fixed memory. An empty list of fields: robots get no packets, or send no telemetry.
struct PacketLayout {
  FixedVector<PacketField, kMaxPacketFields> fields;
  FixedVector<std::byte, kMaxPacketTextBytes> text;
  Framing framing = Framing::kNone;
  bool one_each = false;        // a packet for each robot instead of one for all
  bool commanded_only = false;  // robots without a command are not listed; robots of this layout stop then
  std::uint8_t slots = 0;       // robots in each packet; 0: as many as there are
  RobotId first_id = 0;         // id of the first place, if places stand for ids
  TeamNumber team = kNoTeamNumber;
  bool is_yellow = false;  // our team, of the leagues' two colors
  // Bytes before the first packets after the radio was opened, and before a packet every period; 0: not again.
  std::uint16_t start_at = 0;
  std::uint8_t start_size = 0;
  double start_period_s = 0.0;
  double wheel_base_m = 0.1;                 // of robots that get forward speed and turn rate
  FixedVector<PwmPoint, kMaxPwmPoints> pwm;  // ascending from (0, share at which the wheel starts to turn)
  bool pwm_is_assumed = false;               // nobody measured `pwm`: a share of 1 gives the largest wheel speed
  FixedVector<Receiver, kMaxRobotsPerTeam> receivers;

  /// Sets what the packets depend on of the drive, which can change while robots play.
  void set_drive(double base_m, double max_wheel_speed_mps);
  /// Returns whether a field carries `value`.
  [[nodiscard]] bool has(FieldValue value) const;
  /// Returns whether packets contain the id or address of each robot.
  [[nodiscard]] bool names_robots() const { return has(FieldValue::kId) || has(FieldValue::kAddress); }
  /// What is known of robot `id`; without an entry in `receivers`, its id only.
  [[nodiscard]] Receiver receiver_of(RobotId id) const;
  /// Returns whether a robot's place in the packet stands for its id.
  [[nodiscard]] bool is_by_place() const { return slots > 0 && !names_robots(); }
};

/// Touchline's own packets (docs/radio.md): version 1 without a team number, version 2 with one.
PacketLayout touchline_layout(TeamNumber team = kNoTeamNumber);
/// Touchline's own telemetry.
PacketLayout touchline_telemetry_layout();

/// Returns the largest number of bytes of a packet of `robots` robots with framing, or 0 if it has no limit: digits
/// without limits.
std::size_t largest_packet(const PacketLayout& layout, std::size_t robots);

}  // namespace touchline
