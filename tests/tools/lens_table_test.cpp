// Heights and lenses for the leagues' fields, and the tables in the documentation.
#include "tools/programs/devices/lens_table.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "firmware/config/league_fields.h"
#include "tests/results.h"

namespace touchline::devices {
namespace {

TEST(LensTable, TheDocumentationHasTheTablesThatTheProgramPrints) {
  std::ostringstream page;
  page << std::ifstream(TOUCHLINE_DOCS "/raspberry-pi-cameras.md").rdbuf();
  EXPECT_NE(page.str().find(lens_tables(known_sensors())), std::string::npos)
      << "replace the tables in docs/raspberry-pi-cameras.md by the output of `touchline-devices --lens`";
}

TEST(LensTable, TheFieldFillsTheSensorAtTheHeight) {
  const SensorSize sensor{"square pixels", 5.0, 4.0, 1000};
  FieldParameters field = config::league_field("vsss");
  field.length_m = 1.9f;
  field.goal_depth_m = 0.0f;
  field.width_m = 1.0f;
  // 2 m with the margins on 5 mm, a lens of 5 mm: from 2 m above the tallest robot.
  EXPECT_NEAR(camera_height_m(field, sensor, 5.0), 2.0 + kTallest_m, 1e-6);
  EXPECT_NEAR(pixels_per_meter(field, sensor), 500.0, 1e-3);
  field.width_m = 3.1f;  // now the width decides
  EXPECT_NEAR(camera_height_m(field, sensor, 4.0), 3.2 + kTallest_m, 1e-6);
  EXPECT_NEAR(pixels_per_meter(field, sensor), 1000.0 / 5.0 * 4.0 / 3.2, 1e-3);
}

TEST(LensTable, AnOwnSensorIsRead) {
  const Result<SensorSize> sensor = parse_sensor("4.8x3.6,640");
  ASSERT_OK(sensor);
  EXPECT_EQ(sensor.value().columns, 640u);
  EXPECT_EQ(sensor.value().width_mm, 4.8);
  for (const char* wrong : {"", "4.8", "4.8x3.6", "4.8x3.6,640px", "0x3,640", "nanx3,640", "4.8x3.6,0"}) {
    EXPECT_EQ(parse_sensor(wrong).code(), ErrorCode::kInconsistent) << wrong;
  }
}

}  // namespace
}  // namespace touchline::devices
