#include "firmware/fault_policy.h"

#include <map>

#include <gtest/gtest.h>

#include "firmware/loop_statistics.h"

namespace touchline {
namespace {

TEST(FaultPolicy, EveryCodeHasItsAction) {
  const std::map<ErrorCode, FaultAction> expected{
      {ErrorCode::kOk, FaultAction::kNone},
      {ErrorCode::kTimeout, FaultAction::kSkip},
      {ErrorCode::kBusy, FaultAction::kSkip},
      {ErrorCode::kEndOfStream, FaultAction::kLeave},
      {ErrorCode::kShortFrame, FaultAction::kSkip},
      {ErrorCode::kCorruptFrame, FaultAction::kSkip},
      {ErrorCode::kUnsupported, FaultAction::kLeave},
      {ErrorCode::kNotFound, FaultAction::kReopen},
      {ErrorCode::kPermission, FaultAction::kReopen},
      {ErrorCode::kDeviceBusy, FaultAction::kReopen},
      {ErrorCode::kDisconnected, FaultAction::kReopen},
      {ErrorCode::kIo, FaultAction::kReopen},
      {ErrorCode::kOutOfRange, FaultAction::kLeave},
      {ErrorCode::kInconsistent, FaultAction::kLeave},
      {ErrorCode::kFull, FaultAction::kSkip},
      {ErrorCode::kStopped, FaultAction::kLeave},
  };
  ASSERT_EQ(expected.size(), kErrorCodeCount) << "a code was added: decide about its action";
  for (const auto& [code, action] : expected) EXPECT_EQ(action_for(code), action) << describe(code);
}

TEST(FaultPolicy, AnInvalidCodeStopsTheRobots) {
  EXPECT_EQ(action_for(static_cast<ErrorCode>(200)), FaultAction::kLeave);
}

}  // namespace
}  // namespace touchline
