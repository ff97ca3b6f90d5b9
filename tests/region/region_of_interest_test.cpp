#include <gtest/gtest.h>

#include <limits>
#include <memory>

#include "core/region/region_of_interest.h"

namespace touchline::testing {
namespace {

class RegionOfInterestTest : public ::testing::Test {
 protected:
  // Draws the spans as rows of '#' and '.'.
  std::vector<std::string> drawn(std::initializer_list<PixelPoint> points, int width, int height) {
    Polygon polygon;
    for (const PixelPoint& point : points) polygon.push_back(point);
    status_ = region_->build(polygon, static_cast<std::uint16_t>(width), static_cast<std::uint16_t>(height));
    std::vector<std::string> rows;
    for (int v = 0; v < height; ++v) {
      rows.emplace_back(static_cast<std::size_t>(width), '.');
      int free_from = 0;
      for (const ColumnSpan& span : region_->row(static_cast<std::uint16_t>(v))) {
        EXPECT_LT(span.begin, span.end);
        EXPECT_GE(span.begin, free_from) << "a column lies between two spans";
        EXPECT_LE(span.end, width);
        for (std::size_t u = span.begin; u < span.end; ++u) rows.back()[u] = '#';
        free_from = span.end + 1;
      }
    }
    return rows;
  }
  using Rows = std::vector<std::string>;

