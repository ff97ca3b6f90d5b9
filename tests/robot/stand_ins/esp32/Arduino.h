#pragma once

// Stand-ins for the headers of Arduino-ESP32: the names, parameters and return types that the sketches in
// tools/robot/examples use, written from its documentation. They show that the sketches compile, not that they work.
// ESP_ARDUINO_VERSION_MAJOR, 2 or 3, is set by the compiler's command line.
#include <cstddef>
#include <cstdint>
#include <cstring>

constexpr std::uint8_t LOW = 0, HIGH = 1, OUTPUT = 3;

void pinMode(std::uint8_t pin, std::uint8_t mode);
void digitalWrite(std::uint8_t pin, std::uint8_t value);
void analogWrite(std::uint8_t pin, int value);
std::uint32_t analogReadMilliVolts(std::uint8_t pin);
unsigned long micros();
void delay(std::uint32_t milliseconds);

class HardwareSerial {
 public:
  void begin(unsigned long baud);
  int available();
  int read();
  std::size_t write(const std::uint8_t* bytes, std::size_t size);
};
extern HardwareSerial Serial;

// FreeRTOS.
using QueueHandle_t = struct QueueDefinition*;
using BaseType_t = int;
using UBaseType_t = unsigned;
using TickType_t = std::uint32_t;
constexpr BaseType_t pdTRUE = 1;
QueueHandle_t xQueueCreate(UBaseType_t length, UBaseType_t item_size);
BaseType_t xQueueSend(QueueHandle_t queue, const void* item, TickType_t ticks);
BaseType_t xQueueReceive(QueueHandle_t queue, void* item, TickType_t ticks);

void setup();
void loop();
