#include "tools/programs/calibrate/field/field_drawing.h"
#include "tests/results.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace touchline::calibrate {
namespace {

class Drawing : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  Result<void> read(const std::string& toml) {
    std::ofstream(path_) << toml;
    TOUCHLINE_TRY_ASSIGN(drawing_, read_drawing(path_));
    return {};
  }
  const std::string path_ =
      ::testing::TempDir() + "drawing_" + ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".toml";
  FieldDrawing drawing_;
};

constexpr const char* kWhole = R"(version = 1
[field]
length_m = 2.0
width_m = 1.6
goal_width_m = 0.4
[border]
corner_m = 0.1
open_goals = true
[[line]]
x1_m = 0.0
y1_m = -0.8
x2_m = 0.0
y2_m = 0.8
[[line]]
x1_m = 0.5
y1_m = -0.1
x2_m = 0.5
y2_m = 0.1
[[arc]]
x_m = 0.0
y_m = 0.0
radius_m = 0.2
)";

TEST_F(Drawing, IsConvertedToMarks) {
  ASSERT_OK(read(kWhole));
  const std::vector<Mark> marks = marks_of(drawing_);
  // The border has two long sides, four halves of the short ones, and four corners; inside are two lines and a circle.
  ASSERT_EQ(marks.size(), 13u);
  std::array<double, 4> length{};
  for (const Mark& mark : marks) {
    if (mark.side >= 0) length[static_cast<std::size_t>(mark.side)] += length_of(mark);
  }
  for (const std::size_t side : {0u, 2u}) EXPECT_NEAR(length[side], 2.0 - 2 * 0.1, 1e-6);
  for (const std::size_t side : {1u, 3u}) EXPECT_NEAR(length[side], 1.6 - 2 * 0.1 - 0.4, 1e-6);
  for (const Mark& mark : marks) {
    if (mark.kind != MarkKind::kBorder) continue;
    // The center of the field is on the dark side, on the left of the mark.
    const MarkPlace at = place_on(mark, length_of(mark) / 2);
    EXPECT_GT(at.along_x * (0 - at.y_m) - at.along_y * (0 - at.x_m), 0) << at.x_m << ", " << at.y_m;
  }
  EXPECT_TRUE(marks[10].early) << "it crosses the whole field";
  EXPECT_FALSE(marks[11].early);
  EXPECT_NEAR(length_of(marks[12]), 2 * std::acos(-1.0) * 0.2, 1e-6);
  const MarkPlace top = place_on(marks[12], length_of(marks[12]) / 4);
  EXPECT_NEAR(top.x_m, 0.0, 1e-9);
  EXPECT_NEAR(top.y_m, 0.2, 1e-9);
  EXPECT_NEAR(top.along_x, -1.0, 1e-9);
}

TEST_F(Drawing, APaintedBorderBelongsToTheField) {
  ASSERT_OK(read("version = 1\n[field]\nlength_m = 9.0\nwidth_m = 6.0\n[border]\nkind = \"line\"\nwidth_m = 0.02\n"));
  for (const Mark& mark : marks_of(drawing_)) {
    EXPECT_EQ(mark.kind, MarkKind::kLine);
    if (mark.side == 0) {
      EXPECT_NEAR(mark.begin_y_m, -2.99, 1e-6);
    }
  }
}

TEST_F(Drawing, NamesFileLineAndKeyOfErrors) {
  struct Case {
    const char *from, *to, *message;
  };
  for (const Case& c :
       {Case{"radius_m = 0.2", "radius_m = -0.2", ":22: arc[0].radius_m: "},
        Case{"radius_m = 0.2\n", "", "arc[0].radius_m: is missing"},
        Case{"y2_m = 0.1", "y2_m = -0.1", ":14: line[1]: the ends must be at least 0.05 m apart"},
        Case{"x2_m = 0.5", "x2_m = 5.0", ":14: line[1]: an end is more than 1 m outside"},
        Case{"radius_m = 0.2", "radius_m = 0.2\nfrom_rad = 1.0\nto_rad = 0.5", "arc[0].to_rad: the arc"},
        Case{"corner_m = 0.1", "corner_m = 0.7", ":7: border.corner_m: "},
        Case{"[border]", "[border]\nbrim = 1", ":7: border.brim: "},
        Case{"x_m = 0.0", "x_m = \"left\"", "arc[0].x_m: "}, Case{"length_m = 2.0\n", "", "field.length_m: is missing"},
        Case{"[[arc]]", "[[arc]", ":19: "}}) {
    std::string toml = kWhole;
    toml.replace(toml.find(c.from), std::string(c.from).size(), c.to);
    const std::string text = read(toml).text();
    EXPECT_NE(text.find(c.message), std::string::npos) << c.message << " is not in: " << text;
    EXPECT_EQ(text.rfind(path_, 0), 0u) << text;
  }
}

