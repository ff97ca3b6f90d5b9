// The sender's end of an nRF24L01+: passes Touchline's packets from the serial port (115200 baud) to the robots with
// the sketch arduino_robot (USE_NRF24 1), and their telemetry back. Needs the library RF24.
//
// Arduino Uno or Nano, connected to Touchline's computer by USB. CE at 7, CSN at 8, SCK, MOSI and MISO at 13, 11, 12.
//
// tests/robot only compiles this sketch, against a stand-in for RF24; nobody has run it on hardware yet.

#include <Arduino.h>
#include <RF24.h>
#include <SPI.h>
#include <touchline_robot.h>

// The same values are in arduino_robot.
const uint8_t kToRobots[5] = {'T', 'L', 'c', 'm', 'd'}, kFromRobots[5] = {'T', 'L', 't', 'e', 'l'};
const uint8_t kChannel = 76;  // 2.476 GHz
const uint8_t kPayloadBytes = 32;

RF24 radio(7, 8);
touchline_robot::PacketFinder finder;
uint32_t last_byte_us = 0;

// Whole packets only: robots drop a packet whose parts arrive more than 2 ms apart, and the serial port needs 3 ms for
// 32 bytes.
void send_packet(const uint8_t* bytes, uint8_t size) {
  radio.stopListening();
  for (uint8_t begin = 0; begin < size; begin += kPayloadBytes) {
    uint8_t payload[kPayloadBytes] = {};
    memcpy(payload, bytes + begin, min(size - begin, static_cast<int>(kPayloadBytes)));
    radio.write(payload, kPayloadBytes);
  }
  radio.startListening();
}

void setup() {
  Serial.begin(115200);
  radio.begin();
  radio.setChannel(kChannel);
  radio.setDataRate(RF24_1MBPS);
  radio.setPayloadSize(kPayloadBytes);
  radio.setAutoAck(false);
  radio.openWritingPipe(kToRobots);
  radio.openReadingPipe(1, kFromRobots);
  radio.startListening();
}

void loop() {
  while (Serial.available() > 0) {
    finder.add(static_cast<uint8_t>(Serial.read()));
    last_byte_us = micros();
    while (finder.find()) send_packet(finder.bytes(), finder.size());
  }
  if (micros() - last_byte_us > touchline_robot::kPauseUs) finder.clear();
  if (radio.available()) {
    uint8_t payload[kPayloadBytes];
    radio.read(payload, kPayloadBytes);
    Serial.write(payload, touchline_robot::kTelemetryBytes);
  }
}
