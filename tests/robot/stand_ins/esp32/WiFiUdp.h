#pragma once

#include <WiFi.h>
#include <cstddef>
#include <cstdint>

class WiFiUDP {
 public:
  std::uint8_t begin(std::uint16_t port);
  int parsePacket();
  int read(unsigned char* bytes, std::size_t size);
  IPAddress remoteIP();
  std::uint16_t remotePort();
  int beginPacket(IPAddress address, std::uint16_t port);
  std::size_t write(const std::uint8_t* bytes, std::size_t size);
  int endPacket();
};
