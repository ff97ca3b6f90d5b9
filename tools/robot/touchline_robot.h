#pragma once

// The robot's end of Touchline's radio: finds command packets in received bytes, decides which ones to obey, stops the
// wheels when packets stop, and writes telemetry. docs/radio.md defines the bytes.
//
// For firmware of any robot. Needs C++11 or later and <stdint.h> only: no heap, no exceptions, no standard library, so
// the compilers for AVR, ESP32, STM32 and a PC accept it. A Robot has 85 bytes on an 8-bit AVR.
//
//   touchline_robot::Robot robot(3);                     // this robot's id
//
//   while (there is a received byte) robot.receive(the byte, time in microseconds);
//   robot.update(time in microseconds);                  // in every round of the main loop
//   drive(robot.wheels().left_mmps, robot.wheels().right_mmps);
//
// Speeds are those of the wheels' rims in millimeters per second, positive forward. Times are microseconds of any
// clock that counts up and wraps at 2^32, as Arduino's micros() does.

#include <stdint.h>

namespace touchline_robot {

constexpr uint8_t kMaxRobots = 11;  // in a packet
constexpr uint8_t kMaxPacketBytes = 7 + 5 * kMaxRobots + 2;
constexpr uint8_t kTelemetryBytes = 10;
constexpr uint8_t kNoTeam = 0;  // packets of version 1 have no team number
constexpr uint8_t kLinkNotMeasured = 0xFF;
constexpr uint32_t kPauseUs = 2000;      // a longer pause ends an incomplete packet
constexpr uint32_t kTimeOutUs = 200000;  // without a packet to obey, the robot stops

struct WheelSpeeds {
  int16_t left_mmps;
  int16_t right_mmps;
};

/// CRC-16/CCITT-FALSE with one more byte; start with 0xFFFF. A table of 512 bytes would be faster, but large for an
/// AVR.
inline uint16_t crc_with(uint16_t crc, uint8_t byte) {
  uint16_t x = static_cast<uint16_t>((crc >> 8) ^ byte);
  x = static_cast<uint16_t>(x ^ (x >> 4));
  return static_cast<uint16_t>((crc << 8) ^ (x << 12) ^ (x << 5) ^ x);
}
inline uint16_t crc_of(const uint8_t* bytes, uint8_t size) {
  uint16_t crc = 0xFFFF;
  for (uint8_t i = 0; i < size; ++i) crc = crc_with(crc, bytes[i]);
  return crc;
}
/// Numbers of two bytes are little endian.
inline uint16_t uint16_at(const uint8_t* bytes) {
  return static_cast<uint16_t>(bytes[0] | (static_cast<uint16_t>(bytes[1]) << 8));
}

/// Finds valid command packets in bytes that may be damaged, lost or those of another protocol. After an invalid packet
/// the search goes on after its two start bytes, because a damaged count could hide the next packet.
///
///   finder.add(byte);
///   while (finder.find()) use(finder.bytes(), finder.size());
///
/// Robot below contains one. A radio module that passes packets on uses it alone.
class PacketFinder {
 public:
  /// `version`: of the packets to look for; 0: of versions 1 and 2.
  explicit PacketFinder(uint8_t version = 0) : version_(version) {}

  /// Call find() after each byte until it returns false.
  void add(uint8_t byte) {
    drop(found_);
    if (size_ == kMaxPacketBytes) drop(1);
    buffer_[size_++] = byte;
  }

  /// Returns true if a packet of any team is complete. It can be read until the next call of add(), find() or clear().
  bool find() {
    drop(found_);
    while (size_ > 0) {
      const uint8_t length = length_at_start();
      if (length == kMoreBytes || length > size_) return false;
      if (length != kNoPacket && is_valid(length)) {
        found_ = length;
        return true;
      }
      drop_to_next_start();
    }
    return false;
  }

  /// Forgets an incomplete packet.
  void clear() { size_ = found_ = 0; }

