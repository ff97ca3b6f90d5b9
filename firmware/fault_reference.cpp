#include "firmware/fault_reference.h"

#include <cstring>

#include "firmware/fault_policy.h"
#include "firmware/stop_rules.h"

namespace touchline {
namespace {

constexpr const char* kFaultsBegin = "<!-- begin: touchline faults --update -->\n";
constexpr const char* kFaultsEnd = "<!-- end -->";

struct ActionDescription {
  std::string_view robots, ends_by;
};

constexpr ActionDescription describe_action(FaultAction action) {
  switch (action) {
    case FaultAction::kNone:
      return {"drive", "-"};
    case FaultAction::kSkip:
      return {"drive on; without a good frame they stop as for `no_frames`, without packets by their own time-out",
              "the next good frame or packet"};
    case FaultAction::kReopen:
      return {"stop, as for `no_frames` (camera), `radio` (radio) or `unreadable_line` (GPIO chip)",
              "the device, which is opened again after pauses that double; for the radio see also `radio`"};
    case FaultAction::kLeave:
      return {"stop; the program ends", "a new start of the program, which then waits for a start (`crash`)"};
    case FaultAction::kContinueWithout:
      return {"drive on", "-"};
  }
  return {};
}

void add_row(std::string& page, std::string_view word, std::string_view robots, std::string_view seen,
             std::string_view ends_by) {
  page.append("| `").append(word).append("` | ").append(seen).append(" | ").append(robots).append(" | ");
  page.append(ends_by).append(" |\n");
}

}  // namespace

std::string fault_reference_markdown() {
  std::string page =
      "\n| reason | what you see (status line, page) | robots | ends by |\n"
      "|---|---|---|---|\n";
  for (const HaltDescription& halt : kHaltDescriptions)
    add_row(page, halt.word, halt.robots, halt.reason, halt.ends_by);
  page +=
      "\n## Errors of camera, radio and GPIO chip\n\n"
      "| error | what you see (event log) | robots | ends by |\n"
      "|---|---|---|---|\n";
  for (const ErrorDescription& error : kErrorDescriptions) {
    const ActionDescription action = describe_action(action_for(error.code));
    add_row(page, describe(error.code), action.robots, error.seen, action.ends_by);
  }
  return page;
}

Result<std::string> updated_fault_reference(std::string page) {
  const std::size_t begin = page.find(kFaultsBegin);
  const std::size_t from = begin + std::strlen(kFaultsBegin);
  const std::size_t end = begin == std::string::npos ? begin : page.find(kFaultsEnd, from);
  if (end == std::string::npos)
    return failure(ErrorCode::kNotFound, "the lines that begin and end the tables are missing");
  page.replace(from, end - from, fault_reference_markdown() + "\n");
  return page;
}

}  // namespace touchline
