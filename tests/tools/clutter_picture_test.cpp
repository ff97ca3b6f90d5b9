#include "tools/programs/latency/clutter_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

namespace touchline::latency {
namespace {

constexpr PixelValue kFloor{60, 60, 60};

class ClutterPictureTest : public ::testing::Test {
 protected:
  ClutterPictureTest() {
    parameters_->scan.width_px = 160;
    parameters_->scan.height_px = 120;
    for (std::uint8_t i = 0; i < 3; ++i) {
      const auto low = static_cast<std::uint8_t>(100 + 40 * i);
      parameters_->scan.boxes.push_back({static_cast<ColorId>(i + 1), {low, low, low}, {low, low, low}});
    }
    for (std::size_t team = 0; team < 2; ++team) {
      TeamMarking& marking = parameters_->marker.teams[team];
      marking.layout = paper_layout();
      marking.team_color = static_cast<ColorId>(team + 1);
    }
    parameters_->marker.ball.color = 3;
    FullModelParameters& lens = parameters_->camera.full;
    lens.fx_px = lens.fy_px = 160;
    lens.cx_px = 80, lens.cy_px = 60;
    lens.rotation_rad = {3.1415927f, 0.0f, 0.0f};
    lens.position_m = {0.0f, 0.0f, 0.6f};
    EXPECT_TRUE(camera_.configure(parameters_->camera).ok());
  }
  [[nodiscard]] std::vector<PixelValue> paint(const ClutterRecipe& recipe) const {
    return paint_clutter(recipe, *parameters_, camera_, kFloor);
  }
  static std::ptrdiff_t pixels(const std::vector<PixelValue>& picture, std::uint8_t value) {
    return std::count(picture.begin(), picture.end(), PixelValue{value, value, value});
  }

  std::unique_ptr<PipelineParameters> parameters_ = std::make_unique<PipelineParameters>();
  CameraModel camera_;
};

TEST_F(ClutterPictureTest, TextKeepsAllNumbers) {
  ClutterRecipe recipe;
  int value = 31;
  for (const ClutterNumber& number : clutter_numbers())
    recipe.*number.value = std::clamp(value++, number.low, number.high);
  const std::optional<ClutterRecipe> read = clutter_recipe_of(text_of(recipe));
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(text_of(*read), text_of(recipe));
  EXPECT_FALSE(clutter_recipe_of(text_of(recipe) + " 1").has_value());
  EXPECT_FALSE(clutter_recipe_of("robots 41" + text_of(recipe).substr(9)).has_value());
  EXPECT_FALSE(clutter_recipe_of("").has_value());
}

TEST_F(ClutterPictureTest, RecipesOfTheWorstClutterAreValid) {
  EXPECT_FALSE(worst_clutter().empty());
  for (const NamedClutter& clutter : worst_clutter()) EXPECT_TRUE(clutter_recipe_of(clutter.recipe)) << clutter.name;
}

TEST_F(ClutterPictureTest, PaintsWhatTheRecipeSays) {
  EXPECT_EQ(pixels(paint({}), 60), 160 * 120);
  ClutterRecipe robots;
  robots.robots = 2;
  const auto two = paint(robots);
  // A team patch of 37.5 mm at 300 pixels per meter has 11 x 11 pixels; identification patches have any color.
  EXPECT_GT(pixels(two, 100), 81);
  EXPECT_GT(pixels(two, 140), 81);
  ClutterRecipe balls;
  balls.balls = 1;
  EXPECT_GT(pixels(paint(balls), 180), 20);
  ClutterRecipe noise;
  noise.noise_per_mille = 500;
  EXPECT_NEAR(static_cast<double>(pixels(paint(noise), 60)), 160 * 60, 500);
  ClutterRecipe heap;
  heap.heap = 200;
  EXPECT_LT(pixels(paint(heap), 60), 160 * 100);
  EXPECT_EQ(paint(heap), paint(heap));
}

TEST_F(ClutterPictureTest, BlurIsAMean) {
  ClutterRecipe recipe;
  recipe.balls = 1;
  recipe.ball_percent = 400;
  const auto sharp = paint(recipe);
  recipe.blur = 2;
  const auto blurred = paint(recipe);
  double sum = 0, of_sharp = 0;
  for (std::size_t i = 0; i < sharp.size(); ++i) {
    sum += blurred[i][0];
    of_sharp += sharp[i][0];
  }
  EXPECT_NE(blurred, sharp);
  EXPECT_NEAR(sum / of_sharp, 1.0, 0.02);
}

}  // namespace
}  // namespace touchline::latency
