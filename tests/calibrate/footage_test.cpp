#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/region/region_scanner.h"
#include "hal/replay/replay_camera.h"
#include "tests/results.h"
#include "tools/programs/calibrate/imaging/camera_picture.h"
#include "tools/programs/calibrate/venue/venue_draft.h"

// Learns the colors of tests/footage from other pictures of the same set and checks annotated pictures: each patch must
// have a region of the right color. Other tests check the matching.
namespace touchline::calibrate {
namespace {

struct Case {
  const char* venue;
  const char* annotation;
  std::size_t team_patches, identifications;  // number of annotated patches that were found within kNear_px
  std::size_t all_team_patches, all_identifications;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.venue; }

// Error of the annotation plus half a pixel of chroma, or an outline that merges with a neighbor.
constexpr double kNear_px = 2.0;
constexpr std::uint32_t kMinArea_px = 6;

class Footage : public ::testing::TestWithParam<Case> {};

std::string venue_color(const std::string& annotated) {
  static const std::map<std::string, std::string> names = {
      {"cyan-green", "mint"}, {"red-brown", "brown"}, {"grey-purple", "grey"}};
  const auto found = names.find(annotated);
  return found == names.end() ? annotated : found->second;
}

ScanParameters scan_of(const VenueDraft& venue, const Frame& frame, std::map<std::string, ColorId>& id) {
  ScanParameters parameters;
  parameters.format = frame.format;
  parameters.width_px = frame.width_px;
  parameters.height_px = frame.height_px;
  parameters.region_of_interest = venue.region_of_interest;
  parameters.light = venue.light;
  for (const auto& color : venue.file.color) {
    const auto number = static_cast<ColorId>(id.size() + 1);
    id[color.name] = number;
    for (const auto& box : color.box) parameters.boxes.push_back({number, box.low, box.high});
  }
  return parameters;
}

TEST_P(Footage, HasARegionAtEveryPatch) {
  const char* shared = std::getenv("TOUCHLINE_SHARED");  // NOLINT(concurrency-mt-unsafe): one thread
  if (shared == nullptr) GTEST_SKIP() << "TOUCHLINE_SHARED does not name the folder with footage/";
  const std::string folder = std::string(shared) + "/footage/annotated/";
  std::ifstream file(folder + GetParam().annotation);
  ASSERT_TRUE(file) << folder << GetParam().annotation;
  const auto annotation = nlohmann::json::parse(file);

  const std::string venue_path = std::string(TOUCHLINE_FOOTAGE_TESTS) + "/" + GetParam().venue + "-venue.toml";
  const Result<VenueDraft> draft = read_draft(venue_path);
  ASSERT_TRUE(draft.ok()) << draft.text();
  const VenueDraft& venue = draft.value();
  ASSERT_TRUE(venue.exists) << venue_path;
  const PixelFormat format = hal::replay_format(venue.file.colors.space);
  const Result<CameraPicture> loaded = CameraPicture::load(folder + annotation["image"].get<std::string>(), format);
  ASSERT_TRUE(loaded.ok()) << loaded.text();
  const CameraPicture& picture = loaded.value();

  std::map<std::string, ColorId> id;
  const ScanParameters parameters = scan_of(venue, picture.frame(), id);
  const auto scanner = std::make_unique<RegionScanner>();
  const auto runs = std::make_unique<Runs>();
  const auto regions = std::make_unique<Regions>();
  ASSERT_TRUE(scanner->configure(parameters).ok());
  ASSERT_TRUE(scanner->scan(picture.frame(), *runs, *regions).ok());

  const auto seen = [&](const std::string& color, const nlohmann::json& center) {
    double nearest = 1e9;
    for (const Region& region : *regions) {
      if (region.color != id.at(color) || region.area_px < kMinArea_px) continue;
      nearest = std::min(nearest, std::hypot(static_cast<double>(region.centroid.u_px) - center[0].get<double>(),
                                             static_cast<double>(region.centroid.v_px) - center[1].get<double>()));
    }
    if (nearest > kNear_px) {
      RecordProperty("missed", color);
      std::printf("  %s at %.0f, %.0f: nearest %.1f px\n", color.c_str(), center[0].get<double>(),
                  center[1].get<double>(), std::min(nearest, 999.0));
    }
    return nearest <= kNear_px;
  };
  std::size_t balls = 0, teams = 0, identifications = 0, all_teams = 0, all_identifications = 0;
  for (const auto& object : annotation["objects"]) {
    if (object["type"] == "ball") {
      balls += seen("orange", object["centre"]) ? 1U : 0U;
      continue;
    }
    ++all_teams;
    teams += seen(object["team"].get<std::string>(), object["team_patch"]) ? 1U : 0U;
    for (const auto& patch : object["id_patches"]) {
      ++all_identifications;
      identifications += seen(venue_color(patch["colour"].get<std::string>()), patch["centre"]) ? 1U : 0U;
    }
  }
  EXPECT_EQ(balls, 1U);
  EXPECT_EQ(all_teams, GetParam().all_team_patches);
  EXPECT_EQ(all_identifications, GetParam().all_identifications);
  EXPECT_EQ(teams, GetParam().team_patches);
  EXPECT_EQ(identifications, GetParam().identifications);
}

// Learns colors in one of 502 frames: stationary patches must keep their regions although the light flickers and a dark
// stick passes over them.
TEST(FootageVideo, StationaryPatchesKeepTheirRegions) {
  const char* shared = std::getenv("TOUCHLINE_SHARED");  // NOLINT(concurrency-mt-unsafe): one thread
  if (shared == nullptr) GTEST_SKIP() << "TOUCHLINE_SHARED does not name the folder with footage/";
  const Result<VenueDraft> draft = read_draft(std::string(TOUCHLINE_FOOTAGE_TESTS) + "/vss-overhead-venue.toml");
  ASSERT_TRUE(draft.ok()) << draft.text();
  const VenueDraft& venue = draft.value();
  hal::ReplayCamera camera({std::string(shared) + "/footage/vss-overhead.mp4", PixelFormat::kRgb24, 0.0});
  ASSERT_OK(camera.open());
  ASSERT_OK(camera.start());
  const auto scanner = std::make_unique<RegionScanner>();
  const auto runs = std::make_unique<Runs>();
  const auto regions = std::make_unique<Regions>();
  std::map<std::string, ColorId> id;
  // These patches are completely visible; the window cuts off half of the fifth robot's red patch.
  const std::map<std::string, std::size_t> expected = {{"yellow", 2}, {"red", 1},   {"pink", 2},
                                                       {"blue", 3},   {"green", 1}, {"orange", 1}};
  constexpr std::uint32_t kPatchArea_px = 35;
  std::map<std::string, std::size_t> as_expected;
  std::size_t frames = 0;
  while (true) {
    const Result<hal::FrameLease> lease = camera.wait(Instant::max());
    if (!lease.ok()) break;
    const Frame& frame = lease.value().frame();
    if (frames == 0) {
      ASSERT_TRUE(scanner->configure(scan_of(venue, frame, id)).ok());
    }
    ++frames;
    ASSERT_TRUE(scanner->scan(frame, *runs, *regions).ok());
    for (const auto& [color, count] : expected) {
      std::size_t seen = 0;
      for (const Region& region : *regions)
        seen += region.color == id.at(color) && region.area_px >= kPatchArea_px ? 1U : 0U;
      as_expected[color] += seen == count ? 1U : 0U;
    }
  }
  EXPECT_EQ(frames, 502U);
  for (const auto& [color, count] : as_expected) {
    // The stick covers the blue patch of the pushed robot in eight frames.
    EXPECT_EQ(count, color == "blue" ? 494U : 502U) << color;
  }
}

INSTANTIATE_TEST_SUITE_P(Sets, Footage,
                         ::testing::Values(Case{"vsss-bar-normal", "danhega_outputs_24.json", 6, 11, 6, 12},
                                           Case{"vsss-bar-dark", "danhega_outputs3_8.json", 6, 12, 6, 12},
                                           Case{"vsss-halves", "rinobot_2736.json", 6, 6, 6, 6},
                                           Case{"mirosot-triangles", "agh_b_white1.json", 10, 17, 10, 20}));

}  // namespace
}  // namespace touchline::calibrate