// SSL-Vision's geometry publishes these measures, so they must be those of the lines that the calibration searches.
TEST(Presets, MeasuresOfTheMarkingsAreThoseOfTheLines) {
  for (const FieldPreset& preset : field_presets()) {
    const FieldParameters& field = preset.drawing.field;
    const double depth = static_cast<double>(field.penalty_area_depth_m),
                 width = static_cast<double>(field.penalty_area_width_m),
                 goal_line = static_cast<double>(field.length_m) / 2,
                 thickness = static_cast<double>(field.line_width_m);
    // The outer edges of lines that belong to the area are at its published measures.
    const double outside = preset.drawing.border.kind == BorderKind::kLine ? thickness / 2 : 0.0;
    ASSERT_EQ(preset.drawing.arc.size(), 1u) << preset.name;
    EXPECT_NEAR(preset.drawing.arc[0].radius_m + outside, static_cast<double>(field.center_circle_m), 1e-6);
    int fronts = 0;
    for (const DrawnLine& line : preset.drawing.line) {
      EXPECT_NEAR(line.width_m, thickness, 1e-6) << preset.name;
      if (line.x1_m != line.x2_m || line.x1_m == 0) continue;
      ++fronts;
      EXPECT_NEAR(goal_line - std::abs(line.x1_m) + outside, depth, 1e-6) << preset.name;
      EXPECT_NEAR(std::abs(line.y2_m - line.y1_m) + 2 * outside, width, 1e-6) << preset.name;
    }
    EXPECT_EQ(fronts, 2) << preset.name;
  }
  const FieldParameters& vsss = find_preset("vsss")->drawing.field;
  EXPECT_FLOAT_EQ(vsss.penalty_area_depth_m, 0.15f);
  EXPECT_FLOAT_EQ(vsss.penalty_area_width_m, 0.7f);
  const FieldParameters& middle = find_preset("mirosot-middle")->drawing.field;
  EXPECT_FLOAT_EQ(middle.penalty_area_depth_m, 0.35f);
  EXPECT_FLOAT_EQ(middle.penalty_area_width_m, 0.8f);
  const FieldParameters& a = find_preset("ssl-a")->drawing.field;
  EXPECT_FLOAT_EQ(a.penalty_area_depth_m, 1.8f);
  EXPECT_FLOAT_EQ(a.penalty_area_width_m, 3.6f);
}

TEST(Presets, HaveTheLinesOfTheirLeague) {
  for (const FieldPreset& preset : field_presets()) {
    const double x = static_cast<double>(preset.drawing.field.length_m) / 2;
    const double y = static_cast<double>(preset.drawing.field.width_m) / 2;
    std::size_t arcs = 0;
    for (const Mark& mark : marks_of(preset.drawing)) {
      arcs += mark.radius_m > 0 ? 1u : 0u;
      for (const double way : {0.0, 0.5, 1.0}) {
        const MarkPlace at = place_on(mark, way * length_of(mark));
        EXPECT_LE(std::abs(at.x_m), x + 1e-6) << preset.name;
        EXPECT_LE(std::abs(at.y_m), y + 1e-6) << preset.name;
      }
    }
    EXPECT_EQ(arcs, 1u) << preset.name;
  }
  EXPECT_EQ(find_preset(2.2f, 1.8f), find_preset("mirosot-middle"));
  EXPECT_EQ(find_preset("mirosot"), nullptr);
  ASSERT_NE(find_preset("ssl"), nullptr);
  EXPECT_EQ(find_preset("ssl"), find_preset("ssl-a"));
  EXPECT_EQ(find_preset(2.1f, 1.8f), nullptr);
}

}  // namespace
}  // namespace touchline::calibrate
