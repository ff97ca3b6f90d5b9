#pragma once

class IPAddress {};

enum wifi_mode_t { WIFI_STA = 1 };

class WiFiClass {
 public:
  bool mode(wifi_mode_t mode);
  bool setSleep(bool enabled);
  bool setAutoReconnect(bool enabled);
  int begin(const char* name, const char* password);
};
extern WiFiClass WiFi;
