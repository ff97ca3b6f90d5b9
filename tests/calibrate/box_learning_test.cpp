#include "tools/programs/calibrate/colors/box_learning.h"

#include <gtest/gtest.h>

#include <random>

#include "tools/programs/calibrate/colors/initial_boxes.h"

namespace touchline::calibrate {
namespace {

std::vector<ColorCount> cloud(std::array<int, 3> middle, int spread, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> offset(-spread, spread);
  std::vector<Channels> pixels;
  for (int i = 0; i < count; ++i) {
    Channels p{};
    for (std::size_t c = 0; c < 3; ++c)
      p[c] = static_cast<std::uint8_t>(std::clamp(middle[c] + offset(random), 0, 255));
    pixels.push_back(p);
  }
  return count_colors(pixels);
}

double caught(const LearnedColors& learned, ColorId color, const std::vector<ColorCount>& pixels) {
  double sum = 0;
  for (const ColorCount& p : pixels) {
    for (const ColorBox& box : learned.boxes) {
      if (box.color == color && contains(box, p.value)) {
        sum += p.count;
        break;
      }
    }
  }
  return sum / total(pixels);
}

TEST(BoxLearning, KeepsHalfOfTheDistanceToTheNeighbor) {
  LearningInput input;
  input.colors = {{"a", cloud({100, 100, 100}, 5, 2000, 1)}, {"b", cloud({150, 100, 100}, 5, 2000, 2)}};
  const Result<LearnedColors> result = learn_boxes(input, {});
  ASSERT_TRUE(result.ok()) << result.text();
  const LearnedColors& learned = result.value();
  ASSERT_EQ(learned.boxes.size(), 2U);
  // Cores end at 105 and begin at 145.
  EXPECT_NEAR(learned.boxes[0].high[0], 125, 2);
  EXPECT_NEAR(learned.boxes[1].low[0], 125, 2);
  EXPECT_LT(learned.boxes[0].high[0], learned.boxes[1].low[0]);
  ASSERT_EQ(learned.margins.size(), 1U);
  EXPECT_NEAR(learned.margins[0].levels, 40, 2);
  // Without other samples, the box grows by the largest margin.
  EXPECT_NEAR(learned.boxes[0].low[0], 95 - 40, 1);
}

TEST(BoxLearning, StaysAwayFromTheBackground) {
  LearningInput input;
  input.colors = {{"a", cloud({120, 120, 120}, 5, 2000, 1)}};
  input.background = cloud({120, 120, 90}, 5, 100000, 2);
  const Result<LearnedColors> result = learn_boxes(input, {});
  ASSERT_TRUE(result.ok()) << result.text();
  const LearnedColors& learned = result.value();
  EXPECT_NEAR(learned.boxes[0].low[2], 105, 2);  // half the distance from 115 to 95
  EXPECT_EQ(caught(learned, 1, input.background), 0.0);
  EXPECT_EQ(caught(learned, 1, input.colors[0].pixels), 1.0);
}

TEST(BoxLearning, LeavesRoomToTheBackgroundBeyondTheLargestMargin) {
  LearningInput input;
  input.colors = {{"a", cloud({120, 120, 120}, 5, 2000, 1)}};
  input.background = cloud({67, 120, 120}, 5, 100000, 2);
  const Result<LearnedColors> result = learn_boxes(input, {});
  ASSERT_TRUE(result.ok()) << result.text();
  EXPECT_NEAR(result.value().boxes[0].low[0], 83, 1);  // 115 - 40 is 3 levels from the background
}

// On the side where brown touches green, the floor is behind it.
TEST(BoxLearning, LeavesRoomToTheBackgroundBehindAnotherBox) {
  LearningInput input;
  input.colors = {{"brown", cloud({115, 68, 37}, 10, 2000, 1)}, {"green", cloud({26, 152, 58}, 10, 2000, 2)}};
  input.background = cloud({58, 61, 59}, 6, 100000, 3);
  const Result<LearnedColors> result = learn_boxes(input, {});
  ASSERT_TRUE(result.ok()) << result.text();
  const ColorBox& brown = result.value().boxes[0];
  EXPECT_GT(result.value().boxes[1].high[0], 66) << "the green is touched";
  EXPECT_NEAR(brown.low[0], 75, 1);
}

TEST(BoxLearning, SplitsAColorBesideAnotherOne) {
  // The samples are two slanted clouds, like colors under increasing light; a single box around one would include the
  // other.
  std::vector<Channels> first, second;
  std::mt19937 random(3);
  std::uniform_int_distribution<int> noise(-3, 3);
  for (int i = 0; i < 6000; ++i) {
    const int t = 60 + i % 120;
    const auto at = [&](int x) { return static_cast<std::uint8_t>(std::clamp(x + noise(random), 0, 255)); };
    first.push_back({at(t), at(t), at(t / 2)});
    second.push_back({at(t), at(t + 60), at(t / 2)});
  }
  LearningInput input;
  input.colors = {{"a", count_colors(first)}, {"b", count_colors(second)}};
  const Result<LearnedColors> result = learn_boxes(input, {});
  ASSERT_TRUE(result.ok()) << result.text();
  const LearnedColors& learned = result.value();
  EXPECT_GT(learned.boxes.size(), 3U);
  EXPECT_LE(learned.boxes.size(), 8U);
  std::size_t i = 0, j = 0;
  EXPECT_FALSE(overlapping_boxes(learned.boxes, i, j));
  EXPECT_GT(caught(learned, 1, input.colors[0].pixels), 0.93);
  EXPECT_GT(caught(learned, 2, input.colors[1].pixels), 0.93);
  EXPECT_LT(caught(learned, 1, input.colors[1].pixels), 0.03);
  EXPECT_LT(caught(learned, 2, input.colors[0].pixels), 0.03);
}

TEST(BoxLearning, SupportsFifteenColorsAndMore) {
  LearningInput input;
  unsigned seed = 1;
  for (int r = 0; r < 3; ++r) {
    for (int g = 0; g < 3; ++g) {
      for (int b = 0; b < 3; ++b) {
        if (r + g + b == 0) continue;
        input.colors.push_back(
            {"c" + std::to_string(seed), cloud({30 + 90 * r, 30 + 90 * g, 30 + 90 * b}, 20, 500, seed)});
        ++seed;
      }
    }
  }
  input.background = cloud({30, 30, 30}, 20, 50000, 99);
  const Result<LearnedColors> result = learn_boxes(input, {});
  ASSERT_TRUE(result.ok()) << result.text();
  const LearnedColors& learned = result.value();
  EXPECT_EQ(learned.boxes.size(), 26U);
  for (std::size_t c = 0; c < 26; ++c) {
    EXPECT_GT(caught(learned, static_cast<ColorId>(c + 1), input.colors[c].pixels), 0.98);
  }
}

TEST(BoxLearning, RejectsColorsThatCannotBeLearned) {
  EXPECT_EQ(learn_boxes({}, {}).code(), ErrorCode::kOutOfRange);
  LearningInput input;
  input.colors = {{"a", cloud({100, 100, 100}, 5, 100, 1)}, {"b", {}}};
  const Result<LearnedColors> empty = learn_boxes(input, {});
  EXPECT_EQ(empty.code(), ErrorCode::kNotFound);
  EXPECT_NE(empty.text().find("b"), std::string::npos);
  input.colors[1] = {"b", input.colors[0].pixels};
  EXPECT_EQ(learn_boxes(input, {}).code(), ErrorCode::kInconsistent);
  input.colors.assign(kMaxColors + 1, input.colors[0]);
  EXPECT_EQ(learn_boxes(input, {}).code(), ErrorCode::kOutOfRange);
}

// In shade with half the light, and in glare, a team color is in a box, and another color is not.
TEST(BoxLearning, FindsTeamColorsInOtherLight) {
  LearningInput input;
  input.colors = {{"blue", cloud({20, 90, 200}, 4, 2000, 1), ColorUse::kTeam},
                  {"red", cloud({200, 30, 30}, 4, 2000, 2), ColorUse::kIdentification}};
  input.background = cloud({60, 62, 60}, 6, 100000, 3);
  const auto shade = cloud({14, 64, 142}, 3, 500, 4), glare = cloud({100, 132, 228}, 3, 500, 5);
  const auto gray = cloud({150, 150, 152}, 3, 500, 6);
  const Result<LearnedColors> team = learn_boxes(input, {});
  ASSERT_TRUE(team.ok()) << team.text();
  EXPECT_GT(caught(team.value(), 1, shade), 0.95);
  EXPECT_GT(caught(team.value(), 1, glare), 0.95);
  EXPECT_EQ(caught(team.value(), 1, gray), 0.0);
  EXPECT_LT(caught(team.value(), 1, input.background), 1e-4);
  input.colors[0].use = ColorUse::kOther;
  const Result<LearnedColors> other = learn_boxes(input, {});
  ASSERT_TRUE(other.ok()) << other.text();
  EXPECT_EQ(caught(other.value(), 1, shade), 0.0);
  EXPECT_EQ(caught(other.value(), 1, glare), 0.0);
}

// The ball is found in shade with half the light, unless an identification color may be there.
TEST(BoxLearning, FindsTheBallInOtherLightWhereNoOtherColorIs) {
  LearningInput input;
  input.colors = {{"orange", cloud({230, 110, 30}, 4, 2000, 1), ColorUse::kBall},
                  {"blue", cloud({20, 90, 200}, 4, 2000, 2), ColorUse::kIdentification}};
  input.background = cloud({60, 62, 60}, 6, 100000, 3);
  const auto shade = cloud({168, 80, 22}, 3, 500, 4);
  const Result<LearnedColors> ball = learn_boxes(input, {});
  ASSERT_TRUE(ball.ok()) << ball.text();
  EXPECT_GT(caught(ball.value(), 1, shade), 0.95);
  // Now brown may be in this place, too.
  const auto room = [](const LearnedColors& learned) {
    double sum = 0;
    for (const ColorBox& box : learned.boxes) {
      double volume = box.color == 1 ? 1 : 0;
      for (std::size_t c = 0; c < 3; ++c) volume *= box.high[c] - box.low[c] + 1;
      sum += volume;
    }
    return sum;
  };
  input.colors.push_back({"brown", {}, ColorUse::kIdentification});
  for (const std::array<int, 3>& brown : {std::array{130, 75, 40}, std::array{200, 140, 60}, std::array{120, 80, 50},
                                          std::array{230, 80, 60}, std::array{200, 60, 20}}) {
    input.colors.back() = {"brown", cloud(brown, 4, 2000, 6), ColorUse::kIdentification};
    const Result<LearnedColors> beside_patch = learn_boxes(input, {});
    input.colors.back().use = ColorUse::kOther;
    const Result<LearnedColors> beside_other = learn_boxes(input, {});
    ASSERT_TRUE(beside_patch.ok() && beside_other.ok());
    EXPECT_LT(room(beside_patch.value()), 0.95 * room(ball.value())) << "less than without the brown";
    EXPECT_EQ(room(beside_patch.value()), room(beside_other.value())) << "a team color would take room from patches";
  }
  input.colors.pop_back();
  input.colors.push_back({"brown", cloud({168, 80, 22}, 4, 2000, 5), ColorUse::kIdentification});
  const Result<LearnedColors> beside = learn_boxes(input, {});
  ASSERT_TRUE(beside.ok()) << beside.text();
  EXPECT_LT(caught(beside.value(), 1, shade), 0.05);
  EXPECT_GT(caught(beside.value(), 3, shade), 0.95) << "its own box is not smaller";
}

}  // namespace
}  // namespace touchline::calibrate
