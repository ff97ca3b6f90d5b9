#pragma once

// Stand-in for the library RF24, with those of its functions that the sketches in tools/robot/examples use: payloads
// arrive at the serial port and leave by it, so that a test can run the sketch on a simulated ATmega328P without a
// simulated nRF24L01+. Channel, speed and addresses have no effect. At 500000 baud a payload takes about as long as on
// the air.
#include <Arduino.h>

enum rf24_datarate_e { RF24_1MBPS, RF24_2MBPS, RF24_250KBPS };

class RF24 {
 public:
  RF24(uint16_t, uint16_t) {}
  bool begin() {
    Serial.begin(500000);
    return true;
  }
  void setChannel(uint8_t) {}
  bool setDataRate(rf24_datarate_e) { return true; }
  void setPayloadSize(uint8_t size) { payload_bytes_ = size; }
  void setAutoAck(bool) {}
  void openWritingPipe(const uint8_t*) {}
  void openReadingPipe(uint8_t, const uint8_t*) {}
  void startListening() { listens_ = true; }
  void stopListening() { listens_ = false; }
  bool available() { return listens_ && Serial.available() >= payload_bytes_; }
  void read(void* bytes, uint8_t size) { Serial.readBytes(static_cast<uint8_t*>(bytes), size); }
  bool write(const void* bytes, uint8_t size) {
    if (listens_) return false;  // as on the air
    Serial.write(static_cast<const uint8_t*>(bytes), size);
    return true;
  }

 private:
  int payload_bytes_ = 32;
  bool listens_ = false;
};
