#include "core/subpixel/pose_equations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/subpixel/blurred_outline.h"
#include "core/subpixel/fit_kernel.h"
#include "tests/marker/real_layouts.h"

namespace touchline::testing {
namespace {

// 2 mm: the largest patch, a bar of 75 mm, fits into a PatchEdge.
constexpr float kEdgeRamp_m = 0.008f, kArm_m = 0.0375f, kGrid_m = 0.002f;

float ramp(float outside_m) {
  const float t = std::clamp(0.5f - outside_m / kEdgeRamp_m, 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

// The covered fraction of a pixel at (x, y) along the axes of a rectangle or a circle.
float covered(const PatchPlace& place, float x, float y) {
  if (place.outline == PatchOutline::kCircle) return ramp(std::hypot(x, y) - 0.5f * place.length_m);
  return ramp(std::abs(x) - 0.5f * place.length_m) * ramp(std::abs(y) - 0.5f * place.width_m);
}

// The pixels of a patch in the frame of a robot, whose real pose differs by `moved`: x, y, and the turn times the arm.
void see(const MarkerLayout& layout, std::size_t k, const Vector3& moved, PatchEdge& edge) {
  const PatchPlace& place = layout.patches[k];
  const BlurredOutline outline(place);
  const FieldPoint box = outline.half_box(kEdgeRamp_m);
  const float turn = moved[2] / kArm_m, c = outline.cos(), s = outline.sin();
  edge.clear();
  for (float y = -box.y_m; y < box.y_m; y += kGrid_m) {
    for (float x = -box.x_m; x < box.x_m; x += kLanes * kGrid_m) {
      edge.resize(edge.size() + 1);
      EdgePixels& pixels = edge.back();
      pixels = {};
      for (std::size_t i = 0; i < kLanes; ++i) {
        const float along = x + kGrid_m * static_cast<float>(i);
        const float px = place.x_m + c * along - s * y - moved[0], py = place.y_m + s * along + c * y - moved[1];
        const float tx = std::cos(turn) * px + std::sin(turn) * py - place.x_m;
        const float ty = std::cos(turn) * py - std::sin(turn) * px - place.y_m;
        pixels.x.value[i] = along;
        pixels.y.value[i] = y;
        pixels.measured.value[i] = 1.0f;
        pixels.light[0].value[i] = covered(place, c * tx + s * ty, c * ty - s * tx);
      }
    }
  }
}

PoseEquations equations(const MarkerLayout& layout, const Vector3& moved) {
  PoseEquations all;
  const auto edge = std::make_unique<PatchEdge>();
  for (std::size_t k = 0; k < layout.patches.size(); ++k) {
    see(layout, k, moved, *edge);
    const BlurredOutline outline(layout.patches[k]);
    EdgeFitTask task;
    task.edge = edge.get();
    task.outline = &outline;
    task.along = {1, 0, 0};
    task.ramp_m = kEdgeRamp_m;
    all += pose_equations(portable_fit_kernel().accumulate_edge(task), patch_by_pose(layout.patches[k], kArm_m));
  }
  return all;
}

// The right side is the normal matrix times a small motion. A wrong derivative would give another motion.
TEST(PoseEquations, FindASmallMotion) {
  for (const MarkerLayout& layout : {paper_layout(), bar_layout(), disks_layout()}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const float size : {-2e-4f, 2e-4f}) {
        Vector3 moved{};
        moved[axis] = size;
        const PoseEquations found = equations(layout, moved);
        Matrix3 inverse;
        ASSERT_TRUE(invert(found.normal, inverse));
        const Vector3 by = product(inverse, found.right);
        for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(by[i], moved[i], 1.2e-5f) << "axis " << axis << ", " << i;
      }
    }
  }
}

// Half the change of the squared error is the right side.
TEST(PoseEquations, HaveTheGradientOfTheSquaredError) {
  const MarkerLayout layout = paper_layout();
  const auto squared = [&](const Vector3& moved) {
    double sum = 0;
    const auto edge = std::make_unique<PatchEdge>();
    for (std::size_t k = 0; k < layout.patches.size(); ++k) {
      see(layout, k, moved, *edge);
      const BlurredOutline outline(layout.patches[k]);
      EdgeFitTask task;
      task.edge = edge.get();
      task.outline = &outline;
      task.along = {1, 0, 0};
      task.ramp_m = kEdgeRamp_m;
      sum += static_cast<double>(portable_fit_kernel().accumulate_edge(task).squares);
    }
    return sum;
  };
  const Vector3 far{0.0008f, -0.0005f, 0.0006f};
  const PoseEquations found = equations(layout, far);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    constexpr float kStep = 5e-5f;
    Vector3 before = far, after = far;
    before[axis] -= kStep;
    after[axis] += kStep;
    // The picture moves, not the model; to first order in `far`, that is the opposite.
    const double gradient = (squared(after) - squared(before)) / static_cast<double>(4 * kStep);
    const auto right = static_cast<double>(found.right[axis]);
    EXPECT_NEAR(gradient / right, 1.0, 0.15) << axis;
  }
}

TEST(PoseEquations, RefuseAnUndeterminedPose) {
  Matrix3 inverse;
  EXPECT_TRUE(invert({{{2, 0, 1}, {0, 3, 0}, {1, 0, 4}}}, inverse));
  EXPECT_NEAR(inverse[0][0], 4.0f / 7, 1e-6f);
  EXPECT_NEAR(inverse[0][2], -1.0f / 7, 1e-6f);
  EXPECT_NEAR(inverse[1][1], 1.0f / 3, 1e-6f);
  EXPECT_FALSE(invert({{{2, 2, 0}, {2, 2, 0}, {0, 0, 1}}}, inverse)) << "edges of one direction";
  EXPECT_FALSE(invert({{{1, 0, 0}, {0, 0, 0}, {0, 0, 1}}}, inverse));
}

}  // namespace
}  // namespace touchline::testing