  const uint8_t* bytes() const { return buffer_; }
  uint8_t size() const { return found_; }

  bool is_stop() const { return (buffer_[3] & 1) != 0; }
  uint8_t sequence() const { return buffer_[4]; }
  /// 1 to 255, or kNoTeam for a packet of version 1.
  uint8_t team() const { return has_team() ? buffer_[5] : kNoTeam; }

  /// The speeds of robot `id`; zero if the packet does not contain it.
  WheelSpeeds speeds_of(uint8_t id) const {
    for (uint8_t at = header_bytes(); at < found_ - 2; at = next_robot(at)) {
      if (buffer_[at] != id) continue;
      return {static_cast<int16_t>(uint16_at(buffer_ + at + 1)), static_cast<int16_t>(uint16_at(buffer_ + at + 3))};
    }
    return {0, 0};
  }

 private:
  // Instead of a length: these bytes start no packet, or more bytes are needed to know.
  static constexpr uint8_t kNoPacket = 0, kMoreBytes = 0xFF;

  bool has_team() const { return buffer_[2] == 2; }
  uint8_t header_bytes() const { return has_team() ? 7 : 6; }
  static uint8_t next_robot(uint8_t at) { return static_cast<uint8_t>(at + 5); }

  // Each test uses only bytes that have arrived.
  uint8_t length_at_start() const {
    if (buffer_[0] != 'T') return kNoPacket;
    if (size_ > 1 && buffer_[1] != 'L') return kNoPacket;
    if (size_ < 3) return kMoreBytes;
    if (buffer_[2] != 1 && buffer_[2] != 2) return kNoPacket;
    if (version_ != 0 && buffer_[2] != version_) return kNoPacket;
    if (has_team() && size_ > 5 && buffer_[5] == kNoTeam) return kNoPacket;
    if (size_ < header_bytes()) return kMoreBytes;
    const uint8_t count = buffer_[header_bytes() - 1];
    if (count > kMaxRobots) return kNoPacket;
    return static_cast<uint8_t>(header_bytes() + 5 * count + 2);
  }

  bool is_valid(uint8_t length) const {
    const uint8_t end = static_cast<uint8_t>(length - 2);
    if (crc_of(buffer_, end) != uint16_at(buffer_ + end)) return false;
    for (uint8_t at = header_bytes(); at < end; at = next_robot(at)) {
      if (buffer_[at] > 127) return false;
      for (uint8_t other = header_bytes(); other < at; other = next_robot(other)) {
        if (buffer_[other] == buffer_[at]) return false;
      }
    }
    return true;
  }

  void drop_to_next_start() {
    uint8_t count = 1;
    while (count < size_ && buffer_[count] != 'T') ++count;
    drop(count);
  }
  void drop(uint8_t count) {
    for (uint8_t i = count; count > 0 && i < size_; ++i) buffer_[i - count] = buffer_[i];
    size_ = static_cast<uint8_t>(size_ - count);
    found_ = 0;
  }

  uint8_t buffer_[kMaxPacketBytes] = {};
  uint8_t version_;
  uint8_t size_ = 0;
  uint8_t found_ = 0;  // length of the packet at the start of the buffer
};

/// What one robot does with received bytes ("What a robot must do" in docs/radio.md).
class Robot {
 public:
  /// `id`: 0 to 127. `team`: the team's number, 1 to 255. A robot with a number obeys only packets with this number, a
  /// robot without one only packets without one.
  explicit Robot(uint8_t id, uint8_t team = kNoTeam) : finder_(team == kNoTeam ? 1 : 2), id_(id), team_(team) {}

  /// Processes one byte of a serial line. Returns true if it completed a packet that the robot obeys.
  bool receive(uint8_t byte, uint32_t now_us) {
    end_after_time_out(now_us);
    last_byte_us_ = now_us;
    finder_.add(byte);
    bool obeyed = false;
    while (finder_.find()) obeyed = obey(now_us) || obeyed;
    return obeyed;
  }

