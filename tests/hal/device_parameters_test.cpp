#include "hal/device_parameters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

namespace touchline::hal {
namespace {

/// Collects all keys and checks that each default is valid.
struct Checker {
  std::set<std::string> keys;

  void add(const Key& key) {
    EXPECT_TRUE(keys.insert(std::string(key.name)).second) << key.name << " twice";
    EXPECT_FALSE(key.help.empty()) << key.name;
  }
  template <class Number>
  void number(Number& value, const Key& key) {
    add(key);
    EXPECT_GE(static_cast<double>(value), key.range.low) << key.name;
    EXPECT_LE(static_cast<double>(value), key.range.high) << key.name;
  }
  template <class Enum, class Choices>
  void choice(Enum& value, const Choices& choices, const Key& key) {
    add(key);
    const auto is = [&](const Choice<Enum>& choice) { return choice.value == value; };
    EXPECT_EQ(std::count_if(choices.begin(), choices.end(), is), 1) << key.name;
    std::set<std::string_view> words;
    for (const Choice<Enum>& choice : choices) EXPECT_TRUE(words.insert(choice.word).second) << choice.word;
  }
  void flag(const bool&, const Key& key) { add(key); }
  void text(const std::string& value, const Key& key) {
    add(key);
    // Only devices in a network have them.
    if (key.name == "address" || key.name == "control" || key.name == "interface") return;
    EXPECT_FALSE(value.empty()) << key.name;
  }
  template <class Container>
  void numbers(const Container&, const Key& key) {
    add(key);
  }
  template <class Container>
  void list(const Container&, const Key& key) {
    add(key);
  }
};

template <class Settings>
std::set<std::string> checked_keys() {
  Checker checker;
  Settings settings;
  Settings::describe(settings, checker);
  return checker.keys;
}

// The keys that docs/files.md lists.
TEST(DeviceParameters, DefaultsAreValidAndKeysAreTheDocumentedOnes) {
  EXPECT_EQ(checked_keys<CameraSettings>(),
            (std::set<std::string>{"backend", "device", "format", "width_px", "height_px", "rate_hz", "buffers",
                                   "exposure_us", "exposure_steps", "gain", "white_balance_k", "focus", "power_line",
                                   "lockstep", "poses", "address", "control", "interface", "source_delay_s"}));
  EXPECT_EQ(checked_keys<RadioSettings>(),
            (std::set<std::string>{"backend", "device", "baud", "address", "port", "local_port", "interface",
                                   "time_to_live", "robots", "more", "delay_s", "telemetry", "low_battery_v"}));
  EXPECT_EQ(checked_keys<GpioSettings>(),
            (std::set<std::string>{"backend", "chip", "status_led_line", "strobe_line", "emergency_stop_line",
                                   "emergency_stop_active_low", "emergency_stop_bias", "start_line", "start_active_low",
                                   "start_bias", "debounce_s"}));
}

}  // namespace
}  // namespace touchline::hal
