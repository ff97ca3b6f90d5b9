#include "tools/programs/calibrate/colors/field_reference.h"

#include <gtest/gtest.h>

#include <memory>

#include "tests/calibrate/painted_field.h"

// The reference of the field; for pictures of 320 x 240 pixels it has 20 x 15 cells of 16 x 16.
namespace touchline::calibrate {
namespace {

constexpr std::size_t kColumns = 20, kRows = 15;
constexpr int kCell_px = 16;

class FieldReference : public ::testing::Test {
 protected:
  FieldReference() {
    // Red patches are found by their color.
    fit_.learned.boxes.push_back({1, {120, 0, 0}, {255, 90, 90}});
  }
  void show(const std::string& name, const std::vector<PaintedPatch>& patches, double light = 1.0,
            PixelFormat format = PixelFormat::kRgb24) {
    input_.pictures[name] = painted_field(patches, format, static_cast<unsigned>(input_.pictures.size()),
                                          [light](int, int) { return light; });
  }
  const LightReference& made() {
    *reference_ = field_reference(draft_, input_, fit_);
    return *reference_;
  }
  [[nodiscard]] static std::size_t cell_at(int u, int v) {
    return static_cast<std::size_t>(v / kCell_px) * kColumns + static_cast<std::size_t>(u / kCell_px);
  }
  // Returns the sum of the channel over four pixels; 0: the cell is not used.
  [[nodiscard]] int at(int u, int v, std::size_t channel = 1) const {
    return reference_->colors.sum[channel][cell_at(u, v)];
  }
  [[nodiscard]] std::size_t left_out() const {
    const auto& sums = reference_->colors.sum[1];
    return static_cast<std::size_t>(std::count(sums.begin(), sums.begin() + kColumns * kRows, 0));
  }

