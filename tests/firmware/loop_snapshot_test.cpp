#include "firmware/snapshot_ring.h"
#include "hal/linux/monotonic_clock.h"
#include "tests/firmware/loop_fixture.h"
#include "tools/programs/latency/allocation_counter.h"

namespace touchline::testing {
namespace {

class LoopSnapshotTest : public LoopTest {};

TEST_F(LoopSnapshotTest, EveryFrameGivesASnapshot) {
  const auto snapshots = std::make_unique<SnapshotRing>();
  settings.snapshots = snapshots.get();
  SnapshotReader reader(*snapshots);
  struct Steps {
    std::vector<Instant> captured, sent;
  } steps;
  const Instant begin = hal::MonotonicClock::read();
  start({[](void* context, const StepTrace& trace, const StepTiming& timing) {
           Steps& seen = *static_cast<Steps*>(context);
           seen.captured.push_back(trace.frame.capture_time);
           seen.sent.push_back(timing.sent);
         },
         &steps});
  run_until(1.0);
  Snapshot snapshot;
  for (std::size_t i = 0; i < steps.sent.size(); ++i) {
    ASSERT_TRUE(reader.read(snapshot));
    EXPECT_EQ(snapshot.number, i);
    EXPECT_EQ(snapshot.captured, steps.captured[i]);
    EXPECT_EQ(snapshot.sent, steps.sent[i]);
    EXPECT_GE(snapshot.received, snapshot.captured);
    EXPECT_GE(snapshot.machine_sent, begin);
    EXPECT_LE(snapshot.machine_sent, hal::MonotonicClock::read());
    EXPECT_EQ(snapshot.width_px, FakeCamera::kWidth);
    EXPECT_EQ(snapshot.halt, kHaltNone) << i;
  }
  EXPECT_FALSE(reader.read(snapshot));
  EXPECT_GT(steps.sent.size(), 40U);
}

TEST(LoopSnapshot, CarriesTheBytesOfATestedRobot) {
  const auto trace = std::make_unique<StepTrace>();
  const auto snapshot = std::make_unique<Snapshot>();
  StepInputs inputs;
  inputs.events.telemetry.push_back(std::byte{7});
  trace->inputs = &inputs;
  PacketLayout layout;
  for (const RobotId id : {RobotId{4}, RobotId{9}}) layout.receivers.push_back({id});
  for (std::size_t i = 0; i < 2; ++i) {
    OutgoingPacket outgoing;
    outgoing.receiver = i;
    outgoing.packet.push_back(std::byte{static_cast<unsigned char>(10 + i)});
    trace->packets.push_back(outgoing);
  }
  copy_bytes(*trace, layout, 9, *snapshot);
  EXPECT_EQ(snapshot->packet_bytes, 2U) << "of all packets, which share the line";
  ASSERT_EQ(snapshot->sent_bytes.size(), 1U);
  EXPECT_EQ(snapshot->sent_bytes[0], std::byte{11});
  EXPECT_EQ(snapshot->received_bytes.size(), 1U);
  trace->packets.pop_back();
  trace->packets.back().receiver = kAllRobots;
  copy_bytes(*trace, layout, 9, *snapshot);
  ASSERT_EQ(snapshot->sent_bytes.size(), 1U);
  EXPECT_EQ(snapshot->sent_bytes[0], std::byte{10}) << "a packet for all robots";
  copy_bytes(*trace, layout, kUnknownId, *snapshot);
  EXPECT_TRUE(snapshot->sent_bytes.empty() && snapshot->received_bytes.empty()) << "nobody is tested";
  EXPECT_EQ(snapshot->packet_bytes, 1U);
}

TEST(LoopSnapshot, WritingAllocatesNothing) {
  if (!latency::allocations_are_counted()) GTEST_SKIP() << "sanitizers bring their own allocator";
  const auto snapshots = std::make_unique<SnapshotRing>();
  const auto trace = std::make_unique<StepTrace>();
  const auto snapshot = std::make_unique<Snapshot>();
  const std::uint64_t before = latency::allocations_of_this_thread();
  for (int i = 0; i < 100; ++i) {
    copy_trace(*trace, *snapshot);
    snapshots->write(*snapshot);
  }
  EXPECT_EQ(latency::allocations_of_this_thread() - before, 0U);
}

}  // namespace
}  // namespace touchline::testing