  /// The same for several bytes, such as a part of a packet from a radio module.
  bool receive(const uint8_t* bytes, uint8_t size, uint32_t now_us) {
    bool obeyed = false;
    for (uint8_t i = 0; i < size; ++i) obeyed = receive(bytes[i], now_us) || obeyed;
    return obeyed;
  }

  /// The same for a datagram, which starts and ends with a packet (UDP, ESP-NOW).
  bool receive_datagram(const uint8_t* bytes, uint8_t size, uint32_t now_us) {
    finder_.clear();
    const bool obeyed = receive(bytes, size, now_us);
    finder_.clear();
    return obeyed;
  }

  /// Call it in every round of the main loop, after all received bytes have been processed: a round that took long
  /// delays bytes in the receive buffer, which is not a pause on the line. Stops the wheels after the time-out.
  void update(uint32_t now_us) {
    if (now_us - last_byte_us_ > kPauseUs) finder_.clear();
    end_after_time_out(now_us);
  }

  /// Speeds to drive with now. Zero at the start, after a stop, after the time-out, and if the last packet does not
  /// contain this robot.
  WheelSpeeds wheels() const { return wheels_; }
  /// False at the start and after the time-out.
  bool has_link() const { return has_link_; }
  uint8_t id() const { return id_; }
  /// Share of the sender's packets that arrived, in percent, over the last 64; kLinkNotMeasured before.
  uint8_t link_percent() const { return link_percent_; }

 private:
  static constexpr uint8_t kPacketsPerMeasurement = 64;  // one to two seconds

  bool obey(uint32_t now_us) {
    if (finder_.team() != team_) return false;
    // Newer: by 1 to 127, modulo 256. Repeated packets and packets out of order have no effect, except a stop.
    const uint8_t step = static_cast<uint8_t>(finder_.sequence() - sequence_);
    const bool is_newer = !has_link_ || (step >= 1 && step <= 127);
    if (!is_newer && !finder_.is_stop()) return false;
    if (is_newer) {
      if (has_link_) count_packets(step);
      sequence_ = finder_.sequence();
      has_link_ = true;
    }
    last_obeyed_us_ = now_us;
    wheels_ = finder_.is_stop() ? WheelSpeeds{0, 0} : finder_.speeds_of(id_);
    return true;
  }

  void end_after_time_out(uint32_t now_us) {
    if (!has_link_ || now_us - last_obeyed_us_ < kTimeOutUs) return;
    has_link_ = false;  // accepts any sequence number
    wheels_ = {0, 0};
    link_percent_ = kLinkNotMeasured;
    sent_ = received_ = 0;
  }

  void count_packets(uint8_t step) {
    sent_ = static_cast<uint8_t>(sent_ + step);
    ++received_;
    if (sent_ < kPacketsPerMeasurement) return;
    link_percent_ = static_cast<uint8_t>(static_cast<uint16_t>(received_) * 100 / sent_);
    sent_ = received_ = 0;
  }

  PacketFinder finder_;
  WheelSpeeds wheels_ = {0, 0};
  uint32_t last_byte_us_ = 0, last_obeyed_us_ = 0;
  uint8_t id_, team_;
  uint8_t sequence_ = 0;  // of the last packet that was newer
  bool has_link_ = false;
  uint8_t sent_ = 0, received_ = 0;  // packets of this measurement
  uint8_t link_percent_ = kLinkNotMeasured;
};

/// Telemetry: battery and link, about twice a second. The time between packets is 400 to 600 ms, pseudo-random and
/// different for each robot, so that two robots do not always send at the same moment.
///
///   uint8_t packet[kTelemetryBytes];
///   if (telemetry.is_due(micros())) send(telemetry.write(battery_mv, robot.link_percent(), packet), kTelemetryBytes);
class Telemetry {
 public:
  explicit Telemetry(uint8_t id) : random_(static_cast<uint16_t>(40503U * (id + 1U))), id_(id) {}