  VenueDraft draft_;
  ColorFitInput input_;
  ColorFit fit_;
  std::unique_ptr<LightReference> reference_ = std::make_unique<LightReference>();
};

const PaintedPatch kFirst{"red", {200, 30, 30}, 80, 120}, kSecond{"red", {200, 30, 30}, 240, 120};
// The sum is that of four pixels of the painted floor, with noise of four levels.
constexpr int kFloorSum = 4 * 48, kTolerance = 30;

TEST_F(FieldReference, HasTheColorOfTheFloor) {
  show("a.png", {});
  made();
  ASSERT_EQ(reference_->columns, kColumns);
  ASSERT_EQ(reference_->rows, kRows);
  EXPECT_EQ(left_out(), 0u);
  for (const auto& [u, v] : {std::pair{8, 8}, {160, 120}, {310, 230}}) {
    EXPECT_NEAR(at(u, v, 0), 4 * 45, kTolerance);
    EXPECT_NEAR(at(u, v, 1), kFloorSum, kTolerance);
    EXPECT_NEAR(at(u, v, 2), 4 * 50, kTolerance);
  }
}

TEST_F(FieldReference, LeavesOutWhatARobotCoversInEveryPicture) {
  show("a.png", {kFirst, kSecond});
  show("b.png", {kFirst});
  made();
  EXPECT_EQ(at(80, 120), 0) << "the patch";
  EXPECT_EQ(at(98, 120), 0) << "the robot's dark top beside it";
  EXPECT_NEAR(at(240, 120), kFloorSum, kTolerance) << "the floor is seen in the other picture";
  EXPECT_NEAR(at(160, 120), kFloorSum, kTolerance);
  // 24 pixels around a patch of 12, and half a cell: 4 x 4 to 5 x 5 cells.
  EXPECT_GE(left_out(), 16u);
  EXPECT_LE(left_out(), 25u);
}

TEST_F(FieldReference, LeavesOutClicksWhoseColorIsInNoBox) {
  show("a.png", {{"blue", {40, 60, 200}, 80, 120}});
  made();
  EXPECT_EQ(left_out(), 0u);
  input_.clicks.push_back({"a.png", "blue", 80, 120});
  made();
  EXPECT_EQ(at(80, 120), 0);
  EXPECT_NEAR(at(160, 120), kFloorSum, kTolerance);
  input_.clicks[0].image = "b.png";
  made();
  EXPECT_EQ(left_out(), 0u) << "the click belongs to another picture";
}

TEST_F(FieldReference, IsTheMedianOfThePictures) {
  show("a.png", {}, 1.0);
  show("b.png", {}, 3.0);
  show("c.png", {}, 1.5);
  made();
  EXPECT_NEAR(at(160, 120), 1.5 * kFloorSum, kTolerance);
}

// If a robot covers the floor in one of two pictures, the other picture's light does not fill the gap.
TEST_F(FieldReference, MixesNoLights) {
  show("a.png", {kFirst}, 1.0);
  show("b.png", {}, 2.0);
  made();
  EXPECT_EQ(at(80, 120), 0);
  EXPECT_NEAR(at(160, 120), kFloorSum, kTolerance);
  show("b.png", {}, 1.02);
  made();
  EXPECT_NEAR(at(80, 120), kFloorSum, kTolerance) << "lamps flicker";
}

TEST_F(FieldReference, EndsAQuarterOfAMeterOutsideTheField) {
  // A camera 2 m above the floor, 3 mm per pixel.
  draft_.exists = true;
  draft_.file.picture.width_px = 320;
  draft_.file.picture.height_px = 240;
  draft_.file.field.length_m = 0.3f;
  draft_.file.field.width_m = 0.15f;
  CameraParameters& camera = draft_.file.camera_model;
  camera.full.fx_px = camera.full.fy_px = 669.6f;
  camera.full.cx_px = 159.5f;
  camera.full.cy_px = 119.5f;
  camera.full.rotation_rad = {3.14159265f, 0.0f, 0.0f};
  camera.full.position_m = {0.0f, 0.0f, 2.0f};
  ASSERT_TRUE(has_camera_model(draft_));
  show("a.png", {});
  made();
  // 0.4 m and 0.325 m from the center are 134 and 109 pixels.
  EXPECT_NE(at(160 + 120, 120), 0);
  EXPECT_EQ(at(160 + 150, 120), 0);
  EXPECT_NE(at(160, 120 - 95), 0);
  EXPECT_EQ(at(160, 2), 0);
  // 10 cm are 33 pixels: more than the 24 without a model.
  draft_.file.field.length_m = draft_.file.field.width_m = 2.0f;
  show("a.png", {kFirst});
  made();
  EXPECT_EQ(at(80 + 6 + 30, 120), 0);
  EXPECT_NE(at(80 + 6 + 54, 120), 0);
}

TEST_F(FieldReference, EndsAtTheRegionOfInterestWithoutACameraModel) {
  for (const PixelPoint corner : {PixelPoint{60, 40}, {260, 40}, {260, 200}, {60, 200}}) {
    draft_.region_of_interest.push_back(corner);
  }
  show("a.png", {});
  made();
  EXPECT_NEAR(at(160, 120), kFloorSum, kTolerance);
  EXPECT_EQ(at(30, 120), 0);
  EXPECT_EQ(at(160, 230), 0);
}

TEST_F(FieldReference, IsRgbInEveryPixelFormat) {
  for (const PixelFormat format : {PixelFormat::kYuyv, PixelFormat::kNv12}) {
    input_.pictures.clear();
    fit_.learned.boxes.clear();
    show("a.png", {}, 1.0, format);
    made();
    EXPECT_NEAR(at(160, 120, 0), 4 * 45, kTolerance);
    EXPECT_NEAR(at(160, 120, 2), 4 * 50, kTolerance);
  }
}

TEST_F(FieldReference, OfNoPictureIsEmpty) { EXPECT_EQ(made().columns, 0); }

}  // namespace
}  // namespace touchline::calibrate
