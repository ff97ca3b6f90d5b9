// A Touchline robot with an Arduino Uno or Nano (ATmega328P, 16 MHz) and two motors.
//
// Commands arrive at the serial port (pins 0 and 1, 115200 baud), from a radio module that passes bytes on (XBee in
// transparent mode, HC-12, a cable). With USE_NRF24 1 they arrive by an nRF24L01+ instead, from the sketch
// arduino_dongle; this needs the library RF24.
//
// Pins of the motor driver (TB6612FNG, L298N and similar ones): one for forward, one for backward, one for PWM.
//                 left  right
//   forward         2      5
//   backward        4      6
//   PWM             9     10
// nRF24: CE at 7, CSN at 8, SCK, MOSI and MISO at 13, 11 and 12. Battery: a divider of 2:1 at A0 (at most 10 V).
//
// tests/robot runs this sketch on a simulated ATmega328P.

#ifndef USE_NRF24
#define USE_NRF24 0
#endif
#ifndef ROBOT_ID
#define ROBOT_ID 0  // 0 to 127, different for each robot
#endif
#ifndef TEAM_NUMBER
#define TEAM_NUMBER 0  // team_number of the team file; 0: no number
#endif

#include <Arduino.h>
#include <touchline_robot.h>
#if USE_NRF24
#include <RF24.h>
#include <SPI.h>
#endif

// Measure these two with the wheels in the air, and correct them on the field.
const int16_t kFullSpeedMmps = 1500;  // speed of the wheel's rim at PWM 255
const uint8_t kStartPwm = 30;         // smallest PWM value at which the wheel turns

struct Motor {
  uint8_t forward_pin, backward_pin, pwm_pin;
};
const Motor kLeftMotor = {2, 4, 9}, kRightMotor = {5, 6, 10};
const uint8_t kBatteryPin = A0;
const uint16_t kBatteryFullScaleMv = 10000;  // at the divider's input for 5 V at A0

touchline_robot::Robot robot(ROBOT_ID, TEAM_NUMBER);
touchline_robot::Telemetry telemetry(ROBOT_ID);

void drive(const Motor& motor, int16_t speed_mmps) {
  const int16_t pwm = touchline_robot::pwm_from_speed(speed_mmps, kFullSpeedMmps, kStartPwm);
  digitalWrite(motor.forward_pin, pwm > 0 ? HIGH : LOW);
  digitalWrite(motor.backward_pin, pwm < 0 ? HIGH : LOW);
  analogWrite(motor.pwm_pin, abs(pwm));
}

void set_up(const Motor& motor) {
  pinMode(motor.forward_pin, OUTPUT);
  pinMode(motor.backward_pin, OUTPUT);
  pinMode(motor.pwm_pin, OUTPUT);
  drive(motor, 0);
}

uint16_t battery_mv() {
  return static_cast<uint16_t>(static_cast<uint32_t>(analogRead(kBatteryPin)) * kBatteryFullScaleMv / 1023);
}

#if USE_NRF24

RF24 radio(7, 8);
// All robots listen at the same address; the packet says for whom it is. The same values are in arduino_dongle.
const uint8_t kToRobots[5] = {'T', 'L', 'c', 'm', 'd'}, kFromRobots[5] = {'T', 'L', 't', 'e', 'l'};
const uint8_t kChannel = 76;  // 2.476 GHz
const uint8_t kPayloadBytes = 32;

void set_up_radio() {
  radio.begin();
  radio.setChannel(kChannel);
  radio.setDataRate(RF24_1MBPS);
  radio.setPayloadSize(kPayloadBytes);
  radio.setAutoAck(false);  // all robots receive the same packet, so none of them acknowledges it
  radio.openWritingPipe(kFromRobots);
  radio.openReadingPipe(1, kToRobots);
  radio.startListening();
}

// A packet is longer than a payload: it arrives as one or two payloads, filled up with zeros.
void receive_commands() {
  uint8_t payload[kPayloadBytes];
  while (radio.available()) {
    radio.read(payload, kPayloadBytes);
    robot.receive(payload, kPayloadBytes, micros());
  }
}

void send_telemetry(const uint8_t* bytes) {
  uint8_t payload[kPayloadBytes] = {};
  memcpy(payload, bytes, touchline_robot::kTelemetryBytes);
  radio.stopListening();
  radio.write(payload, kPayloadBytes);
  radio.startListening();
}

#else

void set_up_radio() { Serial.begin(115200); }

void receive_commands() {
  while (Serial.available() > 0) robot.receive(static_cast<uint8_t>(Serial.read()), micros());
}

// The packet fits into the transmit buffer, so this does not wait.
void send_telemetry(const uint8_t* bytes) { Serial.write(bytes, touchline_robot::kTelemetryBytes); }

#endif

void setup() {
  set_up(kLeftMotor);
  set_up(kRightMotor);
  set_up_radio();
}

void loop() {
  receive_commands();
  robot.update(micros());
  drive(kLeftMotor, robot.wheels().left_mmps);
  drive(kRightMotor, robot.wheels().right_mmps);
  if (telemetry.is_due(micros())) {
    uint8_t packet[touchline_robot::kTelemetryBytes];
    send_telemetry(telemetry.write(battery_mv(), robot.link_percent(), packet));
  }
}
