#include "core/identification/drive_record.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace touchline