  bool is_due(uint32_t now_us) {
    if (now_us - last_us_ < wait_us_) return false;
    last_us_ = now_us;
    random_ = static_cast<uint16_t>(25173U * random_ + 13849U);  // linear congruential generator, period 65536
    wait_us_ = 400000 + static_cast<uint32_t>(3) * random_;
    return true;
  }

  /// `battery_mv`: 0 if it is not measured. `link_percent`: 0 to 100 or kLinkNotMeasured. Returns `out`.
  const uint8_t* write(uint16_t battery_mv, uint8_t link_percent, uint8_t (&out)[kTelemetryBytes]) {
    out[0] = 'T';
    out[1] = 'R';
    out[2] = 1;
    out[3] = id_;
    out[4] = sequence_++;
    out[5] = static_cast<uint8_t>(battery_mv & 0xFF);
    out[6] = static_cast<uint8_t>(battery_mv >> 8);
    out[7] = link_percent;
    const uint16_t crc = crc_of(out, 8);
    out[8] = static_cast<uint8_t>(crc & 0xFF);
    out[9] = static_cast<uint8_t>(crc >> 8);
    return out;
  }

 private:
  uint32_t last_us_ = 0, wait_us_ = 400000;
  uint16_t random_;
  uint8_t id_, sequence_ = 0;
};

// From speeds to motors.

inline int16_t saturated(int32_t value) {
  return static_cast<int16_t>(value > 32767 ? 32767 : value < -32767 ? -32767 : value);
}

/// Wheel speeds for a speed of the robot's center in mm/s and a turn rate in milliradians per second, positive
/// counter-clockwise. `track_mm`: distance between the wheels. For firmware that also drives by itself.
inline WheelSpeeds wheels_from_twist(int16_t v_mmps, int32_t w_mradps, uint16_t track_mm) {
  // 100 rad/s and 1 m have 10^8, far below the limit of 32 bits.
  const int32_t w = w_mradps > 100000 ? 100000 : w_mradps < -100000 ? -100000 : w_mradps;
  const int32_t track = track_mm > 1000 ? 1000 : track_mm;
  const int32_t difference = w * track / 2000;
  return {saturated(v_mmps - difference), saturated(v_mmps + difference)};
}

/// Scales both speeds by the same factor if one of them is above the maximum (above 0), so that the robot stays on its
/// curve.
inline WheelSpeeds limited(WheelSpeeds wheels, int16_t max_mmps) {
  const int32_t left = wheels.left_mmps, right = wheels.right_mmps;
  const int32_t fast_left = left < 0 ? -left : left, fast_right = right < 0 ? -right : right;
  const int32_t fastest = fast_left > fast_right ? fast_left : fast_right;
  if (fastest <= max_mmps) return wheels;
  return {static_cast<int16_t>(left * max_mmps / fastest), static_cast<int16_t>(right * max_mmps / fastest)};
}

/// The PWM value of a motor, -255 to 255, without a speed sensor. `full_mmps`: speed of the rim at 255, above 0.
/// `start_pwm`: the smallest value at which the wheel turns; smaller ones are skipped. Speed 0 gives 0.
inline int16_t pwm_from_speed(int16_t speed_mmps, int16_t full_mmps, uint8_t start_pwm) {
  if (speed_mmps == 0) return 0;
  const int32_t speed = speed_mmps < 0 ? -static_cast<int32_t>(speed_mmps) : speed_mmps;
  int32_t pwm = start_pwm + (255 - start_pwm) * speed / full_mmps;
  if (pwm > 255) pwm = 255;
  return static_cast<int16_t>(speed_mmps < 0 ? -pwm : pwm);
}

/// Turns of the wheel per second, to compare with an encoder.
inline float turns_per_second(int16_t speed_mmps, float wheel_diameter_mm) {
  return static_cast<float>(speed_mmps) / (3.14159265f * wheel_diameter_mm);
}

}  // namespace touchline_robot
