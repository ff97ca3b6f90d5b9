// Frames without a picture, whose source recognized robots and ball itself.
#include "core/pipeline.h"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>

namespace touchline {
namespace {

using namespace std::chrono_literals;

class SightingsOnly : public ::testing::Test {
 protected:
  SightingsOnly() {
    const auto parameters = std::make_unique<PipelineParameters>();
    parameters->has_pictures = false;
    parameters->marker.field.length_m = 1.5f;
    parameters->marker.field.width_m = 1.3f;
    PacketLayout& layout = parameters->radio;
    layout = {};
    layout.one_each = true;
    layout.receivers.push_back({0, 0});
    for (const FieldValue value : {FieldValue::kColor, FieldValue::kLeft, FieldValue::kRight}) {
      PacketField field;
      field.value = value;
      field.type = value == FieldValue::kColor ? FieldType::kU8 : FieldType::kF32;
      layout.fields.push_back(field);
    }
    const Status status = pipeline_->configure(*parameters);
    EXPECT_TRUE(status.ok()) << describe(status.code()) << ": no camera, no colors";
  }

  const StepTrace& step(float x_m, const StepInputs& inputs = {}, int robots = 1) {
    sightings_->robots.clear();
    for (int id = 0; id < robots; ++id) {
      RobotSighting robot;
      robot.id = static_cast<RobotId>(id);
      robot.has_heading = true;
      robot.pose.position = {x_m, 0.25f * static_cast<float>(id)};
      robot.confidence = 0.99f;
      sightings_->robots.push_back(robot);
    }
    sightings_->ball.seen = true;
    sightings_->ball.position = {0.5f, 0.1f};
    sightings_->ball.confidence = 0.99f;
    Frame frame;
    frame.capture_time = now_ += 16ms;
    frame.sightings = sightings_.get();
    return pipeline_->step(frame, inputs);
  }

  std::unique_ptr<Pipeline> pipeline_ = std::make_unique<Pipeline>();
  std::unique_ptr<Sightings> sightings_ = std::make_unique<Sightings>();
  Instant now_{1s};
};

TEST_F(SightingsOnly, GiveTracksAndCommands) {
  const StepTrace* trace = nullptr;
  for (int i = 0; i < 20; ++i) trace = &step(-0.3f);
  EXPECT_TRUE(trace->status.ok());
  ASSERT_EQ(trace->tracks.robots.size(), 1u);
  EXPECT_EQ(trace->tracks.robots[0].team, Team::kOwn);
  EXPECT_EQ(trace->tracks.robots[0].id, 0);
  EXPECT_EQ(trace->tracks.ball.state, TrackState::kSeen);
  EXPECT_FALSE(trace->commands.stop);
  ASSERT_EQ(trace->packets.size(), 1u);
  EXPECT_EQ(trace->packets[0].packet[0], std::byte{0}) << "the blue team";
}

TEST_F(SightingsOnly, ARefereeThatExchangesTheColorsExchangesTheTeams) {
  StepInputs inputs;
  inputs.teams.colors_exchanged = true;
  const StepTrace* trace = nullptr;
  for (int i = 0; i < 20; ++i) trace = &step(-0.3f, inputs);
  ASSERT_EQ(trace->tracks.robots.size(), 1u);
  EXPECT_EQ(trace->tracks.robots[0].team, Team::kOpponent);
  EXPECT_EQ(trace->packets[0].packet[0], std::byte{1}) << "we are the yellow team now";
}

TEST_F(SightingsOnly, EverythingMayBeElsewhereAtOnce) {
  for (int i = 0; i < 45; ++i) ASSERT_FALSE(step(-0.3f, {}, 3).picture.contradicts) << i;
  // A simulator places the robots after a goal.
  for (int i = 0; i < 20; ++i) {
    const StepTrace& trace = step(0.4f, {}, 3);
    EXPECT_FALSE(trace.picture.contradicts) << i;
    EXPECT_FALSE(trace.picture.is_unusable()) << i;
  }
}

TEST_F(SightingsOnly, APictureIsRefused) {
  Frame frame;
  frame.capture_time = now_ += 16ms;
  const StepTrace& trace = pipeline_->step(frame);
  EXPECT_EQ(trace.status.code(), ErrorCode::kUnsupported);
  EXPECT_TRUE(trace.sightings.robots.empty());
}

}  // namespace
}  // namespace touchline