  std::unique_ptr<RegionOfInterest> region_ = std::make_unique<RegionOfInterest>();
  Status status_;
};

TEST_F(RegionOfInterestTest, FewerThanThreePointsAreTheWholePicture) {
  EXPECT_EQ(drawn({}, 3, 2), (Rows{"###", "###"}));
  EXPECT_EQ(drawn({{1, 1}, {2, 2}}, 3, 2), (Rows{"###", "###"}));
  EXPECT_TRUE(status_.ok());
}

TEST_F(RegionOfInterestTest, IncludesItsLeftAndUpperBorders) {
  EXPECT_EQ(drawn({{1, 1}, {4, 1}, {4, 3}, {1, 3}}, 6, 4), (Rows{"......", ".###..", ".###..", "......"}));
  EXPECT_EQ(drawn({{1, 3}, {4, 3}, {4, 1}, {1, 1}}, 6, 4), (Rows{"......", ".###..", ".###..", "......"}))
      << "in both directions";
  EXPECT_EQ(drawn({{0.5f, 0.5f}, {4.5f, 0.5f}, {4.5f, 2.5f}, {0.5f, 2.5f}}, 6, 4),
            (Rows{"......", ".####.", ".####.", "......"}));
}

TEST_F(RegionOfInterestTest, MayBeConcave) {
  // A field with two goal boxes and a notch from above.
  EXPECT_EQ(drawn({{1, 0},
                   {3, 0},
                   {3, 2},
                   {5, 2},
                   {5, 0},
                   {7, 0},
                   {7, 2},
                   {8, 2},
                   {8, 4},
                   {7, 4},
                   {7, 5},
                   {1, 5},
                   {1, 4},
                   {0, 4},
                   {0, 2},
                   {1, 2}},
                  9, 6),
            (Rows{".##..##..", ".##..##..", "########.", "########.", ".######..", "........."}));
}

TEST_F(RegionOfInterestTest, UsesTheEvenOddRuleWhereItCrossesItself) {
  // One border draws two overlapping squares: their common part is outside.
  EXPECT_EQ(drawn({{0, 0}, {6, 0}, {6, 3}, {3, 3}, {3, 0}, {9, 0}, {9, 3}, {0, 3}}, 10, 3),
            (Rows{"###...###.", "###...###.", "###...###."}));
}

TEST_F(RegionOfInterestTest, AdjacentSpansAreJoined) {
  // One border around two squares side by side.
  drawn({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {8, 0}, {8, 4}, {4, 4}, {4, 0}}, 10, 4);
  for (std::uint16_t v = 0; v < 4; ++v) EXPECT_EQ(region_->row(v).size(), 1u);
}

TEST_F(RegionOfInterestTest, RepeatedPointsAndEdgesThatTurnBackHaveNoEffect) {
  const Rows square = drawn({{1, 1}, {4, 1}, {4, 3}, {1, 3}}, 6, 4);
  EXPECT_EQ(drawn({{1, 1}, {4, 1}, {4, 1}, {4, 3}, {1, 3}, {1, 3}, {1, 1}}, 6, 4), square)
      << "the first point is repeated at the end";
  EXPECT_EQ(drawn({{1, 1}, {4, 1}, {5.5f, 2}, {4, 1}, {4, 3}, {1, 3}}, 6, 4), square) << "a spike out and back";
  EXPECT_EQ(drawn({{1, 1}, {2.5f, 1}, {4, 1}, {4, 3}, {1, 3}}, 6, 4), square) << "a corner of 180 degrees";
}

TEST_F(RegionOfInterestTest, IsClippedToThePicture) {
  EXPECT_EQ(drawn({{-1e6f, -1e6f}, {1e6f, -1e6f}, {1e6f, 1e6f}, {-1e6f, 1e6f}}, 3, 2), (Rows{"###", "###"}));
  EXPECT_EQ(drawn({{-4, -4}, {2, -4}, {2, 1}, {-4, 1}}, 4, 2), (Rows{"##..", "...."}));
}

TEST_F(RegionOfInterestTest, HasRoomForTheMaximumNumberOfSpans) {
  Polygon comb;
  for (int tooth = 0; tooth < 16; ++tooth) {
    comb.push_back({static_cast<float>(tooth) * 80.0f, 5000.0f});
    comb.push_back({static_cast<float>(tooth) * 80.0f + 40.0f, -5000.0f});
  }
  ASSERT_TRUE(region_->build(comb, kMaxFrameWidth, kMaxFrameHeight).ok());
  std::size_t full_rows = 0;
  for (std::uint16_t v = 0; v < kMaxFrameHeight; ++v) {
    ASSERT_LE(region_->row(v).size(), kMaxPolygonPoints / 2);
    full_rows += region_->row(v).size() == kMaxPolygonPoints / 2 ? 1u : 0u;
  }
  EXPECT_GT(full_rows, kMaxFrameHeight / 2) << "fewer only where the last edge runs through a corner of the others";
}

TEST_F(RegionOfInterestTest, RejectsInvalidPolygons) {
  drawn({{0.2f, 0.2f}, {0.8f, 0.2f}, {0.8f, 0.8f}}, 4, 4);
  EXPECT_EQ(status_.code(), ErrorCode::kInconsistent) << "between pixel centers";
  drawn({{0, 0}, {2, 2}, {3, 3}}, 4, 4);
  EXPECT_EQ(status_.code(), ErrorCode::kInconsistent) << "a line has no inside";
  drawn({{5, 0}, {9, 0}, {9, 4}, {5, 4}}, 4, 4);
  EXPECT_EQ(status_.code(), ErrorCode::kInconsistent) << "beside the picture";
  drawn({{0, 0}, {4, std::numeric_limits<float>::quiet_NaN()}, {4, 4}}, 1, 0);
  EXPECT_EQ(status_.code(), ErrorCode::kOutOfRange);
  drawn({{0, 0}, {4, std::numeric_limits<float>::infinity()}, {4, 4}}, 1, 0);
  EXPECT_EQ(status_.code(), ErrorCode::kOutOfRange);
  EXPECT_EQ(region_->build({}, kMaxFrameWidth + 1, 4).code(), ErrorCode::kOutOfRange);
  EXPECT_EQ(region_->build({}, 4, kMaxFrameHeight + 1).code(), ErrorCode::kOutOfRange);
}

}  // namespace
}  // namespace touchline::testing
