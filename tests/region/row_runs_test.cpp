#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/region/row_runs.h"
#include "tests/color/owned_picture.h"
#include "tests/region/region_comparison.h"

namespace touchline::testing {
namespace {

struct Found {
  int begin, end, color;
  friend bool operator==(const Found&, const Found&) = default;
};
void PrintTo(const Found& run, std::ostream* out) { *out << "[" << run.begin << ", " << run.end << ") " << run.color; }

std::vector<Found> found(const Run* runs, std::size_t count) {
  std::vector<Found> list;
  for (const Run& run : std::span(runs, count)) {
    EXPECT_EQ(run.row, 5);
    EXPECT_EQ(run.next, kNoRun);
    list.push_back({run.begin, run.end, run.color});
  }
  return list;
}

// Random rows with widths around multiples of a word, from single pixels to runs over several words.
class RowRunsTest : public ::testing::Test {
 protected:
  struct Row {
    ColorRow colors;
    OccupiedWords occupied = 0;
    std::vector<ColorId> list;  // the pixels of the row and one background pixel
  };

  void fill(Row& row, std::size_t width, int density, int length) {
    row.colors = {};
    row.occupied = 0;
    row.list.assign(width + 1, kBackground);
    for (std::size_t u = 0; u < width;) {
      const auto end = std::min(width, u + static_cast<std::size_t>(pick(random_, 1, length)));
      const auto color = static_cast<ColorId>(pick(random_, 0, 9) < density ? pick(random_, 1, 2) : 0);
      for (; u < end; ++u) {
        row.colors.pixels()[u] = row.list[u] = color;
        if (color != kBackground) row.occupied |= OccupiedWords{1} << u / kOccupiedWordPixels;
      }
    }
  }
  static std::vector<Found> list_runs(const std::vector<ColorId>& colors) {
    std::vector<Found> list;
    for (int u = 0; u + 1 < static_cast<int>(colors.size()); ++u) {
      const ColorId color = colors[static_cast<std::size_t>(u)];
      if (color == kBackground) continue;
      if (!list.empty() && list.back().end == u && list.back().color == color) {
        ++list.back().end;
      } else {
        list.push_back({u, u + 1, color});
      }
    }
    return list;
  }

  static constexpr int kWidths[] = {1, 2, 31, 63, 64, 65, 127, 128, 129, 191, 192, 193, 640, 2592};
  std::mt19937 random_{11};
  RowMasks masks_;
};

TEST_F(RowRunsTest, AgreeWithACheckOfEachPixel) {
  const auto out = std::make_unique<std::array<touchline::Run, kMaxFrameWidth>>();
  const auto writer = std::make_unique<RunWriter>();
  Row above, row;
  for (int round = 0; round < 700; ++round) {
    const auto width = static_cast<std::size_t>(kWidths[static_cast<std::size_t>(round) % std::size(kWidths)]);
    const std::size_t words = (width + 63) / 64;
    writer->configure(words);
    const int density = pick(random_, 0, 10), length = 1 << pick(random_, 0, 8);
    fill(above, width, density, length);
    fill(row, width, density, length);
    fill_masks(row.colors, above.colors, row.occupied, masks_);
    const std::vector<Found> expected = list_runs(row.list);
    ASSERT_EQ(masks_.occupied, row.occupied);
    ASSERT_EQ(writer->count(masks_), expected.size()) << round;
    ASSERT_EQ(found(out->data(), writer->write(masks_, row.colors, 5, out->data())), expected) << round;
    for (std::size_t u = 0; u < words * 64; ++u) {
      const bool like = u < width && row.list[u] != kBackground && row.list[u] == above.list[u];
      ASSERT_EQ((masks_.like_above[u / 64] >> u % 64 & 1u) != 0, like) << round << ", column " << u;
    }

    if (expected.empty()) continue;
    const auto limit = static_cast<std::size_t>(pick(random_, 0, static_cast<int>(expected.size()) - 1));
    const std::vector<Found> left = longest_runs(expected, limit);
    ASSERT_EQ(writer->cut(masks_, limit), left.size()) << round << ", limit " << limit;
    ASSERT_EQ(found(out->data(), writer->write(masks_, row.colors, 5, out->data())), left) << round;
  }
}

TEST_F(RowRunsTest, ContactsJoinRunsOfOneColorThatShareAColumn) {
  const auto writer = std::make_unique<RunWriter>();
  const auto nothing = std::make_unique<ColorRow>();
  Row above, row;
  RowMasks above_masks;
  for (int round = 0; round < 700; ++round) {
    const auto width = static_cast<std::size_t>(kWidths[static_cast<std::size_t>(round) % std::size(kWidths)]);
    writer->configure((width + 63) / 64);
    const int density = pick(random_, 3, 10), length = 1 << pick(random_, 0, 8);
    fill(above, width, density, length);
    fill(row, width, density, length);
    fill_masks(above.colors, *nothing, above.occupied, above_masks);
    fill_masks(row.colors, above.colors, row.occupied, masks_);
    // All runs of a row, or the remaining ones after cut().
    const auto runs_left = [&](RowMasks& masks, const std::vector<ColorId>& colors) {
      std::vector<Found> runs = list_runs(colors);
      if (runs.empty() || pick(random_, 0, 1) == 0) return runs;
      const auto limit = static_cast<std::size_t>(pick(random_, 0, static_cast<int>(runs.size()) - 1));
      writer->cut(masks, limit);
      return longest_runs(std::move(runs), limit);
    };
    const std::vector<Found> runs_above = runs_left(above_masks, above.list), runs = runs_left(masks_, row.list);
    std::vector<std::pair<std::size_t, std::size_t>> expected, contacts;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      for (std::size_t k = 0; k < runs_above.size(); ++k) {
        const Found &a = runs_above[k], &b = runs[i];
        if (a.color == b.color && a.begin < b.end && b.begin < a.end) expected.emplace_back(k, i);
      }
    }
    for (const Contact& contact : writer->find_contacts(above_masks, masks_)) {
      contacts.emplace_back(contact.above, contact.below);
    }
    ASSERT_EQ(contacts, expected) << round;
  }
}

TEST_F(RowRunsTest, IsolatedPixelsHaveNoNeighborOfTheirColor) {
  const auto out = std::make_unique<std::array<touchline::Run, kMaxFrameWidth>>();
  const auto writer = std::make_unique<RunWriter>();
  std::array<Row, 3> rows;
  RowMasks below;
  for (int round = 0; round < 300; ++round) {
    const auto width = static_cast<std::size_t>(kWidths[static_cast<std::size_t>(round) % std::size(kWidths)]);
    writer->configure((width + 63) / 64);
    for (Row& row : rows) fill(row, width, 4, 3);
    fill_masks(rows[1].colors, rows[0].colors, rows[1].occupied, masks_);
    fill_masks(rows[2].colors, rows[1].colors, rows[2].occupied, below);
    remove_isolated_pixels(below, masks_);
    std::vector<Found> expected = list_runs(rows[1].list);
    std::erase_if(expected, [&](const Found& run) {
      const auto u = static_cast<std::size_t>(run.begin);
      return run.end - run.begin == 1 && rows[0].list[u] != run.color && rows[2].list[u] != run.color;
    });
    ASSERT_EQ(found(out->data(), writer->write(masks_, rows[1].colors, 5, out->data())), expected) << round;
  }
}

}  // namespace
}  // namespace touchline::testing
