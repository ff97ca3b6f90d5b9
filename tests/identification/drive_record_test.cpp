#include "core/identification/drive_record.h"

#include <gtest/gtest.h>

#include "core/identification/drive_intervals.h"

namespace touchline {
namespace {

Instant instant_at(int milliseconds) { return Instant{} + std::chrono::milliseconds(milliseconds); }

TEST(DriveRecord, RefusesWhatIsNotNewerOrNotFinite) {
  DriveRecord record;
  EXPECT_TRUE(record.add_command(instant_at(10), {0.1f, 0.2f}));
  EXPECT_FALSE(record.add_command(instant_at(10), {0.3f, 0.4f}));
  EXPECT_FALSE(record.add_command(instant_at(20), {std::nanf(""), 0.0f}));
  EXPECT_TRUE(record.add_sighting(instant_at(10), {{0.1f, 0.2f}, 0.3f}));
  EXPECT_FALSE(record.add_sighting(instant_at(9), {{0.1f, 0.2f}, 0.3f}));
  EXPECT_FALSE(record.add_sighting(instant_at(20), {{0.1f, INFINITY}, 0.3f}));
  EXPECT_EQ(record.commands_end(), 1U);
  EXPECT_EQ(record.sightings_end(), 1U);
}

TEST(DriveRecord, OverwritesTheOldest) {
  DriveRecord record;
  constexpr int kExtra = 3, kAll = static_cast<int>(DriveRecord::kCapacity) + kExtra;
  for (int i = 0; i < kAll; ++i) record.add_sighting(instant_at(i), {{static_cast<float>(i), 0.0f}, 0.0f});
  EXPECT_EQ(record.sightings_begin(), static_cast<std::uint64_t>(kExtra));
  EXPECT_EQ(record.sightings_end(), static_cast<std::uint64_t>(kAll));
  EXPECT_EQ(record.sighting(record.sightings_begin()).pose.position.x_m, static_cast<float>(kExtra));
  EXPECT_EQ(record.sighting(record.sightings_end() - 1).pose.position.x_m, static_cast<float>(kAll - 1));
}

// Wheels with a lag of 80 ms, commanded 0.3 m/s for half a second and more before each sighting that is read.
TEST(DriveIntervals, KnowsTheWheelsSpeedAtTheBeginAndAfterGaps) {
  constexpr int kFrame = 16, kSeen = 10'000, kLost = 10'160, kFound = 15'000, kEnd = 15'160;
  DriveRecord record;
  for (int t = 0; t < kEnd; t += kFrame) ASSERT_TRUE(record.add_command(instant_at(t), {0.3f, 0.3f}));
  for (int t = kSeen; t < kEnd; t += kFrame) {
    if (t >= kLost && t < kFound) continue;
    ASSERT_TRUE(record.add_sighting(instant_at(t), {{0.3f * 1e-3f * static_cast<float>(t), 0.0f}, 0.0f}));
  }
  DriveIntervals reader(record, 0.02, {{{0.08, 0.0}, {0.08, 0.0}}}, {});
  DriveInterval interval;
  int usable = 0, gaps = 0;
  while (reader.next(record, interval)) {
    ++(interval.is_usable ? usable : gaps);
    if (!interval.is_usable) continue;
    EXPECT_NEAR(interval.wheels[0].distance_m, interval.forward_m, 2e-5) << usable;
  }
  EXPECT_EQ(gaps, 1);
  EXPECT_EQ(usable, 18);
}

TEST(DriveIntervals, DoesNotUseWheelsWhoseFormerCommandsAreUnknown) {
  DriveRecord record;
  for (int t = 0; t <= 1000; t += 20) {
    ASSERT_TRUE(record.add_sighting(instant_at(t), {}));
    ASSERT_TRUE(record.add_command(instant_at(t), {0.3f, 0.3f}));
  }
  DriveIntervals reader(record, 0.02, {{{0.08, 0.0}, {0.08, 0.0}}}, {});
  DriveInterval interval;
  // Delay and six lags: 500 ms.
  for (int t = 0; t < 1000; t += 20) {
    ASSERT_TRUE(reader.next(record, interval));
    EXPECT_EQ(interval.is_usable, t >= 500) << t;
  }
}

}  // namespace
}  // namespace touchline
