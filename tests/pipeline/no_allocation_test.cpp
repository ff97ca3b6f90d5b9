// Second of three checks for heap allocations: an allocator counts while the loop runs, with every possible device
// fault.
#include "hal/linux/monotonic_clock.h"
#include "tests/firmware/loop_fixture.h"
#include "tools/programs/latency/allocation_counter.h"

namespace touchline::testing {
namespace {

using latency::allocations_are_counted;
using latency::allocations_of_this_thread;

class NoAllocation : public LoopTest {
 protected:
  void SetUp() override {
    if (!allocations_are_counted()) GTEST_SKIP() << "a sanitizer replaces the counting allocator";
    settings.faults.camera_timeout_s = 1.0;
    settings.faults.reopen_after_s = 0.1;
    camera.opened_s.reserve(1000);
    radio.opened_s.reserve(1000);
  }

  // Every error code at every device, for as long as its consequences last, and other events.
  double add_all_faults() {
    double at_s = 1.0;
    for (int code = 1; code <= static_cast<int>(ErrorCode::kStopped); ++code) {
      if (action_for(static_cast<ErrorCode>(code)) == FaultAction::kLeave) continue;  // ends the loop
      for (Script* device :
           {static_cast<Script*>(&camera), static_cast<Script*>(&radio), static_cast<Script*>(&gpio)}) {
        device->add({at_s, at_s + 1.5, static_cast<ErrorCode>(code)});
        at_s += 4.0;
        ++faults_;
      }
    }
    gpio.pull(at_s, at_s + 0.5);
    camera.skip_at = 20;
    camera.skipped = 5;
    return at_s + 2.0;
  }

  int faults_ = 0;
  std::unique_ptr<int> planted_;
};

TEST_F(NoAllocation, LoopNeverAllocatesWithAnyDeviceFault) {
  const double end_s = add_all_faults();
  ASSERT_GE(faults_, 30);
  start();
  run_until(0.5);
  const std::uint64_t before = allocations_of_this_thread();
  while (now_s() < end_s && !loop->iterate()) {
  }
  loop->send_final_stops();
  EXPECT_EQ(allocations_of_this_thread() - before, 0U);
  EXPECT_GE(now_s(), end_s) << "the loop ended before the last fault";
  for (std::size_t device = 0; device < kDeviceCount; ++device) EXPECT_GE(loop->statistics().reopened[device], 5U);
  EXPECT_GT(ring->dropped(), 0U) << "a full ring is one of the faults";
}

TEST_F(NoAllocation, OtherProgramsAndTheRefereeCauseNone) {
  Mailbox<ExternalCommands> commands;
  Mailbox<RefereeState> referee;
  settings.external = {&commands, &referee, false};
  camera.show_robot();
  start();
  run_until(0.5);
  const std::uint64_t before = allocations_of_this_thread();
  for (int i = 0; i < 500; ++i) {
    ExternalCommand command;
    command.id = static_cast<RobotId>(i % 3);
    command.kind = static_cast<ExternalCommand::Kind>(i % 4);
    command.received = hal::MonotonicClock::read();
    ExternalCommands table;
    table.push_back(command);
    commands.put(table);
    RefereeState state;
    state.phase = i % 50 < 40 ? GamePhase::kRunning : GamePhase::kHalt;
    state.own_is_yellow = i % 100 > 80;
    state.own_on_positive_half = i % 20 < 10;
    state.own_height_m = 0.001f * static_cast<float>(i % 100);
    referee.put(state);
    static_cast<void>(loop->iterate());
  }
  EXPECT_EQ(allocations_of_this_thread() - before, 0U);
  EXPECT_GT(loop->statistics().external.commands, 400U);
  EXPECT_GT(loop->statistics().external.referee_messages, 400U);
}

TEST_F(NoAllocation, PlantedAllocationIsFound) {
  start({[](void* context, const StepTrace&, const StepTiming&) {
           static_cast<std::unique_ptr<int>*>(context)->reset(new int(1));
         },
         &planted_});
  run_until(0.5);
  const std::uint64_t before = allocations_of_this_thread();
  run_until(1.0);
  EXPECT_EQ(allocations_of_this_thread() - before, 25U);
}

TEST_F(NoAllocation, PlantedMallocIsFound) {
  const std::uint64_t before = allocations_of_this_thread();
  void* volatile block = std::malloc(100);
  block = std::realloc(block, 200);
  std::free(block);
  EXPECT_EQ(allocations_of_this_thread() - before, 2U);
}

TEST(Memory, OfTheCoreIsAsDocumented) {
  // docs/design.md, Memory. Update that page if the value leaves this range.
  constexpr std::size_t kMiB = std::size_t{1} << 20;
  EXPECT_GT(sizeof(Pipeline), 14 * kMiB / 4);
  EXPECT_LT(sizeof(Pipeline), 16 * kMiB / 4);
  EXPECT_LT(sizeof(Pipeline) + sizeof(ScanTables), 51 * kMiB / 10) << "with the tables that a reload exchanges";
}

}  // namespace
}  // namespace touchline::testing
