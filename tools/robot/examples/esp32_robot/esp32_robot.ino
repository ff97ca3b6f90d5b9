// A Touchline robot with an ESP32 and two motors. NOT RUN ON HARDWARE: tests/robot only compiles this sketch, against
// small stand-ins for the headers of Arduino-ESP32 (versions 2 and 3) that Touchline's authors wrote themselves.
//
// USE_ESP_NOW 0: commands arrive as UDP datagrams in a wireless network.
// USE_ESP_NOW 1: they arrive by ESP-NOW, without an access point, from the sketch esp32_dongle.
//
// Pins of the motor driver (TB6612FNG, L298N and similar ones): one for forward, one for backward, one for PWM.
//                 left  right
//   forward        16     18
//   backward       17     19
//   PWM            25     26
// Battery: a divider of 4:1 at 34 (at most 12 V).

#ifndef USE_ESP_NOW
#define USE_ESP_NOW 0
#endif
#ifndef ROBOT_ID
#define ROBOT_ID 0  // 0 to 127, different for each robot
#endif
#ifndef TEAM_NUMBER
#define TEAM_NUMBER 0  // team_number of the team file; 0: no number
#endif

#include <Arduino.h>
#include <WiFi.h>
#include <touchline_robot.h>
#if USE_ESP_NOW
#include <esp_now.h>
#include <esp_wifi.h>
#else
#include <WiFiUdp.h>
#endif

// Measure these two with the wheels in the air, and correct them on the field.
const int16_t kFullSpeedMmps = 1500;  // speed of the wheel's rim at PWM 255
const uint8_t kStartPwm = 30;         // smallest PWM value at which the wheel turns

struct Motor {
  uint8_t forward_pin, backward_pin, pwm_pin;
};
const Motor kLeftMotor = {16, 17, 25}, kRightMotor = {18, 19, 26};
const uint8_t kBatteryPin = 34;
const uint32_t kBatteryDivider = 4;

touchline_robot::Robot robot(ROBOT_ID, TEAM_NUMBER);
touchline_robot::Telemetry telemetry(ROBOT_ID);

struct Datagram {
  uint8_t size;
  uint8_t bytes[touchline_robot::kMaxPacketBytes];
};

void drive(const Motor& motor, int16_t speed_mmps) {
  const int16_t pwm = touchline_robot::pwm_from_speed(speed_mmps, kFullSpeedMmps, kStartPwm);
  digitalWrite(motor.forward_pin, pwm > 0 ? HIGH : LOW);
  digitalWrite(motor.backward_pin, pwm < 0 ? HIGH : LOW);
  analogWrite(motor.pwm_pin, pwm < 0 ? -pwm : pwm);
}

uint32_t now_us() { return static_cast<uint32_t>(micros()); }

void set_up(const Motor& motor) {
  pinMode(motor.forward_pin, OUTPUT);
  pinMode(motor.backward_pin, OUTPUT);
  pinMode(motor.pwm_pin, OUTPUT);
  drive(motor, 0);
}

#if USE_ESP_NOW

const uint8_t kWifiChannel = 1;  // the same in esp32_dongle
const uint8_t kEverybody[6] = {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF};
QueueHandle_t datagrams = nullptr;

// Called by the task of the wireless network, so the bytes go through a queue to loop().
#if ESP_ARDUINO_VERSION_MAJOR >= 3
void on_datagram(const esp_now_recv_info_t*, const uint8_t* bytes, int size) {
#else
void on_datagram(const uint8_t*, const uint8_t* bytes, int size) {
#endif
  Datagram datagram;
  if (size < 1 || size > static_cast<int>(sizeof datagram.bytes)) return;
  datagram.size = static_cast<uint8_t>(size);
  memcpy(datagram.bytes, bytes, datagram.size);
  xQueueSend(datagrams, &datagram, 0);
}

void set_up_radio() {
  datagrams = xQueueCreate(8, sizeof(Datagram));
  WiFi.mode(WIFI_STA);
  WiFi.setSleep(false);
  esp_wifi_set_channel(kWifiChannel, WIFI_SECOND_CHAN_NONE);
  esp_now_init();
  esp_now_peer_info_t everybody = {};
  memcpy(everybody.peer_addr, kEverybody, sizeof kEverybody);
  everybody.channel = kWifiChannel;
  esp_now_add_peer(&everybody);
  esp_now_register_recv_cb(on_datagram);
}

void on_obeyed() {}
bool next_datagram(Datagram& datagram) { return xQueueReceive(datagrams, &datagram, 0) == pdTRUE; }
void send_telemetry(const uint8_t* bytes) { esp_now_send(kEverybody, bytes, touchline_robot::kTelemetryBytes); }

#else

const char* const kNetworkName = "robots";
const char* const kNetworkPassword = "change this";
const uint16_t kPort = 10301;  // to which Touchline sends
WiFiUDP udp;
IPAddress sender;  // of the last command that was obeyed
uint16_t sender_port = 0;

void set_up_radio() {
  WiFi.mode(WIFI_STA);
  WiFi.setSleep(false);                        // otherwise datagrams wait up to 0.1 s for the receiver
  WiFi.begin(kNetworkName, kNetworkPassword);  // connects in the background, and again after a loss
  WiFi.setAutoReconnect(true);
  udp.begin(kPort);
}

bool next_datagram(Datagram& datagram) {
  const int size = udp.parsePacket();
  if (size <= 0) return false;
  const int length = udp.read(datagram.bytes, sizeof datagram.bytes);
  datagram.size = length == size ? static_cast<uint8_t>(length) : 0;
  // The rest of a datagram that is too long for a packet: parsePacket() finds no other one until it has been read.
  uint8_t rest[64];
  while (udp.read(rest, sizeof rest) > 0) {
  }
  return true;
}

void on_obeyed() {
  sender = udp.remoteIP();
  sender_port = udp.remotePort();
}

void send_telemetry(const uint8_t* bytes) {
  if (sender_port == 0) return;
  udp.beginPacket(sender, sender_port);
  udp.write(bytes, touchline_robot::kTelemetryBytes);
  udp.endPacket();
}

#endif

void setup() {
  set_up(kLeftMotor);
  set_up(kRightMotor);
  set_up_radio();
}

void loop() {
  Datagram datagram;
  // At most eight at a time: other people's datagrams must not delay the time-out.
  for (int i = 0; i < 8 && next_datagram(datagram); ++i) {
    if (robot.receive_datagram(datagram.bytes, datagram.size, now_us())) on_obeyed();
  }
  robot.update(now_us());
  drive(kLeftMotor, robot.wheels().left_mmps);
  drive(kRightMotor, robot.wheels().right_mmps);
  if (telemetry.is_due(now_us())) {
    uint8_t packet[touchline_robot::kTelemetryBytes];
    const uint16_t battery_mv = static_cast<uint16_t>(kBatteryDivider * analogReadMilliVolts(kBatteryPin));
    send_telemetry(telemetry.write(battery_mv, robot.link_percent(), packet));
  }
  delay(1);  // lets the other tasks of this core run
}
