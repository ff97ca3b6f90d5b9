// The sender's end of ESP-NOW: an ESP32 at the USB port of Touchline's computer. It passes packets from the serial port
// (115200 baud) to the robots with the sketch esp32_robot (USE_ESP_NOW 1), and their telemetry back. NOT RUN ON
// HARDWARE: tests/robot only compiles this sketch, against small stand-ins for the headers of Arduino-ESP32 (versions 2
// and 3) that Touchline's authors wrote themselves.

#include <Arduino.h>
#include <WiFi.h>
#include <esp_now.h>
#include <esp_wifi.h>
#include <touchline_robot.h>

const uint8_t kWifiChannel = 1;  // the same in esp32_robot
const uint8_t kEverybody[6] = {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF};

struct Report {
  uint8_t bytes[touchline_robot::kTelemetryBytes];
};

touchline_robot::PacketFinder finder;
uint32_t last_byte_us = 0;
QueueHandle_t reports = nullptr;

// Called by the task of the wireless network, so the bytes go through a queue to loop().
#if ESP_ARDUINO_VERSION_MAJOR >= 3
void on_datagram(const esp_now_recv_info_t*, const uint8_t* bytes, int size) {
#else
void on_datagram(const uint8_t*, const uint8_t* bytes, int size) {
#endif
  Report report;
  if (size != static_cast<int>(sizeof report.bytes)) return;
  memcpy(report.bytes, bytes, sizeof report.bytes);
  xQueueSend(reports, &report, 0);
}

void setup() {
  Serial.begin(115200);
  reports = xQueueCreate(16, sizeof(Report));
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

void loop() {
  // One datagram for each packet: robots do not have to put parts together.
  while (Serial.available() > 0) {
    finder.add(static_cast<uint8_t>(Serial.read()));
    last_byte_us = static_cast<uint32_t>(micros());
    while (finder.find()) esp_now_send(kEverybody, finder.bytes(), finder.size());
  }
  if (static_cast<uint32_t>(micros()) - last_byte_us > touchline_robot::kPauseUs) finder.clear();
  Report report;
  while (xQueueReceive(reports, &report, 0) == pdTRUE) Serial.write(report.bytes, sizeof report.bytes);
}
