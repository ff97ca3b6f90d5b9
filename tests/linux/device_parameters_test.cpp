#include "hal/device_parameters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

namespace touchline::hal {
namespace {

/// Notes every key and checks that the default is one that the file may hold.
struct Checker {
  std::set<std::string> keys;

  void add(std::string_view key, std::string_view help) {
    EXPECT_TRUE(keys.insert(std::string(key)).second) << key << " twice";
    EXPECT_FALSE(help.empty()) << key;
  }
  template <class Number>
  void number(std::string_view key, Number& value, Range range, std::string_view, std::string_view help) {
    add(key, help);
    EXPECT_GE(static_cast<double>(value), range.low) << key;
    EXPECT_LE(static_cast<double>(value), range.high) << key;
  }
  template <class Enum>
  void choice(std::string_view key, Enum& value, std::span<const Choice<Enum>> choices, std::string_view help) {
    add(key, help);
    const auto is = [&](const Choice<Enum>& choice) { return choice.value == value; };
    EXPECT_EQ(std::count_if(choices.begin(), choices.end(), is), 1) << key;
    std::set<std::string_view> words;
    for (const Choice<Enum>& choice : choices) EXPECT_TRUE(words.insert(choice.word).second) << choice.word;
  }
  void flag(std::string_view key, const bool&, std::string_view help) { add(key, help); }
  void text(std::string_view key, const std::string& value, std::string_view help) {
    add(key, help);
    EXPECT_FALSE(value.empty()) << key;
  }
};

template <class Settings>
std::set<std::string> checked_keys() {
  Checker checker;
  Settings settings;
  Settings::describe(settings, checker);
  return checker.keys;
}

// The keys of docs/files.md.
TEST(DeviceParameters, DefaultsAreValidAndKeysAreTheDocumentedOnes) {
  EXPECT_EQ(checked_keys<CameraSettings>(),
            (std::set<std::string>{"backend", "device", "format", "width_px", "height_px", "rate_hz", "buffers",
                                   "exposure_us", "exposure_steps", "gain", "white_balance_k", "focus", "power_line"}));
  EXPECT_EQ(checked_keys<RadioSettings>(),
            (std::set<std::string>{"backend", "device", "baud", "delay_s", "telemetry", "low_battery_v"}));
  EXPECT_EQ(checked_keys<GpioSettings>(),
            (std::set<std::string>{"backend", "chip", "status_led_line", "strobe_line", "emergency_stop_line",
                                   "emergency_stop_active_low", "emergency_stop_bias", "start_line", "start_active_low",
                                   "start_bias", "debounce_s"}));
}

}  // namespace
}  // namespace touchline::hal
