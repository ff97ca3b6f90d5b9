// Games that are drawn from above.
#include "tools/programs/simulate/game_video.h"

#include <gtest/gtest.h>
#include <array>
#include <filesystem>

#include "tests/results.h"
#include "tools/programs/simulate/game_picture.h"

namespace touchline::simulate {
namespace {

const std::string kVideoBoard = TOUCHLINE_BOARDS "/mock/board.toml";

// Number of pixels that are about as red, green and blue as this.
int pixels_like(const replay::SurfacePtr& surface, std::array<int, 3> rgb) {
  const replay::Pixels pixels = replay::pixels_of(*surface);
  int count = 0;
  for (std::uint32_t v = 0; v < pixels.height; ++v) {
    for (std::uint32_t u = 0; u < pixels.width; ++u) {
      const std::uint8_t* const bgr = &pixels.bgrx[v * pixels.stride_bytes + 4 * u];
      if (std::abs(bgr[2] - rgb[0]) < 8 && std::abs(bgr[1] - rgb[1]) < 8 && std::abs(bgr[0] - rgb[2]) < 8) ++count;
    }
  }
  return count;
}

TEST(DrawGame, ShowsRobotsAndBall) {
  const hal::mock::ArenaParameters arena;
  ShownGame shown;
  shown.ball = {0.5, 0.5};
  const int ball = pixels_like(draw_game(arena, shown), {255, 140, 26});
  EXPECT_NEAR(ball, 3.14159 * 8.0 * 8.0, 80.0) << "a radius of 21 mm";
  const int blue = pixels_like(draw_game(arena, shown), {77, 148, 255});
  shown.robots.push_back({hal::mock::Side::kOwn, 3, {-0.5, 0.2, 0.7}, "attack", Vector2{0.0, 0.0}});
  const replay::SurfacePtr with_robot = draw_game(arena, shown);
  EXPECT_GT(pixels_like(with_robot, {77, 148, 255}), blue + 300);
  EXPECT_EQ(cairo_image_surface_get_width(with_robot.get()) % 2, 0);
  EXPECT_EQ(cairo_image_surface_get_height(with_robot.get()) % 2, 0);
}

TEST(RecordGame, WritesPicturesOfTheGameThatASeriesPlays) {
  const Result<Team> own = load_team(kVideoBoard, "play", {}), opponent = load_team(kVideoBoard, "univector", {});
  ASSERT_OK(own);
  ASSERT_OK(opponent);
  const hal::mock::ArenaParameters arena = fair_arena(*own.value().configuration, 3);
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "touchline_game_video";
  std::filesystem::remove_all(folder);
  VideoSettings settings{.path = folder.string(), .rate_hz = 2.0, .seed = 4, .duration_s = 1.7};
  int pictures = 0;
  const Result<GameResult> game = record_game(arena, own.value(), opponent.value(), settings, [&] { ++pictures; });
  ASSERT_OK(game);
  EXPECT_EQ(pictures, 4) << "at 0, 0.5, 1 and 1.5 s";
  EXPECT_TRUE(std::filesystem::exists(folder / "000003_game.png"));
  const Result<GameResult> played =
      play_game(arena, own.value(), opponent.value(), 4, settings.duration_s, OwnView::kSightings);
  ASSERT_OK(played);
  EXPECT_EQ(game.value().hash, played.value().hash) << "drawing changes nothing";
  settings.path = (folder / "game.mp4").string();
  ASSERT_OK(record_game(arena, own.value(), opponent.value(), settings, {}));
  EXPECT_GT(std::filesystem::file_size(settings.path), 1000U);
  settings.path = (folder / "000003_game.png" / "x").string();
  EXPECT_NE(record_game(arena, own.value(), opponent.value(), settings, {}).text().find(settings.path),
            std::string::npos);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace touchline::simulate
