#include <algorithm>

#include "firmware/console/hub.h"

namespace touchline::console {

Result<void> Hub::control_recording(const Client& client, const ClientMessage& message) {
  using Wish = ClientMessage::RecordingWish;
  const std::string who = "client " + std::to_string(client.number);
  if (!links_.recordings) {
    return failure(ErrorCode::kUnsupported,
                   "there is no folder for recordings: set recording.folder in the board file");
  }
  if (message.recording != Wish::kDelete) {
    return links_.recordings->set_on(message.recording == Wish::kStart, "ended on the page");
  }
  recordings_thread_.run([this, recordings = links_.recordings, name = message.name, number = client.number, who,
                          request = message.request.value_or(0)]() -> FileThread::Finish {
    const Result<void> removed = recordings->remove(name);
    return [this, removed, name, number, who, request] {
      if (removed.ok()) links_.print("console: " + who + " deleted the recording " + name);
      const auto found =
          std::find_if(clients_.begin(), clients_.end(), [&](const Client& one) { return one.number == number; });
      if (found != clients_.end()) found->answers.push_back({request, removed.ok() ? std::string() : removed.text()});
    };
  });
  return {};
}

}  // namespace touchline::console
