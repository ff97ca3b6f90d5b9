#pragma once

#include <cstddef>
#include <cstdint>

using esp_err_t = int;

struct esp_now_peer_info_t {
  std::uint8_t peer_addr[6];
  std::uint8_t lmk[16];
  std::uint8_t channel;
  int ifidx;
  bool encrypt;
  void* priv;
};
#if ESP_ARDUINO_VERSION_MAJOR >= 3
struct esp_now_recv_info_t {
  std::uint8_t* src_addr;
  std::uint8_t* des_addr;
  void* rx_ctrl;
};
using esp_now_recv_cb_t = void (*)(const esp_now_recv_info_t* info, const std::uint8_t* bytes, int size);
#else
using esp_now_recv_cb_t = void (*)(const std::uint8_t* address, const std::uint8_t* bytes, int size);
#endif

esp_err_t esp_now_init();
esp_err_t esp_now_add_peer(const esp_now_peer_info_t* peer);
esp_err_t esp_now_register_recv_cb(esp_now_recv_cb_t callback);
esp_err_t esp_now_send(const std::uint8_t* address, const std::uint8_t* bytes, std::size_t size);
